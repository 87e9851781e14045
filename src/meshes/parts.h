// SPDX-License-Identifier: BSD-3-Clause
// Files that hold meshes at places: what their readers share.
#pragma once

#include <Eigen/Geometry>

#include <string>

#include "meshes/triangle_soup.h"

namespace fcl_artic::meshes {

/// A mesh that places refer to. Corners of primitives are numbers of its own vertices.
struct Part {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::size_t> corners;  ///< of all faces, one after another
  std::vector<std::size_t> ends;     ///< of each face, in `corners`
  std::size_t points = 0, lines = 0;

  void addFace(std::initializer_list<std::size_t> face) {
    corners.insert(corners.end(), face);
    ends.push_back(corners.size());
  }
};

/// Adds a part at a place. Where that mirrors it, the corners of faces change their sense, so that what is outside
/// stays so.
/// @throws std::runtime_error as TriangleSoup::addFace(); for more vertices or triangles than 10^8: places may refer to
/// places.
void addPart(const Part& part, const Eigen::Affine3d& M, const Source& source, TriangleSoup& soup);

/// Notes which axis a file says is up, unless a file of the same notes said it before, as a robot may have many.
/// @param axis  'x' or 'y'. @param said  by the file; else by the format's rules. @param format  such as "COLLADA".
void noteUpAxis(char axis, bool said, const std::string& format, bool turned, const Source& source);

/// Turns what is up to z. @param axis  'x', 'y' or 'z'.
Eigen::Matrix3d turnUp(char axis);

}  // namespace fcl_artic::meshes
