// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/nearness.h"

#include <algorithm>
#include <limits>

#include "geometry/mesh_triangle.h"
#include "numerics/assertion.h"
#include "numerics/baseline_isa.h"

#include "convex/cloud.h"
#include "convex/gjk.h"

namespace fcl_artic {
namespace {

using engine::Piece;
using engine::PieceKind;

/// The square of x's distance from a box.
double squareFrom(const engine::Node& node, const Eigen::Vector3d& x) {
  const Eigen::Array3d lo = Eigen::Array3f::Map(node.lo).cast<double>(),
                       hi = Eigen::Array3f::Map(node.hi).cast<double>();
  return (lo - x.array()).max(x.array() - hi).max(0.0).square().sum();
}

/// How near the simplex has a point to the origin. Whatever weights a combination has, if none is negative and their
/// sum is 1 its point is one of the bodies' difference: only that is relied on.
double nearestOf(const baseline::Simplex& s) {
  if (s.n < 4) return norm(combined(s));
  const auto volume = [](const baseline::Vec3& a, const baseline::Vec3& b, const baseline::Vec3& c) {
    return dot(a, cross(b, c));
  };
  const baseline::Vec3 &a = s.v[0].w, &b = s.v[1].w, &c = s.v[2].w, &d = s.v[3].w;
  const double parts[4] = {volume(b, c, d), -volume(a, c, d), volume(a, b, d), -volume(a, b, c)};
  const double sum = parts[0] + parts[1] + parts[2] + parts[3];
  double nearest = std::numeric_limits<double>::infinity();
  if (std::all_of(parts, parts + 4, [&](double part) { return part / sum >= 0; })) {
    nearest = norm(a * (parts[0] / sum) + b * (parts[1] / sum) + c * (parts[2] / sum) + d * (parts[3] / sum));
  }
  for (int out = 0; out < 4; ++out) {  // a flat one's faces
    const baseline::Vec3 &x = s.v[(out + 1) & 3].w, &y = s.v[(out + 2) & 3].w, &z = s.v[(out + 3) & 3].w;
    const baseline::Vec3 weights = baseline::nearestOnTriangle(x, y, z);
    const double found = norm(x * weights[0] + y * weights[1] + z * weights[2]);
    nearest = std::min(nearest, found);
  }
  return nearest;
}

}  // namespace

bool Nearness::isNearPiece(std::int32_t index, const Eigen::Vector3d& x, double most) const {
  baseline::PieceRoom room;
  const Piece& piece = baseline::pieceOf(tree_, index, room);
  if (piece.kind == PieceKind::vertices && piece.num_vertices == 3) {
    const MeshTriangle triangle = triangleOf(tree_, index);
    return (nearestPoint(triangle, x) - x).squaredNorm() <= most * most;
  }
  const baseline::Vec3 at(x.data());
  const double known = distanceFrom(piece, spread(at))[0];
  if (known < baseline::kInfinite) return known <= most;
  Piece point;
  point.kind = PieceKind::point;
  std::copy_n(x.data(), 3, point.center);
  baseline::DifferenceBody body;
  body.tree_a = body.tree_b = &tree_;
  body.a = &piece;
  body.b = &point;
  body.pose.R = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  body.pose.c = {0, 0, 0};
  baseline::GjkResult found;
  const double within = most + piece.radius;
  baseline::gjk<true>(body, at - baseline::pointWithin(tree_, piece, baseline::Vec3(0, 0, 0)),
                      {1e-6, within, 100, within}, found);
  return nearestOf(found.simplex) <= within;
}

bool Nearness::isNear(const Eigen::Vector3d& x, double most, std::int32_t& last) const {
  if (tree_.num_pieces == 0) return false;
  if (last >= 0 && isNearPiece(last, x, most)) return true;
  constexpr std::size_t kDeepest = 256;  // trees along a curve are 160 levels deep at most, others balanced
  std::int32_t open[kDeepest];
  std::size_t count = 0;
  const double square = most * most * (1 + 1e-12);
  const auto squareTo = [&](int node) {
    baseline::NodeRoom room;
    return squareFrom(baseline::nodeOf(tree_, node, room), x);
  };
  if (squareTo(0) <= square) open[count++] = 0;
  while (count) {
    baseline::NodeRoom room;
    const engine::Node& node = baseline::nodeOf(tree_, open[--count], room);
    if (node.isLeaf()) {
      if (node.piece() == last || !isNearPiece(node.piece(), x, most)) continue;
      last = node.piece();
      return true;
    }
    const double left = squareTo(node.left()), right = squareTo(node.right());
    FCL_ARTIC_ASSERT(count + 2 <= kDeepest);
    const bool left_first = left < right;
    // The nearer one is looked at first.
    if (left_first && right <= square) open[count++] = node.right();
    if (left <= square) open[count++] = node.left();
    if (!left_first && right <= square) open[count++] = node.right();
  }
  return false;
}

}  // namespace fcl_artic
