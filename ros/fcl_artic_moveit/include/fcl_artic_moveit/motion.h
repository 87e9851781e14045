// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include <fcl_artic/trajectory.h>
#include <moveit/robot_trajectory/robot_trajectory.hpp>

#include "fcl_artic_moveit/robot.h"

namespace fcl_artic_moveit {

/// What lies between two waypoints, by what runs it. The polynomials are those of fcl_artic::JointTrajectory::linear(),
/// cubic() and quintic().
enum class Interpolation {
  automatic,  ///< quintic where the waypoints have velocities and accelerations, cubic with velocities, else linear
  linear,     ///< straight in the joints; quaternions by the shortest rotation
  cubic,      ///< the cubic with the waypoints' velocities
  quintic,    ///< the quintic with their velocities and accelerations
  jtc,        ///< as automatic: what joint_trajectory_controller runs by `interpolation_method: splines`
  jtc_none    ///< `interpolation_method: none`: each waypoint at once; taken as linear, and noted
};

/// How joints that turn forever go where a step is half a turn or longer.
enum class Turns {
  ask,      ///< such a step is refused
  given,    ///< as the values say
  shortest  ///< the shorter way round, as MoveIt's own interpolation has it
};

/// Of a parameter's value: "auto", "linear", "cubic", "quintic", "jtc", "jtc-none". @throws std::invalid_argument
/// naming these.
Interpolation interpolationNamed(const std::string& name);
/// Of a parameter's value: "ask", "given", "shortest". @throws std::invalid_argument naming these.
Turns turnsNamed(const std::string& name);
const char* toString(Interpolation interpolation);

struct MotionOptions {
  Interpolation interpolation = Interpolation::automatic;
  Turns turns = Turns::ask;
  /// By how much a mimic joint that moves with the group may be off from where its master has it, as encoders are, rad
  /// or m. What is certified is where the master has it.
  double mimic_tolerance = 1e-3;
};

/// A MoveIt trajectory as the motion that is asked about.
struct Motion {
  Interpolation interpolation;  ///< that was used: linear, cubic or quintic
  bool timed;                   ///< whether the trajectory has times; if not, they are the waypoints' numbers
  std::vector<double> times;    ///< of the waypoints, s, from the trajectory's start, as in its message
  fcl_artic::JointTrajectory trajectory;
  std::vector<std::string> notes;  ///< what was accepted though unusual, one line each

  /// The waypoint at or before time t.
  std::size_t waypointBefore(double t) const;
};

/// Makes a motion of a trajectory. Joints that are not in its group stay where its first waypoint has them, mimic
/// joints too where the tree lets them stand. A single waypoint stands still, from 0 to 1.
/// @param trajectory  of the model that `robot` was made of.
/// @throws std::invalid_argument, naming waypoint and joint: no waypoint, a joint outside the group that moves, values
///   that are not finite, mimic joints that are elsewhere than their masters have them, times that do not increase,
///   waypoints of which only some have velocities or accelerations, an interpolation for which these or the times are
///   missing, a step of half a turn (Turns::ask), a floating joint that turns by a quintic or moves by a cubic, a
///   planar joint with differential drive that moves, unless the interpolation is stated.
Motion toMotion(const RobotTree& robot, const robot_trajectory::RobotTrajectory& trajectory,
                const MotionOptions& options = {});

/// Whether a joint moves with the group: it is one of its joints or mimics one; with no group all do.
bool movesWith(const moveit::core::JointModelGroup* group, const moveit::core::JointModel& joint);

}  // namespace fcl_artic_moveit
