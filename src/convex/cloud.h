// SPDX-License-Identifier: BSD-3-Clause
//
// Nodes and pieces of a tree by their numbers. The tree of a cloud stores neither below its clusters: they are made of
// the balls when they are asked for (doc/ARCHITECTURE.md, "Clouds"). All other trees store all of theirs.
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

/// Box of `count` balls from this one on.
inline engine::BoxBounds boxOfBalls(const TreeView& cloud, int first, int count) {
  engine::BoxBounds box;
  for (int i = first; i < first + count; ++i) {
    const double radius = radiusOfBall(cloud, i);
    for (int k = 0; k < 3; ++k) {
      const double x = cloud.balls[i].center[k], lo = x - radius, hi = x + radius;
      box.lo[k] = i == first || lo < box.lo[k] ? lo : box.lo[k];
      box.hi[k] = i == first || hi > box.hi[k] ? hi : box.hi[k];
    }
  }
  return box;
}

/// Some balls of a cluster, side by side, and the number of the left child of the node over them; the nodes over n
/// balls take 2 (n - 1) numbers, from that child's on.
struct BallRange {
  int first, count, child;
  BallRange left() const { return {first, count / 2, child + 2}; }
  BallRange right() const { return {first + count / 2, count - count / 2, child + 2 * (count / 2)}; }
};

/// The node over a range of a cluster's balls, with its left child's number, or ~ball.
inline Node nodeOver(const TreeView& cloud, const BallRange& range) {
  Node node;
  setBox(boxOfBalls(cloud, range.first, range.count), node);
  node.child = range.count == 1 ? ~range.first : range.child;
  return node;
}

/// The range under a node below a cluster.
inline BallRange rangeBelowCluster(const TreeView& cloud, int node) {
  const int at = (node - cloud.num_nodes) / 2;
  const engine::Ball& ball = cloud.balls[at];
  const int first = at - ball.place;
  BallRange range = {first, ball.cluster_size, cloud.num_nodes + 2 * first};
  for (;;) {
    const BallRange left = range.left(), right = range.right();
    if (node == range.child) return left;
    if (node == range.child + 1) return right;
    range = node < right.child ? left : right;
  }
}

/// A node of a tree. It is the tree's own, or lies in `room`.
FCL_ARTIC_INLINE const Node& nodeOf(const TreeView& tree, int node, NodeRoom& room) {
  if (!tree.balls || node < tree.num_nodes) return tree.nodes[node];
  return room.node = nodeOver(tree, rangeBelowCluster(tree, node));
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
