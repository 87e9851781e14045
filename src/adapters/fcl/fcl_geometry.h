// SPDX-License-Identifier: BSD-3-Clause
//
// FCL geometries as trees of convex pieces: the one place where the core looks into FCL's types.
#pragma once

#include <memory>

#include <fcl/geometry/collision_geometry.h>

#include "geometry/shape_tree.h"

namespace fcl_artic {

/// Reads a geometry: BVHModel of any bounding volume (triangles; a surface), Box, Sphere, Capsule, Cylinder, Cone,
/// Ellipsoid, TriangleP (solids but for the triangle).
/// @throws std::invalid_argument naming the type and what is wrong with it.
std::shared_ptr<const ShapeTree> readGeometry(const fcl::CollisionGeometryd& geometry);

/// FCL's name for the geometry's type.
const char* geometryName(const fcl::CollisionGeometryd& geometry);

/// The rigid transform with its rotation made orthonormal to rounding.
/// @throws std::invalid_argument naming `what` when a value is not finite or the rotation is off by more than 1e-6.
Eigen::Isometry3d requireRigid(const Eigen::Isometry3d& M, const std::string& what);

}  // namespace fcl_artic
