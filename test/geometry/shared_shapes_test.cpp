// SPDX-License-Identifier: BSD-3-Clause
//
// One tree for all who hold a mesh of the same content, and another one for each other content.
#include "setup/shared_shapes.h"

#include <thread>
#include <vector>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <gtest/gtest.h>

#include "fcl_artic/solid_mesh.h"

namespace shared_shapes_test {

using namespace fcl_artic;
using Eigen::Vector3d;

namespace {

using Mesh = fcl::BVHModel<fcl::OBBRSSd>;

/// A tetrahedron whose tip is at height z.
std::shared_ptr<Mesh> tetrahedron(double z) {
  auto mesh = std::make_shared<Mesh>();
  mesh->beginModel();
  mesh->addSubModel(std::vector<Vector3d>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.25, 0.25, z}},
                    {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}});
  mesh->endModel();
  mesh->computeLocalAABB();
  return mesh;
}

double top(const ShapeTree& tree) {
  double top = -1;
  for (int i = 0; i < 12; ++i) top = std::max(top, tree.view().vertices[3 * i + 2]);
  return top;
}

}  // namespace

TEST(SharedShapes, EqualMeshesHaveOneTree) {
  const auto one = tetrahedron(1), same = tetrahedron(1), other = tetrahedron(2);
  const SharedShape first = readShared(*one), second = readShared(*same), third = readShared(*other);
  EXPECT_EQ(first.shape, second.shape);
  EXPECT_EQ(first.content, second.content);
  EXPECT_NE(first.shape, third.shape);
  EXPECT_EQ(top(*first.shape), 1);
  EXPECT_EQ(top(*third.shape), 2);
}

TEST(SharedShapes, ChangedInPlaceIsAnother) {
  const auto mesh = tetrahedron(1);
  const SharedShape before = readShared(*mesh);
  mesh->vertices[3][2] = 0.5;  // its box, by which it is looked up, stays what it was
  const SharedShape after = readShared(*mesh);
  EXPECT_NE(before.shape, after.shape);
  EXPECT_EQ(top(*before.shape), 1);
  EXPECT_EQ(top(*after.shape), 0.5);
}

TEST(SharedShapes, SolidAndSurfaceAreTwo) {
  const auto surface = tetrahedron(1);
  const auto solid = std::make_shared<SolidMesh<fcl::OBBRSSd>>(*surface);
  solid->computeLocalAABB();
  const SharedShape a = readShared(*surface), b = readShared(*solid);
  EXPECT_NE(a.shape, b.shape);
  EXPECT_FALSE(a.shape->space());
  EXPECT_TRUE(b.shape->space());
}

TEST(SharedShapes, NothingIsKeptThatNobodyHolds) {
  std::weak_ptr<const ShapeTree> watched;
  const auto mesh = tetrahedron(3);
  {
    const SharedShape held = readShared(*mesh);
    watched = held.shape;
    EXPECT_FALSE(watched.expired());
  }
  EXPECT_TRUE(watched.expired());
  EXPECT_EQ(top(*readShared(*mesh).shape), 3);
}

TEST(SharedShapes, ThreadsGetTheTreeOfTheirOwnContent) {
  std::vector<std::shared_ptr<Mesh>> meshes;
  for (int i = 0; i < 8; ++i) meshes.push_back(tetrahedron(1 + i % 4));
  std::vector<int> wrong(8, 0);
  std::vector<std::thread> threads;
  for (int t = 0; t < 8; ++t) {
    threads.emplace_back([&, t] {
      for (int i = 0; i < 400; ++i) {
        const int k = (t + i) % 8;
        wrong[static_cast<std::size_t>(t)] += top(*readShared(*meshes[static_cast<std::size_t>(k)]).shape) != 1 + k % 4;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, std::vector<int>(8, 0));
}

}  // namespace shared_shapes_test
