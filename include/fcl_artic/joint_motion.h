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

  const Eigen::VectorXd& q0() const { return q0_; }
  const Eigen::VectorXd& dq() const { return dq_; }
  Eigen::VectorXd configuration(double t) const { return q0_ + t * dq_; }

 private:
  JointMotion(Eigen::VectorXd q0, Eigen::VectorXd dq) : q0_(std::move(q0)), dq_(std::move(dq)) {}
  Eigen::VectorXd q0_, dq_;
};

}  // namespace fcl_artic
