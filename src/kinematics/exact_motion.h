// SPDX-License-Identifier: BSD-3-Clause
//
// Motions of the very numbers that others have, which the public makers would round once more.
#pragma once

#include <vector>

#include "fcl_artic/trajectory.h"

namespace fcl_artic {

struct ExactMotion {
  /// @param coefficients  as JointMotion::coefficients() returns them. If a quaternion's length is 1 to rounding, it is
  ///   taken as it is.
  /// @param references  as JointMotion::references() returns them; empty: all variables are polynomials.
  /// @throws std::invalid_argument as JointMotion::polynomial() and tangentHalfAnglePolynomial().
  static JointMotion motion(const KinematicTree& tree, const Eigen::MatrixXd& coefficients,
                            const Eigen::VectorXd& references);
  /// The variables of a motion, to be made those of a part of it.
  static Eigen::MatrixXd& variables(JointMotion& motion) { return motion.variables_; }
  /// @param pieces  over t in [0, 1] each.
  /// @throws std::invalid_argument as JointTrajectory::piecewise().
  static JointTrajectory trajectory(const KinematicTree& tree, const std::vector<double>& times,
                                    std::vector<JointMotion> pieces);
};

}  // namespace fcl_artic
