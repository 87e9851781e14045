// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "geometry/shape_tree.h"
#include "geometry/wide_tree.h"
#include "numerics/baseline_isa.h"
#include "random.h"

#include "convex/cloud.h"

namespace wide_tree_test {

using namespace fcl_artic;

using Eigen::Vector3d;
using engine::Node;
using engine::Piece;
using engine::TreeView;

namespace {

constexpr double kRadius = 0.01;

/// A surface that goes up and down, as two triangles a cell, far from the origin.
std::shared_ptr<const ShapeTree> surface(Random& random, int cells) {
  const Vector3d centre = std::pow(10.0, uniform(random, -2, 3)) * unit(random);
  std::vector<Vector3d> points;
  std::vector<std::array<int, 3>> triangles;
  for (int i = 0; i <= cells; ++i) {
    for (int j = 0; j <= cells; ++j) points.push_back(centre + Vector3d(i, j, uniform(random, 0, 3)) / cells);
  }
  for (int i = 0; i < cells; ++i) {
    for (int j = 0; j < cells; ++j) {
      const int at = i * (cells + 1) + j, next = at + cells + 1;
      triangles.push_back({at, next, at + 1});
      triangles.push_back({next, next + 1, at + 1});
    }
  }
  return ShapeTree::fromTriangles(points, triangles);
}

std::shared_ptr<const ShapeTree> balls(Random& random, int count) {
  std::vector<Piece> pieces(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    pieces[i].kind = engine::PieceKind::point;
    pieces[i].primitive = static_cast<std::int32_t>(i);
    pieces[i].radius = kRadius * uniform(random, 0, 1);
    Vector3d::Map(pieces[i].center) = unit(random) + Vector3d(5, 0, 0);
  }
  return ShapeTree::fromPieces(pieces);
}

/// The same as a cloud, whose tree stores no nodes below its clusters.
std::shared_ptr<const ShapeTree> cloud(Random& random, int count) {
  std::vector<Vector3d> centers(static_cast<std::size_t>(count));
  for (Vector3d& center : centers) center = unit(random) + Vector3d(5, 0, 0);
  return ShapeTree::fromBalls(centers, {kRadius});
}

void piecesBelow(const TreeView& tree, int at, std::vector<int>& pieces) {
  baseline::NodeRoom room;
  const Node& node = baseline::nodeOf(tree, at, room);
  if (node.isLeaf()) {
    pieces.push_back(node.piece());
    return;
  }
  piecesBelow(tree, node.left(), pieces);
  piecesBelow(tree, node.right(), pieces);
}

TEST(WideTree, HoldsEachLeafOnceInBoxesThatHoldIt) {
  std::mt19937 random(12);
  std::uniform_real_distribution<double> at(-1, 1);
  for (const std::size_t count : {1, 2, 3, 8, 9, 20, 64, 65, 129, 1000}) {
    std::vector<BoxBounds> boxes(count);
    for (BoxBounds& box : boxes) {
      for (int k = 0; k < 3; ++k) {
        box.lo[k] = at(random);
        box.hi[k] = box.lo[k] + 0.1 * std::abs(at(random));
      }
    }
    const std::vector<engine::WideNode> tree = wideTree(boxes);
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
    // Full nodes would be count / 7; at each level the last one may have few children. Nodes of a small scene
    // have two.
    EXPECT_LE(tree.size(), count > 128 ? count / 7 + 4 : count / 2 + 1);
  }
  EXPECT_TRUE(wideTree({}).empty());
}

TEST(WideTree, HasTheLargestBoxesAtItsRoot) {
  std::mt19937 random(13);
  std::uniform_real_distribution<double> at(-1, 1);
  std::vector<BoxBounds> boxes(200);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const double size = i == 40 || i == 77 ? 1.9 : 0.05;
    for (int k = 0; k < 3; ++k) {
      boxes[i].lo[k] = at(random);
      boxes[i].hi[k] = boxes[i].lo[k] + size;
    }
  }
  const engine::WideNode root = wideTree(boxes)[0];
  EXPECT_EQ(std::count(root.child, root.child + root.num_children, ~40), 1);
  EXPECT_EQ(std::count(root.child, root.child + root.num_children, ~77), 1);
}

TEST(UpperNodes, HoldEachPieceOnce) {
  Random random(1);
  int patches = 0;
  for (const auto& tree : {surface(random, 6), surface(random, 40), balls(random, 64), balls(random, 3000),
                           cloud(random, 64), cloud(random, 3000)}) {
    const TreeView& view = tree->viewWithUpperNodes();
    ASSERT_EQ(view.nodes, tree->view().nodes);
    ASSERT_TRUE(view.upper);
    std::vector<int> seen(static_cast<std::size_t>(view.num_pieces), 0);
    std::vector<std::int32_t> open = {0};
    while (!open.empty()) {
      const engine::UpperNode& upper = view.upper[open.back()];
      open.pop_back();
      for (int lane = 0; lane < 8; ++lane) {
        const std::int32_t at = upper.node[lane];
        if (at < 0) {
          EXPECT_EQ(upper.upper[lane], -1);
          EXPECT_GT(upper.boxes.lo[0][lane], upper.boxes.hi[0][lane]);  // it meets nothing
          continue;
        }
        for (int k = 0; k < 3; ++k) {
          ASSERT_LT(at, view.num_nodes);
          EXPECT_EQ(upper.boxes.lo[k][lane], view.nodes[at].lo[k]);
          EXPECT_EQ(upper.boxes.hi[k][lane], view.nodes[at].hi[k]);
        }
        std::vector<int> below;
        piecesBelow(view, at, below);
        if (upper.upper[lane] >= 0) {  // all of it is below that upper node's children
          std::vector<int> of_children;
          for (const std::int32_t child : view.upper[upper.upper[lane]].node) {
            if (child >= 0) piecesBelow(view, child, of_children);
          }
          std::sort(below.begin(), below.end());
          std::sort(of_children.begin(), of_children.end());
          EXPECT_EQ(below, of_children);
          open.push_back(upper.upper[lane]);
          continue;
        }
        ++patches;
        for (const int piece : below) ++seen[static_cast<std::size_t>(piece)];
      }
    }
    EXPECT_EQ(seen, std::vector<int>(seen.size(), 1));
  }
  EXPECT_GT(patches, 700);
}

TEST(UpperNodes, SmallAndUnboundedBodiesHaveNone) {
  Random random(3);
  EXPECT_FALSE(surface(random, 5)->viewWithUpperNodes().upper);
  EXPECT_FALSE(balls(random, 63)->viewWithUpperNodes().upper);
  EXPECT_FALSE(cloud(random, 63)->viewWithUpperNodes().upper);
  EXPECT_FALSE(ShapeTree::fromPieces({})->viewWithUpperNodes().upper);
}

}  // namespace

}  // namespace wide_tree_test
