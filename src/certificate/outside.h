// SPDX-License-Identifier: BSD-3-Clause
//
// Points that show that two bodies, of which a solid, are not in each other (doc/CERTIFICATES.md, SOLID).
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "certificate/moving_world.h"

namespace fcl_artic::certificate {

/// A point of one body, and a half-line from it along which the other one's surface is counted.
struct OutsidePoint {
  std::size_t piece;  ///< as the world counts them; a triangle's point is (5 c0 + 7 c1 + 4 c2) / 16
  int side;           ///< along +x, +y, +z, -x, -y, -z of the other body's geometry
};

/// For each part of A's surface that hangs together, or each piece of another geometry, one of its points that is
/// outside of B if B is a solid. Then the same of B's points.
/// @param t  time.
/// @return none where a part has no point that is surely outside.
std::optional<std::vector<OutsidePoint>> findOutside(MovingWorld& moving, int a, int b, double t);

}  // namespace fcl_artic::certificate
