// SPDX-License-Identifier: BSD-3-Clause
//
// Bodies of the engine's problem as convex solids in one frame: the world, or the tree frame of a body that moves,
// which stands still there.
#pragma once

#include <cstddef>
#include <cstdint>

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

/// Bounds of the volumes that a link sweeps, and how they are drawn.
struct SweptParts {
  Bounds parts[8];      ///< bounds over each eighth of the motion
  double least = 0;     ///< m; a node smaller than this is added as the ball around its box
  std::int32_t window;  ///< of the batch
};

/// Pieces of a body that stands still, in the frame of the swept volumes.
class BodyPieces {
 public:
  /// @param at      where the tree stands in that frame.
  /// @param margin  that all of it is grown by, m.
  BodyPieces(const engine::TreeView& tree, const engine::Placement& at, double margin);
  /// Adds those pieces below a node whose bounds meet one of the parts, as objects of the batch's next group.
  /// @param most  the number of objects that the batch may come to.
  /// @param[in,out] lanes  parts to look at; those that no piece meets are taken out.
  /// @param[in,out] reach  joined with the bounds of what is added.
  /// @return false if there are more, the tree is too deep, or the body is unbounded: then nothing is known, and
  /// nothing is added.
  bool add(std::int32_t node, const SweptParts& swept, std::size_t most, std::uint32_t& lanes, Bounds& reach,
           Batch& batch) const;

 private:
  bool collect(std::int32_t node, const SweptParts& swept, std::size_t most, std::uint32_t& lanes, Bounds& reach,
               Batch& batch) const;
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
