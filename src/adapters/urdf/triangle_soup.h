// SPDX-License-Identifier: BSD-3-Clause
// What the readers of mesh files read.
#pragma once

#include <fcl/math/triangle.h>
#include <Eigen/Core>

#include <string>
#include <string_view>
#include <vector>

namespace fcl_artic::detail {

struct TriangleSoup {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<fcl::Triangle> triangles;

  /// Adds a face of any number of corners as triangles (cutPolygon()); a point or a line adds none.
  /// @param corners  numbers of vertices that are there. @throws std::runtime_error naming `where` for a vertex that is
  /// not finite, and for a polygon that is too large to cut.
  void addFace(const std::size_t* corners, std::size_t count, const std::string& where);
};

/// Reads a Wavefront OBJ: its vertices and faces.
/// @param notes  what was passed over though unusual is appended; may be null.
/// @throws std::runtime_error naming `where`, line and reason.
TriangleSoup readObj(std::string_view content, const std::string& where, std::vector<std::string>* notes);

/// Whether an STL file is a binary one: as long as its head says.
bool isBinaryStl(std::string_view content);
TriangleSoup readBinaryStl(std::string_view content);

}  // namespace fcl_artic::detail
