// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/cloud_tree.h"

#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <utility>

#include "geometry/curve_order.h"
#include "numerics/assertion.h"
#include "numerics/baseline_isa.h"
#include "numerics/constants.h"
#include "threads/parallel.h"

#include "convex/cloud.h"

namespace fcl_artic {
namespace {

using engine::Ball;
using engine::Node;
using engine::TreeView;

/// From this number of balls on the work goes over threads, in parts of this size at least.
constexpr std::size_t kManyBalls = 1 << 14, kFewestOfPart = 1 << 11;
/// While a part is built, the number of a child below a cluster is twice its first ball's, and this more. The number
/// of nodes that are stored is not known yet.
constexpr std::int32_t kBelowCluster = 1 << 30;
static_assert(2 * kMaxBalls < kBelowCluster && 4 * kMaxBalls < std::size_t{1} << 31);

/// Builds parts of the tree, each by one thread, then the nodes above them.
class CloudBuilder {
 public:
  CloudBuilder(const std::vector<Eigen::Vector3d>& centers, const std::vector<double>& radii, int threads)
      : centers_(centers),
        radii_(radii),
        threads_(centers.size() < kManyBalls ? 1 : threads),
        order_({centers[0].data(), 3}, centers.size(), threads) {}

  CloudTree run() {
    const std::size_t size = centers_.size();
    tree_.balls = LargeArray<Ball>(size);
    tree_.radii.resize(radii_.size());
    tree_.radii[0] = radii_[0];
    tree_.show(view_);
    divide(order_.all(), std::max(kFewestOfPart, size / 256));
    parallelFor(parts_.size(), threads_, [&](std::size_t i) {
      Part& part = parts_[i];
      part.nodes.reserve(part.range.size() / 4);
      part.nodes.resize(2);
      part.nodes[0] = build(part.range, part.nodes);
    });
    auto stored = static_cast<std::int32_t>(2 + 2 * above_.size());
    for (Part& part : parts_) {
      part.first = stored - 2;
      stored += static_cast<std::int32_t>(part.nodes.size()) - 2;
    }
    tree_.nodes = LargeArray<Node>(static_cast<std::size_t>(stored));
    parallelFor(parts_.size(), threads_, [&](std::size_t i) { store(parts_[i]); });
    for (std::size_t i = above_.size(); i-- > 0;) {
      const auto left = static_cast<std::int32_t>(2 + 2 * i);
      Node& node = at(above_[i]);
      baseline::enclose(at(left), at(left + 1), node);
      node.child = left;
    }
    at(1) = at(0);
    return std::move(tree_);
  }

 private:
  struct Part {
    CurveOrder::Range range;
    std::int32_t root;        ///< its node's number
    std::int32_t first = 0;   ///< what is added to the numbers of the nodes below
    std::vector<Node> nodes;  ///< node 0 is the part's root, node 1 is not used
  };

  Node& at(std::int32_t node) { return tree_.nodes[static_cast<std::size_t>(node)]; }

  /// Divides the cloud into parts, and numbers the nodes above them: the children of the i-th are 2 + 2 i and the next.
  void divide(const CurveOrder::Range& range, std::size_t size, std::int32_t node = 0) {
    if (range.size() <= size) return parts_.push_back({range, node, 0, {}});
    const auto left = static_cast<std::int32_t>(2 + 2 * above_.size());
    above_.push_back(node);
    const auto [first, second] = order_.split(range);
    divide(first, size, left);
    divide(second, size, left + 1);
  }
  /// Builds what is below a node, and returns that node.
  Node build(const CurveOrder::Range& range, std::vector<Node>& nodes) {
    if (range.size() <= engine::kMaxClusterSize) return buildCluster(range);
    const auto [first, second] = order_.split(range);
    const std::size_t left = nodes.size();
    nodes.resize(left + 2);
    const Node a = build(first, nodes), b = build(second, nodes);
    nodes[left] = a;
    nodes[left + 1] = b;
    Node node;
    baseline::enclose(a, b, node);
    node.child = static_cast<std::int32_t>(left);
    return node;
  }
  Node buildCluster(const CurveOrder::Range& range) {
    order_.finish(range);
    for (std::size_t i = range.begin; i < range.end; ++i) {
      const std::uint32_t number = order_.number(i);
      Ball& ball = tree_.balls[i];
      std::copy_n(centers_[number].data(), 3, ball.center);
      ball.number = static_cast<std::int32_t>(number);
      ball.place = static_cast<std::uint16_t>(i - range.begin);
      ball.cluster_size = static_cast<std::uint16_t>(range.size());
      if (radii_.size() > 1) tree_.radii[i] = radii_[number];
      const baseline::Piece piece = baseline::pieceOfBall(view_, static_cast<int>(i));
      requireNear(piece);
    }
    const auto first = static_cast<int>(range.begin), size = static_cast<int>(range.size());
    return baseline::nodeOverBalls(view_, first, size, kBelowCluster + 2 * first);
  }
  /// Copies a part's nodes to their places, with the numbers that their children have there.
  void store(const Part& part) {
    const auto num_nodes = static_cast<std::int32_t>(tree_.nodes.size());
    for (std::size_t i = 0; i < part.nodes.size(); ++i) {
      if (i == 1) continue;
      Node& node = at(i == 0 ? part.root : part.first + static_cast<std::int32_t>(i));
      node = part.nodes[i];
      if (node.child >= 0) node.child += node.child >= kBelowCluster ? num_nodes - kBelowCluster : part.first;
    }
  }

  const std::vector<Eigen::Vector3d>& centers_;
  const std::vector<double>& radii_;
  const int threads_;
  CurveOrder order_;
  CloudTree tree_;
  TreeView view_;  ///< of its balls
  std::vector<Part> parts_;
  std::vector<std::int32_t> above_;  ///< numbers of the nodes above the parts, each before its children
};

}  // namespace

void CloudTree::show(TreeView& view) const {
  view.nodes = nodes.data();
  view.num_nodes = static_cast<std::int32_t>(nodes.size());
  view.num_pieces = static_cast<std::int32_t>(balls.size());
  view.balls = balls.data();
  view.ball_radii = radii.data();
  view.ball_radius_stride = radii.size() > 1 ? 1 : 0;
}

void requireNear(const engine::Piece& piece) {
  if (!(piece.reach + piece.radius <= kFarthest)) throw std::invalid_argument("a size is not finite or beyond 1e9 m");
}

CloudTree buildCloudTree(const std::vector<Eigen::Vector3d>& centers, const std::vector<double>& radii, int threads) {
  FCL_ARTIC_ASSERT(centers.size() > 1 && centers.size() <= kMaxBalls);
  FCL_ARTIC_ASSERT(radii.size() == 1 || radii.size() == centers.size());
  return CloudBuilder(centers, radii, threads).run();
}

}  // namespace fcl_artic
