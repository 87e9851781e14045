// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

namespace fcl_artic {

inline bool isIdentity(const Eigen::Matrix3d& R) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (R(i, j) != (i == j ? 1 : 0)) return false;  // so it goes for NaN
    }
  }
  return true;
}
inline bool isIdentity(const Eigen::Isometry3d& M) {
  return M(0, 3) == 0 && M(1, 3) == 0 && M(2, 3) == 0 && isIdentity(Eigen::Matrix3d(M.linear()));
}

/// 1 - R^T R.
inline Eigen::Matrix3d orthonormalityDefect(const Eigen::Matrix3d& R) {
  return Eigen::Matrix3d::Identity() - R.transpose() * R;
}

/// The rotation next to R, whose columns may be off by up to 1e-6, with an error that the pads allow for
/// (doc/NUMERICS.md, "Pads"). R itself where it is orthonormal to rounding already.
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
