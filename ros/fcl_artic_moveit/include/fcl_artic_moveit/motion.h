// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include <fcl_artic/interpolation.h>
#include <moveit/robot_trajectory/robot_trajectory.hpp>

#include "fcl_artic_moveit/robot.h"

namespace fcl_artic_moveit {

// Curves between two waypoints have the names that the program has: fcl_artic/interpolation.h.
using fcl_artic::Interpolation;
using fcl_artic::interpolationNamed;
using fcl_artic::Turns;
using fcl_artic::turnsNamed;

struct MotionOptions {
  Interpolation interpolation = Interpolation::automatic;
  Turns turns = Turns::ask;  ///< that a controller's own interpolation leaves open: fcl_artic::turnsOf()
  /// By how much a mimic joint that moves with the group may be off from where its master has it, as encoders are, rad
  /// or m. The motion that is certified has the joint where the master has it.
  double mimic_tolerance = 1e-3;
  double blend = 0;  ///< s, half the duration of a blend, of Interpolation::blends
};

/// A MoveIt trajectory as the motion that is asked about.
struct Motion {
  Interpolation interpolation;     ///< that was used; never automatic or jtc
  bool timed;                      ///< whether the trajectory has times; if not, they are the waypoints' numbers
  std::vector<double> times;       ///< of the waypoints, s, from the trajectory's start, as in its message
  fcl_artic::Waypoints waypoints;  ///< these times, and all variables of the tree, with the rates that count
  fcl_artic::JointTrajectory trajectory;
  std::vector<std::string> notes;  ///< what was accepted though unusual, one line each

  /// The waypoint at or before time t.
  std::size_t waypointBefore(double t) const;
};

/// Makes a motion of a trajectory. Joints that are not in its group stay where its first waypoint has them, mimic
/// joints too where the tree lets them stand. A single waypoint stands still, from 0 to 1.
/// @param trajectory  of the model that `robot` was made of.
/// @throws std::invalid_argument, naming waypoint and joint: no waypoint, a joint outside the group that moves, values
///   that are not finite, times that do not increase. Also for mimic joints not where their masters have them. Also for
///   waypoints of which only some have velocities or accelerations, an interpolation for which these or the times are
///   missing, and a step of half a turn (Turns::ask). Also for a floating joint that moves by another curve than linear
///   or by a controller's. Also for a planar joint with differential drive that moves, unless the interpolation is
///   stated.
Motion toMotion(const RobotTree& robot, const robot_trajectory::RobotTrajectory& trajectory,
                const MotionOptions& options = {});

/// Whether a joint moves with the group: it is one of its joints or mimics one; with no group all do.
bool movesWith(const moveit::core::JointModelGroup* group, const moveit::core::JointModel& joint);

}  // namespace fcl_artic_moveit
