// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "fcl_artic/joint_motion.h"

namespace fcl_artic {

/// A trajectory in joint space: motions one after the other. Each is a JointMotion: polynomials of time up to the fifth
/// degree, or angles by a tangent half-angle law. Times are in any unit, mostly seconds; they are finite and increase,
/// and the whole duration is finite.
///
/// The pieces are checked as they are, in doubles: piece k begins exactly at its own first configuration. The end of
/// one piece and the beginning of the next may differ by rounding: by 1e-9 rad or m plus 1e-12 of the values. More is
/// refused as a jump.
///
/// It belongs to the joint variables of the tree that it was made for, as a JointMotion does, and keeps no reference to
/// the tree. A trajectory that was moved from has no pieces: requireOf() throws std::invalid_argument then, and the
/// other members throw std::out_of_range, except numPieces() and times().
class FCL_ARTIC_EXPORT JointTrajectory {
 public:
  /// How waypoints of joints that turn forever (continuous joints, a planar joint's angle) are taken.
  enum class Unwrap {
    no,   ///< As they are: the joint goes from value to value, even if that is the longer way round.
    yes,  ///< Each is reached by the shorter way from its predecessor: whole turns are added from there on.
  };

  /// Makes a trajectory of polynomials of t - times[k] on [times[k], times[k + 1]].
  /// @param times  one more than pieces.
  /// @param coefficients  of each piece, as JointMotion::polynomial() takes them; column j belongs to (t - times[k])^j.
  /// @throws std::invalid_argument, naming piece and joint: as JointMotion::polynomial(), no piece, a wrong number of
  ///   times, times that do not increase, a jump from one piece to the next.
  static JointTrajectory piecewise(const KinematicTree& tree, const std::vector<double>& times,
                                   const std::vector<Eigen::MatrixXd>& coefficients);

  /// Makes a trajectory that goes straight from waypoint to waypoint, quaternions by the shortest rotation
  /// (JointMotion::linear()).
  /// @param times      one for each waypoint.
  /// @param waypoints  at least two, of tree.dof() joint values each, rad or m.
  /// @throws std::invalid_argument, naming waypoint or piece,
  ///   - as JointMotion::linear(),
  ///   - for fewer than two waypoints, a wrong number of times, times that do not increase,
  ///   - with Unwrap::yes also for a mimic joint that would not come to its waypoint, as JointMotion::shortest().
  static JointTrajectory linear(const KinematicTree& tree, const std::vector<double>& times,
                                const std::vector<Eigen::VectorXd>& waypoints, Unwrap unwrap = Unwrap::no);

  /// Makes a trajectory of JointMotion::tangentHalfAngle() from waypoint to waypoint: paths of planners in the tangent
  /// configuration space.
  /// @param times      one for each waypoint.
  /// @param waypoints  at least two, of tree.dof() joint values each, rad or m.
  /// @param reference  q*: tree.dof() values, of which those of angles count; empty: 0.
  /// @throws std::invalid_argument, naming waypoint or piece: as JointMotion::tangentHalfAngle() and linear().
  static JointTrajectory tangentHalfAngle(const KinematicTree& tree, const std::vector<double>& times,
                                          const std::vector<Eigen::VectorXd>& waypoints,
                                          const Eigen::VectorXd& reference = {});

  /// Makes a trajectory of cubic (Hermite) pieces through the waypoints, with given velocities there.
  /// @param times       one for each waypoint.
  /// @param waypoints   at least two, of tree.dof() joint values each, rad or m.
  /// @param velocities  for each waypoint, rad or m per unit of time; for a quaternion the angular velocity x, y, z in
  ///   the joint's frame, and 0.
  /// @throws std::invalid_argument as linear() and piecewise(), and for velocities of a wrong size, not finite, or with
  ///   a fourth entry for a quaternion that is not 0.
  static JointTrajectory cubic(const KinematicTree& tree, const std::vector<double>& times,
                               const std::vector<Eigen::VectorXd>& waypoints,
                               const std::vector<Eigen::VectorXd>& velocities, Unwrap unwrap = Unwrap::no);

  /// Makes a trajectory of quintic pieces through the waypoints, with given velocities and accelerations there.
  /// @param times          one for each waypoint.
  /// @param waypoints      at least two, of tree.dof() joint values each, rad or m.
  /// @param velocities     for each waypoint, rad or m per unit of time.
  /// @param accelerations  for each waypoint, rad or m per unit of time squared.
  /// @throws std::invalid_argument as cubic(), and for a quaternion that does not stand still (use piecewise() there).
  static JointTrajectory quintic(const KinematicTree& tree, const std::vector<double>& times,
                                 const std::vector<Eigen::VectorXd>& waypoints,
                                 const std::vector<Eigen::VectorXd>& velocities,
                                 const std::vector<Eigen::VectorXd>& accelerations, Unwrap unwrap = Unwrap::no);

  /// Makes a trajectory of straight lines joined by parabolas: at constant acceleration over [times[k] - blend,
  /// times[k] + blend] around each inner waypoint, which is passed by, not passed through.
  /// @param times      one for each waypoint.
  /// @param waypoints  at least two, of tree.dof() joint values each, rad or m.
  /// @param blend      half the duration of a blend, at least 0; blends must not overlap. 0: as linear().
  /// @throws std::invalid_argument as linear(), for blends that overlap or are negative or not finite, and for a joint
  ///   with a quaternion.
  static JointTrajectory parabolicBlends(const KinematicTree& tree, const std::vector<double>& times,
                                         const std::vector<Eigen::VectorXd>& waypoints, double blend,
                                         Unwrap unwrap = Unwrap::no);

  /// Makes a trajectory along a B-spline, on the times where it is defined: [knots[degree], knots[n]] for n control
  /// points.
  /// @param degree  1 to 5.
  /// @param knots   n + degree + 1 times, not decreasing; inner ones repeated at most `degree` times.
  /// @param control_points  at least degree + 1, of tree.dof() joint values each, rad or m.
  /// @throws std::invalid_argument, naming the knot or control point, for
  ///   - values outside these ranges,
  ///   - control points that are no configuration,
  ///   - no time between the inner knots,
  ///   - pieces that JointMotion::polynomial() refuses,
  ///   - a joint with a quaternion.
  static JointTrajectory bspline(const KinematicTree& tree, int degree, const std::vector<double>& knots,
                                 const std::vector<Eigen::VectorXd>& control_points);

  /// Time at which the trajectory begins.
  double beginTime() const { return times_.at(0); }
  /// Time at which the trajectory ends.
  double endTime() const { return times_.at(times_.size() - 1); }
  /// Number of pieces; 0 only after a move.
  std::size_t numPieces() const { return pieces_.size(); }
  /// Piece k as a motion over t in [0, 1], which stands for [times()[k], times()[k + 1]].
  const JointMotion& piece(std::size_t k) const { return pieces_.at(k); }
  /// Times at which the pieces begin, and the end: numPieces() + 1 entries.
  const std::vector<double>& times() const { return times_; }
  /// Number of joint variables: dof() of the tree.
  Eigen::Index size() const { return pieces_.at(0).size(); }
  /// Returns the configuration at time t, clamped to [beginTime(), endTime()]: size() entries, rad or m.
  Eigen::VectorXd configuration(double t) const;
  /// Checks that the trajectory is of the tree's joint variables.
  /// @throws std::invalid_argument if it is not, or was moved from, as JointMotion::requireOf().
  void requireOf(const KinematicTree& tree) const;

 private:
  friend struct ExactMotion;  ///< makes a trajectory of these pieces again
  JointTrajectory(const KinematicTree& tree, std::vector<double> times, std::vector<JointMotion> pieces);
  std::vector<double> times_;
  std::vector<JointMotion> pieces_;
};

}  // namespace fcl_artic
