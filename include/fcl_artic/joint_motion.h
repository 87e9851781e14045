// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "fcl_artic/kinematic_tree.h"

namespace fcl_artic {

/// Motion in joint space for t in [0, 1], a polynomial for every joint variable; q(t) = q0 + t Δq in the simplest case
/// (Redon 2004, Section 3).
///
/// A quaternion (floating, spherical joint) turns by a rotation vector: the orientation is exp([w(t)]) R0, with R0 the
/// orientation at t = 0 and w(t) a polynomial in the joint's frame, w(0) = 0.
///
/// A motion belongs to the joint variables of the tree that it was made for (KinematicTree::jointSpace()): a tree of
/// other ones refuses it, whatever their number. What has been moved from is no motion; all trees refuse it.
class FCL_ARTIC_EXPORT JointMotion {
 public:
  /// Every joint variable goes straight from q0 to q1, also where that is the longer way round. A quaternion takes the
  /// shortest rotation at constant speed (slerp, as OMPL's SO3 and SE3 spaces); of a quaternion and its negative, which
  /// are one orientation, the nearer is meant.
  /// @throws std::invalid_argument for wrong sizes, values that are not finite, or beyond 1e5 rad or 1e5 m.
  static JointMotion linear(const KinematicTree& tree, const Eigen::VectorXd& q0, const Eigen::VectorXd& q1);
  /// As linear(), but continuous joints and a planar joint's angle take the shorter way: their Δq is wrapped to [-π,
  /// π].
  /// @throws also when a joint mimics a wrapped continuous one with a multiplier that is no integer: its end pose
  ///   would not be the one of q1.
  static JointMotion shortest(const KinematicTree& tree, const Eigen::VectorXd& q0, const Eigen::VectorXd& q1);
  /// The polynomials themselves, up to the fifth degree.
  /// @param coefficients  dof() rows; column 0 is the configuration at t = 0, column k belongs to t^k. From column 1 on
  ///   the rows x, y, z of a quaternion hold the rotation vector w, and its row w is 0.
  /// @throws std::invalid_argument for wrong sizes, values that are not finite, or where the absolute coefficients of a
  ///   joint, mimic joints too, sum to more than 1e5 rad or 1e5 m.
  static JointMotion polynomial(const KinematicTree& tree, const Eigen::MatrixXd& coefficients);

  /// The configuration at t = 0, quaternions normalised.
  Eigen::VectorXd q0() const { return configuration(0); }
  /// The coefficients of t (with linear(): q1 - q0).
  Eigen::VectorXd dq() const { return variables_.col(1); }
  Eigen::VectorXd configuration(double t) const;
  /// Number of joint variables.
  Eigen::Index size() const { return variables_.rows(); }
  /// Highest power of t that there is a column for, at least 1.
  Eigen::Index degree() const { return variables_.cols() - 1; }
  /// As polynomial() takes them.
  Eigen::MatrixXd coefficients() const;

  /// Whether it is a motion of the tree's joint variables.
  bool isOf(const KinematicTree& tree) const { return joint_space_.sameAs(tree.jointSpace()); }
  /// @throws std::invalid_argument when it is not, beginning with `what` and naming both trees.
  void requireOf(const KinematicTree& tree, const char* what = "the motion") const {
    if (!isOf(tree)) refuse(tree, what);
  }

  /// As the queries take them: coefficients(), but w(0) = 0 in place of quaternions, which are in orientations().
  const Eigen::MatrixXd& variables() const { return variables_; }
  /// Orientations at t = 0 of the joints that have a quaternion, in the order of the joints: rotation matrices,
  /// row-major.
  const std::vector<double>& orientations() const { return orientations_; }

 private:
  JointMotion(const KinematicTree& tree, Eigen::MatrixXd coefficients);
  [[noreturn]] void refuse(const KinematicTree& tree, const char* what) const;

  Fingerprint joint_space_;
  std::string tree_name_;  ///< for messages
  Eigen::MatrixXd variables_;
  std::vector<double> orientations_;
  struct Start {
    Eigen::Index row;
    double quaternion[4];  ///< x, y, z, w
  };
  std::vector<Start> starts_;  ///< what orientations_ is made of
};

}  // namespace fcl_artic
