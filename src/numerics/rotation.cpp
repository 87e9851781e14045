// SPDX-License-Identifier: BSD-3-Clause
#include "numerics/rotation.h"

#include "numerics/shown.h"

namespace fcl_artic {

std::string whyNotRigid(const Eigen::Isometry3d& M, double most) {
  if (!M.matrix().allFinite()) return "has a transform that is not finite";
  const double defect = orthonormalityDefect(M.linear()).cwiseAbs().maxCoeff();
  if (!(defect <= most)) return "has a transform whose rotation is not orthonormal (defect " + shown(defect) + ")";
  if (!(M.linear().determinant() > 0)) return "has a transform that is a reflection (its determinant is -1)";
  return "is more than 1e9 m away";
}

}  // namespace fcl_artic
