// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace fcl_artic {

/// The rotation next to R, whose columns may be off by up to 1e-6, with an error that the pads allow for (doc/NUMERICS.md,
/// "Pads"). R itself where it is orthonormal to rounding already.
inline Eigen::Matrix3d orthonormal(Eigen::Matrix3d R) {
  for (int round = 0; round < 3; ++round) {  // Newton's iteration: squares the defect
    const Eigen::Matrix3d defect = Eigen::Matrix3d::Identity() - R.transpose() * R;
    if (defect.cwiseAbs().maxCoeff() <= 4e-16) break;
    R += 0.5 * R * defect;
  }
  return R;
}

}  // namespace fcl_artic
