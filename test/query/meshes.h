// SPDX-License-Identifier: BSD-3-Clause
//
// Surfaces of boxes around the origin.
#pragma once

#include <memory>
#include <vector>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/OBBRSS.h>
#include <Eigen/Core>

namespace fcl_artic {
namespace test {

using Mesh = fcl::BVHModel<fcl::OBBRSSd>;

inline std::shared_ptr<Mesh> meshOf(const std::vector<Eigen::Vector3d>& vertices,
                                    const std::vector<fcl::Triangle>& triangles) {
  auto mesh = std::make_shared<Mesh>();
  mesh->beginModel();
  mesh->addSubModel(vertices, triangles);
  mesh->endModel();
  return mesh;
}

/// Two triangles a side: those of y, of x, of z.
/// @param closed  false: a tube along z, without the sides of z.
inline std::shared_ptr<Mesh> boxMesh(const Eigen::Vector3d& half, bool closed = true) {
  std::vector<Eigen::Vector3d> v;
  for (int i = 0; i < 8; ++i) {
    v.push_back(half.cwiseProduct(Eigen::Vector3d((i & 1) ? 1 : -1, (i & 2) ? 1 : -1, (i & 4) ? 1 : -1)));
  }
  const int sides[6][4] = {{0, 4, 5, 1}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}, {0, 1, 3, 2}, {4, 6, 7, 5}};
  std::vector<fcl::Triangle> t;
  for (int i = 0; i < (closed ? 6 : 4); ++i) {
    t.emplace_back(sides[i][0], sides[i][1], sides[i][2]);
    t.emplace_back(sides[i][0], sides[i][2], sides[i][3]);
  }
  return meshOf(v, t);
}
inline std::shared_ptr<Mesh> cubeMesh(double half) {
  return boxMesh(Eigen::Vector3d::Constant(half));
}

/// Each side is cut into n x n squares.
inline std::shared_ptr<Mesh> fineBoxMesh(const Eigen::Vector3d& half, int n) {
  std::vector<Eigen::Vector3d> v;
  std::vector<fcl::Triangle> t;
  for (int side = 0; side < 6; ++side) {
    const int x = side / 2, y = (x + 1) % 3, z = (x + 2) % 3;
    const std::size_t first = v.size(), row = static_cast<std::size_t>(n) + 1;
    for (int i = 0; i <= n; ++i) {
      for (int j = 0; j <= n; ++j) {
        Eigen::Vector3d p;
        p[x] = side % 2 ? half[x] : -half[x];
        p[y] = half[y] * (2.0 * i / n - 1);
        p[z] = half[z] * (2.0 * j / n - 1);
        v.push_back(p);
      }
    }
    for (std::size_t i = 0; i + 1 < row; ++i) {
      for (std::size_t j = 0; j + 1 < row; ++j) {
        const std::size_t at = first + i * row + j;
        t.emplace_back(at, at + row, at + row + 1);
        t.emplace_back(at, at + row + 1, at + 1);
      }
    }
  }
  return meshOf(v, t);
}

}  // namespace test
}  // namespace fcl_artic
