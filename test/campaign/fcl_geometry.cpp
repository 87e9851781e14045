// SPDX-License-Identifier: BSD-3-Clause
#include <stdexcept>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>

#include "geometry.h"

namespace campaign {
namespace {

template <typename Volume>
std::shared_ptr<fcl::CollisionGeometryd> build(const std::vector<Vec3>& vertices,
                                               const std::vector<std::array<int, 3>>& triangles) {
  std::vector<fcl::Triangle> faces;
  for (const auto& t : triangles)
    faces.emplace_back(static_cast<std::size_t>(t[0]), static_cast<std::size_t>(t[1]), static_cast<std::size_t>(t[2]));
  auto model = std::make_shared<fcl::BVHModel<Volume>>();
  model->beginModel();
  model->addSubModel(vertices, faces);
  if (model->endModel() != fcl::BVH_OK) throw std::runtime_error("FCL did not take a generated mesh");
  model->computeLocalAABB();
  return model;
}

}  // namespace

std::shared_ptr<fcl::CollisionGeometryd> makeFclMesh(const std::vector<Vec3>& vertices,
                                                     const std::vector<std::array<int, 3>>& triangles,
                                                     Geometry::BV bv) {
  switch (bv) {
    case Geometry::BV::obb:
      return build<fcl::OBBd>(vertices, triangles);
    case Geometry::BV::aabb:
      return build<fcl::AABBd>(vertices, triangles);
    case Geometry::BV::rss:
      return build<fcl::RSSd>(vertices, triangles);
    case Geometry::BV::obbrss:
      break;
  }
  return build<fcl::OBBRSSd>(vertices, triangles);
}

std::shared_ptr<fcl::CollisionGeometryd> makeFclShape(Piece::Kind kind, const Vec3& half) {
  std::shared_ptr<fcl::CollisionGeometryd> g;
  if (kind == Piece::box) g = std::make_shared<fcl::Boxd>(2 * half.x(), 2 * half.y(), 2 * half.z());
  if (kind == Piece::cylinder) g = std::make_shared<fcl::Cylinderd>(half.x(), 2 * half.z());
  if (kind == Piece::sphere) g = std::make_shared<fcl::Sphered>(half.x());
  if (g) g->computeLocalAABB();
  return g;
}

}  // namespace campaign
