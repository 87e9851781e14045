// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fcl/geometry/collision_geometry.h>
#include <fcl/math/triangle.h>

#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "fcl_artic/kinematic_tree.h"
#include "meshes/triangle_soup.h"

namespace fcl_artic::detail {

using GeometryPtr = std::shared_ptr<fcl::CollisionGeometryd>;

/// Throws what all loaders throw. @param where  names file and part, such as "'a.urdf': link 'b'".
[[noreturn]] inline void fail(const std::string& where, const std::string& reason) {
  throw std::runtime_error(where + ": " + reason);
}

/// A number as messages show it.
std::string text(double value);

/// @param size  full lengths, m. @throws std::runtime_error naming `where` unless all are positive and finite.
GeometryPtr makeBox(const Eigen::Vector3d& size, const std::string& where);
GeometryPtr makeSphere(double radius, const std::string& where);
/// Centred at the origin, axis z, as in FCL, URDF and MoveIt.
GeometryPtr makeCylinder(double radius, double length, const std::string& where);
GeometryPtr makeCone(double radius, double length, const std::string& where);
/// A BVHModel<OBBRSSd>. Triangles with two equal corners, a segment each, are left out where an edge of another
/// triangle covers them, with a note; vertices without a triangle are noted.
/// @param solid  a SolidMesh of all triangles: those without area may be what closes it.
/// @throws std::runtime_error naming `where` for an index out of range, a vertex that is not finite or no triangle
///   with an area. Also for a mesh that is to be a solid and can't be one.
GeometryPtr makeMesh(std::vector<Eigen::Vector3d> vertices, std::vector<fcl::Triangle> triangles,
                     const std::string& where, std::vector<std::string>* notes, bool solid = false);

/// The geometry, as a loader makes it, with all its lengths multiplied. @throws std::runtime_error naming `where`.
GeometryPtr scaledGeometry(const GeometryPtr& geometry, double scale, const std::string& where);

/// Reads a mesh by assimp, for formats that have no reader here, with a note that says so.
/// @throws std::runtime_error naming the source, also for bones, morph targets, animations.
meshes::TriangleSoup importMesh(const meshes::Source& source, const std::string& ending);

/// The ending of a file's name, in lower case, such as ".stl".
std::string endingOf(const std::string& path);

/// The farthest that the joint carries its child's frame from where its own frame stands, in m, within its limits. (A
/// mimic joint: within those of the joint that it follows.) It is 0 for joints that only turn, infinite for a slide
/// without limits and for planar and floating joints.
double slideUpper(const KinematicTree& tree, JointId j);

}  // namespace fcl_artic::detail
