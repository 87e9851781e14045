// SPDX-License-Identifier: BSD-3-Clause
//
// A geometry as the engine sees it: a tree of boxes over convex pieces. Plain data; its owner is ShapeTree.
#pragma once

#include <cstdint>

#include "model/eight_boxes.h"
#include "model/piece.h"

namespace fcl_artic {
namespace engine {

/// Bounding volume: an axis-aligned box in the tree's frame that holds the pieces below it, radii included. Single
/// precision, rounded outward: eight lanes then compare in one instruction, and what it loses the leaves win back.
/// Half a cache line, and siblings lie side by side: a traversal that descends reads one line.
struct alignas(32) Node {
  float lo[3], hi[3];
  float radius;        ///< half the box's diagonal, rounded up
  std::int32_t child;  ///< left child, the right one follows it; a leaf has ~piece, which is < 0
  bool isLeaf() const { return child < 0; }
  int left() const { return child; }
  int right() const { return child + 1; }
  int piece() const { return ~child; }
};

/// Node of the upper levels of a large body's tree, for stage 1: up to eight children, each of which stands for a node
/// of the tree. Each child's box holds all that is below it. The children of one upper node together hold all that is
/// below the node that it stands for. Node 0 stands for the root.
struct alignas(64) UpperNode {
  EightBoxes boxes;       ///< the nodes' own, in the tree's frame; lanes that are not used have empty ones
  std::int32_t node[8];   ///< the tree's node; -1: the lane is not used
  std::int32_t upper[8];  ///< the same as an upper node; -1: stage 1 goes no further
};

/// A ball of a cloud. Balls lie in the order of the tree's leaves. A *cluster* is up to kMaxClusterSize of them that
/// lie side by side; the tree stores no nodes below it (convex/cloud.h).
struct alignas(32) Ball {
  double center[3];
  std::int32_t number;         ///< of its point: the primitive id
  std::uint16_t place;         ///< in its cluster: there are as many balls before it
  std::uint16_t cluster_size;  ///< the number of balls
};
constexpr int kMaxClusterSize = 16;

/// A body's geometry: constant, shared by threads. Node 0 is the root, node 1 is not used.
struct TreeView {
  const Node* nodes = nullptr;
  const Piece* pieces = nullptr;               ///< of a cloud: the first one only
  const double* vertices = nullptr;            ///< xyz, packed
  const double* hulls = nullptr;               ///< see PieceKind; 64-byte aligned
  const Piece* outer = nullptr;                ///< one convex piece that holds the whole body; null: none worth having
  const Piece* parts = nullptr;                ///< convex pieces that hold what is below a node each
  const std::int16_t* part_of_node = nullptr;  ///< index into `parts`, -1: none; null: no node has one
  const UpperNode* upper = nullptr;            ///< of a large obstacle; null: stage 1 takes it as a whole
  const Ball* balls = nullptr;                 ///< of a cloud: as many as pieces; null: all pieces are stored
  const double* ball_radii = nullptr;          ///< ball i's is at i * ball_radius_stride, which is 0 or 1
  std::int32_t ball_radius_stride = 0;
  std::int32_t num_nodes = 0;  ///< that are stored; of a cloud, nodes below clusters have numbers from here on
  std::int32_t num_pieces = 0;
  double extent = 0;  ///< largest |p|, radii included: the size that pads scale with
};

/// A box by its ends.
struct BoxBounds {
  double lo[3], hi[3];
};

/// A box in a body's tree frame, grown by a ball, that holds the body: exact for boxes, balls and capsules.
struct CoreBox {
  double lo[3], hi[3], radius;
};

/// A closed part of a mesh's surface: its box, and points of it that lie far out, one per lane.
struct ClosedPart {
  double lo[3], hi[3];
  alignas(64) double points[3][8];
};
/// Balls inside closed parts of a mesh (doc/NUMERICS.md, "Inner balls"), in its tree's frame. Lanes go over balls;
/// those that fill the last eight up have a radius far below 0.
struct InnerBalls {
  static constexpr std::int32_t kMax = 16;
  alignas(64) double center[3][kMax];
  alignas(64) double radius[kMax];
  std::int32_t part[kMax];  ///< that the ball lies in
  std::int32_t count = 0;   ///< without what fills up
  double reach = 0;         ///< they lie within this of the segment of the mesh's line swept sphere, about
  const ClosedPart* parts = nullptr;
};

}  // namespace engine
}  // namespace fcl_artic
