// SPDX-License-Identifier: BSD-3-Clause
#include "meshes/polygon.h"

#include <Eigen/Geometry>

#include <cmath>
#include <limits>

namespace fcl_artic::meshes {
namespace {

using Outline = std::vector<Eigen::Vector2d>;

/// Twice the signed area of a triangle: positive where it turns to the left.
double turn(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  const Eigen::Vector2d u = b - a, v = c - a;
  return u.x() * v.y() - u.y() * v.x();
}

/// The corners as seen against the polygon's normal, in which it turns to the left. The normal is the sum of its edges'
/// cross products (Newell). The polygon is scaled to size 1, so that no product overflows. If it has no area, all
/// corners are at 0.
Outline flattened(const std::vector<Eigen::Vector3d>& corners) {
  Eigen::Vector3d lower = corners[0], upper = corners[0];
  for (const Eigen::Vector3d& x : corners) {
    lower = lower.cwiseMin(x);
    upper = upper.cwiseMax(x);
  }
  const double size = (upper / 2 - lower / 2).maxCoeff();
  Outline points(corners.size(), Eigen::Vector2d::Zero());
  if (!(size > 0)) return points;
  const auto scaled = [&](std::size_t i) -> Eigen::Vector3d {
    return (corners[i % corners.size()] - corners[0]) / size;
  };
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < corners.size(); ++i) normal += scaled(i).cross(scaled(i + 1));
  if (!(normal.norm() > 0) || !normal.allFinite()) return points;
  const Eigen::Vector3d x = normal.unitOrthogonal(), y = normal.normalized().cross(x);
  for (std::size_t i = 0; i < corners.size(); ++i) points[i] = {x.dot(scaled(i)), y.dot(scaled(i))};
  return points;
}

/// A turn of this size may be the rounding of coordinates of size 1 or less: it counts as none.
constexpr double kFlat = 16 * std::numeric_limits<double>::epsilon();

/// Whether the polygon turns to the left at all of its corners, and once round in all.
bool isConvex(const Outline& points) {
  const std::size_t n = points.size();
  int changes = 0;  // of the direction from left to right; a convex polygon has two
  double last = 0, first = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector2d &a = points[i], &b = points[(i + 1) % n], &c = points[(i + 2) % n];
    if (turn(a, b, c) < -kFlat) return false;
    const double step = b.x() - a.x();
    if (std::abs(step) <= kFlat) continue;
    if (last == 0) first = step;
    changes += last * step < 0;
    last = step;
  }
  changes += last * first < 0;
  return changes <= 2;
}

/// Whether p lies in the triangle, which turns to the left, or on its rim.
bool holds(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c, const Eigen::Vector2d& p) {
  return turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0;
}

}  // namespace

std::vector<std::array<std::size_t, 3>> cutPolygon(const std::vector<Eigen::Vector3d>& corners, std::size_t& compared) {
  const std::size_t n = corners.size();
  std::vector<std::array<std::size_t, 3>> triangles;
  triangles.reserve(n - 2);
  const Outline points = flattened(corners);
  if (n == 3 || isConvex(points)) {
    for (std::size_t i = 1; i + 1 < n; ++i) triangles.push_back({0, i, i + 1});
    return triangles;
  }
  // Cuts off ears: corners whose triangle holds no other corner. If a round finds no ear, as in a polygon that crosses
  // itself, any corner is cut off, so that the work ends and no edge is lost.
  std::vector<std::size_t> before(n), after(n);
  for (std::size_t i = 0; i < n; ++i) before[i] = (i + n - 1) % n, after[i] = (i + 1) % n;
  const auto isEar = [&](std::size_t i) {
    const Eigen::Vector2d &a = points[before[i]], &b = points[i], &c = points[after[i]];
    if (!(turn(a, b, c) > 0)) return false;
    for (std::size_t k = after[after[i]]; k != before[i]; k = after[k]) {
      ++compared;
      const Eigen::Vector2d& p = points[k];
      if (p == a || p == b || p == c) continue;  // where a polygon with a hole is slit open, corners come twice
      if (turn(points[before[k]], p, points[after[k]]) <= 0 && holds(a, b, c, p)) return false;
    }
    return true;
  };
  std::size_t left = n, at = 0, tried = 0;
  while (left > 3) {
    if (tried < left && !isEar(at)) {
      at = after[at];
      ++tried;
      if (compared > kMaxCompared) return {};
      continue;
    }
    triangles.push_back({before[at], at, after[at]});
    after[before[at]] = after[at];
    before[after[at]] = before[at];
    at = after[after[at]];  // not the next one at once, which would give a fan of slivers
    tried = 0;
    --left;
  }
  triangles.push_back({before[at], at, after[at]});
  return triangles;
}

}  // namespace fcl_artic::meshes
