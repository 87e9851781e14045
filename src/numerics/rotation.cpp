// SPDX-License-Identifier: BSD-3-Clause
#include "numerics/rotation.h"

#include <algorithm>

#include "numerics/shown.h"

namespace fcl_artic {

Eigen::Matrix3d Rotation::firstOfCircle(const Eigen::Matrix3d& R) {
  const auto next = [](const Eigen::Matrix3d& A) { return step(A, orthonormalityDefect(A)); };
  Eigen::Matrix3d first = R, at = next(R);
  for (int i = 0; i < kRounds && at != R; ++i, at = next(at)) {
    const double *a = at.data(), *b = first.data();
    if (std::lexicographical_compare(a, a + 9, b, b + 9)) first = at;
  }
  return first;
}

std::string whyNotRigid(const Eigen::Isometry3d& M, double most) {
  if (!M.matrix().allFinite()) return "has a transform that is not finite";
  const double defect = orthonormalityDefect(M.linear()).cwiseAbs().maxCoeff();
  if (!(defect <= most)) return "has a transform whose rotation is not orthonormal (defect " + shown(defect) + ")";
  if (!(M.linear().determinant() > 0)) return "has a transform that is a reflection (its determinant is -1)";
  return "is more than 1e9 m away";
}

}  // namespace fcl_artic
