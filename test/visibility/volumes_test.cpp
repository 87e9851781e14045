// SPDX-License-Identifier: BSD-3-Clause
// Bounds of obstacles' trees in the world.
#include "visibility/volumes.h"

#include <array>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "geometry/shape_tree.h"

namespace fcl_artic {
namespace visibility {
namespace volumes_test {
namespace {

using Eigen::Vector3d;

/// The tree leaves no piece out: what it comes to is what a look at each piece finds.
TEST(BodyPieces, NodesHoldTheirPieces) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  const auto direction = [&]() -> Vector3d {
    return Vector3d(normal(random), normal(random), normal(random)).normalized();
  };
  std::vector<Vector3d> vertices;
  std::vector<std::array<int, 3>> triangles;
  std::uniform_real_distribution<double> place(-1, 1);
  for (int i = 0; i < 2000; ++i) {
    const Vector3d at(place(random), place(random), place(random));
    for (int k = 0; k < 3; ++k) vertices.push_back(at + 0.05 * direction());
    triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  const auto tree = ShapeTree::fromTriangles(vertices, triangles);
  std::size_t found = 0;
  for (int trial = 0; trial < 50; ++trial) {
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(3 * place(random), direction()));
    const Vector3d at = 2 * direction();
    engine::Body body;
    body.tree = &tree->view();
    Eigen::Matrix<double, 3, 3, Eigen::RowMajor>::Map(body.placement.R) = turn.toRotationMatrix();
    Vector3d::Map(body.placement.t) = at;
    body.placement.length = at.norm() + 1e-9;
    body.placement.ulps = 8;
    Bounds parts[8];
    for (Bounds& part : parts) {
      Vector3d segment[2] = {at + direction(), at + direction()};
      part = boundsOf(segment[0].data(), 2, 0.02);
    }
    const double margin = trial % 2 ? 0.01 : 0;
    const auto meets = [&](std::uint32_t lanes, const Bounds& bounds) {
      bool any = false;
      for (int lane = 0; lane < 8; ++lane) any = any || ((lanes >> lane & 1) && parts[lane].meets(bounds));
      return any;
    };
    const std::uint32_t asked = trial % 3 ? 0xff : 0x05;
    std::size_t expected = 0;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      Vector3d corners[3];
      for (std::size_t k = 0; k < 3; ++k) corners[k] = turn * vertices[3 * i + k] + at;
      expected += meets(asked, boundsOf(corners[0].data(), 3, margin));
    }
    Batch batch;
    std::vector<Cluster> clusters, free;
    Collection collection{batch, 0, 100000, clusters, free};
    Bounds reach = Bounds::none();
    std::uint32_t lanes = asked;
    ASSERT_TRUE(BodyPieces(*body.tree, body.placement, margin).add(parts, lanes, 0, 0.3, 0, 0, collection, reach));
    EXPECT_EQ(batch.objects.size(), expected) << trial;
    found += expected;
  }
  EXPECT_GT(found, 3000u);
}

}  // namespace
}  // namespace volumes_test
}  // namespace visibility
}  // namespace fcl_artic
