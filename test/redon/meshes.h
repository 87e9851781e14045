// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/OBBRSS.h>

namespace redon_test {

using Mesh = fcl::BVHModel<fcl::OBBRSSd>;
using MeshPtr = std::shared_ptr<Mesh>;

inline MeshPtr mesh(const std::vector<fcl::Vector3d>& vertices, const std::vector<fcl::Triangle>& triangles) {
  auto model = std::make_shared<Mesh>();
  model->beginModel();
  model->addSubModel(vertices, triangles);
  model->endModel();
  return model;
}

inline MeshPtr triangle(const fcl::Vector3d& a, const fcl::Vector3d& b, const fcl::Vector3d& c) {
  return mesh({a, b, c}, {fcl::Triangle(0, 1, 2)});
}

/// A closed box about the origin.
inline MeshPtr boxMesh(double x, double y, double z) {
  std::vector<fcl::Vector3d> v;
  for (int c = 0; c < 8; ++c) v.emplace_back(c & 1 ? x : -x, c & 2 ? y : -y, c & 4 ? z : -z);
  const std::size_t sides[12][3] = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
                                    {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
  std::vector<fcl::Triangle> t;
  for (const auto& s : sides) t.emplace_back(s[0], s[1], s[2]);
  return mesh(v, t);
}

}  // namespace redon_test
