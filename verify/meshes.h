// SPDX-License-Identifier: BSD-3-Clause
// Mesh files, read strictly, and whether a geometry of the world is one.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "statement.h"

namespace verify {

/// Faces of a mesh file.
struct MeshFile {
  std::vector<double> points;          // three each
  std::vector<std::uint32_t> corners;  // of all faces, one after the other
  std::vector<std::size_t> ends;       // of each face, in `corners`
};
/// STL, binary or text, or OBJ; decimals as the nearest doubles. @throws BadInput
MeshFile readMesh(const std::string& path);

/// Corners of a triangle, from the one with which the nine numbers are least: so orientation counts, and the corner
/// that a writer begins with does not.
using Triangle = std::array<double, 9>;

/// Compares geometries with mesh files: each is read and put in order once.
class MeshComparison {
 public:
  explicit MeshComparison(const World& world);
  /// Whether the world's mesh is the file with its coordinates multiplied. Each triangle of either is one of the other,
  /// with the same orientation and as often; a face of more than three corners is cut into triangles at its corners. If
  /// the mesh is a surface, triangles without area that lie on edges of the mesh may be missing.
  /// @param scale  factors of x, y, z; three more are multiplied by what comes out.
  /// @param missing  set to how many are.
  bool same(const Geometry& mesh, int number, const std::string& path, const std::vector<double>& scale,
            std::size_t& missing);

 private:
  struct Sorted {
    std::vector<Triangle> all;   // in order
    std::vector<Triangle> flat;  // those without area
    std::string hash;            // of the others
  };
  struct File {
    MeshFile faces;
    Sorted sorted;  // with fans in place of faces
    bool polygons = false;
  };
  static Sorted inOrder(std::vector<Triangle> triangles);
  const File& file(const std::string& path, const std::vector<double>& scale);
  bool compare(const Geometry& mesh, const Sorted& stated, const File& file, std::size_t& missing);
  bool cut(const File& file, const Sorted& mesh, bool solid, std::vector<Triangle>& missing);

  std::map<int, Sorted> meshes_;
  std::map<std::pair<std::string, std::vector<double>>, File> files_;
  std::map<std::string, MeshFile> read_;
  void spend(std::uint64_t steps);

  std::map<std::pair<int, const File*>, std::pair<bool, std::size_t>> known_;
  std::uint64_t steps_left_ = 8000000;  // corners that are read, put in order or cut off; more of a large world
};

}  // namespace verify
