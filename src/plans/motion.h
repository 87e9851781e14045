// SPDX-License-Identifier: BSD-3-Clause
//
// From a plan as its file says it to the motion that is asked about: what is between the waypoints is said here, and
// nowhere guessed.
#pragma once

#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "fcl_artic/trajectory.h"
#include "plans/plan.h"

namespace fcl_artic::plans {

/// What lies between two waypoints that are h apart, s = (t - t_k) / h in [0, 1], d = q1 - q0.
///
/// - linear: q0 + s d; a quaternion turns the shorter way at constant speed. Velocities do not count.
/// - cubic (Hermite), with velocities v: q0 + c1 s + c2 s² + c3 s³,
///     c1 = h v0,  c2 = 3 d - 2 h v0 - h v1,  c3 = h v0 + h v1 - 2 d.
/// - quintic, with velocities and accelerations a: q0 + c1 s + ... + c5 s⁵,
///     c1 = h v0,  c2 = h² a0 / 2,  c3 = 10 d - 6 h v0 - 4 h v1 - 3/2 h² a0 + 1/2 h² a1,
///     c4 = -15 d + 8 h v0 + 7 h v1 + 3/2 h² a0 - h² a1,  c5 = 6 d - 3 h (v0 + v1) - 1/2 h² (a0 - a1).
/// - jtcUpsampled: the one spline of cubics whose velocity and acceleration go on at the inner waypoints, from rest to
///   rest; of a plan with velocities as automatic.
/// - blends: straight lines joined by parabolas, at constant acceleration from `blend` before each inner waypoint to
///   `blend` after it (JointTrajectory::parabolicBlends()).
///
/// - tangentHalfAngle: JointTrajectory::tangentHalfAngle().
///
/// Cubic and quintic are the only polynomials of these degrees with these values at both ends, and so those of
/// ros_control's and ros2_control's joint_trajectory_controller, which takes the highest degree that both points have
/// values for, as `automatic` and `jtc` do. Of joints that turn forever it takes the values as they are. Rounding of
/// their coefficients moves them by no more than 2e-13 of the largest of |q|, h |v| and h² |a| of the two waypoints
/// (doc/NUMERICS.md, section 12); what is certified is the polynomial with these coefficients.
enum class Interpolation {
  automatic,  ///< quintic where velocities and accelerations are given, cubic where velocities are, else linear
  linear,
  cubic,
  quintic,
  blends,
  jtc,               ///< as automatic: what joint_trajectory_controller runs by `interpolation_method: splines`
  jtcUpsampled,      ///< what it runs of a message on its topic, by `positions_upsampling.enable: true`
  jtcNone,           ///< `interpolation_method: none`: each waypoint at once; taken as linear, and noted
  tangentHalfAngle,  ///< the tangent of half of each angle goes straight
};

/// Of an option's value: "auto", "linear", "cubic", "quintic", "blends", "jtc", "jtc-upsampled", "jtc-none" or
/// "tangent-half-angle". @throws std::invalid_argument, which says of "totg" what to do.
Interpolation interpolationNamed(const std::string& name);
const char* toString(Interpolation interpolation);

/// How joints that turn forever go from value to value, where that makes a difference: where a step is longer than half
/// a turn.
enum class Turns {
  ask,      ///< such a step is refused, and both ways named
  given,    ///< as the values say
  shortest  ///< the shorter way round (JointTrajectory::Unwrap::yes)
};

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
  /// What was accepted though beyond, a note for each joint.
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

/// @throws std::invalid_argument naming waypoint and joint: the plan's own error; fewer than two waypoints, rows of
///   another length than joints; a joint that is unknown, named twice, or without a value; values that are not finite,
///   or beyond the joint's limits by more than the tolerance; times that do not increase; an interpolation for which
///   velocities or accelerations are missing, or that has no times; a turn that has to be asked for; a quaternion that
///   turns by half a turn from one waypoint to the next, which says not which way round.
PlanMotion toMotion(const KinematicTree& tree, const Plan& plan, const MotionOptions& options);

}  // namespace fcl_artic::plans
