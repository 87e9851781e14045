// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "fcl_artic/joint_motion.h"

namespace fcl_artic {

/// A trajectory in joint space: motions one after the other, each a polynomial of time up to the fifth degree. Times
/// are in any unit, seconds mostly; they are finite and increase.
///
/// What is checked is what the pieces say, in doubles: piece k begins exactly at its own first configuration. Where one
/// piece ends and the next begins they may differ by rounding, 1e-9 rad or m (and 1e-12 of the values); more is refused
/// as a jump.
class FCL_ARTIC_EXPORT JointTrajectory {
 public:
  /// What a list of waypoints means for joints that turn forever (continuous ones, a planar joint's angle).
  enum class Unwrap {
    no,   ///< from value to value as they are, also where that is the longer way round
    yes,  ///< each takes the shorter way from its predecessor: whole turns are added from there on
  };

  /// Polynomials of t - times[k] on [times[k], times[k + 1]].
  /// @param times  one more than pieces.
  /// @param coefficients  of each piece, as JointMotion::polynomial() takes them; column j belongs to (t - times[k])^j.
  /// @throws std::invalid_argument, naming piece and joint: as JointMotion::polynomial(), wrong sizes, times that do
  ///   not increase, a jump from one piece to the next.
  static JointTrajectory piecewise(const KinematicTree& tree, const std::vector<double>& times,
                                   const std::vector<Eigen::MatrixXd>& coefficients);

  /// Straight from waypoint to waypoint, quaternions by the shortest rotation, as JointMotion::linear().
  /// @throws std::invalid_argument, naming the waypoint: fewer than two, as JointMotion::linear(), times that do not
  /// increase.
  static JointTrajectory linear(const KinematicTree& tree, const std::vector<double>& times,
                                const std::vector<Eigen::VectorXd>& waypoints, Unwrap unwrap = Unwrap::no);

  /// Cubic pieces (Hermite) with these velocities at the waypoints.
  /// @param velocities  per unit of time; of a quaternion: the angular velocity x, y, z in the joint's frame, and 0.
  static JointTrajectory cubic(const KinematicTree& tree, const std::vector<double>& times,
                               const std::vector<Eigen::VectorXd>& waypoints,
                               const std::vector<Eigen::VectorXd>& velocities, Unwrap unwrap = Unwrap::no);

  /// Quintic pieces with these velocities and accelerations at the waypoints.
  /// @throws std::invalid_argument also for a joint with a quaternion: use piecewise() there.
  static JointTrajectory quintic(const KinematicTree& tree, const std::vector<double>& times,
                                 const std::vector<Eigen::VectorXd>& waypoints,
                                 const std::vector<Eigen::VectorXd>& velocities,
                                 const std::vector<Eigen::VectorXd>& accelerations, Unwrap unwrap = Unwrap::no);

  /// Straight lines joined by parabolas: at constant acceleration over [times[k] - blend, times[k] + blend] around each
  /// inner waypoint, which is passed by, not through.
  /// @param blend  half a blend's duration, at most half the time between two waypoints; 0: as linear().
  /// @throws std::invalid_argument also for a joint with a quaternion.
  static JointTrajectory parabolicBlends(const KinematicTree& tree, const std::vector<double>& times,
                                         const std::vector<Eigen::VectorXd>& waypoints, double blend,
                                         Unwrap unwrap = Unwrap::no);

  /// A B-spline, on the times where it is defined: [knots[degree], knots[n]] for n control points.
  /// @param degree  1 to 5.
  /// @param knots   n + degree + 1, not decreasing; inner ones of a multiplicity up to `degree`.
  /// @throws std::invalid_argument also for a joint with a quaternion.
  static JointTrajectory bspline(const KinematicTree& tree, int degree, const std::vector<double>& knots,
                                 const std::vector<Eigen::VectorXd>& control_points);

  // What has been moved from has no pieces: the functions below throw std::out_of_range then.
  double beginTime() const { return times_.at(0); }
  double endTime() const { return times_.at(times_.size() - 1); }
  std::size_t numPieces() const { return pieces_.size(); }
  /// Over t in [0, 1], which stands for [times()[k], times()[k + 1]].
  const JointMotion& piece(std::size_t k) const { return pieces_.at(k); }
  /// Begin of each piece, and the end.
  const std::vector<double>& times() const { return times_; }
  /// Number of joint variables.
  Eigen::Index size() const { return pieces_.at(0).size(); }
  /// At t, cut to [beginTime(), endTime()].
  Eigen::VectorXd configuration(double t) const;
  /// Refuses a trajectory of other joint variables, as JointMotion::requireOf().
  /// @throws std::invalid_argument
  void requireOf(const KinematicTree& tree) const;

 private:
  JointTrajectory(const KinematicTree& tree, std::vector<double> times, std::vector<JointMotion> pieces);
  std::vector<double> times_;
  std::vector<JointMotion> pieces_;
};

}  // namespace fcl_artic
