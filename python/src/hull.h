// SPDX-License-Identifier: BSD-3-Clause
//
// Faces of a convex hull, for pictures: queries take the hull of the vertices and look at no face.
#pragma once

#include <map>
#include <set>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

namespace fcl_artic::python {

/// Triangles of the hull of points, counter-clockwise seen from outside; none if the points lie in a plane, or nearly
/// so. Points are added one after the other, each of them seen from the faces that it lies outside of.
inline std::vector<Eigen::Matrix<std::size_t, 3, 1>> hullFaces(const std::vector<Eigen::Vector3d>& points) {
  using Face = Eigen::Matrix<std::size_t, 3, 1>;
  using Eigen::Vector3d;
  if (points.size() < 4) return {};
  Eigen::AlignedBox3d box;
  for (const Vector3d& p : points) box.extend(p);
  const double small = 1e-9 * box.diagonal().norm();
  const auto farthest = [&](const auto& distance) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < points.size(); ++i) {
      if (distance(points[i]) > distance(points[best])) best = i;
    }
    return best;
  };
  const std::size_t a = 0;
  const std::size_t b = farthest([&](const Vector3d& p) { return (p - points[a]).norm(); });
  const Vector3d along = (points[b] - points[a]).normalized();
  const std::size_t c = farthest([&](const Vector3d& p) { return along.cross(p - points[a]).norm(); });
  const Vector3d across = along.cross(points[c] - points[a]).normalized();
  const std::size_t d = farthest([&](const Vector3d& p) { return std::abs(across.dot(p - points[a])); });
  if (std::abs(across.dot(points[d] - points[a])) <= small) return {};
  const Vector3d middle = (points[a] + points[b] + points[c] + points[d]) / 4;
  const auto height = [&](const Face& f, const Vector3d& p) {
    const Vector3d n = (points[f[1]] - points[f[0]]).cross(points[f[2]] - points[f[0]]);
    return n.norm() > 0 ? n.normalized().dot(p - points[f[0]]) : 0;
  };
  std::vector<Face> faces;
  const auto add = [&](std::size_t i, std::size_t j, std::size_t k) {
    const Face f(i, j, k);
    faces.push_back(height(f, middle) <= 0 ? f : Face(i, k, j));
  };
  add(a, b, c);
  add(a, b, d);
  add(a, c, d);
  add(b, c, d);
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::vector<Face> kept;
    std::set<std::pair<std::size_t, std::size_t>> edges;  // of the faces that see the point
    for (const Face& f : faces) {
      if (height(f, points[i]) <= small) {
        kept.push_back(f);
        continue;
      }
      for (const auto& [from, to] : {std::pair(f[0], f[1]), std::pair(f[1], f[2]), std::pair(f[2], f[0])}) {
        if (!edges.erase({to, from})) edges.insert({from, to});
      }
    }
    for (const auto& [from, to] : edges) kept.emplace_back(from, to, i);
    faces = std::move(kept);
  }
  return faces;
}

}  // namespace fcl_artic::python
