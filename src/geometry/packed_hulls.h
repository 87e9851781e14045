// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "model/piece.h"

namespace fcl_artic {

/// Vertices of hulls as the engine's lanes take them (engine::PieceKind), 64-byte aligned.
class PackedHulls {
 public:
  /// @param points  at least one.
  /// @return their hull grown by a radius, a piece whose vertices data() holds.
  engine::Piece add(const std::vector<Eigen::Vector3d>& points, double radius);
  /// Null for no hull. Until the next one is added.
  const double* data() const { return blocks_.empty() ? nullptr : blocks_[0].x; }
  std::size_t bytes() const { return blocks_.capacity() * sizeof(Block); }

 private:
  struct alignas(64) Block {
    double x[8];
  };
  std::vector<Block> blocks_;
};

}  // namespace fcl_artic
