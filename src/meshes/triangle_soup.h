// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fcl/math/triangle.h>
#include <Eigen/Core>

#include <cstddef>
#include <vector>

#include "meshes/source.h"

namespace fcl_artic::meshes {

/// The content of a mesh file.
struct TriangleSoup {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<fcl::Triangle> triangles;
  std::size_t points = 0, lines = 0;  ///< Left out: they have no surface.
  std::size_t uneven = 0;             ///< Faces whose corners lie in no plane.
  std::size_t compared = 0;           ///< Corners, to cut faces: cutPolygon().

  /// Adds a face of any number of corners as triangles (cutPolygon()); counts one of one or two as a point or a line.
  /// @param corners  numbers of vertices. @throws std::runtime_error naming the source for a face without a corner, a
  /// vertex that isn't there, one that is not finite, and polygons that take too long to cut.
  void addFace(const std::size_t* corners, std::size_t count, const Source& source);

  /// Notes what was left out, and what is not defined by the file.
  void noteSkipped(const Source& source) const;
};

}  // namespace fcl_artic::meshes
