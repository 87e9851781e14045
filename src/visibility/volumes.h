// SPDX-License-Identifier: BSD-3-Clause
//
// Bodies of the engine's problem as convex solids in the world.
#pragma once

#include <cstdint>

#include "narrowphase/problem.h"
#include "visibility/batch.h"

namespace fcl_artic {
namespace visibility {

/// An axis-aligned box in the world.
struct Box {
  double lo[3], hi[3];
  bool meets(const Box& other) const {
    return lo[0] <= other.hi[0] && other.lo[0] <= hi[0] && lo[1] <= other.hi[1] && other.lo[1] <= hi[1] &&
           lo[2] <= other.hi[2] && other.lo[2] <= hi[2];
  }
  void join(const Box& other);
};

/// A link's line swept sphere over one of the motion's parts.
Box boxOf(const engine::SweptLink& link);
Volume addVolume(const engine::SweptLink& link, Batch& batch);

/// Pieces of a still body, in the world.
class BodyPieces {
 public:
  /// @param margin  that all of it is grown by, m.
  BodyPieces(const engine::Body& body, double margin);
  /// Adds those whose boxes meet one of `parts`, as objects of a group: triangles and other convex pieces; a node smaller
  /// than `least` (m) as the ball around its box, with all that is in it.
  /// @param most  of all objects of the batch.
  /// @return false where that was too few, or the body is unbounded: what was added is not all of it.
  bool add(const Box* parts, int num_parts, double least, std::size_t most, std::int32_t window, std::int32_t group,
           Batch& batch) const;

 private:
  Box boxOf(const engine::Node& node) const;
  void toWorld(const double* p, double* x) const;
  Volume volumeOf(const engine::Piece& piece, Batch& batch) const;
  Volume ballAround(const engine::Node& node, Batch& batch) const;

  const engine::Body& body_;
  double pad_;  ///< rounding of a point's way to the world, and the margin
};

}  // namespace visibility
}  // namespace fcl_artic
