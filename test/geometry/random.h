// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <random>

#include <Eigen/Core>

using Random = std::mt19937_64;

inline double uniform(Random& random, double lo, double hi) {
  return lo + (hi - lo) * static_cast<double>(random() >> 11) * 0x1p-53;
}

/// A direction.
inline Eigen::Vector3d unit(Random& random) {
  for (;;) {
    const Eigen::Vector3d x(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1));
    if (x.norm() > 0.1 && x.norm() < 1) return x.normalized();
  }
}
