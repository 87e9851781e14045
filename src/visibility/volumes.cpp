// SPDX-License-Identifier: BSD-3-Clause
#include "visibility/volumes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "numerics/baseline_isa.h"

#include "convex/cloud.h"

namespace fcl_artic {
namespace visibility {
namespace {

constexpr double kSqrt3 = 1.7320508075688773;
/// Coordinates x, y and z of the directions of Bounds, and their lengths.
constexpr double kAlong[3][Bounds::kDirections] = {{1, 0, 0, 1, 1, 0, 0, 1, -1, 1, 1, 1, 1},
                                                   {0, 1, 0, 1, -1, 1, 1, 0, 0, 1, 1, -1, -1},
                                                   {0, 0, 1, 0, 0, 1, -1, 1, 1, 1, -1, 1, -1}};

constexpr double kLengths[Bounds::kDirections] = {1,       1,       1,      M_SQRT2, M_SQRT2, M_SQRT2, M_SQRT2,
                                                  M_SQRT2, M_SQRT2, kSqrt3, kSqrt3,  kSqrt3,  kSqrt3};

/// A body's tree where it stands.
struct PlacedTree {
  const engine::TreeView& tree;
  const engine::Placement& at;
  double pad;  ///< bound on the rounding of a placed point, plus the margin

  PlacedTree(const engine::TreeView& of, const engine::Placement& where, double margin)
      : tree(of),
        at(where),
        // The placement's own error and a dozen roundings of numbers no larger than these.
        pad(margin + 0x1p-52 * (at.ulps + 64) * (2 * of.extent + at.length + margin)) {}

  void place(const double* p, double* x) const {
    const double *R = at.R, *t = at.t;
    for (int k = 0; k < 3; ++k) x[k] = R[3 * k] * p[0] + R[3 * k + 1] * p[1] + R[3 * k + 2] * p[2] + t[k];
  }
  Volume addBall(const engine::Node& node, Drawing& drawing) const {
    double center[3], x[3];
    for (int k = 0; k < 3; ++k) center[k] = 0.5 * (static_cast<double>(node.lo[k]) + static_cast<double>(node.hi[k]));
    place(center, x);
    return drawing.addVolume(x, 1, static_cast<double>(node.radius) + pad);
  }
  /// Adds the piece as the hull of points: itself, or, where it is curved, a polyhedron around it. An unbounded
  /// piece has no points.
  Volume addPiece(const engine::Piece& piece, Drawing& drawing) const {
    Volume volume = {static_cast<std::int32_t>(drawing.points.size() / 3), 0, piece.radius + pad};
    baseline::coverCore(tree, piece, [&](double a, double b, double c) {
      const double p[3] = {piece.center[0] + a, piece.center[1] + b, piece.center[2] + c};
      double x[3];
      place(p, x);
      drawing.points.insert(drawing.points.end(), x, x + 3);
      ++volume.count;
    });
    return volume;
  }
};

}  // namespace

Bounds::Bounds() {
  std::fill_n(lo, kDirections, std::numeric_limits<double>::infinity());
  std::fill_n(hi, kDirections, -std::numeric_limits<double>::infinity());
}

void Bounds::join(const Bounds& other) {
  for (int d = 0; d < kDirections; ++d) {
    lo[d] = std::min(lo[d], other.lo[d]);
    hi[d] = std::max(hi[d], other.hi[d]);
  }
}

std::uint32_t Bounds::meet(const Bounds* parts, std::uint32_t lanes) const {
  std::uint32_t met = 0;
  for (; lanes; lanes &= lanes - 1) {
    const Bounds& part = parts[__builtin_ctz(lanes)];
    int d = 0;
    while (d < kDirections && !(lo[d] > part.hi[d] || part.lo[d] > hi[d])) ++d;
    if (d == kDirections) met |= lanes & -lanes;
  }
  return met;
}

Bounds boundsOf(const double* points, int count, double radius) {
  Bounds b;
  double size = radius;
  for (const double* p = points; p < points + 3 * static_cast<std::ptrdiff_t>(count); p += 3) {
    for (int d = 0; d < Bounds::kDirections; ++d) {
      const double at = kAlong[0][d] * p[0] + kAlong[1][d] * p[1] + kAlong[2][d] * p[2];
      b.lo[d] = std::min(b.lo[d], at);
      b.hi[d] = std::max(b.hi[d], at);
    }
    size += std::abs(p[0]) + std::abs(p[1]) + std::abs(p[2]);  // not a number, where one of them isn't
  }
  for (int d = 0; d < Bounds::kDirections; ++d) {
    const double grow = kLengths[d] * radius + 0x1p-48 * size;
    b.lo[d] -= grow;
    b.hi[d] += grow;
  }
  return b;
}

bool addPieces(const engine::TreeView& tree, std::int32_t root, const engine::Placement& at, double margin,
               const SweptParts& swept, std::size_t most, std::uint32_t& lanes, Bounds& reach, Drawing& drawing) {
  if (!(tree.nodes[0].radius < engine::kUnbounded)) return false;
  const PlacedTree placed(tree, at, margin);
  const std::size_t num_pieces = drawing.pieces.size(), num_points = drawing.points.size();
  const auto addNothing = [&] {
    drawing.pieces.resize(num_pieces);
    drawing.points.resize(num_points);
    return false;
  };
  struct Open {
    std::int32_t node;
    std::uint32_t lanes;
  };
  constexpr int kMostOpen = 128;
  Open stack[kMostOpen];
  int open = 0;
  stack[open++] = {root, lanes};
  std::uint32_t touched = 0;
  Bounds reached = reach;
  while (open) {
    const Open top = stack[--open];
    baseline::NodeRoom room;
    const engine::Node& node = baseline::nodeOf(tree, top.node, room);
    const bool small = static_cast<double>(node.radius) < swept.least, drawn = small || node.isLeaf();
    baseline::PieceRoom piece;
    const Volume volume = small || !node.isLeaf()
                              ? placed.addBall(node, drawing)
                              : placed.addPiece(baseline::pieceOf(tree, node.piece(), piece), drawing);
    const double* points = drawing.points.data() + 3 * static_cast<std::ptrdiff_t>(volume.first);
    const Bounds bounds = boundsOf(points, volume.count, volume.radius);
    const std::uint32_t met = bounds.meet(swept.parts, top.lanes);
    if (met && drawn) {
      if (drawing.pieces.size() >= most) return addNothing();
      touched |= met;
      reached.join(bounds);
      drawing.pieces.push_back({volume, drawing.num_groups});
      continue;
    }
    drawing.points.resize(3 * static_cast<std::size_t>(volume.first));
    if (!met) continue;
    if (open + 2 > kMostOpen) return addNothing();
    stack[open++] = {node.right(), met};
    stack[open++] = {node.left(), met};
  }
  lanes &= touched;
  reach = reached;
  return true;
}

}  // namespace visibility
}  // namespace fcl_artic
