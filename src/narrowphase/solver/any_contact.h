// SPDX-License-Identifier: BSD-3-Clause
//
// Poses at which contact is likely, for queries that any contact answers: they are tried before any pair is followed,
// and the first proof ends the query. No guess is trusted: a contact that is reported is proven, and its time is the
// pose's.
//
// 1. Before stage 1, tryLikely(): balls inside two links, in the middle of a part for which an advisor suggests that
//    they meet.
// 2. In stage 1, tryObstacle(), for a link deep in a solid: a ball inside the link, a hull's vertex in the solid, a
//    chord of the solid through a triangle.
//    tryPatch(), for a body deep in a node of a large one: of a mesh in the hand a vertex in the solid; pieces below
//    the node.
// 3. In stage 1, considerLinks(): a ball inside a link in a ball inside another, in the pose in which their line
//    swept spheres are deepest in each other.
// 4. In the first batch (PairSearch::testHulls()) pair by pair, links deepest in each other first (deepestFirst()). If
//    the hulls are not proven apart, tryLinks() tries balls inside the links at all other poses in which these may
//    meet. If the links are deep in each other, it also tests their nodes' boxes by the six axes, in one pose, down to
//    triangles. Contact is proven if an edge of one certainly pierces another.
// 5. tryOverlaps(): leaves at the middle of a part in which hulls overlap, unless the pair rests from the start on.
// 6. tryEnds(): the start or the end of the motion, of what the first batch leaves in the part beside it alone.
// 7. In the search, Follower::proveAhead(): the pieces at a followed pair's witness, a little after the contact
//    expected.
#pragma once

#include "narrowphase/solver/ball_proofs.h"
#include "narrowphase/solver/earliest_first.h"
#include "narrowphase/solver/resting.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

class AnyContact : PartOfSolver {
 public:
  AnyContact(SearchState& state, BallProofs& balls, PoseProofs& proofs, Traversal& traversal)
      : PartOfSolver(state.task),
        frames_(state.frames),
        motions_(state.motions),
        horizon_(state.horizon),
        contacts_(state.contacts),
        balls_(balls),
        proofs_(proofs),
        traversal_(traversal) {}

  void begin() {
    overlap_guesses_.clear();
    pose_guesses_.clear();
  }

  /// Whether any contact answers the query.
  bool isWanted() const { return query().any && !query().every_pair && contacts_.watching(); }
  bool tryLikely();
  /// Hulls of a pair overlap, or so it seems, in the middles of these lanes of [0, 1].
  /// @param node_a  the node of body A: the root, or a patch.
  void guessOverlap(PairId pair, unsigned lanes, std::int32_t node_a = 0) {
    overlap_guesses_.push({pair, node_a, 0, lanes});
  }
  void forgetOverlaps() { overlap_guesses_.clear(); }
  bool tryObstacle(PairId pair, int lane, const Vec3& near, bool thin);
  void considerLinks(PairId pair, Lanes square, double radii);
  bool tryPatch(const Entry& e);
  const Buffer<std::int32_t>& deepestFirst(const Buffer<Entry>& open);
  bool tryLinks(const Entry& e);
  bool tryOverlaps(Buffer<Entry>& open);
  bool tryEnds(const Buffer<Entry>& open);

 private:
  bool isLeafPair(PairId pair) const;
  bool restsFromTheStart(const Entry& e);
  bool tryLeafPair(PairId pair, int lane);

  SweptFrames& frames_;
  RelativeMotions& motions_;
  Horizon& horizon_;
  const ContactList& contacts_;
  BallProofs& balls_;
  PoseProofs& proofs_;
  Traversal& traversal_;

  Buffer<Entry> overlap_guesses_;
  /// A pose at which contact of two links is expected.
  struct PoseGuess {
    PairId pair;
    std::int32_t lane;
    double distance;  ///< of their line swept spheres' segments, as part of the radii
    unsigned near;    ///< other lanes in which balls inside them may meet

    bool isDeep() const { return distance < kDeepLinks; }
  };
  /// Null: there is none.
  const PoseGuess* guessOf(PairId pair) const {
    int begin = 0;
    for (int end = pose_guesses_.size(); begin < end;) {
      const int middle = begin + (end - begin) / 2;
      if (engine::indexOf(pose_guesses_[middle].pair) < engine::indexOf(pair)) {
        begin = middle + 1;
      } else {
        end = middle;
      }
    }
    const bool found = begin < pose_guesses_.size() && pose_guesses_[begin].pair == pair;
    return found ? &pose_guesses_[begin] : nullptr;
  }

  Buffer<PoseGuess> pose_guesses_;  ///< in the order of pairs
  EarliestFirst deepest_first_;     ///< by distance
  Buffer<std::int32_t> order_;
};

/// Tries balls inside links where the query's advisors expect the balls to meet. (Its code is kept apart from that of
/// other queries.)
[[gnu::noinline, gnu::cold]] inline bool AnyContact::tryLikely() {
  frames_.set(whole());
  for (int n = 0; n < query().num_advisors; ++n) {
    const engine::Advisor& advisor = query().advisors[n];
    std::int32_t count = 0;
    const engine::LikelyContact* likely = advisor.suggest ? advisor.suggest(advisor.self, count) : nullptr;
    for (std::int32_t i = 0; i < count; ++i) {
      const auto [link_pair, part] = likely[i];
      FCL_ARTIC_ASSERT(link_pair >= 0 && link_pair < problem().num_link_pairs && part >= 0 && part < kLanes);
      const PairId pair = problem().linkPair(link_pair);
      if (!problem().isAllowed(pair) && balls_.inLinks(pair, part)) return true;
    }
  }
  return false;
}

/// Whether both bodies are one convex piece each.
inline bool AnyContact::isLeafPair(PairId pair) const {
  const PairParts bodies = problem().parts(pair);
  return body(bodies.a).tree->num_pieces == 1 && body(bodies.b).tree->num_pieces == 1;
}

/// Tries the common point that GJK finds of two bodies of one piece each.
inline bool AnyContact::tryLeafPair(PairId pair, int lane) {
  return proofs_.leaves(motions_.of(pair, whole()), 0, 0, lane);
}

/// For a link whose line swept sphere is deep in a solid. Tries a ball inside the link, a vertex in the solid, and a
/// chord of the solid; if the solid is thin, the chord before the vertex. If both are of one piece, tries a common
/// point.
/// @param near  the point, in the solid's tree frame, where the link's segment is nearest to it.
inline bool AnyContact::tryObstacle(PairId pair, int lane, const Vec3& near, bool thin) {
  if (isLeafPair(pair)) return tryLeafPair(pair, lane);
  if (balls_.inSolid(pair, lane)) return true;
  const Seen seen = motions_.of(pair, whole());
  if (thin && proofs_.chordPierces(seen, lane, near)) return true;
  if (proofs_.vertexInside(seen, lane)) return true;
  return !thin && proofs_.chordPierces(seen, lane, near);
}

/// For two links whose line swept spheres meet. Tries balls inside them at the pose at which the spheres are deepest in
/// each other. If both are of one piece, tries a common point. Stores that pose, and the others at which balls may
/// meet, as guesses.
/// @param square  of their segments' distance in the middle of each lane.
inline void AnyContact::considerLinks(PairId pair, Lanes square, double radii) {
  const double least = minLane(square), distance = sqrt(least) / radii;
  const int lane = __builtin_ctz(kAllLanes & ~greater(square, Lanes(least)));
  if (isLeafPair(pair)) {
    if (distance < kDeepLinks) tryLeafPair(pair, lane);
    return;
  }
  const double reach = balls_.ballReach(pair);
  unsigned near = reach > 0 ? kAllLanes & ~greater(square, Lanes(reach * reach)) : 0;
  if (near && balls_.inLinks(pair, lane)) return;
  near &= ~(1u << lane);
  if (!near && distance >= kDeepLinks) return;
  FCL_ARTIC_ASSERT(!pose_guesses_.size() ||
                   engine::indexOf(pose_guesses_[pose_guesses_.size() - 1].pair) < engine::indexOf(pair));
  pose_guesses_.push({pair, lane, distance, near});
}

/// For a body deep in a node of a large one, in the lane in which it is deepest. Where a mesh is carried into a solid,
/// tries a vertex of its hull in the solid. Then tries pieces below the node. (A Panda with a mesh of 10^4 triangles:
/// without the vertex any contact takes a tenth longer; with four times the boxes of what is carried, 5 %.)
inline bool AnyContact::tryPatch(const Entry& e) {
  const Seen seen = motions_.of(e.pair, whole());
  const bool is_carried = e.b != 0;
  if (is_carried && isSolid(seen->a()) && proofs_.vertexInside(seen, e.deepest)) return true;
  return proofs_.anyPieces(seen, e.deepest, is_carried ? kMaxBoxPairs / 4 : kMaxBoxPairs, e);
}

/// Returns the order in which pairs are to be looked at, as indices into `open`. Links deep in each other come first,
/// the deepest before the others. All other pairs follow as they stand. Empty: all as they stand.
inline const Buffer<std::int32_t>& AnyContact::deepestFirst(const Buffer<Entry>& open) {
  order_.clear();
  deepest_first_.clear();
  const auto distance = [&](int i) {
    const PoseGuess* const guess = pose_guesses_.size() ? guessOf(open[i].pair) : nullptr;
    return guess && guess->isDeep() ? guess->distance : static_cast<double>(open[i].nearness);
  };
  const auto isDeep = [&](int i) { return distance(i) < static_cast<double>(kNotDeep); };
  for (int i = 0; i < open.size(); ++i) {
    if (isDeep(i)) deepest_first_.add(distance(i), i);
  }
  if (deepest_first_.empty()) return order_;
  while (!deepest_first_.empty()) order_.push(deepest_first_.take());
  for (int i = 0; i < open.size(); ++i) {
    if (!isDeep(i)) order_.push(i);
  }
  return order_;
}

/// For links whose line swept spheres meet, and whose hulls are not proven apart. Tries balls inside them at all other
/// poses at which the balls may meet. If the spheres are deep in each other, tries triangles at the pose at which they
/// are deepest.
/// @param e  only its lanes are tried.
inline bool AnyContact::tryLinks(const Entry& e) {
  if (e.deepest >= 0 && (e.mask >> e.deepest & 1)) {  // (to try a vertex for each patch takes longer)
    return proofs_.anyPieces(motions_.of(e.pair, whole()), e.deepest, kMaxBoxPairs, e);
  }
  const PoseGuess* const guess = guessOf(e.pair);
  if (!guess) return false;
  frames_.set(whole());
  for (unsigned near = guess->near & e.mask; near; near &= near - 1) {
    if (balls_.inLinks(e.pair, __builtin_ctz(near))) return true;
  }
  if (!guess->isDeep() || !(e.mask >> guess->lane & 1)) return false;
  return proofs_.anyTriangles(motions_.of(e.pair, whole()), guess->lane, kMaxBoxPairs, e);
}

/// Whether a pair whose hulls overlap rests at t = 0, or nearly so: then it may do so at all poses, with many pieces of
/// which nothing can be proven. (Without it any contact of two arms on their table took 100 us; now 27.)
inline bool AnyContact::restsFromTheStart(const Entry& e) {
  const Seen seen = motions_.of(e.pair, whole());
  const TreeView &A = seen->a(), &B = seen->b();
  const double shallow = kShallow * seen->smallerRadius();
  if (leafPieceOf(A, e.a) >= 0 && leafPieceOf(B, e.b) >= 0) return false;
  if (e.deep || !NodeHull::exists(A, e.a) || !NodeHull::exists(B, e.b) ||
      depthWithin(traversal_.simplexOf(e)) > shallow)
    return false;
  GjkResult g;
  ++statistics().gjk;
  return abs(restingGap(seen, e, 0, g)) <= shallow;
}

/// Tries the poses in the middles of the lanes in which hulls overlap, with all pieces.
/// @param open  scratch for what the traversals leave; as before on return.
/// @return true when the search is over: contact is proven, or the query has ended.
inline bool AnyContact::tryOverlaps(Buffer<Entry>& open) {
  if (overlap_guesses_.size() == 0) return false;
  const TimeBatch middles = TimeBatch::middles();
  horizon_.dropSuspicion();
  horizon_.setBatch(middles);
  const int roots = open.size();
  for (int i = 0; i < overlap_guesses_.size() && !horizon_.isOver(); ++i) {
    const Entry& e = overlap_guesses_[i];
    if (restsFromTheStart(e)) continue;
    traversal_.descend(motions_.of(e.pair, middles), e, Aim::poses, open);
    open.truncate(roots);
  }
  horizon_.dropSuspicion();
  horizon_.setBatch(whole());
  return horizon_.isOver();
}

/// Tries the start or the end of the motion, for pairs and patches that may touch in the part beside it alone: a few
/// pieces of each. (Of 300 contacts of a Panda with a cloud of 10^6 points, four such took half of the time.)
/// @param open  what the first batch has left.
inline bool AnyContact::tryEnds(const Buffer<Entry>& open) {
  if (!isWanted()) return false;
  for (int i = 0; i < open.size() && !horizon_.isOver(); ++i) {
    const Entry& e = open[i];
    const bool last = e.mask == 1u << (kLanes - 1);
    if (!last && e.mask != 1) continue;
    if (proofs_.anyPieces(motions_.of(e.pair, TimeBatch::around(last)), 0, kMaxBoxPairs / 4, e)) return true;
  }
  return false;
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
