// SPDX-License-Identifier: BSD-3-Clause
//
// Numbers and poses that tests of queries draw. (One draw after the other: operands and arguments have no order.)
#pragma once

#include <vector>

#include "pairs/random.h"

namespace fcl_artic::test {

class Random : public pairs::Random {
 public:
  using pairs::Random::Random;
  bool oneIn(int n) { return below(n) == 0; }
  /// Each coordinate within +-size.
  Eigen::Vector3d box(double size) {
    const double x = uniform(-size, size), y = uniform(-size, size), z = uniform(-size, size);
    return {x, y, z};
  }
  Eigen::Isometry3d pose(double size) {
    Eigen::Isometry3d M = Eigen::Isometry3d::Identity();
    M.translation() = box(size);
    M.linear() = rotation();
    return M;
  }
  template <class T>
  T& of(std::vector<T>& all) {
    return all[static_cast<std::size_t>(below(static_cast<int>(all.size())))];
  }
};

}  // namespace fcl_artic::test
