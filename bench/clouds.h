// SPDX-License-Identifier: BSD-3-Clause
//
// Clouds of points, as a depth camera or a scanner gives them, and a cut through any points.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <Eigen/Geometry>

#include "arm_scene.h"
#include "random.h"

namespace fcl_artic::bench {

/// What a depth camera sees, row by row: a table with a can on it, the floor and a wall behind, 1 to 2 m ahead of the
/// robot; and its noise along the rays.
inline std::vector<Eigen::Vector3d> frameOf(int points, Random& random) {
  const Eigen::Vector3d eye(0.2, 0, 1.3);
  const Eigen::Matrix3d down = Eigen::AngleAxisd(0.6, Eigen::Vector3d::UnitY()).toRotationMatrix();
  const int columns = std::max(1, static_cast<int>(std::sqrt(points * 4 / 3.0))), rows = points / columns;
  std::vector<Eigen::Vector3d> out;
  out.reserve(static_cast<std::size_t>(points));
  for (int i = 0; i < rows * columns; ++i) {
    const int column = i % columns, row = i / columns;
    const double u = (column + 0.5) / columns - 0.5, v = 0.5 - (row + 0.5) / rows;
    const Eigen::Vector3d ray = down * Eigen::Vector3d(1, -1.4 * u, 1.05 * v);
    double nearest = (1.7 - eye.x()) / ray.x();  // the wall
    const auto meet = [&](double at, const auto& isThere) {
      if (at > 0 && at < nearest && isThere(eye + at * ray)) nearest = at;
    };
    meet(-eye.z() / ray.z(), [](const Eigen::Vector3d&) { return true; });  // the floor
    meet((0.1 - eye.z()) / ray.z(),
         [](const Eigen::Vector3d& x) { return x.x() > 0.85 && x.x() < 1.65 && std::abs(x.y()) < 0.8; });
    const Eigen::Vector3d from = eye - Eigen::Vector3d(1.1, 0.3, 0);  // the can: |from + at ray| = 0.06 across z
    const double a = ray.head<2>().squaredNorm(), b = ray.head<2>().dot(from.head<2>());
    const double root = b * b - a * (from.head<2>().squaredNorm() - 0.06 * 0.06);
    if (root > 0)
      meet((-b - std::sqrt(root)) / a, [](const Eigen::Vector3d& x) { return x.z() > 0.1 && x.z() < 0.35; });
    out.push_back(eye + (nearest + 0.002 * (random.uniform() - 0.5)) * ray);
  }
  return out;
}

/// Points of a surface, as a scanner sees it, each off by up to a third of its radius along each axis.
inline std::vector<Eigen::Vector3d> scan(const TriangleMesh& mesh, std::size_t n, double radius, Random& random) {
  std::vector<Eigen::Vector3d> points;
  while (points.size() < n) {
    const auto& t = mesh.triangles[static_cast<std::size_t>(random.index(static_cast<int>(mesh.triangles.size())))];
    double u = random.uniform(0, 1), v = random.uniform(0, 1);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const Eigen::Vector3d a = mesh.vertices[t[0]], b = mesh.vertices[t[1]], c = mesh.vertices[t[2]];
    const double x = random.uniform(-1, 1), y = random.uniform(-1, 1), z = random.uniform(-1, 1);
    points.push_back(a + u * (b - a) + v * (c - a) + radius / 3 * Eigen::Vector3d(x, y, z));
  }
  return points;
}

/// The numbers of points in groups: all of them, halved across the longest side of their box until there are enough.
inline std::vector<std::vector<std::size_t>> cut(const std::vector<Eigen::Vector3d>& points, std::size_t groups) {
  std::vector<std::vector<std::size_t>> out(1);
  for (std::size_t i = 0; i < points.size(); ++i) out[0].push_back(i);
  while (out.size() < groups) {
    std::vector<std::vector<std::size_t>> halves;
    for (std::vector<std::size_t>& group : out) {
      Eigen::AlignedBox3d box;
      for (const std::size_t i : group) box.extend(points[i]);
      Eigen::Index side = 0;
      box.sizes().maxCoeff(&side);
      const auto middle = group.begin() + static_cast<std::ptrdiff_t>(group.size() / 2);
      std::nth_element(group.begin(), middle, group.end(),
                       [&](std::size_t a, std::size_t b) { return points[a][side] < points[b][side]; });
      halves.emplace_back(group.begin(), middle);
      halves.emplace_back(middle, group.end());
    }
    out = std::move(halves);
  }
  return out;
}

}  // namespace fcl_artic::bench
