// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

/// Makes the data that comes with the project: a PUMA 560 and scenes of pipes. The output is the same on every machine.
/// The random numbers are the project's own. Tables are rounded far above the differences between mathematical
/// libraries. Coordinates are on a grid of 10 µm, so that an OBJ file holds exactly the doubles of the mesh.
namespace fcl_artic::generator {

/// Closed triangle surfaces, outside seen counter-clockwise; m. Parts may overlap.
struct Mesh {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<int, 3>> triangles;
};

constexpr std::size_t kMinPipeTriangles = 1000, kMaxPipeTriangles = 1000000;

/// Pipes along random axis-parallel paths round a robot at the origin, in [-1.2, 1.2] x [-1.2, 1.2] x [0, 1.6] m.
/// No pipe comes within 0.5 m of the z axis: an arm that stands upright can turn about it. Larger scenes have more
/// pipes and finer ones.
/// @param triangles  wanted size; the mesh has it to within 1 %.
/// @throws std::invalid_argument when triangles is not in [kMinPipeTriangles, kMaxPipeTriangles].
Mesh pipes(std::size_t triangles, std::uint64_t seed);
/// The same pipes, each a mesh of its own; pipes() has their vertices and triangles in this order.
std::vector<Mesh> separatePipes(std::size_t triangles, std::uint64_t seed);
/// Writes pipes(triangles, seed) as OBJ. @throws std::runtime_error naming the file when it can't be written.
void writePipes(std::size_t triangles, std::uint64_t seed, const std::string& obj_path);

/// The moving and still bodies of the PUMA 560, base first, each in the frame of its URDF link.
struct NamedMesh {
  std::string link;
  Mesh mesh;
};
std::vector<NamedMesh> puma560Meshes();
/// Writes dir/puma560.urdf and dir/meshes/LINK.obj; makes the folders. @throws std::runtime_error naming the file.
void writePuma560(const std::string& dir);

}  // namespace fcl_artic::generator
