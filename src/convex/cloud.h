// SPDX-License-Identifier: BSD-3-Clause
//
// Nodes and pieces of a tree by their numbers. The tree of a cloud stores neither below its clusters: they are made of
// the balls when they are asked for (engine::Ball). All other trees store all of theirs.
#pragma once

#include "convex/node_boxes.h"
#include "convex/piece_kinds.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

/// Room for a node or a piece that is made when it is asked for. It is not initialised: mostly it is not used.
struct NodeRoom {
  union {
    Node node;
  };
  NodeRoom() {}
};
struct PieceRoom {
  union {
    Piece piece;
  };
  PieceRoom() {}
};

FCL_ARTIC_INLINE double radiusOfBall(const TreeView& cloud, int ball) {
  return cloud.ball_radii[static_cast<std::ptrdiff_t>(ball) * cloud.ball_radius_stride];
}

/// Some balls of a cluster, side by side, and the left child of the node over them. The nodes over n balls take
/// 2 (n - 1) numbers, from that child's on. Balls are counted from the cluster's first one, nodes from the left child
/// of the cluster's node.
struct BallRange {
  std::uint8_t first, count, child;
};

/// The ranges under the nodes below a cluster, by its size.
struct ClusterNodes {
  BallRange below[engine::kMaxClusterSize + 1][2 * (engine::kMaxClusterSize - 1)] = {};
  std::uint8_t leaf[engine::kMaxClusterSize + 1][engine::kMaxClusterSize] = {};  ///< by the ball

  constexpr ClusterNodes() {
    for (std::uint8_t size = 2; size <= engine::kMaxClusterSize; ++size) {
      divide({0, size, 0}, below[size]);
      for (int i = 0; i < 2 * (size - 1); ++i) {
        if (below[size][i].count == 1) leaf[size][below[size][i].first] = static_cast<std::uint8_t>(i);
      }
    }
  }
  static constexpr void divide(const BallRange& range, BallRange* ranges) {
    if (range.count == 1) return;
    const auto half = static_cast<std::uint8_t>(range.count / 2);
    BallRange& left = ranges[range.child];
    BallRange& right = ranges[range.child + 1];
    left = {range.first, half, static_cast<std::uint8_t>(range.child + 2)};
    right = {static_cast<std::uint8_t>(range.first + half), static_cast<std::uint8_t>(range.count - half),
             static_cast<std::uint8_t>(range.child + 2 * half)};
    divide(left, ranges);
    divide(right, ranges);
  }
};
inline constexpr ClusterNodes kClusterNodes;

/// The ends of a ball's box.
FCL_ARTIC_INLINE void boundBall(const TreeView& cloud, int ball, FourDoubles& lower, FourDoubles& upper) {
  typedef long long Bits __attribute__((vector_size(32)));
  static_assert(sizeof(Bits) == sizeof(engine::Ball));
  Bits bits;
  __builtin_memcpy(&bits, cloud.balls + ball, sizeof bits);
  const auto center = reinterpret_cast<FourDoubles>(bits & Bits{-1, -1, -1, 0});
  const double radius = radiusOfBall(cloud, ball);
  lower = center - FourDoubles{radius, radius, radius, 0};
  upper = center + FourDoubles{radius, radius, radius, 0};
}

/// The node over `count` balls from this one on.
/// @param child  its left child's number; it has none over a single ball.
inline Node nodeOverBalls(const TreeView& cloud, int first, int count, int child) {
  FourDoubles lo, hi;
  boundBall(cloud, first, lo, hi);
  for (int i = first + 1; i < first + count; ++i) {
    FourDoubles low, high;
    boundBall(cloud, i, low, high);
    lo = low < lo ? low : lo;
    hi = high > hi ? high : hi;
  }
  Node node;
  setBox(lo, hi, node);
  setRadius(node);
  node.child = count == 1 ? ~first : child;
  return node;
}

/// Whether the tree stores no nodes below a node that it stores.
FCL_ARTIC_INLINE bool isCluster(const TreeView& tree, const Node& node) {
  return tree.balls && node.child >= tree.num_nodes;
}

/// The balls under a node below a cluster, and the number of its left child.
struct BallsOfNode {
  int first, count, child;
};
inline BallsOfNode ballsBelowCluster(const TreeView& cloud, int node) {
  const int ball = (node - cloud.num_nodes) / 2, first = ball - cloud.balls[ball].place;
  const int numbers = cloud.num_nodes + 2 * first;
  const BallRange& range = kClusterNodes.below[cloud.balls[ball].cluster_size][node - numbers];
  return {first + range.first, range.count, numbers + range.child};
}

/// A node of a tree. It is the tree's own, or lies in `room`.
FCL_ARTIC_INLINE const Node& nodeOf(const TreeView& tree, int node, NodeRoom& room) {
  if (!tree.balls || node < tree.num_nodes) return tree.nodes[node];
  const BallsOfNode balls = ballsBelowCluster(tree, node);
  return room.node = nodeOverBalls(tree, balls.first, balls.count, balls.child);
}
/// The piece of a leaf; negative: the node with this number is none.
FCL_ARTIC_INLINE int leafPieceOf(const TreeView& tree, int node) {
  if (!tree.balls || node < tree.num_nodes) return tree.nodes[node].piece();
  const BallsOfNode balls = ballsBelowCluster(tree, node);
  return balls.count == 1 ? balls.first : -1;
}

inline Piece pieceOfBall(const TreeView& cloud, int ball) {
  const engine::Ball& at = cloud.balls[ball];
  Piece piece;
  piece.kind = PieceKind::point;
  piece.primitive = at.number;
  double square = 0;
  for (int k = 0; k < 3; ++k) {
    piece.center[k] = at.center[k];
    square += at.center[k] * at.center[k];
  }
  piece.radius = radiusOfBall(cloud, ball);
  piece.reach = sqrt(square) * (1 + 1e-15);
  return piece;
}

/// A piece of a tree. It is the tree's own, or lies in `room`.
FCL_ARTIC_INLINE const Piece& pieceOf(const TreeView& tree, int piece, PieceRoom& room) {
  if (!tree.balls) return tree.pieces[piece];
  return room.piece = pieceOfBall(tree, piece);
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
