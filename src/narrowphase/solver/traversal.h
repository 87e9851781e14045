// SPDX-License-Identifier: BSD-3-Clause
//
// One pair over one batch: hulls, node pairs, leaf pairs, and what GJK claims of them.
#pragma once

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

/// Slot of a node's swept box in the still body's frame. One box serves every partner that the node meets in this
/// batch.
inline int Solver::sweptNode(int side, int index) {
  Cached& cached = cached_[side][index & (kCached - 1)];
  if (isSwept(side, index)) return cached.slot;
  cached.epoch = pair_epoch_;
  cached.node = index;
  cached.slot = pool_.size();
  sweepNode(this->side(side).m, side_[side].moving->nodes[index], pad_ + margin_, pool_.grow());
  return cached.slot;
}

inline unsigned Solver::nodesMayTouch(int a, int b, unsigned mask) {
  ++statistics_.node_tests;
  const Node &A = side_[0].still->nodes[a], &B = side_[0].moving->nodes[b];
  // Of two nodes one has mostly been met before: its swept box is there.
  const int known = isSwept(0, b) ? 0 : 1;
  const auto box = [&](int s) { return apart(pool_[s ? sweptNode(1, a) : sweptNode(0, b)], s ? B : A); };
  mask &= ~box(known);
  if (!mask) return 0;
  // A node that is larger than the other seldom tells more, and its box has to be made.
  const int other = 1 - known;
  if (isSwept(other, other ? a : b) || (other ? A : B).radius < kLargerNode * (other ? B : A).radius)
    mask &= ~box(other);
  if (!mask || !(A.radius >= engine::kUnbounded || B.radius >= engine::kUnbounded)) return mask;
  return mask & ~apartFromUnbounded(a, b);
}

/// Lanes in which a node is apart from the whole of an unbounded body, along that one's normal.
inline unsigned Solver::apartFromUnbounded(int a, int b) {
  unsigned separated = 0;
  for (int s = 0; s < 2; ++s) {
    const Side& side = this->side(s);
    const Piece& still = side.still->pieces[0];
    const Node& node = side.moving->nodes[s ? a : b];
    if (side.still->num_pieces != 1 || !unbounded(still) || node.radius >= engine::kUnbounded) continue;
    Piece box;
    box.kind = PieceKind::box;
    middleOf(node, box.center);
    double far2 = 0;
    for (int k = 0; k < 3; ++k) {
      box.size[k] = 0.5 * (static_cast<double>(node.hi[k]) - static_cast<double>(node.lo[k]));
      const double far = max(abs(node.lo[k]), abs(node.hi[k]));
      far2 += far * far;
    }
    box.reach = sqrt(far2) * (1 + 8 * kUlp);
    double sign = 0;
    ++statistics_.certificates;
    separated |= certainlySeparated(side, still, box, still.size, kAllLanes, margin_, pad_, sign);
  }
  return separated;
}

/// The pieces at a lane's middle, or, but for the remainder, at any tau of it.
inline DifferenceBody Solver::differenceAt(const Piece& a, const Piece& b, int lane, double tau) const {
  DifferenceBody body;
  body.tree_a = side_[0].still;
  body.tree_b = side_[0].moving;
  body.a = &a;
  body.b = &b;
  const RigidLanes& m = side_[0].m;
  for (int i = 0; i < 9; ++i) body.pose.R[i] = m.R[0][i][lane];
  for (int i = 0; i < 3; ++i) body.pose.c[i] = m.c[0][i][lane];
  if (tau != 0) {
    for (int i = 0; i < 9; ++i) body.pose.R[i] += tau * (m.R[1][i][lane] + tau * m.R[2][i][lane]);
    for (int i = 0; i < 3; ++i) body.pose.c[i] += tau * (m.c[1][i][lane] + tau * m.c[2][i][lane]);
  }
  return body;
}

/// Lanes of `mask` in which no direction tried keeps the pieces apart. Directions are those that GJK finds for whole
/// lanes, where it is to, and its witnesses at the middles of lanes, each frozen in one frame and in the other; all are
/// tried on all lanes.
/// @param most  so many overlapping middles end the search.
/// @param last  what GJK begins with, and ends with.
/// @param whole  wanted for bodies' hulls; for parts of them, and for leaves, it does not pay.
/// @param onOverlap  called with a lane at whose middle GJK claims overlap.
template <class F>
inline unsigned Solver::notSeparated(const Piece& a, const Piece& b, unsigned mask, int most, Simplex& last,
                                     Whole whole, const F& onOverlap) {
  double guess[3], sign = 0;
  bool have_guess = false;
  unsigned untried = mask;
  whole.wanted = whole.wanted && !unbounded(a) && !unbounded(b);
  const double slack = whole.wanted ? slackOf(side(0), a, b, margin_, pad_) : 0;
  const auto separatesWhole = [&](int lane) {
    GjkResult g;
    searchNearest(SweptDifference(side(0), a, b, lane), guess, kWitnessAccuracy, slack, slack, 48, g);
    ++statistics_.gjk;
    if (!(g.lower > slack)) return false;
    ++statistics_.certificates;
    mask &= ~certainlySeparated(side(0), a, b, g.n, mask, margin_, pad_, sign);
    return !(mask >> lane & 1);
  };
  for (; most > 0 && (untried &= live_ & ~contact_lane_) != 0; untried &= mask) {
    // The middle one of the lanes left: its direction serves neighbours on both sides, its contact ends the later half.
    const int lane = middleLane(untried);
    untried &= ~(1u << lane);
    if (whole.wanted && whole.towards) {
      for (int k = 0; k < 3; ++k) guess[k] = whole.towards[k][lane];
      have_guess = true;
      if (separatesWhole(lane)) continue;
    }
    const DifferenceBody body = differenceAt(a, b, lane);
    if (!have_guess) {
      for (int k = 0; k < 3; ++k) guess[k] = body.pose.c[k];
    }
    GjkResult g;
    gjk(body, guess, kWitnessAccuracy, a.radius + b.radius + margin_, 48, g, &last);
    last = g.simplex;
    ++statistics_.gjk;
    for (int k = 0; k < 3; ++k) guess[k] = g.n[k];
    have_guess = true;
    if (g.overlap) {
      --most;
      onOverlap(lane);
      continue;
    }
    for (int k = 0; k < 3; ++k) witness_[k] = g.n[k];
    have_witness_ = true;
    // In the frame of the piece with more vertices first: the still piece's range takes one direction, the moving
    // one's 24.
    double n[3];
    body.opposite(g.n, n);
    const int first = a.num_vertices > b.num_vertices ? 0 : 1;
    unsigned separated = 0;
    for (int i = 0; i < 2 && (mask & ~separated); ++i) {
      ++statistics_.certificates;
      const unsigned left = mask & ~separated;
      separated |= (first + i) & 1 ? certainlySeparated(side(1), b, a, n, left, margin_, pad_, sign)
                                   : certainlySeparated(side(0), a, b, g.n, left, margin_, pad_, sign);
    }
    mask &= ~separated;
    if (whole.wanted && !whole.towards && (mask >> lane & 1)) separatesWhole(lane);
  }
  return mask;
}

/// GJK's last simplex of a pair's hulls in this query; empty at first.
inline Simplex& Solver::simplexOf(int pair) {
  HullSimplex& kept = hull_simplices_[pair & (kHullSimplices - 1)];
  if (kept.pair != pair || kept.query != query_number_) {
    kept.pair = pair;
    kept.query = query_number_;
    kept.simplex.n = 0;
  }
  return kept.simplex;
}

/// Puts the lanes behind this one off: there seems to be contact at its middle.
inline void Solver::claimOverlap(int lane) {
  if (decide_only_ || last_ || tm_at_[lane] >= claimed_) return;
  claimed_ = tm_at_[lane];
  updateLive();
}

/// A small body lies within a large mesh's bounds, halfway, and its hull in that one's: hulls would say nothing.
inline bool Solver::isWithin() {
  for (int s = 0; s < 2; ++s) {
    const Node &large = side_[s].still->nodes[0], &small = side_[s].moving->nodes[0];
    if (side_[s].still->num_pieces == 1 || large.radius < 2 * small.radius) continue;
    const Side& side = this->side(s);
    double center[3];
    middleOf(small, center);
    bool inside = true;
    for (int k = 0; k < 3; ++k) {
      const double x = dot(side.m.R[0] + 3 * k, center)[kLanes / 2] + side.m.c[0][k][kLanes / 2];
      inside = inside && x > large.lo[k] && x < large.hi[k];
    }
    if (!inside) continue;
    const Piece &a = *side_[0].still->outer, &b = *side_[0].moving->outer;
    const DifferenceBody body = differenceAt(a, b, kLanes / 2);
    GjkResult g;
    gjk(body, body.pose.c, kWitnessAccuracy, a.radius + b.radius + margin_, 48, g);
    ++statistics_.gjk;
    return g.overlap;
  }
  return false;
}

/// Lanes of `mask` in which the hulls around both bodies are not certainly apart: what most pairs of neighbours need,
/// before any of their triangles is looked at.
/// @param claim  overlapping hulls count as a claim of contact.
/// @param whole  as in notSeparated().
/// @return with kWithin where hulls tell nothing.
inline unsigned Solver::hullsMayTouch(unsigned mask, int pair, bool claim, Whole whole) {
  const TreeView &A = *side_[0].still, &B = *side_[0].moving;
  if (A.num_pieces == 1 && B.num_pieces == 1) return query_->any && watching_ ? leavesMayTouch(pair, 0, 0, mask) : mask;
  if (!A.outer || !B.outer) return mask;
  if (isWithin()) return mask | kWithin;
  return notSeparated(*A.outer, *B.outer, mask, kMostHullOverlaps, simplexOf(pair), whole, [&](int lane) {
    overlaps_ |= 1u << lane;
    if (query_->any && watching_ && proveVertexInside(pair, lane)) return;
    if (claim) claimOverlap(lane);
  });
}

/// Lanes of `mask` in which the hulls around what is below two nodes are not certainly apart: a concave body is cut
/// into convex parts by them.
inline unsigned Solver::partsMayTouch(int a, int b, unsigned mask) {
  const auto part = [](const TreeView& tree, int node, const TreeView& other) -> const Piece* {
    const bool whole = tree.num_pieces == 1 ||
                       (node == 0 && (tree.parts || tree.nodes[0].radius < kLargerNode * other.nodes[0].radius));
    if (whole) return tree.outer;
    return tree.part_of_node && tree.part_of_node[node] >= 0 ? tree.parts + tree.part_of_node[node] : nullptr;
  };
  const TreeView &A = *side_[0].still, &B = *side_[0].moving;
  if (!A.parts && !B.parts) return mask;
  const Piece *x = part(A, a, B), *y = x ? part(B, b, A) : nullptr;
  Simplex last;
  return y ? notSeparated(*x, *y, mask, kMostHullOverlaps, last, {}, [](int) {}) : mask;
}

/// Lanes of `mask` in which two leaves are not certainly apart.
inline unsigned Solver::leavesMayTouch(int pair, int piece_a, int piece_b, unsigned mask) {
  ++statistics_.leaf_tests;
  const Piece &a = side_[0].still->pieces[piece_a], &b = side_[0].moving->pieces[piece_b];
  double sign = 0;
  if (hasDirection(a)) {
    ++statistics_.certificates;
    mask &= ~certainlySeparated(side(0), a, b, a.size, mask, margin_, pad_, sign);
    if (!mask) return 0;
  }
  if (hasDirection(b)) {
    ++statistics_.certificates;
    mask &= ~certainlySeparated(side(1), b, a, b.size, mask, margin_, pad_, sign);
    if (!mask) return 0;
  }
  if (have_witness_) {
    ++statistics_.certificates;
    mask &= ~certainlySeparated(side(0), a, b, witness_, mask, margin_, pad_, sign);
    if (!mask) return 0;
  }
  Simplex last;
  return notSeparated(a, b, mask, kLanes, last, {}, [&](int lane) {
    if (tm_at_[lane] < watchFrom(pair)) return;
    if (query_->any && watching_ && proveLeaves(pair, piece_a, piece_b, lane)) return;
    claimOverlap(lane);
  });
}

/// Dual traversal from one node pair; what stays undecided is appended to entries_.
inline void Solver::traverse(int pair, int a, int b, unsigned mask) {
  FCL_ARTIC_ASSERT(pair == present_ && mask != 0 && mask <= kAllLanes);
  const Node *A = side_[0].still->nodes, *B = side_[0].moving->nodes;
  // Earliest lane first: once a contact is found, nothing was spent on later lanes alone.
  const auto push = [&](const Entry& e) { stack_[__builtin_ctz(e.mask)].push(e); };
  if (decide_only_ && a == 0 && b == 0) {
    mask = nodesMayTouch(0, 0, mask);
    if (mask) mask = hullsMayTouch(mask, pair, false, {}) & kAllLanes;
    if (!mask) return;
  }
  const double split_time = last_ ? 0 : kSplitTime * amplitude_;
  Entry e = {pair, a, b, mask};
  const int most = last_ ? 0x7fffffff : entries_.size() + kMostOpen;
  bool held = true;  // e goes on with a child; else it is the next of the stacks
  for (int lane = 0;;) {
    if (!held) {
      while (lane < kLanes && stack_[lane].size() == 0) ++lane;
      if (lane == kLanes) break;
      const int top = stack_[lane].size() - 1;
      e = stack_[lane][top];
      stack_[lane].truncate(top);
    }
    held = false;
    if (const unsigned later = e.mask & ~live_) {
      if (!decide_only_) entries_.push({pair, e.a, e.b, later | kPutOff});
      e.mask &= live_;
      if (!e.mask) continue;
    }
    if (outOfBudget()) break;
    if (free_nodes_ && (free_nodes_[e.a / 64] >> e.a % 64 & 1)) continue;
    if (e.a != 0 || e.b != 0 || roots_batch_ != batch_) e.mask = nodesMayTouch(e.a, e.b, e.mask);
    if (e.mask && (e.a != 0 || e.b != 0)) e.mask = partsMayTouch(e.a, e.b, e.mask);
    if (!e.mask) continue;
    const Node &x = A[e.a], &y = B[e.b];
    if (x.isLeaf() && y.isLeaf()) {
      e.mask = leavesMayTouch(pair, x.piece(), y.piece(), e.mask);
      if (!e.mask) continue;
      if (decide_only_) {
        blocked_ |= e.mask;
        live_ &= ~e.mask;
      } else {
        entries_.push(e);
      }
    } else if (e.mask == contact_lane_ || max(x.radius, y.radius) < split_time || entries_.size() > most) {
      entries_.push(e);
    } else {
      if (y.isLeaf() || (!x.isLeaf() && x.radius > y.radius)) {
        push({pair, x.right(), e.b, e.mask});
        e.a = x.left();
      } else {
        push({pair, e.a, y.right(), e.mask});
        e.b = y.left();
      }
      held = (e.mask >> lane & 1) != 0;
      if (!held) push(e);
    }
  }
  for (Buffer<Entry>& stack : stack_) stack.clear();
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
