// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "model/tree_view.h"

namespace fcl_artic {

/// Closed parts of a mesh: triangles that hang together by corners at the very same place, where every edge belongs to
/// an even number of them. A part encloses the points that it goes around an odd number of times.
struct ClosedParts {
  std::vector<std::int32_t> part_of_piece;  ///< -1: of a part that is open
  std::int32_t count = 0;
};

/// @param mesh  of triangles only.
ClosedParts findClosedParts(const engine::TreeView& mesh);

/// Triangles that hang together by corners at the very same place, closed or not.
struct ConnectedParts {
  std::vector<std::int32_t> part_of_piece;
  std::int32_t count = 0;
};
/// @param mesh  of triangles only.
ConnectedParts findConnectedParts(const engine::TreeView& mesh);

/// Why a mesh bounds no solid; empty when it does. It does when it is closed and consistently oriented: its triangles
/// then pass every edge as often in the one direction as in the other. Corners at the very same place are one. (In a
/// manifold: once each. Which side is the outer one does not matter, nor do triangles without area, as long as their
/// edges count.)
/// @param mesh  of triangles only.
std::string whyNoSolid(const engine::TreeView& mesh);

}  // namespace fcl_artic
