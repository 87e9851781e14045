// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <vector>

#include <Eigen/Core>

namespace fcl_artic {

/// n unit vectors, evenly spread over the sphere (Fibonacci's spiral).
inline std::vector<Eigen::Vector3d> spreadDirections(int n) {
  std::vector<Eigen::Vector3d> directions;
  for (int i = 0; i < n; ++i) {
    const double z = 1 - (2 * i + 1) / static_cast<double>(n), r = std::sqrt(1 - z * z);
    const double angle = 2.399963229728653 * i;  // the golden angle
    directions.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
  }
  return directions;
}

}  // namespace fcl_artic
