// SPDX-License-Identifier: BSD-3-Clause
//
// The bodies that the robot carries along a trajectory.
#pragma once

#include <moveit/robot_state/robot_state.hpp>
#include <moveit/robot_trajectory/robot_trajectory.hpp>

namespace fcl_artic_moveit {

/// A trajectory along which bodies come and go is none that a manager is asked about.
/// @throws std::invalid_argument if there is no waypoint, or one carries other bodies than the first.
void requireSameBodies(const robot_trajectory::RobotTrajectory& trajectory);

/// A planner whose waypoints have lost what the robot carries leaves a trajectory of another robot.
/// @throws std::invalid_argument if `first` lacks a body that `start` carries, or has it elsewhere.
void requireBodiesOf(const moveit::core::RobotState& start, const moveit::core::RobotState& first);

}  // namespace fcl_artic_moveit
