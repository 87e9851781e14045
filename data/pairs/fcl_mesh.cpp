// SPDX-License-Identifier: BSD-3-Clause
#include <stdexcept>

#include <fcl/geometry/bvh/BVH_model.h>

#include "pairs/body.h"

namespace pairs {
namespace {

template <class BV>
std::shared_ptr<fcl::CollisionGeometryd> build(const std::vector<Vec3>& vertices,
                                               const std::vector<std::array<int, 3>>& triangles) {
  std::vector<fcl::Triangle> faces;
  for (const auto& t : triangles) {
    faces.emplace_back(static_cast<std::size_t>(t[0]), static_cast<std::size_t>(t[1]), static_cast<std::size_t>(t[2]));
  }
  auto model = std::make_shared<fcl::BVHModel<BV>>();
  model->beginModel(static_cast<int>(faces.size()), static_cast<int>(vertices.size()));
  model->addSubModel(vertices, faces);
  if (model->endModel() != fcl::BVH_OK) throw std::runtime_error("FCL does not take a generated mesh");
  model->computeLocalAABB();
  return model;
}

}  // namespace

std::shared_ptr<fcl::CollisionGeometryd> makeFclMesh(const std::vector<Vec3>& vertices,
                                                     const std::vector<std::array<int, 3>>& triangles, Volume volume) {
  switch (volume) {
    case Volume::rss:
      return build<fcl::RSSd>(vertices, triangles);
    case Volume::obbrss:
      return build<fcl::OBBRSSd>(vertices, triangles);
    case Volume::aabb:
      return build<fcl::AABBd>(vertices, triangles);
    case Volume::obb:
      return build<fcl::OBBd>(vertices, triangles);
    case Volume::kios:
      return build<fcl::kIOSd>(vertices, triangles);
    case Volume::kdop16:
      return build<fcl::KDOPd<16>>(vertices, triangles);
    case Volume::kdop18:
      return build<fcl::KDOPd<18>>(vertices, triangles);
    case Volume::kdop24:
      return build<fcl::KDOPd<24>>(vertices, triangles);
  }
  return nullptr;
}

}  // namespace pairs
