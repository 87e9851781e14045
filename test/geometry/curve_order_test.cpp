// SPDX-License-Identifier: BSD-3-Clause
//
// Trees along a curve: sound for any points, the same on any number of threads, and no worse where points are uneven.
#include "geometry/curve_order.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "geometry/shape_tree.h"
#include "numerics/baseline_isa.h"
#include "random.h"

#include "convex/cloud.h"

namespace curve_order_test {

using namespace fcl_artic;
using Eigen::Vector3d;

namespace {

std::vector<Vector3d> points(std::size_t n, const std::function<Vector3d(std::size_t)>& at) {
  std::vector<Vector3d> all(n);
  for (std::size_t i = 0; i < n; ++i) all[i] = at(i);
  return all;
}

/// What is found on the way through a tree.
struct Walk {
  int depth = 0;
  double area = 0;  ///< of all boxes but the root's up to a radius, summed
};

/// Walks through the tree of balls, and holds each node to its children, and each leaf to its ball.
Walk walk(const ShapeTree& tree, const std::vector<Vector3d>& centers, const std::vector<double>& radii,
          float up_to_radius = 1e30f) {
  const engine::TreeView& view = tree.view();
  Walk found;
  EXPECT_EQ(view.num_pieces, static_cast<int>(centers.size()));
  std::vector<int> seen(centers.size(), 0);
  std::set<int> visited;
  std::vector<std::pair<int, int>> open{{0, 1}};
  while (!open.empty()) {
    const auto [me, depth] = open.back();
    open.pop_back();
    EXPECT_TRUE(me >= 0 && me < view.num_nodes + 2 * view.num_pieces && visited.insert(me).second) << me;
    found.depth = std::max(found.depth, depth);
    baseline::NodeRoom room;
    const engine::Node& node = baseline::nodeOf(view, me, room);
    const Vector3d size = (Eigen::Vector3f::Map(node.hi) - Eigen::Vector3f::Map(node.lo)).cast<double>();
    if (me != 0 && node.radius < up_to_radius) found.area += size[0] * size[1] + size[1] * size[2] + size[2] * size[0];
    EXPECT_GE(2.0 * static_cast<double>(node.radius), size.norm());
    if (!node.isLeaf()) {
      for (const int child : {node.left(), node.right()}) {
        open.emplace_back(child, depth + 1);
        baseline::NodeRoom room_of_child;
        const engine::Node& below = baseline::nodeOf(view, child, room_of_child);
        for (int k = 0; k < 3; ++k) {
          EXPECT_LE(node.lo[k], below.lo[k]);
          EXPECT_GE(node.hi[k], below.hi[k]);
        }
      }
      continue;
    }
    baseline::PieceRoom piece;
    const engine::Piece& ball = baseline::pieceOf(view, node.piece(), piece);
    const auto i = static_cast<std::size_t>(ball.primitive);
    if (i >= centers.size()) {
      ADD_FAILURE() << "a ball has the number " << i;
      continue;
    }
    ++seen[i];
    EXPECT_EQ(Vector3d::Map(ball.center), centers[i]);
    EXPECT_EQ(ball.radius, radii[radii.size() == 1 ? 0 : i]);
    EXPECT_GE(ball.reach, centers[i].norm());
    for (int k = 0; k < 3; ++k) {
      EXPECT_LE(static_cast<double>(node.lo[k]), centers[i][k] - ball.radius);
      EXPECT_GE(static_cast<double>(node.hi[k]), centers[i][k] + ball.radius);
    }
  }
  EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), static_cast<std::ptrdiff_t>(centers.size()));
  EXPECT_EQ(visited.size(), 2 * centers.size() - 1);
  return found;
}

bool sameTree(const ShapeTree& a, const ShapeTree& b) {
  const engine::TreeView &x = a.view(), &y = b.view();
  const auto bytes = [](const auto* data, int n) {
    return std::string(reinterpret_cast<const char*>(data), static_cast<std::size_t>(n) * sizeof *data);
  };
  return bytes(x.nodes, x.num_nodes) == bytes(y.nodes, y.num_nodes) &&
         bytes(x.balls, x.num_pieces) == bytes(y.balls, y.num_pieces);
}

}  // namespace

TEST(CurveOrder, TreesHoldTheirBallsWhateverThePoints) {
  Random random(1);
  const auto in = [&](double size) {
    return Vector3d(uniform(random, -size, size), uniform(random, -size, size), uniform(random, -size, size));
  };
  for (const std::size_t n : {2u, 3u, 4u, 255u, 256u, 257u, 1000u, 1025u, 20000u}) {
    const std::vector<std::function<Vector3d(std::size_t)>> kinds = {
        [&](std::size_t) { return in(1); },
        [&](std::size_t) { return Vector3d(Vector3d(3, -5, 7) + 1e-9 * in(1)); },
        [&](std::size_t) { return Vector3d(1, 2, 3); },                          // all in one place
        [&](std::size_t i) { return i ? in(1e-3) : Vector3d(5e8, -5e8, 5e8); },  // one far away
        [&](std::size_t i) { return Vector3d(std::ldexp(1.0, -static_cast<int>(i % 1074)), 0, 0); },  // ever nearer
        [&](std::size_t i) { return Vector3d(0, i % 2 ? 0.0 : -0.0, i % 3 ? 5e-324 : 0); },
        [&](std::size_t i) { return Vector3d(static_cast<double>(i % 7), static_cast<double>(i % 11), 0); },
        [&](std::size_t i) { return Vector3d(0, 0, static_cast<double>(i)); },
        [&](std::size_t) { return Vector3d(9e8 * unit(random)); }};
    for (std::size_t kind = 0; kind < kinds.size(); ++kind) {
      SCOPED_TRACE("kind " + std::to_string(kind) + ", " + std::to_string(n) + " points");
      const std::vector<Vector3d> centers = points(n, kinds[kind]);
      std::vector<double> radii{0.01};
      for (std::size_t i = 1; n % 2 && i < n; ++i) radii.push_back(uniform(random, 0.001, 0.1));
      const Walk found = walk(*ShapeTree::fromBalls(centers, radii), centers, radii);
      EXPECT_LE(found.depth, 160);
      if (HasFailure()) return;
    }
  }
}

// 200,000 points go over threads in every step. A fault to put in: shares of a sort that are handed out in another
// order.
TEST(CurveOrder, TreesAreTheSameOnAnyNumberOfThreads) {
  Random random(2);
  for (const bool coarse : {false, true}) {  // coarse: many points in one place
    const std::vector<Vector3d> centers = points(200000, [&](std::size_t) {
      Vector3d x(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1));
      return coarse ? Vector3d((20 * x).array().round() / 20) : x;
    });
    const auto one = ShapeTree::fromBalls(centers, {0.01}, 1);
    walk(*one, centers, {0.01});
    for (const int threads : {2, 3, 8, 0}) {
      EXPECT_TRUE(sameTree(*one, *ShapeTree::fromBalls(centers, {0.01}, threads))) << threads << " threads";
    }
  }
}

// One point far away must not lay cells so coarse that all others are in one.
TEST(CurveOrder, BoxesStaySmallBesideAPointFarAway) {
  Random random(3);
  std::vector<Vector3d> centers = points(20000, [&](std::size_t) { return unit(random); });
  const Walk near = walk(*ShapeTree::fromBalls(centers, {1e-4}), centers, {1e-4});
  centers.emplace_back(1e6, 0, 0);
  const Walk with = walk(*ShapeTree::fromBalls(centers, {1e-4}), centers, {1e-4});
  EXPECT_LT(with.area, 1.2 * near.area);
}

// A heap of 200 points is smaller than a cell. Split in halves by a plane, it has boxes of area A 2^(l/3) on level l, A
// its own: 27 A in all down to its points. Halves of points taken at random would have 255 A.
TEST(CurveOrder, HeapsOfPointsAreSplitByPlanes) {
  Random random(4);
  constexpr std::size_t kHeaps = 100;
  std::vector<Vector3d> centers, middles;
  for (std::size_t i = 0; i < kHeaps; ++i) middles.push_back(unit(random));
  const auto in = [&] { return uniform(random, -5e-5, 5e-5); };
  for (int i = 0; i < 200; ++i) {
    for (const Vector3d& middle : middles) centers.push_back(middle + Vector3d(in(), in(), in()));
  }
  const double own = 3 * 1e-4 * 1e-4;
  EXPECT_LT(walk(*ShapeTree::fromBalls(centers, {1e-7}), centers, {1e-7}, 1e-4f).area, 40 * kHeaps * own);
}

// Whoever goes from a cluster to its balls at once comes to the leaves that halving it comes to.
TEST(CurveOrder, ClustersHaveALeafForEachBall) {
  Random random(5);
  for (int size = 2; size <= engine::kMaxClusterSize; ++size) {
    const std::vector<Vector3d> centers =
        points(static_cast<std::size_t>(size), [&](std::size_t) { return unit(random); });
    const auto tree = ShapeTree::fromBalls(centers, {0.01});
    const engine::TreeView& view = tree->view();
    ASSERT_TRUE(baseline::isCluster(view, view.nodes[0]));
    std::set<int> leaves;
    for (int i = 0; i < size; ++i) {
      ASSERT_EQ(view.balls[i].place, i);
      ASSERT_EQ(view.balls[i].cluster_size, size);
      const int leaf = view.nodes[0].child + baseline::kClusterNodes.leaf[size][i];
      baseline::NodeRoom room;
      EXPECT_EQ(baseline::nodeOf(view, leaf, room).child, ~i);
      EXPECT_TRUE(leaves.insert(leaf).second);
    }
  }
}

TEST(CurveOrder, RefusesWhatIsNoPlace) {
  for (const double wrong : std::vector<double>{NAN, INFINITY, -INFINITY, 2e9}) {
    std::vector<Vector3d> centers(100, Vector3d(0, 0, 0));
    centers[70][1] = wrong;
    EXPECT_THROW(ShapeTree::fromBalls(centers, {0.1}), std::invalid_argument) << wrong;
  }
}

}  // namespace curve_order_test
