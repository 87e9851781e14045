// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "numerics/baseline_isa.h"

#include "numerics/vec3.h"

namespace fcl_artic::certificate {

inline baseline::Vec3 fromEigen(const Eigen::Vector3d& v) {
  return {v[0], v[1], v[2]};
}
inline Eigen::Vector3d toEigen(const baseline::Vec3& v) {
  return {v[0], v[1], v[2]};
}

}  // namespace fcl_artic::certificate
