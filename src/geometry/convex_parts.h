// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/packed_hulls.h"
#include "model/tree_view.h"

namespace fcl_artic {

/// A surface of triangles cut into convex parts, coarse ones and finer ones within them. Each of the upper nodes of
/// its tree has a hull, grown by a ball, that holds all triangles below. Where the hull of a concave or bent body
/// meets another body's, the hulls of its parts mostly do not. One step then separates a pair of hulls whose triangles
/// would take hundreds.
class ConvexParts {
 public:
  /// @param whole  outlives this. Without an outer hull it gets no parts.
  explicit ConvexParts(const engine::TreeView& whole);
  ConvexParts(const ConvexParts&) = delete;
  ConvexParts& operator=(const ConvexParts&) = delete;

  /// The whole, with its parts.
  const engine::TreeView& view() const { return view_; }

 private:
  std::vector<engine::Piece> parts_;
  std::vector<std::int16_t> part_of_node_;
  PackedHulls hulls_;
  engine::TreeView view_;
};

}  // namespace fcl_artic
