// SPDX-License-Identifier: BSD-3-Clause
//
// Guesses, by the hulls around two bodies, whether they rest on each other. Nothing is proven by a guess: it says what
// is worth a proof.
#pragma once

#include <initializer_list>

#include "narrowphase/solver/follower.h"
#include "narrowphase/solver/traversal.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

/// Maximum number of a body's pieces that are examined around a point where it may rest.
constexpr int kMaxPiecesAround = 4;

/// Finds pieces at a witness of the body's hull: the one that has the witness's vertices, and some whose boxes,
/// enlarged by `reach`, hold the witness's point.
/// @param at_vertices  pieceAtWitness().
/// @param point  the witness's, in the tree's frame.
/// @return their number, kMaxPiecesAround at most.
inline int piecesAround(const TreeView& tree, int at_vertices, const Vec3& point, double reach, std::int32_t* pieces) {
  constexpr int kDeepest = 64;
  std::int32_t waiting[kDeepest] = {0};
  int found = 0;
  if (at_vertices >= 0) pieces[found++] = at_vertices;
  for (int count = 1; count && found < kMaxPiecesAround;) {
    NodeRoom room;
    const Node& node = nodeOf(tree, waiting[--count], room);
    bool holds = true;
    for (int k = 0; k < 3; ++k) holds &= point[k] >= node.lo[k] - reach && point[k] <= node.hi[k] + reach;
    if (!holds) continue;
    if (node.isLeaf()) {
      if (node.piece() != at_vertices) pieces[found++] = node.piece();
    } else if (count + 2 <= kDeepest) {
      waiting[count++] = node.right();
      waiting[count++] = node.left();
    }
  }
  return found;
}

/// Returns the largest gap of two hulls, without their radii, along directions in which bodies mostly rest on each
/// other. It is mostly negative. The directions are the axes of their frames, the normals of triangles at a witness,
/// and those of the faces of a simplex that holds the origin. (If the hulls touch, the origin lies on one of these
/// faces.)
inline double gapWhereTheyRest(const DifferenceBody& hulls, const Simplex& simplex) {
  double gap = -kUnknownGap;
  const auto tryDirection = [&](const Vec3& n) {
    const double length = norm(n);
    if (!(length > 0)) return;
    for (const double sign : {1 / length, -1 / length}) {
      DifferencePoint lowest;
      hulls.support(n * sign, lowest);
      gap = max(gap, dot(n * sign, lowest.w));
    }
  };
  for (int k = 0; k < 3; ++k) {
    const Vec3 axis(k == 0, k == 1, k == 2);
    tryDirection(axis);
    tryDirection(hulls.pose.R * axis);
  }
  const int a = pieceAtWitness(*hulls.tree_a, simplex, true), b = pieceAtWitness(*hulls.tree_b, simplex, false);
  PieceRoom room;
  if (a >= 0 && hasDirection(pieceOf(*hulls.tree_a, a, room))) tryDirection(sizeOf(pieceOf(*hulls.tree_a, a, room)));
  if (b >= 0 && hasDirection(pieceOf(*hulls.tree_b, b, room)))
    tryDirection(hulls.pose.R * sizeOf(pieceOf(*hulls.tree_b, b, room)));
  for (int out = 0; out < simplex.n && simplex.n >= 3; ++out) {
    const Vec3 &x = simplex.v[(out + 1) % simplex.n].w, &y = simplex.v[(out + 2) % simplex.n].w;
    const Vec3& z = simplex.v[(out + 3) % simplex.n].w;
    tryDirection(cross(y - x, z - x));
    if (simplex.n == 3) break;
  }
  return gap;
}

/// The gap of two hulls as GJK finds it. If GJK claims overlap, it is gapWhereTheyRest() less the radii, or
/// -kUnknownGap if the hulls are in each other by more than `shallow`.
inline double restingGap(const DifferenceBody& hulls, double radii, double shallow, GjkResult& g) {
  gjk(hulls, hulls.pose.c, {kFollowingAccuracy, radii, 64}, g);
  if (!g.overlap || unbounded(*hulls.a) || unbounded(*hulls.b)) return g.lower - radii;
  return depthWithin(g.simplex) + radii > shallow ? -kUnknownGap : gapWhereTheyRest(hulls, g.simplex) - radii;
}

/// The same of the hulls around what is below two nodes, at the begin of a lane. (In a wide lane the pose is off by
/// what the quadratic leaves out.)
inline double restingGap(Seen seen, const Entry& e, int lane, GjkResult& g) {
  const NodeHull below_a(seen->a(), e.a), below_b(seen->b(), e.b);
  const Piece &a = *below_a, &b = *below_b;
  return restingGap(seen->differenceAt(a, b, lane, -1), a.radius + b.radius + seen->margin(),
                    kShallow * seen->smallerRadius(), g);
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
