// SPDX-License-Identifier: BSD-3-Clause
//
// Bodies of the engine's problem as convex solids in one frame: the world, or the tree frame of a body that moves,
// which stands still there.
#pragma once

#include <cstddef>

#include "model/query.h"
#include "visibility/executor.h"

namespace fcl_artic {
namespace visibility {

/// Bounds along 13 directions: the axes, the diagonals of their planes and of space (a 26-DOP).
struct Bounds {
  static constexpr int kDirections = 13;
  double lo[kDirections], hi[kDirections];

  Bounds();  ///< They hold no point.
  void join(const Bounds& other);
  /// Returns the lanes whose parts are not certainly apart from these bounds. NaN is never apart.
  std::uint32_t meet(const Bounds* parts, std::uint32_t lanes) const;
};
/// Bounds of the hull of points, grown by a ball; rounded outward.
Bounds boundsOf(const double* points, int count, double radius);

/// Bounds of what a link sweeps over each eighth of the motion.
struct SweptParts {
  Bounds parts[8];
  double least = 0;  ///< m; a node smaller than this is drawn as the ball around its box
};

/// Adds the pieces below a node of a body that stands still, as the drawing's next group: those whose bounds meet one
/// of the parts that a link sweeps.
/// @param at      where the tree stands in the frame of these parts.
/// @param margin  that the pieces are grown by, m.
/// @param most    the number of pieces that the drawing may come to.
/// @param[in,out] lanes  parts to look at; those that no piece meets are taken out.
/// @param[in,out] reach  joined with the bounds of what is added.
/// @return false if there are more, the tree is too deep, or the body is unbounded: then nothing is known, and nothing
/// is added.
bool addPieces(const engine::TreeView& tree, std::int32_t node, const engine::Placement& at, double margin,
               const SweptParts& swept, std::size_t most, std::uint32_t& lanes, Bounds& reach, Drawing& drawing);

}  // namespace visibility
}  // namespace fcl_artic
