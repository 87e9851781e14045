// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include <fcl/geometry/collision_geometry.h>
#include <geometric_shapes/shapes.h>

namespace fcl_artic_moveit {

/// Makes an FCL geometry of a MoveIt shape, with the same size and frame. Spheres, boxes, cylinders, cones and an
/// octree's occupied cells (by the octree's own threshold) are solids; a mesh is its triangles, a plane the points
/// with a x + b y + c z + d = 0.
///
/// MoveIt's own collision checking by FCL takes a plane's d with the other sign (collision_detection_fcl at 8fcb5d2);
/// here the plane is the one that shape_msgs/Plane describes, which RViz shows.
/// @param shape  an octree is shared, all else is copied.
/// @throws std::invalid_argument naming the reason: a shape of unknown type, a mesh without triangles or with a vertex
///   that is not there. Also for a plane without a normal, and an octree shape without an octree.
std::shared_ptr<fcl::CollisionGeometryd> toFcl(const shapes::Shape& shape);

}  // namespace fcl_artic_moveit
