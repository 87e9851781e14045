// SPDX-License-Identifier: BSD-3-Clause
//
// Trees of meshes, one for all managers and links that have a mesh of the same content at the same time.
#pragma once

#include <memory>

#include <fcl/geometry/collision_geometry.h>

#include "fcl/fcl_geometry.h"

namespace fcl_artic {

/// A geometry's tree, and the copy of what it was made from.
struct SharedShape {
  std::shared_ptr<const ShapeTree> shape;
  std::shared_ptr<const GeometryContent> content;
};

/// Reads a geometry (readGeometry()). If a mesh's vertices and triangles are, byte for byte, those of one that
/// somebody still holds, it gets that one's tree. A robot's two arms share theirs, and so do two managers of one
/// robot. Equal contents give equal trees, so that no answer depends on it; nothing is kept that nobody holds. Safe
/// from several threads.
/// @throws std::invalid_argument as readGeometry().
SharedShape readShared(const fcl::CollisionGeometryd& geometry);

}  // namespace fcl_artic
