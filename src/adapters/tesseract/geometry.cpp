// SPDX-License-Identifier: BSD-3-Clause
#include "adapters/tesseract/geometry.h"

#include <stdexcept>
#include <string>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/octree/octree.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cone.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/plane.h>
#include <fcl/geometry/shape/sphere.h>
#include <octomap/octomap.h>
#include <tesseract/geometry/geometries.h>

namespace fcl_artic {
namespace {

namespace geometry = ::tesseract::geometry;
using Bodies = std::vector<std::shared_ptr<fcl::CollisionGeometryd>>;

std::shared_ptr<fcl::CollisionGeometryd> readMesh(const geometry::PolygonMesh& mesh) {
  if (mesh.getVertexCount() == 0 || mesh.getFaceCount() == 0) throw std::invalid_argument("the mesh is empty");
  const Eigen::VectorXi& faces = *mesh.getFaces();
  std::vector<fcl::Triangle> triangles;
  for (Eigen::Index i = 0; i < faces.size(); i += faces[i] + 1) {
    if (faces[i] != 3) throw std::invalid_argument("a face of the mesh has " + std::to_string(faces[i]) + " corners");
    const auto corner = [&](int k) {
      if (i + k >= faces.size() || faces[i + k] < 0 || faces[i + k] >= mesh.getVertexCount()) {
        throw std::invalid_argument("face " + std::to_string(triangles.size()) + " has a vertex that is not there");
      }
      return static_cast<std::size_t>(faces[i + k]);
    };
    triangles.emplace_back(corner(1), corner(2), corner(3));
  }
  auto copy = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
  copy->beginModel();
  copy->addSubModel(*mesh.getVertices(), triangles);
  copy->endModel();
  return copy;
}

std::shared_ptr<fcl::CollisionGeometryd> readConvex(const geometry::PolygonMesh& mesh) {
  if (mesh.getVertexCount() == 0 || mesh.getFaceCount() == 0) throw std::invalid_argument("the mesh is empty");
  const Eigen::VectorXi& faces = *mesh.getFaces();
  return std::make_shared<fcl::Convexd>(
      mesh.getVertices(), mesh.getFaceCount(),
      std::make_shared<const std::vector<int>>(faces.data(), faces.data() + faces.size()));
}

template <class T>
const T& as(const geometry::Geometry& g) {
  return static_cast<const T&>(g);
}

}  // namespace

Bodies fromTesseractGeometry(const geometry::Geometry& g) {
  switch (g.getType()) {
    case geometry::GeometryType::BOX: {
      const auto& box = as<geometry::Box>(g);
      return {std::make_shared<fcl::Boxd>(box.getX(), box.getY(), box.getZ())};
    }
    case geometry::GeometryType::SPHERE:
      return {std::make_shared<fcl::Sphered>(as<geometry::Sphere>(g).getRadius())};
    case geometry::GeometryType::CYLINDER: {
      const auto& cylinder = as<geometry::Cylinder>(g);
      return {std::make_shared<fcl::Cylinderd>(cylinder.getRadius(), cylinder.getLength())};
    }
    case geometry::GeometryType::CONE: {
      const auto& cone = as<geometry::Cone>(g);
      return {std::make_shared<fcl::Coned>(cone.getRadius(), cone.getLength())};
    }
    case geometry::GeometryType::CAPSULE: {
      const auto& capsule = as<geometry::Capsule>(g);
      return {std::make_shared<fcl::Capsuled>(capsule.getRadius(), capsule.getLength())};
    }
    case geometry::GeometryType::PLANE: {
      const auto& plane = as<geometry::Plane>(g);
      return {std::make_shared<fcl::Planed>(plane.getA(), plane.getB(), plane.getC(), plane.getD())};
    }
    case geometry::GeometryType::MESH:
      return {readMesh(as<geometry::PolygonMesh>(g))};
    case geometry::GeometryType::CONVEX_MESH:
      return {readConvex(as<geometry::PolygonMesh>(g))};
    case geometry::GeometryType::COMPOUND_MESH: {
      Bodies all;
      for (const auto& mesh : as<geometry::CompoundMesh>(g).getMeshes()) {
        for (auto& body : fromTesseractGeometry(*mesh)) all.push_back(std::move(body));
      }
      if (all.empty()) throw std::invalid_argument("the compound mesh is empty");
      return all;
    }
    case geometry::GeometryType::OCTREE: {
      const auto& cells = as<geometry::Octree>(g);
      if (cells.getSubType() != geometry::OctreeSubType::BOX) {
        throw std::invalid_argument("an octree of spheres is not supported; take one of boxes");
      }
      return {std::make_shared<fcl::OcTreed>(cells.getOctree())};
    }
    default:
      throw std::invalid_argument("a geometry of type " +
                                  geometry::GeometryTypeStrings.at(static_cast<std::size_t>(g.getType())) +
                                  " is not supported; shapes, meshes, convex meshes and octrees are");
  }
}

}  // namespace fcl_artic
