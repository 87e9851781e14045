// SPDX-License-Identifier: BSD-3-Clause
//
// Bodies of the engine's problem as convex solids in one frame: the world, or the tree frame of a body that moves,
// which stands still there.
#pragma once

#include <cstdint>
#include <vector>

#include "model/query.h"
#include "visibility/batch.h"

namespace fcl_artic {
namespace visibility {

/// Bounds along 13 directions: the axes, the diagonals of their planes and of space (a 26-DOP).
struct Bounds {
  static constexpr int kDirections = 13;
  double lo[kDirections], hi[kDirections];

  /// Whether they are not certainly apart; true also if a number is NaN.
  bool meets(const Bounds& other) const {
    for (int d = 0; d < kDirections; ++d) {
      if (lo[d] > other.hi[d] || other.lo[d] > hi[d]) return false;
    }
    return true;
  }
  /// Bounds that hold no point.
  static Bounds none();
  void join(const Bounds& other);
};
/// Bounds of the hull of points, grown by a ball; rounded outward.
Bounds boundsOf(const double* points, int count, double radius);

/// Bounds of what a link sweeps over one of the motion's parts.
Bounds boundsOf(const engine::SweptLink& link);
Volume addVolume(const engine::SweptLink& link, Batch& batch);

/// A subtree of a pair's still body. All that is drawn of it is one group.
struct Cluster {
  std::int32_t pair, node;
};

/// The place where the pieces of a query's still bodies are collected.
struct Collection {
  Batch& batch;
  std::int32_t first_group;        ///< the query's, in the batch
  std::size_t most;                ///< maximum number of objects in the batch
  std::vector<Cluster>& clusters;  ///< of each group of the query
  std::vector<Cluster>& free;      ///< proven free without being drawn
  std::int32_t nextGroup() const { return first_group + static_cast<std::int32_t>(clusters.size()); }
};

/// Pieces of a body that stands still, in the frame of the swept volumes.
class BodyPieces {
 public:
  /// @param at      where the tree stands in that frame.
  /// @param margin  that all of it is grown by, m.
  BodyPieces(const engine::TreeView& tree, const engine::Placement& at, double margin);
  /// Adds the pieces whose bounds meet one of the parts: triangles and other convex pieces. A node smaller than
  /// `least` (m) is added as the ball around its box, with all that is in it. Nodes as large as `cluster` (m) make
  /// groups.
  /// @param parts  bounds of what is swept in each of the eight parts of the motion.
  /// @param[in,out] lanes  parts to look at; those that no piece meets are taken out.
  /// @param[in,out] reach  joined with the bounds of what is added.
  /// @return false if there were more than to.most objects, the tree is too deep, or the body is unbounded: nothing is
  /// known then, and `lanes` is unchanged.
  bool add(const Bounds* parts, std::uint32_t& lanes, double least, double cluster, std::int32_t window,
           std::int32_t pair, Collection& to, Bounds& reach) const;

 private:
  Bounds boundsOf(const engine::Node& node) const;
  void place(const double* p, double* x) const;
  Volume volumeOf(const engine::Piece& piece, Batch& batch) const;
  Volume ballAround(const engine::Node& node, Batch& batch) const;

  const engine::TreeView& tree_;
  const engine::Placement& at_;
  double pad_;  ///< bound on the rounding of a placed point, plus the margin
  double axes_[3][Bounds::kDirections], origin_[Bounds::kDirections];  ///< of the tree's frame, along the directions
};

}  // namespace visibility
}  // namespace fcl_artic
