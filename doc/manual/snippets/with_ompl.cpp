// SPDX-License-Identifier: BSD-3-Clause
// OMPL's planners with certified motions: status 0 if all is as the page says.
// [use]
#include <iostream>

#include <fcl_artic/ompl/planning_setup.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/SimpleSetup.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>

namespace ob = ompl::base;
using namespace fcl_artic;

int main() {
  const Robot robot = loadUrdf("data/puma560/puma560.urdf");
  const Scene scene = loadScene("data/pipes.obj");
  const auto manager = std::make_shared<ArticulatedCollisionManager>(robot.tree);
  robot.addTo(*manager);
  scene.addTo(*manager);
  manager->setup();

  const planning::PlanningSetup setup = planning::setUpPlanning(manager, {});  // no joint named: all that move
  ompl::geometric::SimpleSetup plan(setup.si);
  ob::ScopedState<> start(setup.space), goal(setup.space);
  setup.setState(start.get(), {-2.1, 1.0, -1.0, -0.1, -0.1, 0.0});  // rad, in the order of setup.joints
  setup.setState(goal.get(), {-0.1, 0.3, -2.3, -1.0, 1.1, 0.0});
  plan.setStartAndGoalStates(start, goal);
  plan.setPlanner(std::make_shared<ompl::geometric::RRTConnect>(setup.si));
  if (plan.solve(30.0) != ob::PlannerStatus::EXACT_SOLUTION) return 1;
  plan.simplifySolution();
  const bool proven = plan.getSolutionPath().check();  // every motion of the plan, as it is now
  std::cout << (proven ? "proven free\n" : "not proven free\n");
  // [/use]

  // [own]
  const auto space = std::make_shared<ob::RealVectorStateSpace>(2);
  space->setBounds(-2, 2);  // rad
  const auto si = std::make_shared<ob::SpaceInformation>(space);
  Eigen::VectorXd others(6);
  others << 0, 0.8, -1.4, 0, 0, 0;  // where the other joints stay
  const planning::JointMapping mapping(*space, manager->sharedTree(), {"joint1", "joint5"}, others);
  si->setMotionValidator(std::make_shared<planning::ContinuousMotionValidator>(si, manager, mapping));
  si->setStateValidityChecker(std::make_shared<planning::CollisionStateValidityChecker>(si, manager, mapping));
  si->setup();
  // [/own]

  // [why]
  ob::ScopedState<> from(start), to(goal);
  const planning::JointMapping all(*setup.space, manager->sharedTree(), setup.joints);
  const CertifiedResult result = manager->continuousCollide(all.motion(from.get(), to.get()));
  std::cout << result << '\n';
  if (const auto* contact = result.first()) std::cout << *contact << '\n';
  // [/why]

  ob::ScopedState<> here(space), there(space);
  here[0] = there[0] = -0.7;
  here[1] = 0;
  there[1] = 0.2;
  const bool turns = si->isValid(here.get()) && si->checkMotion(here.get(), there.get());
  return proven && turns && result.certain && result.first() && !setup.si->checkMotion(start.get(), goal.get()) ? 0 : 1;
}
