// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "fcl_artic/kinematic_tree.h"

namespace fcl_artic {

/// A motion in joint space over t in [0, 1]: every joint variable is a polynomial of t. The simplest case is linear,
/// q(t) = q0 + t Δq (Redon 2004, Section 3). Angles may go by a tangent half-angle law instead: q* + 2 atan(s(t)) with
/// s a polynomial, the straight lines of planners whose space is s (tangentHalfAngle()).
///
/// The orientation of a floating or spherical joint is exp([w(t)]) R0, with R0 the orientation at t = 0 and the
/// rotation vector w(t) a polynomial in the joint's frame, w(0) = 0.
///
/// A motion belongs to the joint variables of the tree that it was made for (KinematicTree::jointSpace()); trees with
/// other ones refuse it, whatever their number. It keeps no reference to the tree. A motion that was moved from is
/// none: all trees refuse it, and it may only be destroyed or assigned to.
class FCL_ARTIC_EXPORT JointMotion {
 public:
  /// Moves every joint variable straight from q0 to q1, even if that is the longer way round. A quaternion takes the
  /// shortest rotation at constant speed (slerp, as OMPL's SO3 and SE3 spaces); a quaternion and its negative, which
  /// are one orientation, make no difference.
  /// @param q0, q1  tree.dof() joint values each, rad or m.
  /// @throws std::invalid_argument for
  ///   - a wrong size,
  ///   - values that are not finite or beyond 1e5 rad or m,
  ///   - mimic joints whose multiple and offset sum to more than that, whatever their signs,
  ///   - quaternions whose lengths are not 1 within 1e-3.
  static JointMotion linear(const KinematicTree& tree, const Eigen::VectorXd& q0, const Eigen::VectorXd& q1);
  /// Moves as linear(), except that continuous joints and the angles of planar joints take the shorter way round: their
  /// Δq is wrapped to [-π, π].
  /// @param q0, q1  tree.dof() joint values each, rad or m.
  /// @throws std::invalid_argument as linear(), and if a joint that mimics a wrapped one would end in another pose than
  ///   at q1: a prismatic joint, or one whose multiplier is no integer.
  static JointMotion shortest(const KinematicTree& tree, const Eigen::VectorXd& q0, const Eigen::VectorXd& q1);
  /// Stands still at q.
  /// @param q  tree.dof() joint values, rad or m.
  /// @throws std::invalid_argument as linear().
  static JointMotion still(const KinematicTree& tree, const Eigen::VectorXd& q);
  /// Moves along given polynomials, up to the fifth degree.
  /// @param coefficients  tree.dof() rows, 1 to 6 columns. Column 0 is the configuration at t = 0, rad or m; column k
  ///   belongs to t^k. For a quaternion the rows x, y, z hold the rotation vector w from column 1 on, and the row w is
  ///   0.
  /// @throws std::invalid_argument for
  ///   - wrong sizes,
  ///   - values that are not finite,
  ///   - a column 0 that is no configuration,
  ///   - absolute coefficients of a joint, mimic joints too, that sum to more than 1e5 rad or m.
  static JointMotion polynomial(const KinematicTree& tree, const Eigen::MatrixXd& coefficients);
  /// Moves every angle (of revolute, continuous and planar joints) so that the tangent of its half goes straight:
  /// q(t) = q* + 2 atan(s(t)), s(t) = s0 + t (s1 - s0), s = tan((q - q*) / 2), the way through q*'s side. All poses are
  /// rational in t then. It is the edge of planners in the tangent configuration space (Amice, Werner, Tedrake,
  /// Certifying Bimanual RRT Motion Plans in a Second, 2024). Slides and quaternions move as in linear().
  /// @param q0, q1  tree.dof() joint values each, rad or m; angles less than π from q*, by at least 2e-5.
  /// @param reference  q*: tree.dof() values, of which those of angles count; empty: 0.
  /// @throws std::invalid_argument as linear(), and for angles out of that reach, tangents whose absolute coefficients
  ///   sum to more than 1e5, and references of a wrong size, not finite or beyond 1e5.
  static JointMotion tangentHalfAngle(const KinematicTree& tree, const Eigen::VectorXd& q0, const Eigen::VectorXd& q1,
                                      const Eigen::VectorXd& reference = {});
  /// The same with polynomials of any degree up to the fifth.
  /// @param coefficients  as polynomial() takes them, but the rows of angles hold those of s(t) = tan((q(t) - q*) / 2).
  /// @param reference  as in tangentHalfAngle().
  /// @throws std::invalid_argument as polynomial() and tangentHalfAngle().
  static JointMotion tangentHalfAnglePolynomial(const KinematicTree& tree, const Eigen::MatrixXd& coefficients,
                                                const Eigen::VectorXd& reference = {});

  /// Returns the configuration at t = 0, size() entries, with normalised quaternions.
  Eigen::VectorXd q0() const { return configuration(0); }
  /// Returns the coefficients of t, size() entries: for linear() q1 - q0, for a quaternion the rotation vector and 0.
  /// @throws std::invalid_argument if a variable is no polynomial (isPolynomial()).
  Eigen::VectorXd dq() const {
    requirePolynomial("JointMotion::dq()");
    return variables_.col(1);
  }
  /// Returns the configuration at time t, size() entries, rad or m. t is not clamped to [0, 1].
  /// @throws std::invalid_argument if the motion was moved from.
  Eigen::VectorXd configuration(double t) const;
  /// Number of joint variables: dof() of the tree.
  Eigen::Index size() const { return variables_.rows(); }
  /// Whether all variables are polynomials of t; otherwise angles go by a tangent half-angle law.
  bool isPolynomial() const { return half_angles_.empty(); }
  /// Checks that all variables are polynomials of t.
  /// @param who  begins the message.
  /// @throws std::invalid_argument if angles go by a tangent half-angle law.
  void requirePolynomial(const char* who) const;
  /// Highest power of t that has a column of coefficients; at least 1, with a tangent half-angle law at least 2.
  Eigen::Index degree() const { return variables_.cols() - 1; }
  /// Returns the coefficients, size() by degree() + 1, as polynomial() takes them, or tangentHalfAnglePolynomial() if
  /// not isPolynomial().
  Eigen::MatrixXd coefficients() const;

  /// Whether the motion is of the tree's joint variables.
  bool isOf(const KinematicTree& tree) const { return joint_space_.sameAs(tree.jointSpace()); }
  /// Checks that the motion is of the tree's joint variables.
  /// @param what  begins the message.
  /// @throws std::invalid_argument if it is not, or was moved from, naming both trees.
  void requireOf(const KinematicTree& tree, const char* what = "the motion") const {
    if (!isOf(tree)) refuse(tree, what);
  }

  /// The coefficients as queries take them: coefficients(), with w(0) = 0 in place of quaternions, whose orientations
  /// at t = 0 are in orientations().
  const Eigen::MatrixXd& variables() const { return variables_; }
  /// Orientations R0 at t = 0 of the joints that have a quaternion, in the order of the joints: nine numbers each, a
  /// rotation matrix by rows.
  const std::vector<double>& orientations() const { return orientations_; }
  /// Per variable 1 where variables() are of the tangent of half an angle, else 0; empty if isPolynomial().
  const std::vector<std::uint8_t>& halfAngles() const { return half_angles_; }
  /// Reference angles q* of these variables, 0 for others; empty if isPolynomial().
  const Eigen::VectorXd& references() const { return references_; }

 private:
  friend struct ExactMotion;  ///< makes a motion of these numbers again
  JointMotion(const KinematicTree& tree, Eigen::MatrixXd coefficients);
  void goByHalfAngles(const KinematicTree& tree, const Eigen::VectorXd& reference);
  [[noreturn]] void refuse(const KinematicTree& tree, const char* what) const;

  Fingerprint joint_space_;
  std::string tree_name_;  ///< for messages
  Eigen::MatrixXd variables_;
  std::vector<double> orientations_;
  std::vector<std::uint8_t> half_angles_;
  Eigen::VectorXd references_;
  struct Start {
    Eigen::Index row;
    double quaternion[4];  ///< x, y, z, w
  };
  std::vector<Start> starts_;  ///< what orientations_ is made of
};

}  // namespace fcl_artic
