// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include <fcl/geometry/bvh/BVH_model.h>

#include "fcl_artic/export.h"

namespace fcl_artic {

/// Base class by which this library recognises a SolidMesh, whatever its bounding volumes.
class FCL_ARTIC_EXPORT SolidMark {
 public:
  /// Allows destruction through this class.
  virtual ~SolidMark();
};

/// A triangle mesh that is a solid: what lies within it touches it. (For FCL, and as a BVHModel for this library too,
/// a mesh is its surface: a ball inside a closed mesh that touches no triangle is free.) It is filled like any
/// BVHModel, or made from one. It goes wherever FCL geometry goes: into an ArticulatedCollisionManager, as the
/// geometry of a link, an obstacle or an attached object, into a ContinuousCollisionManager, into
/// fcl_artic::continuousCollide(). FCL itself takes it for the BVHModel that it is.
///
///     auto solid = std::make_shared<fcl_artic::SolidMesh<fcl::OBBRSSd>>(*mesh);  // copies mesh
///     manager.registerObject(std::make_shared<fcl::CollisionObjectd>(solid));    // and keeps it alive
///
/// The body is the surface and the points that the surface winds around a number of times other than 0. So each of
/// several closed parts is a solid, whichever way its triangles face. If a part inside another one faces the other
/// way, it is the border of a cavity, and what is in the cavity is outside. If it faces the same way, it adds nothing.
///
/// The mesh must be closed and consistently oriented: each edge is passed by triangles as often in one direction as in
/// the other. Vertices at the very same coordinates are taken as one. (Triangles without area count; a triangle with
/// two corners in one place has no edges.) Where a manager or a query reads the mesh, it checks that and throws
/// std::invalid_argument with the reason and an edge if it is not so.
template <class BV>
class SolidMesh : public fcl::BVHModel<BV>, public SolidMark {
 public:
  /// Creates an empty mesh, to be filled with beginModel(), addSubModel() and endModel().
  SolidMesh() = default;
  /// Copies a mesh, which is not checked here.
  explicit SolidMesh(const fcl::BVHModel<BV>& mesh) : fcl::BVHModel<BV>(mesh) {}
};

/// Makes a SolidMesh of a mesh, with the same kind of bounding volumes, and checks it at once.
/// @param mesh  a BVHModel<BV> of doubles, also a SolidMesh; copied.
/// @throws std::invalid_argument naming the reason: not a BVHModel, empty, not closed, not consistently oriented.
FCL_ARTIC_EXPORT std::shared_ptr<fcl::CollisionGeometryd> makeSolid(const fcl::CollisionGeometryd& mesh);

}  // namespace fcl_artic
