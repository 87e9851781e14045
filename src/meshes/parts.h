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

/// Counts what is made of a file: numbers, vertices and corners that are read or placed, nodes that are gone through.
/// Places refer to meshes, to other places and to the same bytes again, so that a small file could fill all memory. A
/// file that says each thing once makes at most 8 things of each of its bytes. A number takes one byte at least, and
/// is a corner of a strip, so three corners of a triangle. These are read and placed, as the vertices are. kMaxCopies
/// are for what it says repeatedly: about a million triangles, for which FCL's tree takes half a gigabyte.
class Yield {
 public:
  explicit Yield(const Source& source) : source_(source), bytes_(source.content.size()) {}
  /// Another file that is part of it.
  void addBytes(std::size_t bytes) { bytes_ += bytes; }
  /// Before they are made. @throws std::runtime_error for more than the file may make.
  void add(std::size_t count);

 private:
  static constexpr std::size_t kMaxCopies = 4000000, kMaxPerByte = 8;

  const Source& source_;
  std::size_t bytes_, made_ = 0;
};

/// Adds a part at a place. Where that mirrors it, the corners of faces change their sense, so that what is outside
/// stays so.
/// @throws std::runtime_error as TriangleSoup::addFace() and Yield.
void addPart(const Part& part, const Eigen::Affine3d& M, const Source& source, Yield& yield, TriangleSoup& soup);

/// Notes which axis a file says is up, unless a file of the same notes said it before, as a robot may have many.
/// @param axis  'x' or 'y'. @param said  by the file; else by the format's rules. @param format  such as "COLLADA".
void noteUpAxis(char axis, bool said, const std::string& format, bool turned, const Source& source);

/// Turns what is up to z. @param axis  'x', 'y' or 'z'.
Eigen::Matrix3d turnUp(char axis);

}  // namespace fcl_artic::meshes
