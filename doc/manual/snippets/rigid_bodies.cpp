// SPDX-License-Identifier: BSD-3-Clause
// A mesh that moves freely among meshes: status 0 if all is as the page says.
// [use]
#include <iostream>

#include <fcl_artic/ompl/planning_setup.h>
#include <ompl/base/spaces/SE3StateSpace.h>
#include <ompl/geometric/SimpleSetup.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>

namespace ob = ompl::base;
using namespace fcl_artic;

int main() {
  planning::SetupOptions options;
  options.position_lower = {-1.5, -1.5, -0.5};  // m
  options.position_upper = {1.5, 1.5, 1.5};
  const auto body = loadMesh("data/puma560/meshes/forearm.obj", Eigen::Vector3d::Ones());  // or any other geometry
  const auto setup = planning::setUpRigidBody(body, loadScene("data/pipes.obj"), options);

  ob::ScopedState<> start(setup.space), goal(setup.space);
  setup.setState(start.get(), {-1.4, -1.4, 1.2, 0, 0, 0, 1});               // x, y, z in m, quaternion x, y, z, w
  setup.setState(goal.get(), {1.4, 1.4, 0.2, 0, 0, 0.6816388, 0.7316889});  // turned by 1.5 rad about z
  ompl::geometric::SimpleSetup plan(setup.si);
  plan.setStartAndGoalStates(start, goal);
  plan.setPlanner(std::make_shared<ompl::geometric::RRTConnect>(setup.si));
  if (plan.solve(30.0) != ob::PlannerStatus::EXACT_SOLUTION) return 1;
  plan.simplifySolution();
  const bool proven = plan.getSolutionPath().check();
  std::cout << (proven ? "proven free\n" : "not proven free\n");
  // [/use]

  // [plan]
  // Somebody's plan: x, y, z and the quaternion x, y, z, w of each pose.
  const std::vector<std::vector<double>> poses = {
      {-1.4, -1.4, 1.2, 0, 0, 0, 1}, {-1.2, -1.4, 1.2, 0, 0, 0, 1}, {1.4, 1.4, 0.2, 0, 0, 0.6816388, 0.7316889}};
  const planning::JointMapping mapping(*setup.space, setup.manager->sharedTree());
  ob::ScopedState<> from(setup.space), to(setup.space);
  std::vector<CertifiedResult> results;
  for (std::size_t i = 0; i + 1 < poses.size(); ++i) {
    setup.setState(from.get(), poses[i]);
    setup.setState(to.get(), poses[i + 1]);
    results.push_back(setup.manager->continuousCollide(mapping.motion(from.get(), to.get())));
    std::cout << "from pose " << i << ": " << results.back() << '\n';
    if (const auto* contact = results.back().first()) std::cout << *contact << '\n';
  }
  // [/plan]
  return proven && results[0].isFree() && results[1].certain && results[1].first() ? 0 : 1;
}
