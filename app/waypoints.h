// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "fcl_artic/trajectory.h"

namespace fcl_artic::app {

enum class Interpolation {
  linear,
  cubic,
  tangentHalfAngle,  ///< angles go so that the tangent of their half goes straight (JointMotion::tangentHalfAngle())
};
/// Of an option's value.
Interpolation interpolationNamed(const std::string& name);
/// Of a motion from one configuration to another, of which `cubic` says nothing.
JointMotion motionBetween(const KinematicTree& tree, const Eigen::VectorXd& q0, const Eigen::VectorXd& q1,
                          Interpolation interpolation, bool shortest);

/// Waypoints of a file: comma separated values, of which the first line names the columns: `time` (or `t`) and
/// variables of the robot, in any order; those that are not named stay at 0 (a quaternion at no rotation). Empty lines
/// and lines that begin with # are passed over.
struct Waypoints {
  std::vector<double> times;
  std::vector<Eigen::VectorXd> configurations;
  std::string unnamed;    ///< variables without a column
  bool open_end = false;  ///< the last line has no line end: the file may be cut short within its last number
};

/// @throws std::invalid_argument naming file, line and column; std::runtime_error for a file that can't be read to its
/// end.
Waypoints readWaypoints(const KinematicTree& tree, const std::string& path);
/// The same of a file's content. @param path  named in errors.
Waypoints parseWaypoints(const KinematicTree& tree, std::string_view content, const std::string& path);

/// `cubic` passes each inner waypoint at the speed of the parabola through it and its neighbours, and starts and ends
/// at rest.
/// @param shortest  joints that turn forever take the shorter way from waypoint to waypoint.
JointTrajectory interpolate(const KinematicTree& tree, const Waypoints& waypoints, Interpolation interpolation,
                            bool shortest);

}  // namespace fcl_artic::app
