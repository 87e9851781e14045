// SPDX-License-Identifier: BSD-3-Clause
//
// FCL geometries as trees of convex pieces: the one place of the core that reads what is in them (elsewhere they are
// only asked for their type). Geometries are never written to. Functions over S are there for float and double; what is
// float is taken as the double of the same value.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include <fcl/geometry/collision_geometry.h>
#include <fcl/geometry/octree/octree.h>
#include <fcl/math/triangle.h>

#include "geometry/shape_tree.h"
#include "numerics/rotation.h"

namespace fcl_artic {

/// Reads a geometry:
/// - BVHModel of any bounding volume (its triangles; a surface), TriangleP, Plane {n.x = d};
/// - the solids Box, Sphere, Capsule, Cylinder, Cone, Ellipsoid, Convex (the hull of its vertices, whatever its
///   faces), Halfspace {n.x <= d}, OcTree (its occupied cells, see readOcTree) and PointCloud (a ball for each point).
///
/// FCL's cost_density and the thresholds beside it are not asked: a geometry is there.
/// @throws std::invalid_argument naming the type and what is wrong with it.
template <class S>
std::shared_ptr<const ShapeTree> readGeometry(const fcl::CollisionGeometry<S>& geometry);

/// The same; a BVHModel's tree may come from earlier calls in this process, if it was built from the very same vertices
/// and triangles (MeshCache). At most kMeshCacheBytes are kept. Safe from several threads.
template <class S>
std::shared_ptr<const ShapeTree> cachedGeometry(const fcl::CollisionGeometry<S>& geometry);
constexpr std::size_t kMeshCacheBytes = std::size_t{256} << 20;

/// A BVHModel without its bounding volumes, as the caller holds it.
template <class S>
struct MeshArrays {
  const fcl::Vector3<S>* vertices;
  const fcl::Triangle* triangles;
  std::size_t num_vertices, num_triangles;
  bool solid;
};
/// @return whether the geometry is one.
/// @throws std::invalid_argument where it is one without triangles.
template <class S>
bool asMesh(const fcl::CollisionGeometry<S>& geometry, MeshArrays<S>& mesh);

/// Whether nobody can change the geometry in place: a PointCloud. The same object is the same content then.
bool neverChanges(const fcl::CollisionGeometryd& geometry);

/// All that readGeometry() reads of a geometry, copied, to see whether its owner has changed it in place:
/// - its type,
/// - the numbers of a shape,
/// - a mesh's vertices and triangles and whether it is a solid,
/// - an OcTree's occupied cells,
/// - a cloud's points and radii: the tree has all of them, and is held in place of a copy.
///
/// Equal contents give equal trees.
class GeometryContent {
 public:
  /// The geometry must have been read, that is, not refused.
  /// @param tree  that was read of it; null: unknown.
  explicit GeometryContent(const fcl::CollisionGeometryd& geometry, std::shared_ptr<const ShapeTree> tree = nullptr);
  /// Whether the geometry, this one or another, is byte for byte what was copied. It may be one that is refused.
  bool sameAs(const fcl::CollisionGeometryd& geometry) const;
  bool sameAs(const GeometryContent& other) const;

 private:
  std::vector<char> bytes_;
  std::shared_ptr<const ShapeTree> balls_;  ///< of a cloud, in place of the bytes
};

#if FCL_HAVE_OCTOMAP
/// An OcTree's cells without children that are occupied by its own threshold (OcTree::isNodeOccupied): a box each,
/// their primitive ids 0, 1, ... in the order of octomap's leaf iterator. Empty (ShapeTree) when there is none: unknown
/// space is free, as for FCL.
/// In float the cells are where FCL's own float root box puts them.
template <class S>
std::shared_ptr<const ShapeTree> readOcTree(const fcl::OcTree<S>& tree);
/// Only the cells that meet the box, given in the tree's frame; the ids count these.
template <class S>
std::shared_ptr<const ShapeTree> readOcTree(const fcl::OcTree<S>& tree, const Eigen::Vector3d& lower,
                                            const Eigen::Vector3d& upper);
/// FCL's name for the cell that holds a point, as in Contact::b1 (OcTree::getNodeByQueryCellId); -1 where there is
/// none.
template <class S>
std::intptr_t ocTreeCellId(const fcl::OcTree<S>& tree, const Eigen::Vector3d& point);
#endif

/// FCL's name for the geometry's type.
template <class S>
const char* geometryName(const fcl::CollisionGeometry<S>& geometry);

/// The rigid transform with its rotation made orthonormal to rounding.
/// @throws std::invalid_argument naming `what` when a value is not finite or beyond 1e9 m, or the rotation is off by
///         more than 1e-6.
RigidTransform requireRigid(const Eigen::Isometry3d& M, const std::string& what);

}  // namespace fcl_artic
