// SPDX-License-Identifier: BSD-3-Clause
//
// The way between two waypoints. The program, the Python module and the MoveIt adapter share these names.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "fcl_artic/export.h"
#include "fcl_artic/kinematic_tree.h"
#include "fcl_artic/trajectory.h"

namespace fcl_artic {

/// The way between two waypoints that are h apart, s = (t - t_k) / h in [0, 1], d = q1 - q0.
///
/// - linear: q0 + s d; a quaternion turns the shorter way at constant speed. Velocities do not count.
/// - cubic (Hermite), with velocities v: q0 + c1 s + c2 s² + c3 s³,
///     c1 = h v0,  c2 = 3 d - 2 h v0 - h v1,  c3 = h v0 + h v1 - 2 d.
/// - quintic, with velocities and accelerations a: q0 + c1 s + ... + c5 s⁵,
///     c1 = h v0,  c2 = h² a0 / 2,  c3 = 10 d - 6 h v0 - 4 h v1 - 3/2 h² a0 + 1/2 h² a1,
///     c4 = -15 d + 8 h v0 + 7 h v1 + 3/2 h² a0 - h² a1,  c5 = 6 d - 3 h (v0 + v1) - 1/2 h² (a0 - a1).
/// - jtcUpsampled: the one spline of cubics whose velocity and acceleration go on at the inner waypoints, from rest to
///   rest (restToRestVelocities()); of waypoints with velocities as automatic.
/// - blends: straight lines joined by parabolas, at constant acceleration from `blend` before each inner waypoint to
///   `blend` after it (JointTrajectory::parabolicBlends()).
/// - tangentHalfAngle: JointTrajectory::tangentHalfAngle().
///
/// Cubic and quintic are the only polynomials of these degrees with these values at both ends. So they are those of
/// ros_control's and ros2_control's joint_trajectory_controller. It takes the highest degree that both points have
/// values for, as `automatic` and `jtc` do. If joints turn forever, it takes their values as they are. Rounding of
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
  jtcNone,           ///< `interpolation_method: none`: each waypoint at once; taken as linear
  tangentHalfAngle,  ///< the tangent of half of each angle goes straight
};

/// How joints that turn forever go from value to value, where that makes a difference: where a step is longer than half
/// a turn.
enum class Turns {
  ask,      ///< such a step is refused, and both ways named
  given,    ///< as the values say
  shortest  ///< the shorter way round (JointTrajectory::Unwrap::yes)
};

/// Returns the interpolation of a name: "auto", "linear", "cubic", "quintic", "blends", "jtc", "jtc-upsampled",
/// "jtc-none" or "tangent-half-angle". @throws std::invalid_argument which names these, and says of "totg" what to do.
FCL_ARTIC_EXPORT Interpolation interpolationNamed(const std::string& name);
/// The name of an interpolation.
FCL_ARTIC_EXPORT const char* toString(Interpolation interpolation);
/// Returns the turns of a name: "ask", "given" or "shortest". @throws std::invalid_argument naming these.
FCL_ARTIC_EXPORT Turns turnsNamed(const std::string& name);

/// Whether an interpolation is named for joint_trajectory_controller: jtc, jtcUpsampled or jtcNone.
FCL_ARTIC_EXPORT bool isController(Interpolation interpolation);

/// The turns that an interpolation leaves to the caller: joint_trajectory_controller goes as the values say.
/// @throws std::invalid_argument for Turns::shortest beside an interpolation that says itself which way round.
FCL_ARTIC_EXPORT Turns turnsOf(Interpolation interpolation, Turns asked);

/// The values that waypoints have beside their positions.
struct WaypointValues {
  bool times, velocities, accelerations;
};

/// The curve that an interpolation is between waypoints of these values; never automatic or jtc.
/// @throws std::invalid_argument naming what is missing: velocities, accelerations or times of a curve that depends on
///   them; for accelerations without velocities, unless the interpolation is stated.
FCL_ARTIC_EXPORT Interpolation curveOf(Interpolation interpolation, const WaypointValues& given);

/// Velocities of the spline of cubics that goes through waypoints from rest to rest, and whose acceleration has no
/// jump: those of JointTrajectory::cubic().
/// @param times      one for each waypoint, increasing.
/// @param waypoints  at least two, of one size, rad or m.
/// @return one vector for each waypoint, rad or m per unit of time; 0 for the first and the last.
FCL_ARTIC_EXPORT std::vector<Eigen::VectorXd> restToRestVelocities(const std::vector<double>& times,
                                                                   const std::vector<Eigen::VectorXd>& waypoints);

/// Waypoints of all joint variables, and their values.
struct Waypoints {
  std::vector<double> times;
  std::vector<Eigen::VectorXd> positions;      ///< rad or m
  std::vector<Eigen::VectorXd> velocities;     ///< read by cubic and quintic
  std::vector<Eigen::VectorXd> accelerations;  ///< read by quintic
};

/// Makes the trajectory of a curve through waypoints.
/// @param curve  as curveOf() returns it.
/// @param blend  half the duration of a blend, in the unit of the times; read by `blends`.
/// @throws std::invalid_argument as the members of JointTrajectory that make them.
FCL_ARTIC_EXPORT JointTrajectory makeTrajectory(const KinematicTree& tree, Interpolation curve,
                                                const Waypoints& waypoints, double blend,
                                                JointTrajectory::Unwrap unwrap);

}  // namespace fcl_artic
