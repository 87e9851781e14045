// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <vector>

#include <fcl/geometry/collision_geometry.h>
#include <Eigen/Core>

namespace fcl_artic::render {

/// A triangle mesh in a geometry's own frame, in m; counter-clockwise seen from outside where there is an outside.
struct Triangles {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<int, 3>> faces;
};

/// Triangles to draw a geometry with: those of a mesh, curved shapes as fine polyhedra, octree cells as boxes, planes
/// as large squares.
/// @throws std::invalid_argument for a kind of geometry that can't be drawn.
Triangles triangulate(const fcl::CollisionGeometryd& geometry);

}  // namespace fcl_artic::render
