// SPDX-License-Identifier: BSD-3-Clause
//
// Component `pinocchio`, header-only: coal's geometries as FCL's, the types that all queries take.
#pragma once

#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <coal/BVH/BVH_model.h>
#include <coal/collision_object.h>
#include <coal/shape/geometric_shapes.h>
#include <fcl/config.h>
#ifdef COAL_HAS_OCTOMAP
#include <coal/octree.h>
#endif
#if FCL_HAVE_OCTOMAP
#include <fcl/geometry/octree/octree.h>
#endif

#include "fcl_artic/fcl_names.h"

namespace fcl_artic {

/// A coal geometry as FCL's.
struct CoalGeometry {
  std::shared_ptr<fcl::CollisionGeometryd> geometry;  ///< The body in its own frame, m, without `swept_radius`.
  /// Radius of the ball that the body is swept with (coal::ShapeBase::getSweptSphereRadius()), m, as far as `geometry`
  /// does not have it: a sphere's and a capsule's are in their radius, and 0 here. A margin stands for the rest: two
  /// swept bodies touch where the bodies come as near as the sum of their radii.
  double swept_radius = 0;
};

/// @cond
namespace detail {

/// A sum that is not below the exact one.
inline double addUp(double a, double b) {
  return b == 0 ? a : std::nextafter(a + b, std::numeric_limits<double>::infinity());
}

inline std::shared_ptr<fcl::CollisionGeometryd> fromCoalMesh(const coal::BVHModelBase& mesh) {
  if (mesh.getModelType() != coal::BVH_MODEL_TRIANGLES || !mesh.vertices || !mesh.tri_indices) {
    throw std::invalid_argument("the mesh has no triangle");
  }
  std::vector<fcl::Vector3d> vertices(mesh.vertices->begin(), mesh.vertices->begin() + mesh.num_vertices);
  std::vector<fcl::Triangle> triangles;
  triangles.reserve(mesh.num_tris);
  for (unsigned i = 0; i < mesh.num_tris; ++i) {
    const coal::Triangle& t = (*mesh.tri_indices)[i];
    for (int k = 0; k < 3; ++k) {
      if (t[static_cast<std::size_t>(k)] >= mesh.num_vertices) {
        throw std::invalid_argument("triangle " + std::to_string(i) + " has vertex " +
                                    std::to_string(t[static_cast<std::size_t>(k)]) + " of " +
                                    std::to_string(mesh.num_vertices));
      }
    }
    triangles.emplace_back(t[0], t[1], t[2]);
  }
  auto copy = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
  copy->beginModel(static_cast<int>(triangles.size()), static_cast<int>(vertices.size()));
  copy->addSubModel(vertices, triangles);
  copy->endModel();
  return copy;
}

/// @param swept  radius that is left over, m.
inline std::shared_ptr<fcl::CollisionGeometryd> fromCoalShape(const coal::CollisionGeometry& geometry, double& swept) {
  switch (geometry.getNodeType()) {
    case coal::GEOM_BOX:
      return std::make_shared<fcl::Boxd>(2 * static_cast<const coal::Box&>(geometry).halfSide);
    case coal::GEOM_SPHERE:
      return std::make_shared<fcl::Sphered>(
          addUp(static_cast<const coal::Sphere&>(geometry).radius, std::exchange(swept, 0)));
    case coal::GEOM_CAPSULE: {
      const auto& capsule = static_cast<const coal::Capsule&>(geometry);
      return std::make_shared<fcl::Capsuled>(addUp(capsule.radius, std::exchange(swept, 0)), 2 * capsule.halfLength);
    }
    case coal::GEOM_CONE: {
      const auto& cone = static_cast<const coal::Cone&>(geometry);
      return std::make_shared<fcl::Coned>(cone.radius, 2 * cone.halfLength);
    }
    case coal::GEOM_CYLINDER: {
      const auto& cylinder = static_cast<const coal::Cylinder&>(geometry);
      return std::make_shared<fcl::Cylinderd>(cylinder.radius, 2 * cylinder.halfLength);
    }
    case coal::GEOM_ELLIPSOID:
      return std::make_shared<fcl::Ellipsoidd>(static_cast<const coal::Ellipsoid&>(geometry).radii);
    case coal::GEOM_CONVEX: {
      const auto& convex = static_cast<const coal::ConvexBase&>(geometry);
      if (!convex.points || convex.num_points == 0) throw std::invalid_argument("the convex shape has no point");
      // The hull of the points is what counts, for coal's support function and for this library; one face that passes
      // all points keeps FCL's constructor from complaining.
      auto points = std::make_shared<const std::vector<fcl::Vector3d>>(convex.points->begin(),
                                                                       convex.points->begin() + convex.num_points);
      auto face = std::make_shared<std::vector<int>>(1, static_cast<int>(convex.num_points));
      for (unsigned i = 0; i < convex.num_points; ++i) face->push_back(static_cast<int>(i));
      return std::make_shared<fcl::Convexd>(std::move(points), 1, std::move(face));
    }
    case coal::GEOM_HALFSPACE: {
      const auto& half = static_cast<const coal::Halfspace&>(geometry);
      return std::make_shared<fcl::Halfspaced>(half.n, half.d);
    }
    case coal::GEOM_PLANE: {
      const auto& plane = static_cast<const coal::Plane&>(geometry);
      return std::make_shared<fcl::Planed>(plane.n, plane.d);
    }
    case coal::GEOM_TRIANGLE: {
      const auto& t = static_cast<const coal::TriangleP&>(geometry);
      return std::make_shared<fcl::TrianglePd>(t.a, t.b, t.c);
    }
    default:
      return nullptr;
  }
}

}  // namespace detail
/// @endcond

/// Makes FCL's geometry of one of coal's: Box, Sphere, Ellipsoid, Capsule, Cone, Cylinder, Convex, Halfspace, Plane,
/// TriangleP, BVHModel with any bounding volume, and, where both libraries have octomap, OcTree with its occupancy
/// threshold. Shapes and cells are solids, meshes and TriangleP surfaces, in both libraries. A mesh is copied; an
/// OcTree shares octomap's.
/// @throws std::invalid_argument for any other geometry (HeightField, point clouds), a mesh or convex shape without
///   triangles or points, and a swept radius that is negative or not finite.
inline CoalGeometry fromCoal(const coal::CollisionGeometry& geometry) {
  CoalGeometry out;
  if (const auto* shape = dynamic_cast<const coal::ShapeBase*>(&geometry)) {
    out.swept_radius = shape->getSweptSphereRadius();
    if (!(out.swept_radius >= 0) || !std::isfinite(out.swept_radius)) {
      throw std::invalid_argument("its swept sphere radius is no number from 0 on");
    }
    out.geometry = detail::fromCoalShape(geometry, out.swept_radius);
  } else if (const auto* mesh = dynamic_cast<const coal::BVHModelBase*>(&geometry)) {
    out.geometry = detail::fromCoalMesh(*mesh);
  }
#if defined(COAL_HAS_OCTOMAP) && FCL_HAVE_OCTOMAP
  if (const auto* cells = dynamic_cast<const coal::OcTree*>(&geometry)) {
    auto copy = std::make_shared<fcl::OcTreed>(cells->getTree());
    copy->setOccupancyThres(cells->getOccupancyThres());
    out.geometry = std::move(copy);
  }
#endif
  if (!out.geometry) {
    throw std::invalid_argument("this type of geometry is not supported (coal node type " +
                                std::to_string(static_cast<int>(geometry.getNodeType())) +
                                "); shapes, triangle meshes and octrees are");
  }
  return out;
}

}  // namespace fcl_artic
