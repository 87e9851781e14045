// SPDX-License-Identifier: BSD-3-Clause
//
// The search for the first contact among the pairs that the stages have left: earliest part of the motion first,
// and in it the pair that meets first.
//
// 1. testHulls(), the first batch: over the eight parts of [0, 1] boxes and then hulls of whole bodies are tested,
//    which part most neighbours before any triangle is examined. GJK finds directions for a whole part of the
//    motion (swept_difference.h), between a link and an obstacle from stage 1's direction on, and witnesses at the
//    middle. If GJK claims an overlap, later parts are put off (Horizon::suspect()); if the claim proves wrong,
//    lookAtPutOff() examines them.
// 2. search(): a problem of one pair, as the drop-in asks it, is followed from its first open part to its last at
//    once. For many pairs descendIntoPieces() traverses their trees over the first batch, and solveLane() takes the
//    parts one after the other.
// 3. solveLane() follows the hulls of each pair to where they meet (Follower::followToRoot()): certificates up to
//    the first root of the gap's bound, then a new direction from there. Two directions show how they turn, and the
//    next certificate's turns likewise: the steps of a secant method.
// 4. The pair that meets first is solved first, and a contact found ends the search in the others. If a mesh is
//    convex, its triangle at the hulls' witness touches at that very time, which is proven at once
//    (proveBelowHulls()). If bodies rest on each other there, pieces at the hulls' witness are tried first
//    (restsAt()); if they are in each other from t = 0 on, triangles that cross there, the first leaves that touch,
//    and triangles that cross within the tolerance after it (touchesAtStart()).
// 5. solvePieces() searches below the hulls: windows of time, each again in eight parts (solveInterval()), with a
//    dual traversal (Traversal::descend()). Swept boxes part pairs of nodes, one box for each node and batch
//    whatever the other node is; so do the hulls around their subtrees, which cut a bent link into convex parts.
//    Triangles' normals, the last direction and GJK's witness at the middle of one part, frozen in either frame,
//    part pairs of leaves; each direction is tried on all parts at once. Nodes smaller than the motion are left to
//    the next level.
// 6. followLeaves() follows the few leaf pairs left in a part one by one: followToRoot() finds t_lower, decide()
//    finds t_upper by proofs of contact within the tolerance after it. If neither decides, the part is divided,
//    down to the tolerance. A pair that is then nearer than the distance tolerance or the pad of rounding is a
//    contact with `certain = false`; of many such pairs kEnoughUncertain are recorded.
#pragma once

#include <utility>

#include "narrowphase/solver/any_contact.h"
#include "narrowphase/solver/earliest_first.h"
#include "narrowphase/solver/resting.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

/// Maximum number of leaf pairs in a lane that are followed one by one; if there are more, the lane is split first.
constexpr int kFewLeaves = 12;
/// Length of the first window of time in which pieces are examined: the motion covers this part of the smaller body's
/// radius in it.
constexpr double kFirstWindow = 0.4;
/// A body's pieces are not examined in lanes of the first batch if half a lane moves it by more than this part of the
/// smaller body's radius.
constexpr double kLongMotion = 0.2;

/// Maximum number of leaf pairs of one lane that are recorded although nothing can be proven of them.
constexpr int kEnoughUncertain = 16;
/// Maximum number of pairs of boxes, as kMostAtPose, that are tested right after the start where nothing was proven at
/// it: a hundredth of a second, where without a proof all that touches is divided down to the finest lanes.
constexpr int kMostAfterStart = 1 << 20;

class PairSearch : PartOfSolver {
 public:
  PairSearch(Task& task, RelativeMotion& motion, Horizon& horizon, ContactList& contacts, Traversal& traversal,
             Follower& follower, AnyContact& any)
      : PartOfSolver(task),
        motion_(motion),
        horizon_(horizon),
        contacts_(contacts),
        traversal_(traversal),
        follower_(follower),
        any_(any) {}

  /// Tests boxes and hulls of whole bodies, in the eight parts of [0, 1], for all pairs of `open`, and removes those
  /// that are apart. Where any contact will do, it is looked for in links whose hulls are not.
  /// @param directionOf  (i) -> the i-th pair's direction, null where there is none (LaneSearch::towards).
  template <class DirectionOf>
  void testHulls(Buffer<Entry>& open, const DirectionOf& directionOf);
  /// Finds the first contact of all pairs of `open`, or of each of them.
  void run(Buffer<Entry>& open);

 private:
  enum class Step { free, done };

  void watch(const TimeBatch& batch) {
    ++statistics().batches;
    horizon_.watch(batch);
  }
  Aim aim() const { return horizon_.isFinest() ? Aim::leaves : Aim::split; }
  bool isLeafPair(const Entry& e) const {
    const PairParts pair = problem().parts(e.pair);
    return body(pair.a).tree->nodes[e.a].isLeaf() && body(pair.b).tree->nodes[e.b].isLeaf();
  }
  /// Whether the present pair moves so far in a lane that only its hulls can be separated, and hardly its pieces,
  /// before the lane is split.
  bool movesFar() const { return motion_.amplitude() > kLongMotion * motion_.smallerRadius(); }

  /// Whether points of both bodies are so near that no proof can separate them. (A direction along which little is
  /// proven says nothing.) What lies within the pad of rounding is near whatever the tolerance: no lane is narrow
  /// enough to prove such a gap.
  bool isNear(double apart) const { return apart <= max(0.5 * query().tolerance_distance, motion_.pad()); }

  /// Of a window in which nothing is divided on.
  double finestWidth() const { return max(query().tolerance_time, kNarrowestLane); }
  /// The end of one that begins at t: the motion may end before.
  double finestEnd(double t) const { return min(1.0, t + finestWidth()); }

  Candidate candidateOf(const Entry& e, double start) const;
  double restingGapOfHulls(int lane, GjkResult& g) {
    ++statistics().gjk;
    return restingGap(motion_, lane, g);
  }
  bool stayNear(const Candidate& f);
  bool restsAt(PairId pair, double t);
  bool touchesAtStart(Buffer<Entry>& open, int begin, int end, int lane);
  bool recordTouching(double t, bool may_rest, bool* near = nullptr);
  void search(Buffer<Entry>& open, int begin, int end);
  void descendIntoPieces(Buffer<Entry>& open, int begin, int end);
  void lookAtPutOff(Buffer<Entry>& open, int begin, unsigned later);
  void solveLane(Buffer<Entry>& open, double start, double stop, int lane, int begin, int end,
                 unsigned first_lanes = 0);
  void solvePieces(Buffer<Entry>& open, const Candidate& f, double stop, int lane);
  Step solveInterval(Buffer<Entry>& open, double start, double width, int begin, int end, int parent_lane);
  Step solveOpenLane(Buffer<Entry>& open, double start, double width, int begin, int end, int lane, bool finest);
  Step followLeaves(const Buffer<Entry>& open, double start, double width, int begin, int end, int lane, bool finest,
                    bool* split);

  RelativeMotion& motion_;
  Horizon& horizon_;
  ContactList& contacts_;
  Traversal& traversal_;
  Follower& follower_;
  AnyContact& any_;
  Buffer<Candidate> candidates_;  ///< of a lane of the first batch
  EarliestFirst earliest_first_;  ///< of these, by the times until which they are proven free
  Buffer<Candidate> leaves_;      ///< of a narrower lane
  Buffer<Candidate> touching_;    ///< at one time
  int splits_at_start_ = 0;       ///< divisions of the lane that begins at 0 before touchesAtStart() is asked
};

/// What an entry stands for, to be followed from `start`.
inline Candidate PairSearch::candidateOf(const Entry& e, double start) const {
  const PairParts pair = problem().parts(e.pair);
  Candidate f = {};
  f.entry = e;
  f.t_lower = max(start, contacts_.watchFrom(e.pair));
  f.apart = kFarApart;
  f.piece_a = body(pair.a).tree->nodes[e.a].piece();
  f.piece_b = body(pair.b).tree->nodes[e.b].piece();
  return f;
}

/// Whether hulls that were followed to f.t_lower are where bodies rest, and do not just pass there on their way into
/// each other.
inline bool PairSearch::stayNear(const Candidate& f) {
  constexpr double kLater = 64;
  const TreeView &A = *body(problem().parts(f.entry.pair).a).tree, &B = *body(problem().parts(f.entry.pair).b).tree;
  motion_.set(f.entry.pair, TimeBatch::around(min(1.0, f.t_lower + kLater * query().tolerance_time)));
  if (depthWithin(f.simplex) > kShallow * motion_.smallerRadius()) return false;
  if (f.t_lower == 0 || !f.have_normal) return true;
  DifferencePoint lowest;
  motion_.differenceAt(*A.outer, *B.outer, 0).support(f.normal, lowest);
  return isNear(-(dot(f.normal, lowest.w) - A.outer->radius - B.outer->radius - motion_.margin()));
}

/// A pair whose hulls touch at t, before which all is free, may rest there, like a cup on a table. Pieces around the
/// hulls' witness are examined by themselves: where contact of two of them at t is proven, or no proof separates them,
/// no contact is earlier, and it is recorded. (Without it thousands of pairs of coplanar triangles are divided down to
/// the finest lanes, of which none can be proven: 27 ms where 10 um farther up it is 6 us.)
/// @return false where others may touch earlier.
inline bool PairSearch::restsAt(PairId pair, double t) {
  const PairParts parts = problem().parts(pair);
  const TreeView &A = *body(parts.a).tree, &B = *body(parts.b).tree;
  if (contacts_.watchFrom(pair) > t) return false;
  motion_.set(pair, TimeBatch::partsOf(t, finestEnd(t) - t));
  GjkResult g;
  if (restingGapOfHulls(0, g) < -kShallow * motion_.smallerRadius()) return false;
  if (!g.overlap && !isNear(g.distance - (A.outer->radius + B.outer->radius + motion_.margin()))) return false;
  if (g.overlap && !originWeights(g.simplex)) return false;
  Vec3 x(0, 0, 0), y(0, 0, 0);  // the witness, in each body's own frame
  for (int i = 0; i < g.simplex.n; ++i) {
    x = x + g.simplex.v[i].a * g.simplex.weight[i];
    y = y + g.simplex.v[i].b * g.simplex.weight[i];
  }
  std::int32_t near_a[kMostAround], near_b[kMostAround];
  const double reach = max(query().tolerance_distance, motion_.pad());
  const int num_a = piecesAround(A, g.simplex, true, x, A.outer->radius + motion_.margin() + reach, near_a);
  const int num_b = piecesAround(B, g.simplex, false, y, B.outer->radius + motion_.margin() + reach, near_b);
  touching_.clear();
  for (int i = 0; i < num_a * num_b; ++i) {
    Candidate f = candidateOf({pair, 0, 0, kAllLanes}, t);
    f.piece_a = near_a[i / num_b];
    f.piece_b = near_b[i % num_b];
    touching_.push(f);
  }
  return recordTouching(t, true);
}

/// For bodies that overlap at t = 0: triangles that cross there are the contact, or the first leaves that touch; it
/// does not matter how many others do. (Without it all of them are divided down to the finest lanes.) Where no contact
/// of them is proven, triangles may cross within the tolerance after it: a body that begins as its own copy shares
/// faces and edges with it at first, and soon crosses it along a line, which is looked for all over.
/// @param begin, end  entries of `open` that are left of one pair, those of this lane.
/// @return false where others may touch earlier.
inline bool PairSearch::touchesAtStart(Buffer<Entry>& open, int begin, int end, int lane) {
  const PairId pair = open[begin].pair;
  const int out_begin = open.size();
  if (contacts_.watchFrom(pair) > 0) return false;
  if (any_.tryTriangles(pair, TimeBatch::around(0), 0, kMostAtPose)) return true;
  const TimeBatch batch = TimeBatch::partsOf(0, finestEnd(0));
  watch(batch);
  motion_.set(pair, batch);
  for (int i = begin; i < end && open.size() < out_begin + kEnoughUncertain; ++i) {
    const Entry e = open[i];
    if (e.isOpenIn(lane)) traversal_.descend({pair, e.a, e.b, 1}, Aim::poses, open);
  }
  touching_.clear();
  for (int i = out_begin; i < open.size() && touching_.size() < kEnoughUncertain; ++i) {
    if (isLeafPair(open[i])) touching_.push(candidateOf(open[i], 0));
  }
  open.truncate(out_begin);
  bool near;
  if (recordTouching(0, false, &near)) return true;
  if (!near) return false;
  const TimeBatch after = TimeBatch::around(min(1.0, 0.5 * query().tolerance_time));
  return any_.tryTriangles(pair, after, 0, kMostAfterStart);
}

/// Whether a leaf pair of `touching_` touches at t; it is recorded.
/// @param may_rest  also record one that no proof can separate from contact.
/// @param[out] near  there is such a one.
inline bool PairSearch::recordTouching(double t, bool may_rest, bool* near) {
  const double stop = finestEnd(t);
  Candidate resting = {};
  int uncertain = 0;
  for (int i = 0; i < touching_.size() && (!may_rest || uncertain < kMostAround); ++i) {
    Candidate& f = touching_[i];
    f.target = Candidate::Target::leafPair;
    const auto isOpen = [&] { return f.t_lower <= t && isNear(f.apart); };
    if (follower_.followToRoot(f, stop, false)) continue;
    if (!f.certain && (!isOpen() || follower_.decide(f, stop))) continue;
    if (f.certain) {
      follower_.record(f);
      if (f.t_lower <= t || horizon_.isOver()) return true;
    } else if (isOpen() && uncertain++ == 0) {
      resting = f;
    }
  }
  if (near) *near = uncertain > 0;
  if (uncertain == 0 || !may_rest) return false;
  horizon_.closeAt(t + query().tolerance_time);
  follower_.record(resting);
  return true;
}

template <class DirectionOf>
inline void PairSearch::testHulls(Buffer<Entry>& open, const DirectionOf& directionOf) {
  any_.forgetOverlaps();
  const int roots = open.size();
  int kept = 0;
  const Buffer<std::int32_t>& order = any_.deepestFirst(open);
  for (int n = 0; n < roots && !horizon_.isOver(); ++n) {
    const int i = order.size() ? order[n] : n;
    Entry& e = open[i];
    if (e.mask & horizon_.live()) {
      motion_.set(e.pair, whole());
      traversal_.rootsAreTested();
      e.mask = traversal_.nodesMayTouch(0, 0, e.mask);
      if (e.mask) {
        const bool suspect = !query().every_pair && movesFar();
        const Traversal::HullLook look = traversal_.hullsMayTouch(e.mask, suspect, {true, directionOf(i)});
        e.mask = look.mask;
        e.within = look.within;
        if (look.overlaps) any_.guessOverlap(e.pair, look.overlaps);
        if (e.mask && !horizon_.isOver()) any_.tryLinks(e);
      }
      horizon_.mustEnd();
    }
  }
  if (horizon_.isOver()) return;
  for (int i = 0; i < roots; ++i) {
    if (open[i].mask) open[kept++] = open[i];
  }
  open.truncate(kept);
}

inline void PairSearch::run(Buffer<Entry>& open) {
  const int roots = open.size();
  if (!query().every_pair) return search(open, 0, roots);
  for (int i = 0; i < roots && !task_.ended(); ++i) {
    const int before = contacts_.size();
    open.truncate(roots);
    horizon_.dropSuspicion();
    watch(whole());
    search(open, i, i + 1);
    contacts_.order(before, horizon_.end());
  }
}

/// The pairs of open[begin, end), over [0, 1]; what is appended meanwhile is left there.
inline void PairSearch::search(Buffer<Entry>& open, int begin, int end) {
  horizon_.beginSearch();
  const int from = open.size();
  if (problem().num_movers == 0 && end - begin == 1) {
    // A problem of one pair needs no order among pairs: it is followed from its first open lane to its last. (Where
    // stage 1 or 2 has left one of many, it goes the way of the others: what they discard is not to change an
    // answer's bits.)
    const Entry& e = open[begin];
    motion_.set(e.pair, whole());
    if (isLeafPair(e) || (motion_.a().outer && motion_.b().outer && movesFar())) {
      const unsigned lanes = e.mask;
      const double start = 0.125 * __builtin_ctz(lanes), stop = 0.125 * (32 - __builtin_clz(lanes));
      return solveLane(open, start, stop, -1, begin, end, contacts_.watchFrom(e.pair) > 0 ? 0 : lanes);
    }
  }
  descendIntoPieces(open, begin, end);
  for (int lane = 0; lane < kLanes && 0.125 * lane < horizon_.end() && !horizon_.isOver(); ++lane) {
    solveLane(open, 0.125 * lane, 0.125 * (lane + 1), lane, from, open.size());
    const unsigned later = kAllLanes & ~((2u << lane) - 1);
    if (later && horizon_.end() > 0.125 * (lane + 1)) lookAtPutOff(open, from, later);
  }
}

/// Traverses the trees from open[begin, end) on, over the first batch. What stays undecided is appended.
inline void PairSearch::descendIntoPieces(Buffer<Entry>& open, int begin, int end) {
  for (int i = begin; i < end && !horizon_.isOver(); ++i) {
    const Entry e = open[i];
    if (!e.mask) continue;
    motion_.set(e.pair, whole());
    bool whole_first = movesFar() && !e.within;
    if (!whole_first && !e.within && !isLeafPair(e) && motion_.a().outer && motion_.b().outer) {
      GjkResult g;
      const double gap = abs(restingGapOfHulls(__builtin_ctz(e.mask), g)) / motion_.smallerRadius();
      whole_first = gap <= kBarely;
      if (!whole_first && gap <= kShallow && (e.mask & 1) && restsAt(e.pair, 0)) continue;
      motion_.set(e.pair, whole());
    }
    if (whole_first) {
      open.push({e.pair, e.a, e.b, e.mask});
    } else {
      traversal_.descend({e.pair, e.a, e.b, e.mask}, aim(), open);
    }
  }
}

/// Examines the entries of open[begin, ...) that were put off after all, if there are any in the next lane: the contact
/// that was suspected is none.
/// @param later  lanes of the first batch that are still to come.
inline void PairSearch::lookAtPutOff(Buffer<Entry>& open, int begin, unsigned later) {
  const int end = open.size();
  const unsigned next = later & (~later + 1);
  bool any = false;
  for (int i = begin; i < end; ++i) any = any || (open[i].put_off && (open[i].mask & next));
  if (!any) return;
  horizon_.dropSuspicion();
  watch(whole());
  for (int i = begin; i < end; ++i) {
    const Entry e = open[i];
    if (!e.put_off) continue;
    open[i].mask = 0;
    open[i].put_off = false;
    if (!(e.mask & later)) continue;
    motion_.set(e.pair, whole());
    traversal_.descend({e.pair, e.a, e.b, e.mask & later}, aim(), open);
  }
}

/// Searches one part of the motion: the pairs that may touch in it, in the order in which they meet.
/// @param lane  of the first batch, whose entries count; -1: all do.
/// @param first_lanes  see Follower::followToRoot().
inline void PairSearch::solveLane(Buffer<Entry>& open, double start, double stop, int lane, int begin, int end,
                                  unsigned first_lanes) {
  using Target = Candidate::Target;
  candidates_.clear();
  earliest_first_.clear();
  const int roots = open.size();
  const bool suspected = lane == 0 && horizon_.contactLane() == 1;  // in this lane
  for (int i = begin; i < end && !horizon_.isOver();) {
    // A run of entries of one pair.
    const int first = open.size();
    const PairId pair_id = open[i].pair;
    bool leaves = true;
    for (; i < end && open[i].pair == pair_id; ++i) {
      const Entry e = open[i];
      if (!e.isOpenIn(lane)) continue;
      leaves = leaves && isLeafPair(e);
      open.push(e);
    }
    const int count = open.size() - first;
    if (count == 0) continue;
    Candidate f = candidateOf(open[first], start);
    f.first = first;
    f.count = count;
    // What is left may be one leaf pair, which is followed at once; whole bodies, of which the hulls are followed; or
    // parts of them that the first batch has come to already.
    const PairParts pair = problem().parts(pair_id);
    const bool hulls = f.entry.isWhole() && !leaves && body(pair.a).tree->outer && body(pair.b).tree->outer;
    f.target = hulls ? Target::hulls : leaves && count == 1 ? Target::leafPair : Target::subtrees;
    if (hulls) f.simplex = traversal_.simplexOf(pair_id);
    if (f.t_lower >= stop || (f.target != Target::subtrees && follower_.followToRoot(f, stop, false, first_lanes))) {
      open.truncate(first);
      continue;
    }
    if (f.certain) return follower_.record(f);
    earliest_first_.add(f.t_lower, candidates_.size());
    candidates_.push(f);
    horizon_.mustEnd();
  }
  while (!earliest_first_.empty() && !horizon_.isOver()) {
    Candidate f = candidates_[earliest_first_.take()];
    horizon_.provenFree(f.t_lower);
    if (f.t_lower >= horizon_.end()) break;
    if (f.isHulls()) {
      follower_.proveBelowHulls(f);
      if (!f.certain && stayNear(f) && restsAt(f.entry.pair, f.t_lower)) continue;
    }
    if (f.isLeafPair() && !f.certain && follower_.decide(f, stop)) continue;
    if (f.certain) {
      follower_.record(f);
      continue;
    }
    horizon_.dropSuspicion();
    // Where something else rests at the start, the search ends there: lanes as narrow as they get, in which nothing is
    // put off, would have all leaves of what is deep in each other asked (14 ms for a link in a table; now 0.1).
    const bool ends_at_start = f.t_lower == 0 && horizon_.end() <= finestWidth();
    if (ends_at_start && touchesAtStart(open, f.first, f.first + f.count, lane)) continue;
    splits_at_start_ = suspected ? 0 : 1;
    solvePieces(open, f, stop, lane);
  }
  open.truncate(roots);
  FCL_ARTIC_ASSERT(horizon_.provenFreeUntil() <= stop);
  if (!horizon_.isOver()) horizon_.provenFree(stop);
}

/// Searches the pieces of one pair, in a lane of the first batch. Windows of time start short, since surfaces are near
/// where hulls meet: the smaller body moves kFirstWindow of its radius. They grow eightfold.
inline void PairSearch::solvePieces(Buffer<Entry>& open, const Candidate& f, double stop, int lane) {
  const int begin = f.first, end = f.first + f.count, roots = open.size();
  if (f.target == Candidate::Target::subtrees) {
    solveOpenLane(open, f.t_lower, stop - f.t_lower, begin, end, lane, false);
    open.truncate(roots);
    return;
  }
  motion_.setWitness(f.entry.pair, f.have_normal ? &f.normal : nullptr);
  const PairParts pair = problem().parts(f.entry.pair);
  const double size = kFirstWindow * min(body(pair.a).tree->nodes[0].radius, body(pair.b).tree->nodes[0].radius);
  stop = min(stop, horizon_.end());
  double span = f.speed * (stop - f.t_lower) > size ? max(size / f.speed, kNarrowestLane) : stop - f.t_lower;
  for (double t = f.t_lower; t < min(stop, horizon_.end()); span *= 8) {
    const double next = t + 1.5 * span < min(stop, horizon_.end()) ? t + span : min(stop, horizon_.end());
    const Step step = solveInterval(open, t, next - t, begin, end, lane);
    open.truncate(roots);
    if (step == Step::done) return;
    t = next;
  }
}

/// One batch over [start, start + width] for open[begin, end), of which those with parent_lane set count (all, when
/// parent_lane < 0). The pair is proven free before `start`.
inline PairSearch::Step PairSearch::solveInterval(Buffer<Entry>& open, double start, double width, int begin, int end,
                                                  int parent_lane) {
  FCL_ARTIC_ASSERT(begin < end);
  const TimeBatch batch = TimeBatch::partsOf(start, width);
  watch(batch);
  if (task_.ended()) return Step::done;
  const int out_begin = open.size();
  const bool finest = horizon_.isFinest();
  for (int i = begin; i < end; ++i) {
    const Entry e = open[i];
    if (!e.isOpenIn(parent_lane)) continue;
    motion_.set(e.pair, batch);
    traversal_.descend({e.pair, e.a, e.b, kAllLanes}, aim(), open);
    if (horizon_.isOver()) return Step::done;
  }
  const int out_end = open.size();
  for (int lane = 0; lane < kLanes; ++lane) {
    if (batch.start[lane] >= horizon_.end()) break;
    if (solveOpenLane(open, batch.start[lane], batch.width, out_begin, out_end, lane, finest) == Step::done) {
      return Step::done;
    }
    open.truncate(out_end);
  }
  return Step::free;
}

/// Decides a lane that some of open[begin, end), of one pair, leave undecided: few leaf pairs are followed one by one;
/// else the lane is split.
inline PairSearch::Step PairSearch::solveOpenLane(Buffer<Entry>& open, double start, double width, int begin, int end,
                                                  int lane, bool finest) {
  int count = 0;
  bool leaves = true;
  for (int i = begin; i < end && (finest || count <= kFewLeaves); ++i) {
    const Entry& e = open[i];
    if (!e.isOpenIn(lane)) continue;
    ++count;
    leaves = leaves && isLeafPair(e);
  }
  if (!count) return Step::free;
  bool split = true;
  if (leaves && (finest || count <= kFewLeaves)) {
    if (followLeaves(open, start, width, begin, end, lane, finest, &split) == Step::done) return Step::done;
  }
  if (!split) return Step::free;
  if (start == 0 && splits_at_start_-- == 0 && touchesAtStart(open, begin, end, lane)) return Step::done;
  return solveInterval(open, start, width, begin, end, lane);
}

/// The leaf pairs that a lane leaves undecided, one by one: how far is each free, and is there contact?
/// @param[out] split  the lane is to be split: it is wider than the tolerance, or the pairs are farther apart than the
///   distance tolerance, and nothing is proven.
inline PairSearch::Step PairSearch::followLeaves(const Buffer<Entry>& open, double start, double width, int begin,
                                                 int end, int lane, bool finest, bool* split) {
  const double stop = start + width;
  leaves_.clear();
  for (int i = begin; i < end; ++i) {
    if (open[i].isOpenIn(lane)) leaves_.push(candidateOf(open[i], start));
  }
  *split = false;
  // Of many that can be neither proven apart nor in contact, some are enough: what is not looked at counts as touching
  // from the lane's begin on. They are taken from all over the list, for neighbours in it are alike.
  const int stride = leaves_.size() / kEnoughUncertain;
  for (int i = 1; stride > 1 && i < kEnoughUncertain; ++i) std::swap(leaves_[i], leaves_[i * stride]);
  int uncertain = 0;
  for (int i = 0; i < leaves_.size(); ++i) {
    Candidate& f = leaves_[i];
    if (!follower_.followToRoot(f, stop, false) && !f.certain) follower_.decide(f, stop);
    if (horizon_.mustEnd()) return Step::done;
    uncertain += f.stuck && !f.certain && isNear(f.apart);
    if (uncertain >= kEnoughUncertain && i + 1 < leaves_.size()) {
      f.t_lower = max(start, contacts_.watchFrom(f.entry.pair));
      leaves_.truncate(i + 1);
    }
    // It touches from the beginning on: nothing can be earlier, and of many such pairs some are enough.
    const bool enough = f.certain && f.t_lower <= start && i >= 64;
    if (enough || horizon_.isOver()) leaves_.truncate(i + 1);
  }
  const bool narrow = width <= kNarrowestLane;
  // (Where any contact will do and one is proven, it is recorded whatever is still open.)
  for (int i = 0; i < leaves_.size() && !horizon_.isOver(); ++i) {
    const Candidate& f = leaves_[i];
    if (!f.stuck || f.certain || f.t_lower >= horizon_.end()) continue;
    if (!narrow && (!finest || !isNear(f.apart))) {
      // What is proven meanwhile is kept: its time is the answer's already, and the narrower lanes may prove a later
      // one.
      for (int k = 0; k < leaves_.size(); ++k) {
        if (leaves_[k].certain) follower_.record(leaves_[k]);
      }
      *split = true;
      return Step::free;
    }
    horizon_.closeAt(f.t_lower + query().tolerance_time);
  }
  const int before = contacts_.size();
  for (int i = 0; i < leaves_.size(); ++i) {
    if (leaves_[i].stuck && leaves_[i].t_lower <= horizon_.end()) follower_.record(leaves_[i]);
  }
  return contacts_.size() > before ? Step::done : Step::free;
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
