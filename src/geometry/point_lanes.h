// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace fcl_artic {

/// Points eight by eight, to find those farthest along directions.
class PointLanes {
 public:
  /// Every `stride`-th of the points, of which there is at least one.
  explicit PointLanes(const std::vector<Eigen::Vector3d>& points, std::size_t stride = 1) : stride_(stride) {
    const std::size_t taken = (points.size() + stride - 1) / stride;
    blocks_.resize((taken + 7) / 8);
    for (std::size_t i = 0; i < 8 * blocks_.size(); ++i) {
      const Eigen::Vector3d& p = points[stride * std::min(i, taken - 1)];  // the last fills up the last eight
      for (std::size_t k = 0; k < 3; ++k) blocks_[i / 8].x[k][i % 8] = p[static_cast<Eigen::Index>(k)];
    }
  }
  /// Index of the first of the points that are farthest along u.
  std::size_t farthest(const Eigen::Vector3d& u) const {
    double most[8];
    std::fill(most, most + 8, -INFINITY);
    for (const Block& block : blocks_) {
      for (int i = 0; i < 8; ++i) {
        const double value = block.along(u, i);
        most[i] = most[i] > value ? most[i] : value;
      }
    }
    const double value = *std::max_element(most, most + 8);
    std::size_t i = 0;
    while (i + 1 < 8 * blocks_.size() && blocks_[i / 8].along(u, static_cast<int>(i % 8)) < value) ++i;
    return stride_ * i;
  }

 private:
  struct Block {
    double x[3][8];
    double along(const Eigen::Vector3d& u, int i) const { return x[0][i] * u[0] + x[1][i] * u[1] + x[2][i] * u[2]; }
  };
  std::size_t stride_;
  std::vector<Block> blocks_;
};

}  // namespace fcl_artic
