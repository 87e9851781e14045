// SPDX-License-Identifier: BSD-3-Clause
//
// The tree of a cloud: balls in the order of a curve, and the nodes over clusters of them (engine::Ball).
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "geometry/large_array.h"
#include "model/tree_view.h"

namespace fcl_artic {

/// With this number, the numbers of a cloud's nodes fit into 32 bits.
constexpr std::size_t kMaxBalls = 500000000;

struct CloudTree {
  LargeArray<engine::Ball> balls;
  std::vector<double> radii;       ///< one for all balls, or one each, in their order
  LargeArray<engine::Node> nodes;  ///< node 0 is the root, node 1 a copy of it

  std::size_t bytes() const { return balls.bytes() + nodes.bytes() + radii.size() * sizeof(double); }
  /// Shows all but a first piece.
  void show(engine::TreeView& view) const;
};

/// @throws std::invalid_argument when a piece's reach or radius is not finite, or their sum is beyond 1e9 m.
void requireNear(const engine::Piece& piece);

/// The tree over two balls or more, at most kMaxBalls. It depends on the balls alone: not on the number of threads, nor
/// on the machine.
/// @param radii  one for all, or one each; finite, at least 0.
/// @param threads  at most; 0: as many as the machine runs at once.
/// @throws std::invalid_argument when a ball is not finite, or reaches beyond 1e9 m.
CloudTree buildCloudTree(const std::vector<Eigen::Vector3d>& centers, const std::vector<double>& radii, int threads);

}  // namespace fcl_artic
