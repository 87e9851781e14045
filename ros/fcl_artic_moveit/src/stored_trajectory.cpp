// SPDX-License-Identifier: BSD-3-Clause
//
// A planner that plans nothing: its plan is the trajectory that the request brings along. So the services and actions
// of move_group certify stored trajectories in the scene of the moment.
#include <algorithm>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <class_loader/class_loader.hpp>
#include <moveit/planning_interface/planning_interface.hpp>
#include <moveit/planning_scene/planning_scene.hpp>
#include <moveit/robot_trajectory/robot_trajectory.hpp>
#include <moveit_msgs/msg/move_it_error_codes.hpp>

namespace fcl_artic_moveit {
namespace {

using moveit_msgs::msg::MoveItErrorCodes;
constexpr const char* kName = "StoredTrajectory";

/// The one trajectory of MotionPlanRequest::reference_trajectories.
/// @throws std::invalid_argument naming what is there instead.
const trajectory_msgs::msg::JointTrajectory& storedOf(const planning_interface::MotionPlanRequest& request) {
  if (request.reference_trajectories.size() != 1 || request.reference_trajectories[0].joint_trajectory.size() != 1 ||
      !request.reference_trajectories[0].cartesian_trajectory.empty()) {
    throw std::invalid_argument(
        "reference_trajectories has to have one entry with one joint_trajectory and nothing else");
  }
  return request.reference_trajectories[0].joint_trajectory[0];
}

/// MoveIt takes numbers by their places, and passes over names that it does not know. So a joint outside the group
/// would be certified where the message has it, and not where the robot has it.
void requireFits(const trajectory_msgs::msg::JointTrajectory& stored, const moveit::core::JointModelGroup& group) {
  const std::vector<std::string>& known = group.getVariableNames();
  std::set<std::string> seen;
  for (const std::string& name : stored.joint_names) {
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      throw std::invalid_argument("joint '" + name + "' is none of the group '" + group.getName() + "'");
    }
    if (!seen.insert(name).second) throw std::invalid_argument("joint '" + name + "' is named twice");
  }
  for (std::size_t k = 0; k < stored.points.size(); ++k) {
    const auto require = [&](const char* what, const std::vector<double>& values, bool may_be_empty) {
      if (values.size() == stored.joint_names.size() || (may_be_empty && values.empty())) return;
      throw std::invalid_argument("point " + std::to_string(k) + " has " + std::to_string(values.size()) + ' ' + what +
                                  " for " + std::to_string(stored.joint_names.size()) + " joints");
    };
    require("positions", stored.points[k].positions, false);
    require("velocities", stored.points[k].velocities, true);
    require("accelerations", stored.points[k].accelerations, true);
    require("efforts", stored.points[k].effort, true);
  }
}

class StoredContext : public planning_interface::PlanningContext {
 public:
  StoredContext(const planning_scene::PlanningSceneConstPtr& scene,
                const planning_interface::MotionPlanRequest& request)
      : PlanningContext(kName, request.group_name) {
    setPlanningScene(scene);
    setMotionPlanRequest(request);
  }

  void solve(planning_interface::MotionPlanResponse& response) override {
    response.planner_id = kName;
    response.error_code.source = kName;
    response.trajectory = nullptr;
    try {
      const trajectory_msgs::msg::JointTrajectory& stored = storedOf(request_);
      const moveit::core::RobotStatePtr start = planning_scene_->getCurrentStateUpdated(request_.start_state);
      // Rates that the robot happens to have are none of the trajectory's.
      start->dropVelocities();
      start->dropAccelerations();
      const moveit::core::JointModelGroup* group = start->getJointModelGroup(request_.group_name);
      if (!group) throw std::invalid_argument("there is no group '" + request_.group_name + "'");
      requireFits(stored, *group);
      auto trajectory = std::make_shared<robot_trajectory::RobotTrajectory>(start->getRobotModel(), group);
      trajectory->setRobotTrajectoryMsg(*start, stored);
      response.trajectory = std::move(trajectory);
      response.error_code.val = MoveItErrorCodes::SUCCESS;
    } catch (const std::exception& error) {
      response.error_code.val = MoveItErrorCodes::INVALID_MOTION_PLAN;
      response.error_code.message = std::string("the stored trajectory is not looked at: ") + error.what();
    }
  }

  void solve(planning_interface::MotionPlanDetailedResponse& response) override {
    planning_interface::MotionPlanResponse one;
    solve(one);
    response.planner_id = one.planner_id;
    response.error_code = one.error_code;
    if (!one.trajectory) return;
    response.trajectory = {one.trajectory};
    response.description = {"stored"};
    response.processing_time = {0};
  }

  bool terminate() override { return true; }
  void clear() override {}
};

}  // namespace

/// Planner whose plan is the request's one reference trajectory, on its group, from the request's start state.
class StoredTrajectory : public planning_interface::PlannerManager {
 public:
  [[nodiscard]] std::string getDescription() const override { return kName; }

  planning_interface::PlanningContextPtr getPlanningContext(const planning_scene::PlanningSceneConstPtr& scene,
                                                            const planning_interface::MotionPlanRequest& request,
                                                            MoveItErrorCodes& error_code) const override {
    if (!scene) {
      error_code.val = MoveItErrorCodes::FAILURE;
      return nullptr;
    }
    error_code.val = MoveItErrorCodes::SUCCESS;
    return std::make_shared<StoredContext>(scene, request);
  }

  [[nodiscard]] bool canServiceRequest(const planning_interface::MotionPlanRequest& request) const override {
    return !request.reference_trajectories.empty();
  }
};

}  // namespace fcl_artic_moveit

CLASS_LOADER_REGISTER_CLASS(fcl_artic_moveit::StoredTrajectory, planning_interface::PlannerManager)
