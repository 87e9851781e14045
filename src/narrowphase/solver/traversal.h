// SPDX-License-Identifier: BSD-3-Clause
//
// One pair over one batch: hulls, node pairs by their swept boxes, leaf pairs by certificates. Entries that stay
// undecided are handed back.
#pragma once

#include "narrowphase/solver/depths.h"
#include "narrowphase/solver/effort_throttle.h"
#include "narrowphase/solver/entry.h"
#include "narrowphase/solver/hull_simplices.h"
#include "narrowphase/solver/node_shape.h"
#include "narrowphase/solver/pose_proofs.h"
#include "narrowphase/solver/swept_ranges.h"
#include "narrowphase/swept_difference.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

/// One of two nodes is always tested by its swept box. So is the other one, unless its radius is this many times its
/// partner's or more and its swept box is not there yet. Measured: a quarter less time for a link amid one large mesh,
/// no change elsewhere; 1 is slower.
constexpr double kLargerNode = 2;
/// Nodes smaller than this part of the motion are split in time before they are split in space. Measured: anything from
/// 0.35 to 1.4 is within 30 %.
constexpr double kSplitTime = 0.7;
/// Once GJK claims overlap of two hulls in this number of lanes, the rest is left to their triangles.
constexpr int kMaxHullOverlaps = 2;
/// The same for convex parts. There are many of them, and their own parts come next.
constexpr int kMaxPartOverlaps = 1;
/// A traversal that has left this number of pairs open leaves the rest unexamined: that lane will be split anyway.
/// Measured: 128 are slower for arms, without any bound a body of 40,000 triangles takes up to 20 ms.
constexpr int kMaxOpen = 512;
/// The same for leaves at single poses, neither proven apart nor in contact, as where bodies rest on each other.
constexpr int kMaxOpenAtPoses = 16;
/// GJK stops when it knows the gap to this part: enough for a direction.
constexpr double kWitnessAccuracy = 0.1;

/// Pieces whose `size` is a direction worth trying.
FCL_ARTIC_INLINE bool hasDirection(const Piece& piece) {
  return piece.kind == PieceKind::vertices || unbounded(piece);
}

/// The middle one of some lanes.
FCL_ARTIC_INLINE int middleLane(unsigned lanes) {
  for (int skip = __builtin_popcount(lanes) / 2; skip; --skip) lanes &= lanes - 1;
  return __builtin_ctz(lanes);
}

/// The purpose of a traversal.
enum class Aim {
  split,      ///< to find what to look at in narrower lanes: ends early where that is more promising
  leaves,     ///< the same, down to the leaves: lanes are as narrow as they get
  poses,      ///< as `leaves`, at single poses, for contacts to be proven: ends where many leaves can't be decided
  freeLanes,  ///< only which lanes are free matters
};

/// The search for directions that certify whole lanes. It pays for bodies' hulls, not for parts of them, nor for
/// leaves.
struct LaneSearch {
  bool wanted = false;
  /// Initial guesses, from A to B in A's frame, one a lane. Null: where the witness at a lane's middle does not certify
  /// the lane, that is the guess.
  const Vec3Lanes* towards = nullptr;
};

/// A node and its number.
struct NodeAt {
  int number;
  const Node& node;
};

/// How directions are looked for that keep two pieces apart.
struct DirectionSearch {
  int max_overlaps;  ///< number of lanes with overlap at the middle that ends the search
  Simplex& last;     ///< GJK begins with it, and leaves there the one that it ends with
  LaneSearch lanes = {};
  SweptRanges* ranges = nullptr;  ///< of a patch and a body's hull: keeps the directions that are found
};

/// One pair over one batch, in the live lanes of Horizon's batch.
class Traversal : PartOfSolver {
 public:
  Traversal(SearchState& state, PoseProofs& proofs)
      : PartOfSolver(state.task), horizon_(state.horizon), contacts_(state.contacts), proofs_(proofs) {}

  /// A new query.
  void begin() {
    for (Buffer<Entry>& stack : stack_)
      stack.clear();  // if the caller's progress threw, entries of the last query are still here
    simplices_.begin();
    ranges_.forget();
    rods_throttle_.begin();
    roots_tested_ = -1;
  }
  Simplex& simplexOf(const Entry& e) { return simplices_.of(e.pair, e.a != 0 ? e.a : e.b); }

  /// Lanes of `mask` in which two nodes' boxes are not certainly apart.
  unsigned nodesMayTouch(Seen seen, const NodeAt& a, const NodeAt& b, unsigned mask);
  /// The same of two whole bodies.
  unsigned rootsMayTouch(Seen seen, unsigned mask) {
    return nodesMayTouch(seen, {0, seen->a().nodes[0]}, {0, seen->b().nodes[0]}, mask);
  }
  /// Says that the root nodes of all pairs are tested over this batch: descend() does not test them over it again.
  void rootsAreTested(Seen seen) { roots_tested_ = seen->batchNumber(); }

  struct HullTest {
    unsigned mask;      ///< lanes in which the hulls around both bodies are not certainly apart
    bool within;        ///< Entry::within
    unsigned overlaps;  ///< lanes at whose middles GJK claims that they overlap
  };
  HullTest hullsMayTouch(Seen seen, const Entry& e, bool suspect, LaneSearch search);

  /// Goes down from a pair of nodes in the lanes of `mask`. Entries that stay undecided are appended to `open`.
  void descend(Seen seen, const Entry& root, Aim aim, Buffer<Entry>& open) {
    descend(seen, root, aim, open, open.size());
  }
  /// The same for one of several patches of a body.
  /// @param begin  of the pair's entries in `open`: they count together (kMaxOpen).
  void descend(Seen seen, const Entry& root, Aim aim, Buffer<Entry>& open, int begin);
  /// Lanes of `mask` in which the pair's bodies are not certainly apart.
  unsigned blockedLanes(Seen seen, unsigned mask);

 private:
  unsigned traverse(Seen seen, const Entry& root, Aim aim, Buffer<Entry>& open, int begin);
  template <class Push>
  void divideCluster(Seen seen, const Entry& e, bool in_a, const Node& cluster, const NodeAt& partner,
                     const Push& push);
  unsigned partsMayTouch(Seen seen, int a, int b, unsigned mask);
  unsigned apartFromUnbounded(Seen seen, const Node& a, const Node& b);
  unsigned apartAcrossRods(Seen seen, const Node& a, const Node& b, unsigned mask);
  unsigned leavesMayTouch(Seen seen, int piece_a, int piece_b, unsigned mask, bool suspect);
  bool isWithin(Seen seen);
  /// Lanes of `mask` in which direction n, in the frame of side.still, certainly keeps the pieces apart.
  FCL_ARTIC_INLINE unsigned separated(const Side& side, const Piece& still, const Piece& moving, const Vec3& n,
                                      unsigned mask) {
    ++statistics().certificates;
    return certainlySeparated(side, still, moving, n, mask);
  }
  bool provesAny() const { return query().any && contacts_.watching(); }
  template <class F>
  unsigned notSeparated(Seen seen, const PiecePair& pieces, unsigned mask, DirectionSearch search, const F& onOverlap);

  Horizon& horizon_;
  const ContactList& contacts_;
  PoseProofs& proofs_;

  HullSimplices simplices_;
  EffortThrottle rods_throttle_;
  SweptRanges ranges_;
  std::int32_t roots_tested_ = -1;  ///< the batch's number
  Buffer<Entry> stack_[kLanes];     ///< node pairs to visit, by their earliest lane
  Buffer<Entry> undecided_;         ///< stays empty
};

inline unsigned Traversal::nodesMayTouch(Seen seen, const NodeAt& a, const NodeAt& b, unsigned mask) {
  ++statistics().node_tests;
  const Node &A = a.node, &B = b.node;
  // One of two nodes has mostly been met before: its swept box is there.
  const int known = seen->isSwept(0, b.number) ? 0 : 1;
  const auto box = [&](int s) {
    const NodeAt& moving = s ? a : b;
    return apart(seen->sweptNode(s, moving.number, moving.node), s ? B : A);
  };
  mask &= ~box(known);
  if (!mask) return 0;
  // The swept box of a node that is larger than the other seldom separates more, and it would have to be computed.
  const int other = 1 - known;
  if (seen->isSwept(other, (other ? a : b).number) || (other ? A : B).radius < kLargerNode * (other ? B : A).radius)
    mask &= ~box(other);
  if (!mask) return 0;
  if (A.radius >= engine::kUnbounded || B.radius >= engine::kUnbounded) return mask & ~apartFromUnbounded(seen, A, B);
  if (rods_throttle_.mayTry()) {
    mask &= ~apartAcrossRods(seen, A, B, mask);
    rods_throttle_.count(!mask);
  }
  return mask;
}

/// Lanes in which two rods are apart along the direction across both. Rods that pass each other askew have boxes that
/// meet in each other's frame until they are as near as they are long. (Two tubes had slivers forty times as long as
/// wide: half a million pairs of triangles were looked at, all but 2,000 of them apart in this way.)
inline unsigned Traversal::apartAcrossRods(Seen seen, const Node& a, const Node& b, unsigned mask) {
  const int axis_a = axisOfRod(a), axis_b = axis_a < 0 ? -1 : axisOfRod(b);
  if (axis_b < 0) return 0;
  const Side& side = seen->side(0);
  const int lane = middleLane(mask);
  const auto along = [](int axis) { return Vec3(axis == 0, axis == 1, axis == 2); };
  const Vec3 n = cross(along(axis_a), laneOf(side.m.R[0], lane) * along(axis_b));
  const double length = norm(n);
  constexpr double kAskew = 1e-6;  // of rods as good as parallel the direction is rounding
  if (!(length > kAskew)) return 0;
  return separated(side, boxOf(a), boxOf(b), n * (1 / length), mask);
}

/// Lanes in which a node is apart from the whole of an unbounded body, along that one's normal.
inline unsigned Traversal::apartFromUnbounded(Seen seen, const Node& a, const Node& b) {
  unsigned apart = 0;
  for (int s = 0; s < 2; ++s) {
    const Side& side = seen->side(s);
    const Piece& still = side.still->pieces[0];
    const Node& node = s ? a : b;
    if (side.still->num_pieces != 1 || !unbounded(still) || node.radius >= engine::kUnbounded) continue;
    apart |= separated(side, still, boxOf(node), sizeOf(still), kAllLanes);
  }
  return apart;
}

/// Two pieces that GJK has found apart in the middle of a lane are nearer there than the tube lets them be.
inline bool meetsInTube(Seen seen, const PiecePair& pieces, const GjkResult& g, int lane) {
  const double reached = pieces.a.radius + pieces.b.radius + seen->touchMargin(pieces.a, pieces.b, g.n, lane);
  return g.distance <= reached;
}

/// Lanes of `mask` in which no direction tried keeps the pieces apart. Directions are GJK's witnesses at the middles of
/// lanes and, if `search` wants them, those that it finds for whole lanes. Each is frozen in one frame and in the
/// other, and tried on all lanes.
/// @param onOverlap  called with a lane at whose middle GJK claims overlap.
template <class F>
inline unsigned Traversal::notSeparated(Seen seen, const PiecePair& pieces, unsigned mask, DirectionSearch search,
                                        const F& onOverlap) {
  const Piece &a = pieces.a, &b = pieces.b;
  Vec3 guess;
  bool have_guess = false;
  unsigned untried = mask;
  const bool whole_lanes = search.lanes.wanted && pieces.areBounded();
  const Vec3Lanes* const towards = search.lanes.towards;
  const double slack = whole_lanes ? slackWithoutTube(seen->side(0), a, b) : 0;
  const auto separatedAlong = [&](const Vec3& n) {  // of A's frame
    if (!search.ranges) return separated(seen->side(0), a, b, n, mask);
    ++statistics().certificates;
    return search.ranges->add(seen, a, n, mask);
  };
  const auto separatesWhole = [&](int lane) {
    GjkResult g;
    searchNearest(SweptDifference(seen->side(0), a, b, lane), guess, {kWitnessAccuracy, slack, 48, slack}, g);
    ++statistics().gjk;
    if (!(g.lower > slack)) return false;
    mask &= ~separatedAlong(g.n);
    return !(mask >> lane & 1);
  };
  for (int left = search.max_overlaps; left > 0 && (untried &= horizon_.live() & ~horizon_.contactLane()) != 0;
       untried &= mask) {
    // The middle one of the lanes left: its direction serves neighbours on both sides, its contact ends the later half.
    const int lane = middleLane(untried);
    untried &= ~(1u << lane);
    if (whole_lanes && towards) {
      guess = laneOf(*towards, lane);
      have_guess = true;
      if (separatesWhole(lane)) continue;
    }
    const DifferenceBody body = seen->differenceAt(a, b, lane);
    if (!have_guess) guess = body.pose.c;
    GjkResult g;
    gjk(body, guess, {kWitnessAccuracy, a.radius + b.radius + seen->margin(), 48}, g, &search.last);
    search.last = g.simplex;
    ++statistics().gjk;
    guess = g.n;
    have_guess = true;
    if (g.overlap) {
      --left;
      onOverlap(lane);
      continue;
    }
    seen->setWitness(g.n);
    // In the frame of the piece with more vertices first: the still piece's range takes one direction, the moving
    // one's 24.
    const Vec3 n = body.opposite(g.n);
    const int first = search.ranges || a.num_vertices > b.num_vertices ? 0 : 1;
    for (int i = 0; i < 2 && mask; ++i) {
      mask &= ~((first + i) & 1 ? separated(seen->side(1), b, a, n, mask) : separatedAlong(g.n));
    }
    if (whole_lanes && !towards && (mask >> lane & 1)) separatesWhole(lane);
    if (seen->stray() > 0 && (mask >> lane & 1) && meetsInTube(seen, pieces, g, lane)) {
      --left;
      onOverlap(lane);
    }
  }
  return mask;
}

/// Whether, halfway through the batch, a small body's middle lies in the box of a large mesh and their hulls are in
/// each other: then hulls would say nothing. (The hulls are taken without their radii: with them GJK may end at a face,
/// from which no depth is known.)
inline bool Traversal::isWithin(Seen seen) {
  for (int s = 0; s < 2; ++s) {
    const Node &large = seen->still(s).nodes[0], &small = seen->moving(s).nodes[0];
    if (seen->still(s).num_pieces == 1 || large.radius < 2 * small.radius) continue;
    const Side& side = seen->side(s);
    const Vec3 x = laneOf(side.m.R[0], kLanes / 2) * middleOf(small) + laneOf(side.m.c[0], kLanes / 2);
    bool inside = true;
    for (int k = 0; k < 3; ++k) inside = inside && x[k] > large.lo[k] && x[k] < large.hi[k];
    if (!inside) continue;
    const Piece &a = *seen->a().outer, &b = *seen->b().outer;
    const DifferenceBody body = seen->differenceAt(a, b, kLanes / 2);
    GjkResult g;
    gjk(body, body.pose.c, {kWitnessAccuracy, 0, 48}, g);
    ++statistics().gjk;
    return g.overlap && depthWithin(g.simplex) > kBarely * small.radius;
  }
  return false;
}

/// Tests the hulls of two bodies, or of a patch and a body. Most pairs of neighbours need no more, before any of their
/// triangles is looked at.
/// @param suspect  overlapping hulls count as suspected contact.
inline Traversal::HullTest Traversal::hullsMayTouch(Seen seen, const Entry& e, bool suspect, LaneSearch search) {
  const TreeView &A = seen->a(), &B = seen->b();
  NodeRoom room_a, room_b;
  const Node &x = nodeOf(A, e.a, room_a), &y = nodeOf(B, e.b, room_b);
  if (x.isLeaf() && y.isLeaf())
    return {provesAny() ? leavesMayTouch(seen, x.piece(), y.piece(), e.mask, true) : e.mask, false, 0};
  if (e.deep || !NodeHull::exists(A, e.a) || !NodeHull::exists(B, e.b)) return {e.mask, false, 0};
  const NodeHull a(A, e.a), b(B, e.b);
  if (e.isWhole() && isWithin(seen)) return {e.mask, true, 0};
  unsigned mask = e.mask, overlaps = 0;
  SweptRanges* const ranges = e.a != 0 && e.b == 0 ? &ranges_ : nullptr;
  if (ranges) ++statistics().node_tests;
  if (ranges && !(mask &= ~ranges->separate(seen, *a, mask, statistics().certificates))) return {0, false, 0};
  const DirectionSearch of_hulls = {kMaxHullOverlaps, simplexOf(e), search, ranges};
  mask = notSeparated(seen, {*a, *b}, mask, of_hulls, [&](int lane) {
    overlaps |= 1u << lane;
    if (provesAny() && proofs_.vertexInside(seen, lane)) return;
    if (suspect) horizon_.suspect(seen->batch().at[lane]);
  });
  return {mask, false, overlaps};
}

/// Lanes of `mask` in which the hulls around what is below two nodes are not certainly apart: a concave body is cut
/// into convex parts by them.
inline unsigned Traversal::partsMayTouch(Seen seen, int a, int b, unsigned mask) {
  const auto part = [](const TreeView& tree, int node, const TreeView& other) -> const Piece* {
    const bool whole = tree.num_pieces == 1 ||
                       (node == 0 && (tree.parts || tree.nodes[0].radius < kLargerNode * other.nodes[0].radius));
    if (whole) return tree.outer;
    return tree.part_of_node && tree.part_of_node[node] >= 0 ? tree.parts + tree.part_of_node[node] : nullptr;
  };
  const TreeView &A = seen->a(), &B = seen->b();
  if (!A.parts && !B.parts) return mask;
  const Piece *x = part(A, a, B), *y = x ? part(B, b, A) : nullptr;
  Simplex last;
  return y ? notSeparated(seen, {*x, *y}, mask, {kMaxPartOverlaps, last}, [](int) {}) : mask;
}

/// Lanes of `mask` in which two leaves are not certainly apart.
/// @param suspect  overlap counts as suspected contact.
inline unsigned Traversal::leavesMayTouch(Seen seen, int piece_a, int piece_b, unsigned mask, bool suspect) {
  ++statistics().leaf_tests;
  const PiecePair pieces(seen->a(), piece_a, seen->b(), piece_b);
  const Piece &a = pieces.a, &b = pieces.b;
  // A direction that keeps neighbours apart mostly serves here too.
  if (seen->witness()) mask &= ~separated(seen->side(0), a, b, *seen->witness(), mask);
  if (mask && hasDirection(a)) mask &= ~separated(seen->side(0), a, b, sizeOf(a), mask);
  if (mask && hasDirection(b)) mask &= ~separated(seen->side(1), b, a, sizeOf(b), mask);
  if (!mask) return 0;
  Simplex last;
  return notSeparated(seen, pieces, mask, {kLanes, last}, [&](int lane) {
    const double t = seen->batch().at[lane];
    if (t < contacts_.watchFrom(seen->pair())) return;
    if (provesAny() && proofs_.leaves(seen, piece_a, piece_b, lane)) return;
    if (suspect) horizon_.suspect(t);
  });
}

/// Pushes the balls of a cluster whose boxes may meet the swept box of a partner. (To divide it by halves takes
/// longer.) Before that, the last direction found is tried on the cluster's box: free motions amid 10^6 points take 2/3
/// of the time so.
/// @param in_a  the cluster is a node of A.
/// @param push  called with an entry of each such ball.
template <class Push>
inline void Traversal::divideCluster(Seen seen, const Entry& e, bool in_a, const Node& cluster, const NodeAt& partner,
                                     const Push& push) {
  const int side = in_a ? 0 : 1;
  const TreeView& cloud = seen->still(side);
  const SweptBox& swept = seen->sweptNode(side, partner.number, partner.node);
  unsigned open = e.mask;
  if (seen->witness() && partner.node.isLeaf()) {
    PieceRoom room;
    const Piece box = boxOf(cluster), &piece = pieceOf(seen->moving(side), partner.node.piece(), room);
    open &= ~(in_a ? separated(seen->side(0), box, piece, *seen->witness(), open)
                   : separated(seen->side(0), piece, box, *seen->witness(), open));
    if (!open) return;
  }
  FCL_ARTIC_ASSERT((in_a ? e.a : e.b) < cloud.num_nodes);  // the traversal comes to no inner node below a cluster
  const int numbers = cluster.child, first = (numbers - cloud.num_nodes) / 2;
  const int size = cloud.balls[first].cluster_size;
  statistics().node_tests += size;
  for (int i = 0; i < size; ++i) {
    FourDoubles lower, upper;
    boundBall(cloud, first + i, lower, upper);
    Node ball;
    setBox(lower, upper, ball);
    const unsigned mask = open & ~apart(swept, ball);
    if (!mask) continue;
    const int number = numbers + kClusterNodes.leaf[size][i];
    push(in_a ? Entry{e.pair, number, e.b, mask} : Entry{e.pair, e.a, number, mask});
  }
}

inline void Traversal::descend(Seen seen, const Entry& root, Aim aim, Buffer<Entry>& open, int begin) {
  FCL_ARTIC_ASSERT(aim != Aim::freeLanes);
  traverse(seen, root, aim, open, begin);
}

inline unsigned Traversal::blockedLanes(Seen seen, unsigned mask) {
  FCL_ARTIC_ASSERT(horizon_.live() == kAllLanes && horizon_.contactLane() == 0);  // all are looked at
  mask = rootsMayTouch(seen, mask);
  if (mask) mask = hullsMayTouch(seen, {seen->pair(), 0, 0, mask}, false, {}).mask;
  return mask ? traverse(seen, {seen->pair(), 0, 0, mask}, Aim::freeLanes, undecided_, 0) : 0;
}

/// Dual traversal. Entries that stay undecided are appended to `open`. With Aim::freeLanes none is: the lanes that are
/// not proven free are returned.
inline unsigned Traversal::traverse(Seen seen, const Entry& root, Aim aim, Buffer<Entry>& open, int begin) {
  FCL_ARTIC_ASSERT(root.pair == seen->pair() && root.mask != 0 && root.mask <= kAllLanes);
  const TreeView &A = seen->a(), &B = seen->b();
  // Earliest lane first: once a contact is found, nothing was spent on later lanes alone.
  const auto push = [&](const Entry& e) { stack_[__builtin_ctz(e.mask)].push(e); };
  const double split_time = aim == Aim::split ? kSplitTime * seen->amplitude() : 0;
  const int max_open = aim == Aim::split ? begin + kMaxOpen : aim == Aim::poses ? begin + kMaxOpenAtPoses : 0x7fffffff;
  unsigned blocked = 0;
  Entry e = root;
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
    if (const unsigned later = e.mask & ~(horizon_.live() & ~blocked)) {
      if (aim == Aim::freeLanes) {
        blocked |= later;
      } else {
        open.push({e.pair, e.a, e.b, later, true});
      }
      e.mask &= ~later;
      if (!e.mask) continue;
    }
    if (horizon_.mustEnd()) break;
    NodeRoom room_a, room_b;
    const Node &x = nodeOf(A, e.a, room_a), &y = nodeOf(B, e.b, room_b);
    if (!e.isWhole() || roots_tested_ != seen->batchNumber()) e.mask = nodesMayTouch(seen, {e.a, x}, {e.b, y}, e.mask);
    if (e.mask && !e.isWhole()) e.mask = partsMayTouch(seen, e.a, e.b, e.mask);
    if (!e.mask) continue;
    if (x.isLeaf() && y.isLeaf()) {
      e.mask = leavesMayTouch(seen, x.piece(), y.piece(), e.mask, aim != Aim::freeLanes);
      if (!e.mask) continue;
      if (aim == Aim::freeLanes) {
        blocked |= e.mask;
      } else {
        open.push(e);
      }
    } else if ((aim != Aim::freeLanes && e.mask == horizon_.contactLane()) ||
               (isSmallerThanMotion(x, split_time) && isSmallerThanMotion(y, split_time)) || open.size() > max_open) {
      open.push(e);
    } else {
      const bool split_a = y.isLeaf() || (!x.isLeaf() && x.radius > y.radius);
      if (isCluster(split_a ? A : B, split_a ? x : y)) {
        divideCluster(seen, e, split_a, split_a ? x : y, split_a ? NodeAt{e.b, y} : NodeAt{e.a, x}, push);
        continue;
      }
      push(split_a ? Entry{e.pair, x.right(), e.b, e.mask} : Entry{e.pair, e.a, y.right(), e.mask});
      (split_a ? e.a : e.b) = (split_a ? x : y).left();
      held = (e.mask >> lane & 1) != 0;
      if (!held) push(e);
    }
  }
  for (Buffer<Entry>& stack : stack_) stack.clear();
  return blocked;
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
