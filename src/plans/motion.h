// SPDX-License-Identifier: BSD-3-Clause
//
// From a plan as its file says it to the motion that is asked about: what is between the waypoints is said here, and
// nowhere guessed.
#pragma once

#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "fcl_artic/interpolation.h"
#include "fcl_artic/trajectory.h"
#include "plans/plan.h"

namespace fcl_artic::plans {

// The names of the way between waypoints are the library's (fcl_artic/interpolation.h).
using fcl_artic::Interpolation;
using fcl_artic::interpolationNamed;
using fcl_artic::toString;
using fcl_artic::Turns;
using fcl_artic::turnsNamed;

/// By so much a value may be beyond a joint's limit, as a sensor's may, and is noted: rad, and for lengths a tenth of
/// it in m.
constexpr double kLimitTolerance = 1e-3;

/// Judges values by the limits of their joints, and keeps of each joint how far they are beyond at most.
class LimitJudge {
 public:
  /// @param tree  must outlive this object.
  /// @param tolerance  as kLimitTolerance, at least 0.
  /// @param ignore  refuses nothing.
  explicit LimitJudge(const KinematicTree& tree, double tolerance = kLimitTolerance, bool ignore = false);
  /// @return why a value of variable v is refused, as an end of a sentence; empty: it is not.
  std::string refusal(int v, double value);
  /// Notes of what was accepted though beyond, one for each joint.
  std::vector<std::string> notes() const;

 private:
  const KinematicTree& tree_;
  double tolerance_;
  bool ignore_;
  std::vector<double> most_;  ///< by variable
};

struct MotionOptions {
  Interpolation interpolation = Interpolation::automatic;
  double blend = 0;  ///< s; half the duration of a blend
  Turns turns = Turns::ask;
  bool ignore_limits = false;                ///< waypoints beyond the joints' limits are noted, not refused
  double limit_tolerance = kLimitTolerance;  ///< of waypoints; at least 0
  bool degrees = false;                      ///< angles of the plan, and their rates, are in degrees
  std::vector<std::string> joints;           ///< names for plans without names, in their order; empty: all variables
  std::map<std::string, double> state;  ///< values of joints that plans do not name; before those of the plan itself
};

/// The motion of a plan.
struct PlanMotion {
  Interpolation interpolation;             ///< that was used; never automatic or jtc
  std::vector<std::string> joints;         ///< what the plan's columns are taken for, in their order
  bool named;                              ///< the plan says so itself; else by MotionOptions::joints or the robot
  bool foreign;                            ///< of Plan
  std::map<std::string, double> rest;      ///< values of all other variables
  std::vector<double> times;               ///< of the waypoints, s; 0, 1, 2 ... where `timed` is false
  std::vector<Eigen::VectorXd> waypoints;  ///< all variables of the tree, as the plan has them
  JointTrajectory trajectory;
  bool timed;
  bool part;                       ///< of Plan
  std::vector<std::string> notes;  ///< the plan's, and what was accepted though unusual

  /// The waypoint at or before time t: 0 to the last.
  std::size_t waypointBefore(double t) const;
};

/// A plan whose angles, and their rates, are in degrees, in rad.
/// @param plan  names its joints.
/// @throws std::invalid_argument: some of its values are in rad already (Plan::has_degrees).
Plan inRadians(const KinematicTree& tree, const Plan& plan);

/// The variables that columns without names are: MotionOptions::joints, else all that MotionOptions::state does not
/// give.
std::vector<std::string> unnamedColumns(const KinematicTree& tree, const MotionOptions& options);

/// For plans among objects that move by themselves (ObjectSpeed): these begin at their places with the plan.
/// @throws std::invalid_argument: the plan has no times, or is one of several parts that follow each other.
void requireClock(const PlanMotion& motion);

/// @throws std::invalid_argument naming waypoint and joint:
///   - the plan's own error;
///   - fewer than two waypoints, rows of another length than joints;
///   - a joint that is unknown, named twice, or without a value;
///   - values that are not finite, or beyond the joint's limits by more than the tolerance;
///   - times that do not increase;
///   - an interpolation for which velocities or accelerations are missing, or that has no times;
///   - a turn that has to be asked for;
///   - a quaternion that turns by half a turn from one waypoint to the next, which says not which way round.
PlanMotion toMotion(const KinematicTree& tree, const Plan& plan, const MotionOptions& options);

}  // namespace fcl_artic::plans
