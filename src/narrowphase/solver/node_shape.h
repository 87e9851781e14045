// SPDX-License-Identifier: BSD-3-Clause
//
// The box of a tree's node: its proportions, and as a piece.
#pragma once

#include "convex/cloud.h"
#include "narrowphase/solver/swept_box.h"
#include "numerics/assertion.h"
#include "numerics/constants.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

/// The proportions of a node's box: its longest axis, and the squares of half its diagonal and of the part of that
/// across this axis.
struct Proportions {
  int longest;
  double square, across;
};
FCL_ARTIC_INLINE Proportions proportionsOf(const Node& node) {
  const Vec3 size = (doublesOf(node.hi) - doublesOf(node.lo)) * 0.5;
  int longest = size[1] > size[0] ? 1 : 0;
  longest = size[2] > size[longest] ? 2 : longest;
  const double square = dot(size, size);
  return {longest, square, square - size[longest] * size[longest]};
}

/// Whether a node is smaller than a motion: its radius is, or that of its section where that is thin. (Slivers lie side
/// by side: a motion wider than they are has them all in each other's way, however long they are. Measured: the slowest
/// queries of two tubes of slivers take a sixth of the time, nothing else changes but slivers against a ball, which
/// take longer by two thirds.)
FCL_ARTIC_INLINE bool isSmallerThanMotion(const Node& node, double motion) {
  constexpr double kThin = 0.125;  // as part of the radius
  if (node.radius < motion) return true;
  const Proportions box = proportionsOf(node);
  return box.across < kThin * kThin * box.square && box.across < motion * motion;
}

/// The axis along which a node's box is a rod, several times as long as it is thick; -1: it is none.
FCL_ARTIC_INLINE int axisOfRod(const Node& node) {
  constexpr double kThick = 0.25;  // half across, as part of half the diagonal
  const Proportions box = proportionsOf(node);
  return box.across < kThick * kThick * box.square ? box.longest : -1;
}

/// A bounded node's box as a piece.
inline Piece boxOf(const Node& node) {
  const Vec3 lo = doublesOf(node.lo), hi = doublesOf(node.hi);
  Piece box;
  box.kind = PieceKind::box;
  middleOf(node).store(box.center);
  ((hi - lo) * 0.5).store(box.size);
  box.reach = norm(max(abs(lo), abs(hi))) * (1 + 8 * kUlp);
  return box;
}

/// The convex piece that holds what is below a node: the hull around the whole body, a leaf's piece, or, of a large
/// body, the node's box.
class NodeHull {
 public:
  NodeHull(const TreeView& tree, int node) : piece_(node == 0 ? tree.outer : nullptr) {
    if (node == 0 || !exists(tree, node)) return;
    NodeRoom room;
    const Node& at = nodeOf(tree, node, room);
    piece_ = at.isLeaf() ? &pieceOf(tree, at.piece(), room_) : &(room_.piece = boxOf(at));
  }
  NodeHull(const NodeHull&) = delete;
  NodeHull& operator=(const NodeHull&) = delete;

  static bool exists(const TreeView& tree, int node) {
    return node == 0 ? tree.outer != nullptr : tree.upper != nullptr;
  }
  const Piece& operator*() const {
    FCL_ARTIC_ASSERT(piece_ != nullptr);  // exists()
    return *piece_;
  }

 private:
  PieceRoom room_;
  const Piece* piece_;
};

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
