// SPDX-License-Identifier: BSD-3-Clause
//
// Plans for a mesh that moves freely among meshes, with OMPL's SE3StateSpace, as FCL's users do, but without a
// resolution.
#include <iostream>

#include <fcl_artic/ompl/planning_setup.h>
#include <ompl/base/spaces/SE3StateSpace.h>
#include <ompl/geometric/SimpleSetup.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>

int main() {
  using namespace fcl_artic;
  namespace ob = ompl::base;
  namespace og = ompl::geometric;
  ompl::msg::setLogLevel(ompl::msg::LOG_ERROR);

  planning::SetupOptions options;
  options.position_lower = {-1.5, -1.5, -0.5};  // m
  options.position_upper = {1.5, 1.5, 1.5};
  const auto body = loadMesh("data/puma560/meshes/forearm.obj", Eigen::Vector3d::Ones());
  const planning::PlanningSetup setup = planning::setUpRigidBody(body, loadScene("data/pipes.obj"), options);

  ob::ScopedState<ob::SE3StateSpace> start(setup.space), goal(setup.space);
  start->setXYZ(-1.4, -1.4, 1.2);
  start->rotation().setIdentity();
  goal->setXYZ(1.4, 1.4, 0.2);
  goal->rotation().setAxisAngle(0, 0, 1, 1.5);  // rad
  std::cout << "straight way free: " << (setup.si->checkMotion(start.get(), goal.get()) ? "yes" : "no") << '\n';

  og::SimpleSetup plan(setup.si);
  plan.setStartAndGoalStates(start, goal);
  plan.setPlanner(std::make_shared<og::RRTConnect>(setup.si));
  if (plan.solve(30.0) != ob::PlannerStatus::EXACT_SOLUTION) {
    std::cout << "no plan within 30 s\n";
    return 1;
  }
  plan.simplifySolution();
  og::PathGeometric& path = plan.getSolutionPath();
  std::cout << "plan of " << path.getStateCount() << " states, proven free: " << (path.check() ? "yes" : "no") << '\n';
}
