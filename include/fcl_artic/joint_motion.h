// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fcl_artic/kinematic_tree.h"

namespace fcl_artic {

/// Motion in joint space, q(t) = q0 + t Δq for t in [0, 1] (Redon 2004, Section 3).
class FCL_ARTIC_EXPORT JointMotion {
 public:
  /// Every joint variable goes straight from q0 to q1, also where that is the longer way round.
  /// @throws std::invalid_argument for wrong sizes, values that are not finite, or beyond 1e5 rad or 1e5 m.
  static JointMotion linear(const KinematicTree& tree, const Eigen::VectorXd& q0, const Eigen::VectorXd& q1);
  /// As linear(), but continuous joints take the shorter way: their Δq is wrapped to [-π, π].
  /// @throws also when a joint mimics a wrapped continuous one with a multiplier that is no integer: its end pose
  ///   would not be the one of q1.
  static JointMotion shortest(const KinematicTree& tree, const Eigen::VectorXd& q0, const Eigen::VectorXd& q1);

  Eigen::VectorXd q0() const { return coefficients_.col(0); }
  Eigen::VectorXd dq() const { return coefficients_.col(1); }
  Eigen::VectorXd configuration(double t) const { return coefficients_.col(0) + t * coefficients_.col(1); }
  /// Number of joint variables.
  Eigen::Index size() const { return coefficients_.rows(); }
  /// Column k belongs to t^k.
  const Eigen::MatrixXd& coefficients() const { return coefficients_; }

 private:
  JointMotion(const Eigen::VectorXd& q0, const Eigen::VectorXd& dq) : coefficients_(q0.size(), 2) {
    coefficients_ << q0, dq;
  }
  Eigen::MatrixXd coefficients_;
};

}  // namespace fcl_artic
