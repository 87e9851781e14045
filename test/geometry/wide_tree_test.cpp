// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "geometry/shape_tree.h"
#include "geometry/wide_tree.h"

namespace wide_tree_test {

using namespace fcl_artic;

namespace {

TEST(WideTree, HoldsEachLeafOnceInBoxesThatHoldIt) {
  std::mt19937 random(12);
  std::uniform_real_distribution<double> at(-1, 1);
  for (const std::size_t count : {1, 2, 3, 8, 9, 20, 64, 65, 1000}) {
    std::vector<BoxBounds> boxes(count);
    for (BoxBounds& box : boxes) {
      for (int k = 0; k < 3; ++k) {
        box.lo[k] = at(random);
        box.hi[k] = box.lo[k] + 0.1 * std::abs(at(random));
      }
    }
    const std::vector<engine::WideNode> tree = widen(buildBoxTree(boxes));
    std::vector<int> seen(count, 0), parents(tree.size(), 0);
    for (const engine::WideNode& node : tree) {
      ASSERT_GE(node.num_children, 1);
      ASSERT_LE(node.num_children, 8);
      for (std::int32_t i = 0; i < node.num_children; ++i) {
        if (node.child[i] < 0) {
          const auto leaf = static_cast<std::size_t>(~node.child[i]);
          ++seen[leaf];
          for (int k = 0; k < 3; ++k) {
            EXPECT_LE(node.boxes.lo[k][i], boxes[leaf].lo[k]);
            EXPECT_GE(node.boxes.hi[k][i], boxes[leaf].hi[k]);
          }
          continue;
        }
        ++parents[static_cast<std::size_t>(node.child[i])];
        const engine::WideNode& child = tree[static_cast<std::size_t>(node.child[i])];
        for (std::int32_t j = 0; j < child.num_children; ++j) {
          for (int k = 0; k < 3; ++k) {
            EXPECT_LE(node.boxes.lo[k][i], child.boxes.lo[k][j]);
            EXPECT_GE(node.boxes.hi[k][i], child.boxes.hi[k][j]);
          }
        }
      }
    }
    EXPECT_EQ(seen, std::vector<int>(count, 1));
    parents[0] = 1;
    EXPECT_EQ(parents, std::vector<int>(tree.size(), 1));
  }
  EXPECT_TRUE(widen({}).empty());
}

}  // namespace

}  // namespace wide_tree_test
