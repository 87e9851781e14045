// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/packed_hulls.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace fcl_artic {

engine::Piece PackedHulls::add(const std::vector<Eigen::Vector3d>& points, double radius) {
  const std::size_t first = blocks_.size(), blocks = (points.size() + 7) / 8;
  blocks_.resize(first + 3 * blocks);
  double reach = 0;
  for (std::size_t i = 0; i < 8 * blocks; ++i) {
    const Eigen::Vector3d& v = points[std::min(i, points.size() - 1)];  // the last one fills up
    for (std::size_t k = 0; k < 3; ++k) blocks_[first + k * blocks + i / 8].x[i % 8] = v[static_cast<Eigen::Index>(k)];
    reach = std::max(reach, v.squaredNorm());
  }
  engine::Piece hull;
  hull.kind = engine::PieceKind::hull;
  hull.first_vertex = static_cast<std::int32_t>(8 * first);
  hull.num_vertices = static_cast<std::int32_t>(8 * blocks);
  hull.radius = radius;
  hull.reach = std::sqrt(reach) * (1 + 1e-15);
  return hull;
}

}  // namespace fcl_artic
