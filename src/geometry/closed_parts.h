// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "narrowphase/problem.h"

namespace fcl_artic {

/// Closed parts of a mesh: triangles that hang together by corners at the very same place, where every edge belongs to
/// an even number of them. A part encloses the points that it goes around an odd number of times.
struct ClosedParts {
  std::vector<std::int32_t> part_of_piece;  ///< -1: of a part that is open
  std::int32_t count = 0;
};

/// @param mesh  of triangles only.
ClosedParts findClosedParts(const engine::TreeView& mesh);

}  // namespace fcl_artic
