// SPDX-License-Identifier: BSD-3-Clause
//
// Questions about a mesh's triangles: the nearest point, a distance that is certain, whether a line crosses it
// (doc/NUMERICS.md, "Inner balls").
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include <Eigen/Geometry>

#include "model/tree_view.h"

namespace fcl_artic {

constexpr double kMeshUlp = 0x1p-52;
/// Directions shorter than this are none.
constexpr double kLeastMeshLength = 1e-100;

struct MeshTriangle {
  Eigen::Vector3d corner[3];
};
inline MeshTriangle triangleOf(const engine::TreeView& mesh, std::int32_t piece) {
  const double* v = mesh.vertices + 3 * static_cast<std::ptrdiff_t>(mesh.pieces[piece].first_vertex);
  return {{Eigen::Vector3d::Map(v), Eigen::Vector3d::Map(v + 3), Eigen::Vector3d::Map(v + 6)}};
}

/// A triangle's point nearest to x, about (Ericson, Real-Time Collision Detection, 5.1.5).
inline Eigen::Vector3d nearestPoint(const MeshTriangle& t, const Eigen::Vector3d& x) {
  const Eigen::Vector3d &a = t.corner[0], &b = t.corner[1], &c = t.corner[2];
  const Eigen::Vector3d ab = b - a, ac = c - a, ax = x - a;
  const double d1 = ab.dot(ax), d2 = ac.dot(ax);
  if (d1 <= 0 && d2 <= 0) return a;
  const Eigen::Vector3d bx = x - b;
  const double d3 = ab.dot(bx), d4 = ac.dot(bx);
  if (d3 >= 0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  const Eigen::Vector3d cx = x - c;
  const double d5 = ab.dot(cx), d6 = ac.dot(cx);
  if (d6 >= 0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  const double scale = 1 / (va + vb + vc);
  return a + vb * scale * ab + vc * scale * ac;
}

/// Lower bound of x's distance from a triangle: all of its points lie beyond the plane across a direction n, whatever
/// that is. A corner's place along it errs by less than 8 kMeshUlp |n| |v - x|.
inline double clearanceAlong(const MeshTriangle& t, const Eigen::Vector3d& x, const Eigen::Vector3d& n) {
  const double length = n.norm();
  if (!(length > kLeastMeshLength)) return 0;
  double least = std::numeric_limits<double>::infinity(), far = 0;
  for (const Eigen::Vector3d& corner : t.corner) {
    const Eigen::Vector3d d = corner - x;
    least = std::min(least, n.dot(d));
    far = std::max(far, d.norm());
  }
  return std::max(0.0, least / length - 32 * kMeshUlp * far);
}
/// Along the direction to the nearest point, wherever that came from.
inline double clearanceOf(const MeshTriangle& t, const Eigen::Vector3d& x, const Eigen::Vector3d& nearest) {
  return clearanceAlong(t, x, nearest - x);
}

/// Distance of x from a node's box, no larger than it is.
inline double clearanceOf(const engine::Node& node, const Eigen::Vector3d& x) {
  double square = 0;
  for (int k = 0; k < 3; ++k) {
    const double d = std::max({node.lo[k] - x[k], x[k] - node.hi[k], 0.0});
    square += d * d;
  }
  return std::sqrt(square) * (1 - 16 * kMeshUlp);
}

/// Least distance of x from a mesh's triangles, no larger than it is; infinite: from none.
/// @param clearance  of x from the triangle of a piece, no larger than it is, and the point that is near: called as
///   clearance(piece, point), infinite for one that does not count.
template <class F>
double leastClearance(const engine::TreeView& mesh, const Eigen::Vector3d& x, const F& clearance,
                      Eigen::Vector3d& nearest) {
  struct Open {
    std::int32_t node;
    double clearance;
  };
  constexpr std::size_t kDeepest = 64;  // trees are balanced
  Open open[kDeepest];
  std::size_t count = 0;
  double least = std::numeric_limits<double>::infinity();
  open[count++] = {0, clearanceOf(mesh.nodes[0], x)};
  while (count) {
    const Open at = open[--count];
    if (at.clearance >= least) continue;
    const engine::Node& node = mesh.nodes[at.node];
    if (node.isLeaf()) {
      Eigen::Vector3d point = x;  // g++ does not see that an infinite clearance is never the least
      const double found = clearance(node.piece(), point);
      if (found >= least) continue;
      least = found;
      nearest = point;
      continue;
    }
    Open left = {node.left(), clearanceOf(mesh.nodes[node.left()], x)};
    Open right = {node.right(), clearanceOf(mesh.nodes[node.right()], x)};
    if (left.clearance < right.clearance) std::swap(left, right);  // the nearer one first
    open[count++] = left;
    open[count++] = right;
  }
  return least;
}

/// Where a line along an axis crosses a triangle.
struct LineCrossing {
  double height;  ///< above the point that the line goes through, about
  bool certain;   ///< which side of that point it lies on
  int direction;  ///< 1: seen from above, the triangle's corners follow each other counterclockwise; else -1
};
enum class Crosses { no, yes, unknown };
/// Whether it does: the signs of the areas that the line's point and the edges span, seen along the axis.
inline Crosses crosses(const MeshTriangle& t, const Eigen::Vector3d& x, int axis, LineCrossing& crossing) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  for (const int k : {u, v}) {
    const double least = std::min({t.corner[0][k], t.corner[1][k], t.corner[2][k]});
    const double most = std::max({t.corner[0][k], t.corner[1][k], t.corner[2][k]});
    if (x[k] < least || x[k] > most) return Crosses::no;
  }
  const Eigen::Vector3d d[3] = {t.corner[0] - x, t.corner[1] - x, t.corner[2] - x};
  double area[3], error[3];  // of the edge across from each corner
  int positive = 0;
  bool unknown = false;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d &p = d[(i + 1) % 3], &q = d[(i + 2) % 3];
    const double one = p[u] * q[v], other = q[u] * p[v];
    area[i] = one - other;
    error[i] = 8 * kMeshUlp * (std::abs(one) + std::abs(other)) + kLeastMeshLength;
    unknown = unknown || !(std::abs(area[i]) > error[i]);
    positive += area[i] > 0;
  }
  if (unknown) return Crosses::unknown;
  if (positive != 0 && positive != 3) return Crosses::no;
  double sum = 0, weights = 0, sum_error = kLeastMeshLength;
  for (int i = 0; i < 3; ++i) {
    sum += area[i] * d[i][axis];
    weights += area[i];
    sum_error += (error[i] + 8 * kMeshUlp * std::abs(area[i])) * std::abs(d[i][axis]);
  }
  crossing = {sum / weights, std::abs(sum) > sum_error, positive ? 1 : -1};
  return Crosses::yes;
}

}  // namespace fcl_artic
