// SPDX-License-Identifier: BSD-3-Clause
//
// Convex pieces: the leaves of every geometry. Plain data: no FCL, no containers, so that the engine, compiled once
// per instruction set, may read it.
#pragma once

#include <cstdint>

namespace fcl_artic {
namespace engine {

/// Kinds of convex piece. Every piece is a core, given by its support function, grown by a ball of that radius.
/// `vertices` and `hull` are both hulls of points; a hull's coordinates lie x, then y, then z, each a multiple of eight
/// (lanes go over them), in TreeView::hulls.
/// `halfspace` {n.x <= offset} and `plane` {n.x = offset} are unbounded: a direction each, no search along any other.
enum class PieceKind : std::int32_t {
  vertices,
  hull,
  point,
  segment,
  box,
  cylinder,
  cone,
  ellipsoid,
  halfspace,
  plane
};
/// Half size of an unbounded piece's box, far beyond all coordinates allowed (1e9 m).
constexpr float kUnbounded = 1e30f;

/// One convex leaf, in its tree's frame; its axes are the frame's.
struct Piece {
  PieceKind kind = PieceKind::vertices;
  std::int32_t first_vertex = 0, num_vertices = 0;  ///< `vertices`; `hull`: index of its first x, multiple of eight
  std::int32_t primitive = -1;                      ///< FCL's id: triangle index, -1 for a shape
  /// box, ellipsoid: half sizes; cylinder, cone: radius, -, half length; segment: -, -, half length.
  /// Triangle: its unit normal (0 when degenerate), a direction worth trying. halfspace, plane: the unit normal n.
  double size[3] = {0, 0, 0};
  double center[3] = {0, 0, 0};  ///< added to the core; 0 for `vertices`; halfspace, plane: offset, 0, 0
  double radius = 0;             ///< rounding radius
  double reach = 0;  ///< upper bound of |p| over the core, from the frame's origin; halfspace, plane: of |offset|
};

}  // namespace engine
}  // namespace fcl_artic
