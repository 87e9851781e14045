// SPDX-License-Identifier: BSD-3-Clause
#include <iostream>

#include <fcl_artic/ompl/planning_setup.h>
#include <ompl/geometric/SimpleSetup.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>

int main() {
  using namespace fcl_artic;
  namespace ob = ompl::base;
  namespace og = ompl::geometric;
  ompl::msg::setLogLevel(ompl::msg::LOG_ERROR);

  const Robot robot = loadUrdf("data/puma560/puma560.urdf");
  const Scene scene = loadScene("data/pipes.obj");
  const auto manager = std::make_shared<ArticulatedCollisionManager>(robot.tree);
  robot.addTo(*manager);
  scene.addTo(*manager);
  manager->setup();
  // With an SRDF all of this is one line: setUpPlanning("arm.urdf", "arm.srdf", "table.scene", "group").
  const planning::PlanningSetup setup = planning::setUpPlanning(manager, {});

  ob::ScopedState<> start(setup.space), goal(setup.space);
  setup.setState(start.get(), {-2.1, 1.0, -1.0, -0.1, -0.1, 0.0});  // rad
  setup.setState(goal.get(), {-0.1, 0.3, -2.3, -1.0, 1.1, 0.0});
  std::cout << "straight way free: " << (setup.si->checkMotion(start.get(), goal.get()) ? "yes" : "no") << '\n';

  og::SimpleSetup plan(setup.si);
  plan.setStartAndGoalStates(start, goal);
  plan.setPlanner(std::make_shared<og::RRTConnect>(setup.si));
  if (plan.solve(10.0) != ob::PlannerStatus::EXACT_SOLUTION) {
    std::cout << "no plan within 10 s\n";
    return 1;
  }
  plan.simplifySolution();
  og::PathGeometric& path = plan.getSolutionPath();
  std::cout << "plan of " << path.getStateCount() << " states, proven free: " << (path.check() ? "yes" : "no") << '\n';
}
