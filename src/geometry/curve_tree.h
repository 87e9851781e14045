// SPDX-License-Identifier: BSD-3-Clause
//
// The tree over many pieces without vertices, by the order of their centres along a curve.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "geometry/curve_order.h"
#include "numerics/baseline_isa.h"
#include "threads/parallel.h"

#include "convex/node_boxes.h"

namespace fcl_artic {

/// From one piece's number to the next one's.
constexpr std::size_t kPieceStride = sizeof(engine::Piece) / sizeof(double);
static_assert(sizeof(engine::Piece) % sizeof(double) == 0, "pieces lie a whole number of doubles apart");

/// The tree over pieces without vertices, in the order of a curve (CurveOrder), over threads. Nodes lie as Builder lays
/// them: those below a node side by side. So their places are known before they are made, and any thread may make them.
/// @tparam Measure  the box of a piece, called as measure(piece), also by several threads; it may write to the piece.
template <class Measure>
class CurveBuilder {
 public:
  /// @param centers  of the pieces, by their numbers.
  /// @param pieces  where they are.
  /// @param nodes  2 a piece.
  CurveBuilder(PointsAt centers, std::size_t size, int threads, engine::Piece* pieces, engine::Node* nodes,
               Measure measure)
      : measure_(measure),
        order_(centers, size, threads),
        threads_(size < kManyPieces ? 1 : threads),
        pieces_(pieces),
        nodes_(nodes) {
    divide({0, order_.all()}, std::max(kFewPieces, size / 256));
  }
  /// The tree over pieces that are where they belong.
  void build() {
    parallelFor(parts_.size(), threads_, [&](std::size_t i) { build(parts_[i]); });
    for (std::size_t i = above_.size(); i-- > 0;) enclose(above_[i]);
    nodes_[1] = nodes_[0];
  }

 private:
  static constexpr std::size_t kFewPieces = 1 << 11, kManyPieces = 1 << 14;
  struct Below {
    std::size_t node;
    CurveOrder::Range range;
    std::size_t child = 2;  ///< its left one; those of the nodes below follow
  };
  /// The two children, the left one first. A node over n pieces takes 2 (n - 1) nodes below it.
  std::pair<Below, Below> split(const Below& at) {
    const auto [left, right] = order_.split(at.range);
    return {{at.child, left, at.child + 2}, {at.child + 1, right, at.child + 2 * left.size()}};
  }
  void divide(const Below& at, std::size_t part) {
    if (at.range.size() <= part) return parts_.push_back(at);
    above_.push_back(at);
    const auto [left, right] = split(at);
    divide(left, part);
    divide(right, part);
  }
  void build(const Below& at) {
    if (at.range.size() == 1) {
      const std::uint32_t piece = order_.number(at.range.begin);
      nodes_[at.node] = baseline::makeLeaf(measure_(pieces_[piece]), static_cast<std::int32_t>(piece));
      return;
    }
    const auto [left, right] = split(at);
    build(left);
    build(right);
    enclose(at);
  }
  /// Makes a node of its children.
  void enclose(const Below& at) {
    engine::Node& node = nodes_[at.node];
    baseline::enclose(nodes_[at.child], nodes_[at.child + 1], node);
    node.child = static_cast<std::int32_t>(at.child);
  }
  const Measure measure_;
  CurveOrder order_;
  const int threads_;
  engine::Piece* const pieces_;
  engine::Node* const nodes_;
  std::vector<Below> parts_;
  std::vector<Below> above_;  ///< nodes above them, each before its children
};

}  // namespace fcl_artic
