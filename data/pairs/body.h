// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <memory>
#include <vector>

#include <fcl/geometry/collision_geometry.h>
#include <Eigen/Core>

#include "pairs/random.h"

namespace pairs {

using Vec3 = Eigen::Vector3d;

enum class Kind { box, sphere, capsule, cylinder, cone, ellipsoid, convex, triangle, halfspace, plane, mesh };
const char* kindName(Kind kind);

/// FCL's bounding volumes of a mesh.
enum class Volume { rss, obbrss, aabb, obb, kios, kdop16, kdop18, kdop24 };
constexpr int kVolumes = 8;

/// A geometry in its own frame, as convex pieces, and the same one for FCL. A piece is a core and a radius around it.
struct Body {
  Kind kind = Kind::box;
  Vec3 half = Vec3::Zero();     ///< half sizes; radius, radius and half length; half axes; of the core
  double radius = 0;            ///< around the core: sphere and capsule
  Vec3 normal = Vec3::UnitZ();  ///< half-space (normal . x <= offset) and plane
  double offset = 0;
  std::vector<Vec3> vertices;                 ///< of convex, triangle and mesh
  std::vector<std::array<int, 3>> triangles;  ///< of a mesh, each a piece
  std::shared_ptr<fcl::CollisionGeometryd> geometry;
  double reach = 0;  ///< no point lies farther from the frame's origin; unbounded bodies: 0

  /// Boxes along the frame's axes, for meshes.
  struct Node {
    Vec3 centre, half;
    int left;  ///< children are left and left + 1; -1 for a leaf
    int piece;
  };
  std::vector<Node> nodes;

  bool unbounded() const { return kind == Kind::halfspace || kind == Kind::plane; }
  int numPieces() const { return kind == Kind::mesh ? static_cast<int>(triangles.size()) : 1; }
};
using BodyPtr = std::shared_ptr<const Body>;

/// Shapes of 0.1 to 0.6 m half sizes; half-spaces and planes through or near the origin.
BodyPtr randomShape(Kind kind, Random& random);
/// @throws std::runtime_error when FCL does not take it.
BodyPtr makeMesh(std::vector<Vec3> vertices, std::vector<std::array<int, 3>> triangles, Volume volume);
/// A star-shaped solid, a ring, a noisy box or loose triangles, of 12 to 2,000 triangles and 0.2 to 0.8 m.
BodyPtr randomMesh(Volume volume, Random& random);

/// In a file of its own, as FCL's mesh headers are slow to compile.
std::shared_ptr<fcl::CollisionGeometryd> makeFclMesh(const std::vector<Vec3>& vertices,
                                                     const std::vector<std::array<int, 3>>& triangles, Volume volume);

}  // namespace pairs
