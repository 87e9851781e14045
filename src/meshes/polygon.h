// SPDX-License-Identifier: BSD-3-Clause
// Polygons of mesh files, cut into triangles.
#pragma once

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <vector>

namespace fcl_artic::meshes {

/// Corners that cutPolygon() compares with triangles at most, of all polygons of a file: about a second. Polygons
/// that are not convex take as many as the square of their corners, those that cross themselves or wind about more, up
/// to the cube.
constexpr std::size_t kMaxCompared = 100000000;

/// Cuts a polygon into n - 2 triangles between its corners, all of its own turning sense. Each of its edges is an edge
/// of one triangle, so that closed meshes stay closed, also where a polygon is broken.
///
/// A convex polygon is cut into a fan from its first corner; another one corner by corner, where the triangle holds no
/// other corner. The surface of a polygon that is not flat is not defined by its corners: it is taken to be these
/// triangles. A polygon that crosses or touches itself is cut so that all of its corners are covered.
/// @param corners  at least 3, finite. @param[in,out] compared  of the file's polygons so far.
/// @return triples of numbers of corners; none where `compared` would pass kMaxCompared.
std::vector<std::array<std::size_t, 3>> cutPolygon(const std::vector<Eigen::Vector3d>& corners, std::size_t& compared);

}  // namespace fcl_artic::meshes
