// SPDX-License-Identifier: BSD-3-Clause
#include "adapters/fcl/fcl_geometry.h"

#include <cmath>
#include <stdexcept>
#include <string>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cone.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/ellipsoid.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/geometry/shape/triangle_p.h>

#include "numerics/rotation.h"

namespace fcl_artic {
namespace {

using engine::Piece;
using engine::PieceKind;

template <class BV>
std::shared_ptr<const ShapeTree> readMesh(const fcl::CollisionGeometryd& geometry) {
  const auto& mesh = static_cast<const fcl::BVHModel<BV>&>(geometry);
  if (mesh.getModelType() == fcl::BVH_MODEL_POINTCLOUD) {
    throw std::invalid_argument("a point cloud has no surface to collide with");
  }
  if (mesh.num_tris <= 0 || !mesh.tri_indices || !mesh.vertices) {
    throw std::invalid_argument("the mesh has no triangle (was endModel() called?)");
  }
  std::vector<Eigen::Vector3d> vertices(mesh.vertices, mesh.vertices + mesh.num_vertices);
  std::vector<std::array<int, 3>> triangles(static_cast<std::size_t>(mesh.num_tris));
  for (int i = 0; i < mesh.num_tris; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      triangles[static_cast<std::size_t>(i)][k] = static_cast<int>(mesh.tri_indices[i][k]);
    }
  }
  return ShapeTree::fromTriangles(vertices, triangles);
}

double requireSize(double x, const char* what) {
  if (!(x > 0) || !std::isfinite(x)) {
    throw std::invalid_argument(std::string("its ") + what + " is " + std::to_string(x) + ", not a positive number");
  }
  return x;
}

std::shared_ptr<const ShapeTree> read(const fcl::CollisionGeometryd& geometry) {
  Piece piece;
  switch (geometry.getNodeType()) {
    case fcl::BV_AABB: return readMesh<fcl::AABBd>(geometry);
    case fcl::BV_OBB: return readMesh<fcl::OBBd>(geometry);
    case fcl::BV_RSS: return readMesh<fcl::RSSd>(geometry);
    case fcl::BV_kIOS: return readMesh<fcl::kIOSd>(geometry);
    case fcl::BV_OBBRSS: return readMesh<fcl::OBBRSSd>(geometry);
    case fcl::BV_KDOP16: return readMesh<fcl::KDOP<double, 16>>(geometry);
    case fcl::BV_KDOP18: return readMesh<fcl::KDOP<double, 18>>(geometry);
    case fcl::BV_KDOP24: return readMesh<fcl::KDOP<double, 24>>(geometry);
    case fcl::GEOM_BOX: {
      const auto& box = static_cast<const fcl::Boxd&>(geometry);
      piece.kind = PieceKind::box;
      for (int k = 0; k < 3; ++k) piece.size[k] = 0.5 * requireSize(box.side[k], "side");
      break;
    }
    case fcl::GEOM_SPHERE:
      piece.kind = PieceKind::point;
      piece.radius = requireSize(static_cast<const fcl::Sphered&>(geometry).radius, "radius");
      break;
    case fcl::GEOM_CAPSULE: {
      const auto& capsule = static_cast<const fcl::Capsuled&>(geometry);
      piece.kind = PieceKind::segment;
      piece.radius = requireSize(capsule.radius, "radius");
      piece.size[2] = 0.5 * requireSize(capsule.lz, "length");
      break;
    }
    case fcl::GEOM_CYLINDER: {
      const auto& cylinder = static_cast<const fcl::Cylinderd&>(geometry);
      piece.kind = PieceKind::cylinder;
      piece.size[0] = requireSize(cylinder.radius, "radius");
      piece.size[2] = 0.5 * requireSize(cylinder.lz, "length");
      break;
    }
    case fcl::GEOM_CONE: {
      const auto& cone = static_cast<const fcl::Coned&>(geometry);
      piece.kind = PieceKind::cone;
      piece.size[0] = requireSize(cone.radius, "radius");
      piece.size[2] = 0.5 * requireSize(cone.lz, "length");
      break;
    }
    case fcl::GEOM_ELLIPSOID: {
      const auto& ellipsoid = static_cast<const fcl::Ellipsoidd&>(geometry);
      piece.kind = PieceKind::ellipsoid;
      for (int k = 0; k < 3; ++k) piece.size[k] = requireSize(ellipsoid.radii[k], "radius");
      break;
    }
    case fcl::GEOM_TRIANGLE: {
      const auto& t = static_cast<const fcl::TrianglePd&>(geometry);
      return ShapeTree::fromTriangles({t.a, t.b, t.c}, {{{0, 1, 2}}});
    }
    default:
      throw std::invalid_argument("this type of geometry is not supported");
  }
  return ShapeTree::fromPiece(piece);
}

}  // namespace

const char* geometryName(const fcl::CollisionGeometryd& geometry) {
  switch (geometry.getNodeType()) {
    case fcl::BV_AABB: return "BVHModel<AABB>";
    case fcl::BV_OBB: return "BVHModel<OBB>";
    case fcl::BV_RSS: return "BVHModel<RSS>";
    case fcl::BV_kIOS: return "BVHModel<kIOS>";
    case fcl::BV_OBBRSS: return "BVHModel<OBBRSS>";
    case fcl::BV_KDOP16: return "BVHModel<KDOP16>";
    case fcl::BV_KDOP18: return "BVHModel<KDOP18>";
    case fcl::BV_KDOP24: return "BVHModel<KDOP24>";
    case fcl::GEOM_BOX: return "Box";
    case fcl::GEOM_SPHERE: return "Sphere";
    case fcl::GEOM_CAPSULE: return "Capsule";
    case fcl::GEOM_CONE: return "Cone";
    case fcl::GEOM_CYLINDER: return "Cylinder";
    case fcl::GEOM_CONVEX: return "Convex";
    case fcl::GEOM_PLANE: return "Plane";
    case fcl::GEOM_HALFSPACE: return "Halfspace";
    case fcl::GEOM_TRIANGLE: return "TriangleP";
    case fcl::GEOM_OCTREE: return "OcTree";
    case fcl::GEOM_ELLIPSOID: return "Ellipsoid";
    default: return "unknown geometry";
  }
}

std::shared_ptr<const ShapeTree> readGeometry(const fcl::CollisionGeometryd& geometry) {
  try {
    return read(geometry);
  } catch (const std::invalid_argument& e) {
    throw std::invalid_argument(std::string(geometryName(geometry)) + ": " + e.what());
  }
}

Eigen::Isometry3d requireRigid(const Eigen::Isometry3d& M, const std::string& what) {
  if (!M.matrix().allFinite()) throw std::invalid_argument(what + " has a transform that is not finite");
  const Eigen::Matrix3d R = M.linear();
  const double defect = (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (defect > 1e-6 || R.determinant() < 0) {
    throw std::invalid_argument(what + " has a transform whose rotation is not orthonormal (defect " +
                                std::to_string(defect) + ")");
  }
  if (M.translation().cwiseAbs().maxCoeff() > 1e9) throw std::invalid_argument(what + " is more than 1e9 m away");
  Eigen::Isometry3d rigid = M;
  rigid.linear() = orthonormal(R);
  return rigid;
}

}  // namespace fcl_artic
