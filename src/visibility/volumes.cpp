// SPDX-License-Identifier: BSD-3-Clause
#include "visibility/volumes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "numerics/baseline_isa.h"

#include "convex/piece_kinds.h"

namespace fcl_artic {
namespace visibility {
namespace {

using engine::Node;
using engine::Piece;

/// Lengths of the directions of Bounds.
constexpr double kSqrt2 = 1.41421356237310, kSqrt3 = 1.73205080756888;
constexpr double kLengths[Bounds::kDirections] = {1,      1,      1,      kSqrt2, kSqrt2, kSqrt2, kSqrt2,
                                                  kSqrt2, kSqrt2, kSqrt3, kSqrt3, kSqrt3, kSqrt3};
/// A vector along the directions of Bounds.
void along(double x, double y, double z, double* at) {
  const double values[Bounds::kDirections] = {x,     y,     z,         x + y,     x - y,     y + z,    y - z,
                                              z + x, z - x, x + y + z, x + y - z, x - y + z, x - y - z};
  std::copy(values, values + Bounds::kDirections, at);
}

}  // namespace

Bounds Bounds::none() {
  Bounds b;
  for (int d = 0; d < kDirections; ++d) {
    b.lo[d] = std::numeric_limits<double>::infinity();
    b.hi[d] = -b.lo[d];
  }
  return b;
}

void Bounds::join(const Bounds& other) {
  for (int d = 0; d < kDirections; ++d) {
    lo[d] = std::min(lo[d], other.lo[d]);
    hi[d] = std::max(hi[d], other.hi[d]);
  }
}

Bounds boundsOf(const double* points, int count, double radius) {
  Bounds b = Bounds::none();
  double size = radius;
  for (int i = 0; i < count; ++i) {
    const double* p = points + 3 * i;
    double at[Bounds::kDirections];
    along(p[0], p[1], p[2], at);
    for (int d = 0; d < Bounds::kDirections; ++d) {
      b.lo[d] = i ? std::min(b.lo[d], at[d]) : at[d];
      b.hi[d] = i ? std::max(b.hi[d], at[d]) : at[d];
    }
    size += std::abs(p[0]) + std::abs(p[1]) + std::abs(p[2]);
  }
  for (int d = 0; d < Bounds::kDirections; ++d) {
    const double grow = kLengths[d] * radius + 0x1p-48 * size;
    b.lo[d] -= grow;
    b.hi[d] += grow;
  }
  return b;
}

Bounds boundsOf(const engine::SweptLink& link) {
  return boundsOf(&link.points[0][0], 6, link.radius);
}

Volume addVolume(const engine::SweptLink& link, Batch& batch) {
  Volume volume;
  volume.first = static_cast<std::int32_t>(batch.points.size() / 3);
  volume.count = 6;
  volume.radius = link.radius;
  batch.points.insert(batch.points.end(), &link.points[0][0], &link.points[0][0] + 18);
  return volume;
}

BodyPieces::BodyPieces(const engine::TreeView& tree, const engine::Placement& at, double margin)
    : tree_(tree),
      at_(at),
      // The placement's own error and a dozen roundings of numbers no larger than these.
      pad_(margin + 0x1p-52 * (at.ulps + 64) * (2 * tree.extent + at.length + margin)) {
  const double *R = at.R, *t = at.t;
  for (int k = 0; k < 3; ++k) along(R[k], R[3 + k], R[6 + k], axes_[k]);
  along(t[0], t[1], t[2], origin_);
}

void BodyPieces::place(const double* p, double* x) const {
  const double *R = at_.R, *t = at_.t;
  for (int k = 0; k < 3; ++k) x[k] = R[3 * k] * p[0] + R[3 * k + 1] * p[1] + R[3 * k + 2] * p[2] + t[k];
}

/// Bounds of the node's box: where its middle is, and how far its half sides reach, along each direction. A direction
/// is no longer than sqrt(3), and roundings are some twenty: within its length times pad_.
Bounds BodyPieces::boundsOf(const Node& node) const {
  double c[3], h[3];
  for (int k = 0; k < 3; ++k) {
    c[k] = 0.5 * (static_cast<double>(node.hi[k]) + static_cast<double>(node.lo[k]));
    h[k] = 0.5 * (static_cast<double>(node.hi[k]) - static_cast<double>(node.lo[k]));
  }
  Bounds b;
  for (int d = 0; d < Bounds::kDirections; ++d) {
    const double x = axes_[0][d], y = axes_[1][d], z = axes_[2][d];
    const double middle = x * c[0] + y * c[1] + z * c[2] + origin_[d];
    const double reach = std::abs(x) * h[0] + std::abs(y) * h[1] + std::abs(z) * h[2] + kLengths[d] * pad_;
    b.lo[d] = middle - reach;
    b.hi[d] = middle + reach;
  }
  return b;
}

Volume BodyPieces::ballAround(const Node& node, Batch& batch) const {
  double center[3], x[3];
  for (int k = 0; k < 3; ++k) center[k] = 0.5 * (static_cast<double>(node.lo[k]) + static_cast<double>(node.hi[k]));
  place(center, x);
  Volume volume;
  volume.first = static_cast<std::int32_t>(batch.points.size() / 3);
  volume.count = 1;
  volume.radius = static_cast<double>(node.radius) + pad_;
  batch.points.insert(batch.points.end(), x, x + 3);
  return volume;
}

/// The piece as the hull of points: itself, or, where it is curved, a polyhedron around it.
Volume BodyPieces::volumeOf(const Piece& piece, Batch& batch) const {
  Volume volume;
  volume.first = static_cast<std::int32_t>(batch.points.size() / 3);
  volume.radius = piece.radius + pad_;
  const auto add = [&](double a, double b, double c) {
    const double p[3] = {piece.center[0] + a, piece.center[1] + b, piece.center[2] + c};
    double x[3];
    place(p, x);
    batch.points.insert(batch.points.end(), x, x + 3);
    ++volume.count;
  };
  baseline::coverCore(tree_, piece, add);  // of an unbounded piece no points: the projector finds it unusable
  return volume;
}

bool BodyPieces::collect(std::int32_t root, const SweptParts& swept, std::size_t most, std::uint32_t& lanes,
                         Bounds& reach, Batch& batch) const {
  if (!(tree_.nodes[0].radius < engine::kUnbounded)) return false;
  const auto met = [&](const Bounds& bounds, std::uint32_t asked) {
    std::uint32_t mask = 0;
    for (int lane = 0; lane < 8; ++lane) {
      if ((asked >> lane & 1) && swept.parts[lane].meets(bounds)) mask |= 1u << lane;
    }
    return mask;
  };
  struct Open {
    std::int32_t node;
    std::uint32_t lanes;
  };
  Open stack[128];
  int open = 0;
  stack[open++] = {root, lanes};
  std::uint32_t touched = 0;
  while (open) {
    const Open top = stack[--open];
    const Node& node = tree_.nodes[top.node];
    const bool small = static_cast<double>(node.radius) < swept.least;
    if (!node.isLeaf() && !small) {
      const std::uint32_t mask = met(boundsOf(node), top.lanes);
      if (!mask) continue;
      if (open + 2 > 128) return false;
      stack[open++] = {node.right(), mask};
      stack[open++] = {node.left(), mask};
      continue;
    }
    if (batch.objects.size() >= most) return false;
    const std::size_t points = batch.points.size();
    const Volume volume = small ? ballAround(node, batch) : volumeOf(tree_.pieces[node.piece()], batch);
    const Bounds bounds = visibility::boundsOf(batch.points.data() + points, volume.count, volume.radius);
    const std::uint32_t mask = met(bounds, top.lanes);
    if (mask) {
      touched |= mask;
      reach.join(bounds);
      batch.objects.push_back({volume, swept.window, batch.num_groups});
    } else {
      batch.points.resize(points);
    }
  }
  lanes &= touched;
  return true;
}

bool BodyPieces::add(std::int32_t node, const SweptParts& swept, std::size_t most, std::uint32_t& lanes, Bounds& reach,
                     Batch& batch) const {
  const std::size_t objects = batch.objects.size(), points = batch.points.size();
  const Bounds reached = reach;
  if (collect(node, swept, most, lanes, reach, batch)) return true;
  batch.objects.resize(objects);
  batch.points.resize(points);
  reach = reached;
  return false;
}

}  // namespace visibility
}  // namespace fcl_artic
