// SPDX-License-Identifier: BSD-3-Clause
#include "fcl_artic_moveit/shapes.h"

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/octree/octree.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/cone.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/plane.h>
#include <fcl/geometry/shape/sphere.h>

namespace fcl_artic_moveit {
namespace {

std::shared_ptr<fcl::CollisionGeometryd> meshOf(const shapes::Mesh& mesh) {
  if (mesh.triangle_count == 0 || !mesh.vertices || !mesh.triangles) {
    throw std::invalid_argument("a mesh without triangles");
  }
  std::vector<fcl::Vector3d> vertices;
  vertices.reserve(mesh.vertex_count);
  for (unsigned int i = 0; i < mesh.vertex_count; ++i) vertices.emplace_back(mesh.vertices + 3 * i);
  std::vector<fcl::Triangle> triangles;
  triangles.reserve(mesh.triangle_count);
  for (unsigned int i = 0; i < mesh.triangle_count; ++i) {
    const unsigned int* corner = mesh.triangles + 3 * i;
    for (int k = 0; k < 3; ++k) {
      if (corner[k] < mesh.vertex_count) continue;
      throw std::invalid_argument("a mesh whose triangle " + std::to_string(i) + " has a vertex " +
                                  std::to_string(corner[k]) + " of " + std::to_string(mesh.vertex_count));
    }
    triangles.emplace_back(corner[0], corner[1], corner[2]);
  }
  auto out = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
  out->beginModel();
  out->addSubModel(vertices, triangles);
  out->endModel();
  return out;
}

std::shared_ptr<fcl::CollisionGeometryd> planeOf(const shapes::Plane& plane) {
  const Eigen::Vector3d normal(plane.a, plane.b, plane.c);
  const double length = normal.norm();
  if (!(length > 0) || !std::isfinite(length) || !std::isfinite(plane.d)) {
    throw std::invalid_argument("a plane whose normal is 0 or not finite");
  }
  return std::make_shared<fcl::Planed>(normal / length, -plane.d / length);  // n . x = -d
}

}  // namespace

std::shared_ptr<fcl::CollisionGeometryd> toFcl(const shapes::Shape& shape) {
  switch (shape.type) {
    case shapes::SPHERE:
      return std::make_shared<fcl::Sphered>(static_cast<const shapes::Sphere&>(shape).radius);
    case shapes::BOX: {
      const double* size = static_cast<const shapes::Box&>(shape).size;
      return std::make_shared<fcl::Boxd>(size[0], size[1], size[2]);
    }
    case shapes::CYLINDER: {
      const auto& cylinder = static_cast<const shapes::Cylinder&>(shape);
      return std::make_shared<fcl::Cylinderd>(cylinder.radius, cylinder.length);
    }
    case shapes::CONE: {
      const auto& cone = static_cast<const shapes::Cone&>(shape);
      return std::make_shared<fcl::Coned>(cone.radius, cone.length);
    }
    case shapes::MESH:
      return meshOf(static_cast<const shapes::Mesh&>(shape));
    case shapes::PLANE:
      return planeOf(static_cast<const shapes::Plane&>(shape));
    case shapes::OCTREE: {
      const auto& octree = static_cast<const shapes::OcTree&>(shape).octree;
      if (!octree) throw std::invalid_argument("an octree shape without an octree");
      return std::make_shared<fcl::OcTreed>(octree);
    }
    case shapes::UNKNOWN_SHAPE:
      break;
  }
  throw std::invalid_argument("a shape of type " + std::to_string(static_cast<int>(shape.type)) +
                              ", which is not known: spheres, boxes, cylinders, cones, meshes, planes and octrees are");
}

}  // namespace fcl_artic_moveit
