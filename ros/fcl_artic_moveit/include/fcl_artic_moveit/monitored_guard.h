// SPDX-License-Identifier: BSD-3-Clause
//
// A guard of executions, on a node, that a planning scene monitor keeps up to date.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include <moveit/planning_scene_monitor/planning_scene_monitor.hpp>
#include <rclcpp/rclcpp.hpp>

#include "fcl_artic_moveit/execution_guard.h"

namespace fcl_artic_moveit {

/// Renews the scene with each update of the monitor, and asks twice in each `period` while a trajectory is executed
/// (Executor::joints). The node has to spin, and the monitor has to monitor. If one of them hangs, or the process ends,
/// nobody stops the robot. If a controller slows down, or says where it is, use ExecutionGuard itself.
class MonitoredGuard {
 public:
  /// Declares the parameters below `prefix` (README.md), and reads them.
  /// @throws std::invalid_argument naming the parameter and its value, rclcpp's exceptions.
  MonitoredGuard(const rclcpp::Node::SharedPtr& node, const planning_scene_monitor::PlanningSceneMonitorPtr& monitor,
                 const std::string& prefix = "execution_guard");
  ~MonitoredGuard();

  /// Sets who stops the execution: called once for each trajectory, on a thread of the node's executor.
  void onMustStop(std::function<void(const GuardReply&)> call);

  /// To be called right before the trajectory is sent to the controllers.
  /// @return the first answer. If it says stop, the trajectory must not be sent: nobody else is told.
  /// @throws as ExecutionGuard::follow().
  GuardReply begin(const robot_trajectory::RobotTrajectory& trajectory);
  /// Has the guard answer no more. To be called when the execution has ended.
  void end();

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace fcl_artic_moveit
