// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace fcl_artic {

/// 1 - R^T R.
inline Eigen::Matrix3d orthonormalityDefect(const Eigen::Matrix3d& R) {
  return Eigen::Matrix3d::Identity() - R.transpose() * R;
}

/// The rotation next to R, whose columns may be off by up to 1e-6, with an error that the pads allow for (doc/NUMERICS.md,
/// "Pads"). R itself where it is orthonormal to rounding already.
/// @param defect  orthonormalityDefect(R).
inline Eigen::Matrix3d orthonormal(Eigen::Matrix3d R, Eigen::Matrix3d defect) {
  for (int round = 0; round < 3 && !(defect.cwiseAbs().maxCoeff() <= 4e-16); ++round) {
    R += 0.5 * R * defect;  // Newton's iteration: squares the defect
    defect = orthonormalityDefect(R);
  }
  return R;
}
inline Eigen::Matrix3d orthonormal(const Eigen::Matrix3d& R) {
  return orthonormal(R, orthonormalityDefect(R));
}

}  // namespace fcl_artic
