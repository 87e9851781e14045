// SPDX-License-Identifier: BSD-3-Clause
//
// The search for the first contact among the pairs that the stages have left: earliest part of the motion first,
// and in it the pair that meets first.
//
// A *part* is one of the eight equal intervals of a batch of time, the lanes.
//
// 1. testHulls(), the first batch: over the eight parts of [0, 1] it tests boxes and then hulls of whole bodies. They
//    prove most neighbours apart before any triangle is examined. GJK finds directions for a whole part of the motion
//    (swept_difference.h), between a link and an obstacle from stage 1's direction on, and witnesses at the middle. If
//    GJK claims an overlap in a part, contact is suspected there, and later parts are put off (Horizon::suspect()). If
//    the suspicion proves wrong, lookAtPutOff() examines them.
//    Each patch of a large body is tested by itself: its piece, or its box, against the link's hull.
// 2. search(): a problem of one pair, as the drop-in asks it, is followed from its first open part to its last at
//    once. For many pairs descendIntoPieces() traverses their trees over the first batch, and solveLane() takes the
//    parts one after the other. Bodies that move little in a part are looked at by decideByHulls() first: it follows
//    their hulls to where these meet. Most bodies' pieces meet there, too.
// 3. solveLane() follows the hulls of each pair to where they meet (Follower::followToRoot()): certificates up to
//    the first root of the gap's bound, then a new direction from there. Two directions show how they turn, and the
//    next certificate's turns likewise: the steps of a secant method.
// 4. The pair that meets first is solved first, and a contact found ends the search in the others. If a mesh is convex,
//    its triangle at the hulls' witness touches at that very time, which is proven at once (proveBelowHulls()). If
//    bodies seem to rest on each other there, the pieces around the hulls' witness are tried before all others
//    (recordWhereTheyRest()). If they are in each other from t = 0 on, recordAtStart() tries triangles that cross
//    there, the first leaves that touch, and triangles that cross within the tolerance after it.
// 5. solvePieces() searches below the hulls: windows of time, each again in eight parts (solveInterval()), with a
//    dual traversal (Traversal::descend()). Swept boxes prove pairs of nodes apart, one box for each node and batch,
//    whatever the other node is. So do the hulls around their subtrees, which cut a bent link into convex parts.
//    Directions prove pairs of leaves apart: triangles' normals, the last direction, and GJK's witness at the middle of
//    one part. Each is held fixed in one body's frame or the other's, and tried on all parts at once. Nodes smaller
//    than the motion are left to the next level.
// 6. followLeaves() follows the few leaf pairs left in a part one by one: followToRoot() finds t_lower, decide()
//    finds t_upper by proofs of contact within the tolerance after it. If neither decides, the part is divided,
//    down to the tolerance. A pair that is then nearer than the distance tolerance or the pad of rounding is a
//    contact with `certain = false`; of many such pairs kEnoughUncertain are recorded.
#pragma once

#include <utility>

#include "narrowphase/solver/contact_writer.h"
#include "narrowphase/solver/earliest_first.h"
#include "narrowphase/solver/resting.h"
#include "narrowphase/solver/stage_one.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

/// Maximum number of leaf pairs in a lane that are followed one by one; if there are more, the lane is split first.
constexpr int kFewLeaves = 12;
/// Maximum number of patches of one large body that are followed one by one in a lane; if there are more, they are
/// traversed together. Measured: up to 12 it makes no difference; without a bound the first contact with a cloud of
/// 10^5 points takes 1.5 to 2 times as long.
constexpr int kFewPatches = 4;
/// Length of the first window of time in which pieces are examined: in it the bodies move about this part of the
/// smaller body's radius against each other.
constexpr double kFirstWindow = 0.4;
/// A body's pieces are not examined in lanes of the first batch if half a lane moves it by more than this part of the
/// smaller body's radius.
constexpr double kLongMotion = 0.2;

/// Maximum number of leaf pairs of one lane that are recorded although nothing can be proven of them.
constexpr int kEnoughUncertain = 16;
/// Maximum number of pairs of boxes, as kMaxBoxPairs, that are tested right after the start if no contact is proven at
/// the start. They take a hundredth of a second. Without a proof the search would divide all that touches down to the
/// finest lanes.
constexpr int kMaxAfterStart = 1 << 20;

/// An interval of time. All that is searched in it is proven free before its start.
struct Window {
  double start, width;
  bool finest = false;  ///< it is as narrow as the tolerance: it is not divided on

  double end() const { return start + width; }
};

/// From the first to the last of some lanes of the first batch.
inline Window windowOf(unsigned lanes) {
  const int first = __builtin_ctz(lanes);
  return {0.125 * first, 0.125 * (32 - __builtin_clz(lanes) - first)};
}

/// Entries begin to end of a list that are open in one lane of their batch; lane -1: all of them.
struct Selection {
  const Buffer<Entry>& list;
  int begin, end, lane;

  bool has(int i) const { return list[i].isOpenIn(lane); }
};

/// On destruction, cuts a list to the length that it had on construction.
class Shortened {
 public:
  explicit Shortened(Buffer<Entry>& list) : list_(list), size_(list.size()) {}
  Shortened(const Shortened&) = delete;
  Shortened& operator=(const Shortened&) = delete;
  ~Shortened() { list_.truncate(size_); }

 private:
  Buffer<Entry>& list_;
  int size_;
};

class PairSearch : PartOfSolver {
 public:
  PairSearch(SearchState& state, PoseProofs& proofs, Traversal& traversal, Follower& follower, AnyContact& any)
      : PartOfSolver(state.task),
        motions_(state.motions),
        horizon_(state.horizon),
        contacts_(state.contacts),
        proofs_(proofs),
        traversal_(traversal),
        follower_(follower),
        any_(any),
        writer_(state) {}

  /// Tests boxes and hulls of whole bodies, in the eight parts of [0, 1], for all pairs of `open`, and removes those
  /// that are apart. Where any contact will do, it is looked for in links whose hulls are not.
  void testHulls(Buffer<Entry>& open, const StageOne& stage_one);
  /// Finds the first contact of all pairs of `open`, or of each of them.
  void run(const Buffer<Entry>& open);

 private:
  enum class LaneResult { free, done, split };
  /// The state of leaf pairs at one time: none is known to touch, or one may, or one is recorded as a contact.
  enum class Touching { no, maybe, recorded };

  void setBatch(const TimeBatch& batch) {
    ++statistics().batches;
    horizon_.setBatch(batch);
  }
  /// The leaf pieces of an entry's nodes; negative: the node is no leaf.
  struct LeafPair {
    std::int32_t a, b;
  };
  LeafPair leavesOf(const Entry& e) const {
    const PairParts pair = problem().parts(e.pair);
    return {leafPieceOf(*body(pair.a).tree, e.a), leafPieceOf(*body(pair.b).tree, e.b)};
  }
  Aim aim() const { return horizon_.isFinest() ? Aim::leaves : Aim::split; }
  bool isLeafPair(const Entry& e) const {
    const LeafPair leaves = leavesOf(e);
    return leaves.a >= 0 && leaves.b >= 0;
  }
  /// Whether there are convex pieces around what is below both nodes.
  bool haveHulls(const Entry& e) const {
    const PairParts parts = problem().parts(e.pair);
    return !e.deep && NodeHull::exists(*body(parts.a).tree, e.a) && NodeHull::exists(*body(parts.b).tree, e.b);
  }
  /// Whether it is two whole bodies, or a patch and a whole body, whose hulls are to be followed.
  bool isFollowed(const Entry& e) const {
    if (e.b != 0 || (e.a != 0 && !body(problem().parts(e.pair).a).tree->upper)) return false;
    return !isLeafPair(e) && haveHulls(e);
  }
  /// Whether a pair moves so far in a lane that only its hulls can be separated, and hardly its pieces, before the lane
  /// is split.
  static bool movesFar(Seen seen) { return seen->amplitude() > kLongMotion * seen->smallerRadius(); }

  /// Whether points of both bodies are so near that no proof can separate them. (A small gap that is proven along one
  /// direction does not show that they are near.) Points within the pad of rounding are near whatever the tolerance: no
  /// lane is narrow enough to prove such a gap.
  bool isNear(double gap_upper, double pad) const { return gap_upper <= max(0.5 * query().tolerance_distance, pad); }
  bool isNear(const Candidate& f) const { return isNear(f.gap_upper, f.pad); }

  /// The width of a window that is not divided on.
  double finestWidth() const { return max(query().tolerance_time, kNarrowestLane); }
  /// The end of one that begins at t: the motion may end before.
  double finestEnd(double t) const { return min(1.0, t + finestWidth()); }

  Candidate candidateOf(const Entry& e, double start) const;
  Candidate hullsOf(const Entry& e, double start);
  double restingGapOfHulls(Seen seen, const Entry& e, int lane, GjkResult& g) {
    ++statistics().gjk;
    return restingGap(seen, e, lane, g);
  }
  bool stayNear(const Candidate& f);
  bool recordWhereTheyRest(const Entry& e, double t);
  bool recordAtStart(const Selection& of);
  Touching recordTouching(double t, bool may_rest);
  void search(const Buffer<Entry>& open, int begin, int end);
  void decideByHulls(Entry& e);
  void descendIntoPieces(const Buffer<Entry>& open, int begin, int end);
  void lookAtPutOff(unsigned later);
  void solveLane(const Selection& of, const Window& window, unsigned first_lanes = 0);
  void followHulls(const Selection& of, const Window& window, unsigned first_lanes);
  void solvePieces(const Candidate& f, double stop, int lane);
  LaneResult solveInterval(const Selection& of, const Window& window);
  LaneResult solveOpenLane(const Selection& of, const Window& window);
  LaneResult followLeaves(const Selection& of, const Window& window);
  void followEach(const Window& window);

  RelativeMotions& motions_;
  Horizon& horizon_;
  ContactList& contacts_;
  PoseProofs& proofs_;
  Traversal& traversal_;
  Follower& follower_;
  AnyContact& any_;
  ContactWriter writer_;
  Buffer<Entry> pieces_;          ///< entries that the first batch has left undecided
  Buffer<Entry> stack_;           ///< of narrower windows: what each leaves to those within it
  Buffer<Candidate> candidates_;  ///< of a lane of the first batch
  EarliestFirst earliest_first_;  ///< of these, by the times until which they are proven free
  Buffer<Candidate> leaves_;      ///< of a narrower lane
  Buffer<Candidate> touching_;    ///< at one time
  PairId crossing_tried_ =
      engine::kNoPair;       ///< recordAtStart() has looked for triangles that cross, all over the bodies
  int splits_at_start_ = 0;  ///< divisions of the lane that begins at 0 before recordAtStart() is asked
};

/// Makes a candidate of an entry, to be followed from `start`.
inline Candidate PairSearch::candidateOf(const Entry& e, double start) const {
  const LeafPair leaves = leavesOf(e);
  Candidate f = {};
  f.entry = e;
  f.t_lower = max(start, contacts_.watchFrom(e.pair));
  f.gap_upper = kUnknownGap;
  f.piece_a = leaves.a;
  f.piece_b = leaves.b;
  return f;
}

/// Makes a candidate of two hulls, to be followed from `start`.
inline Candidate PairSearch::hullsOf(const Entry& e, double start) {
  Candidate f = candidateOf(e, start);
  f.target = Candidate::Target::hulls;
  f.simplex = traversal_.simplexOf(e);
  f.hull_a = *NodeHull(*body(problem().parts(e.pair).a).tree, e.a);
  return f;
}

/// Whether hulls that were followed to f.t_lower are hardly in each other a little later, as hulls of bodies that rest
/// are.
inline bool PairSearch::stayNear(const Candidate& f) {
  constexpr double kLater = 64;
  const TimeBatch later = TimeBatch::around(min(1.0, f.t_lower + kLater * query().tolerance_time));
  const Seen seen = motions_.of(f.entry.pair, later);
  const PiecePair pieces = piecesOf(f, seen);
  const Piece &a = pieces.a, &b = pieces.b;
  if (depthWithin(f.simplex) > kShallow * seen->smallerRadius()) return false;
  if (f.t_lower == 0 || !f.have_normal) return true;
  DifferencePoint lowest;
  seen->differenceAt(a, b, 0).support(f.normal, lowest);
  return isNear(-(dot(f.normal, lowest.w) - a.radius - b.radius - seen->margin()), seen->pad());
}

/// A pair whose hulls touch at t, before which all is free, may rest there, like a cup on a table. Pieces around the
/// hulls' witness are examined by themselves. If contact of two of them at t is proven, or no proof separates them, it
/// is recorded: no contact is earlier. (Otherwise thousands of pairs of coplanar triangles, of which nothing can be
/// proven, would be divided down to the finest lanes. A query took 27 ms so; with the upper body 10 um higher it took 6
/// us.)
/// @return whether a contact is recorded; if not, the pair is to be searched.
inline bool PairSearch::recordWhereTheyRest(const Entry& e, double t) {
  const PairId pair = e.pair;
  if (contacts_.watchFrom(pair) > t) return false;
  const Seen seen = motions_.of(pair, TimeBatch::partsOf(t, finestEnd(t) - t));
  const TreeView &A = seen->a(), &B = seen->b();
  GjkResult g;
  if (restingGapOfHulls(seen, e, 0, g) < -kShallow * seen->smallerRadius()) return false;
  const NodeHull below_a(A, e.a), below_b(B, e.b);
  const Piece &hull_a = *below_a, &hull_b = *below_b;
  const double radii = hull_a.radius + hull_b.radius + seen->margin();
  if (!g.overlap && !isNear(g.distance - radii, seen->pad())) return false;
  if (g.overlap && !originWeights(g.simplex)) return false;
  Vec3 x(0, 0, 0), y(0, 0, 0);  // the witness, in each body's own frame
  for (int i = 0; i < g.simplex.n; ++i) {
    x = x + g.simplex.v[i].a * g.simplex.weight[i];
    y = y + g.simplex.v[i].b * g.simplex.weight[i];
  }
  std::int32_t near_a[kMaxPiecesAround], near_b[kMaxPiecesAround];
  const double reach = max(query().tolerance_distance, seen->pad());
  const int at_a = pieceAtWitness(A, g.simplex, true, e.a), at_b = pieceAtWitness(B, g.simplex, false, e.b);
  const int num_a = piecesAround(A, at_a, x, hull_a.radius + seen->margin() + reach, near_a);
  const int num_b = piecesAround(B, at_b, y, hull_b.radius + seen->margin() + reach, near_b);
  touching_.clear();
  for (int i = 0; i < num_a * num_b; ++i) {
    Candidate f = candidateOf({pair, 0, 0, kAllLanes}, t);
    f.piece_a = near_a[i / num_b];
    f.piece_b = near_b[i % num_b];
    touching_.push(f);
  }
  return recordTouching(t, true) == Touching::recorded;
}

/// For bodies that overlap at t = 0: triangles that cross there are the contact, or the first leaves that touch; it
/// does not matter how many others touch. (Otherwise all of them would be divided down to the finest lanes.) If no
/// contact of them is proven, triangles may cross within the tolerance after the start. A body that begins as a copy of
/// the other one shares faces and edges with it at first, and soon crosses it along a line. This line is looked for all
/// over the bodies.
/// @param of  what is left of one pair.
/// @return whether a contact is recorded; if not, the pair is to be searched.
inline bool PairSearch::recordAtStart(const Selection& of) {
  const PairId pair = of.list[of.begin].pair;
  if (contacts_.watchFrom(pair) > 0) return false;
  const bool first_try = crossing_tried_ != pair;  // (several patches of one body may come here)
  crossing_tried_ = pair;
  const Entry all = {pair, 0, 0, 1};
  if (first_try && proofs_.anyTriangles(motions_.of(pair, TimeBatch::around(0)), 0, kMaxBoxPairs, all)) return true;
  const Shortened shortened(stack_);
  const int out_begin = stack_.size();
  const TimeBatch batch = TimeBatch::partsOf(0, finestEnd(0));
  setBatch(batch);
  const Seen seen = motions_.of(pair, batch);
  for (int i = of.begin; i < of.end && stack_.size() < out_begin + kEnoughUncertain; ++i) {
    const Entry e = of.list[i];
    if (e.isOpenIn(of.lane)) traversal_.descend(seen, {pair, e.a, e.b, 1}, Aim::poses, stack_);
  }
  touching_.clear();
  for (int i = out_begin; i < stack_.size() && touching_.size() < kEnoughUncertain; ++i) {
    if (isLeafPair(stack_[i])) touching_.push(candidateOf(stack_[i], 0));
  }
  const Touching touching = recordTouching(0, false);
  if (touching != Touching::maybe) return touching == Touching::recorded;
  const TimeBatch after = TimeBatch::around(min(1.0, 0.5 * query().tolerance_time));
  return first_try && proofs_.anyTriangles(motions_.of(pair, after), 0, kMaxAfterStart, all);
}

/// Records a leaf pair of `touching_` that touches at t, if there is one.
/// @param may_rest  if no contact at t is proven, the first pair that is near at t and of which nothing is proven is
/// recorded.
inline PairSearch::Touching PairSearch::recordTouching(double t, bool may_rest) {
  const double stop = finestEnd(t);
  Candidate resting = {};
  int uncertain = 0;
  for (int i = 0; i < touching_.size() && (!may_rest || uncertain < kMaxPiecesAround); ++i) {
    Candidate& f = touching_[i];
    f.target = Candidate::Target::leafPair;
    const auto isOpen = [&] { return f.t_lower <= t && isNear(f); };
    if (follower_.followToRoot(f, stop, false)) continue;
    if (!f.certain && (!isOpen() || follower_.decide(f, stop))) continue;
    if (f.certain) {
      writer_.record(f);
      if (f.t_lower <= t || horizon_.isOver()) return Touching::recorded;
    } else if (isOpen() && uncertain++ == 0) {
      resting = f;
    }
  }
  if (uncertain == 0) return Touching::no;
  if (!may_rest) return Touching::maybe;
  horizon_.closeAt(t + query().tolerance_time);
  writer_.record(resting);
  return Touching::recorded;
}

inline void PairSearch::testHulls(Buffer<Entry>& open, const StageOne& stage_one) {
  any_.forgetOverlaps();
  const int roots = open.size();
  int kept = 0;
  const Buffer<std::int32_t>& order = any_.deepestFirst(open);
  for (int n = 0; n < roots && !horizon_.isOver(); ++n) {
    const int i = order.size() ? order[n] : n;
    Entry& e = open[i];
    if (n + 2 < roots) {  // what the one after the next needs first
      const TreeView& tree = *body(problem().parts(open[order.size() ? order[n + 2] : n + 2].pair).a).tree;
      prefetch(tree.nodes);
      if (tree.outer) prefetch(tree.outer);
    }
    if (e.mask & horizon_.live()) {
      const Seen seen = motions_.of(e.pair, whole());
      traversal_.rootsAreTested(seen);
      if (e.isWhole()) e.mask = traversal_.rootsMayTouch(seen, e.mask);
      if (e.mask) {
        const bool suspect = !query().every_pair && movesFar(seen);
        const Traversal::HullTest test = traversal_.hullsMayTouch(seen, e, suspect, {true, stage_one.direction(e)});
        e.mask = test.mask;
        e.within = test.within;
        if (test.overlaps) any_.guessOverlap(e.pair, test.overlaps, e.a);
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

inline void PairSearch::run(const Buffer<Entry>& open) {
  if (!query().every_pair) return search(open, 0, open.size());
  for (int i = 0; i < open.size() && !task_.ended();) {
    const int before = contacts_.size(), begin = i;
    i = endOfPair(open, begin);
    horizon_.dropSuspicion();
    setBatch(whole());
    search(open, begin, i);
    contacts_.order(before, horizon_.end());
  }
}

/// The pairs of open[begin, end), over [0, 1].
inline void PairSearch::search(const Buffer<Entry>& open, int begin, int end) {
  horizon_.beginSearch();
  crossing_tried_ = engine::kNoPair;
  pieces_.clear();
  stack_.clear();
  if (problem().num_movers == 0 && end - begin == 1) {
    // A problem of one pair needs no order among pairs: it is followed from its first open lane to its last. (Where
    // stage 1 or 2 has left one of many, it goes the way of the others.)
    const Entry& e = open[begin];
    if (isLeafPair(e) || (haveHulls(e) && movesFar(motions_.of(e.pair, whole())))) {
      return solveLane({open, begin, end, -1}, windowOf(e.mask), contacts_.watchFrom(e.pair) > 0 ? 0 : e.mask);
    }
  }
  descendIntoPieces(open, begin, end);
  for (int lane = 0; lane < kLanes && 0.125 * lane < horizon_.end() && !horizon_.isOver(); ++lane) {
    solveLane({pieces_, 0, pieces_.size(), lane}, {0.125 * lane, 0.125});
    const unsigned later = kAllLanes & ~((2u << lane) - 1);
    if (later && horizon_.end() > 0.125 * (lane + 1)) lookAtPutOff(later);
  }
}

/// Follows the hulls of two bodies that move little in a lane to where they meet, before the first batch looks at their
/// pieces. Where bodies are convex there, pieces meet at the same time: if that is proven, it is recorded. Lanes that
/// end before the hulls meet are free. (So first contacts of a Panda with itself take a fifth of the time. Hulls that
/// reach farther beyond their bodies than these move within the tolerance are not worth it.)
/// @param e  keeps the lanes that are undecided.
inline void PairSearch::decideByHulls(Entry& e) {
  const unsigned live = e.mask & horizon_.live();
  if (!live || !e.isWhole() || e.within || !isFollowed(e) || horizon_.mustEnd()) return;
  const Seen seen = motions_.of(e.pair, whole());
  const double speed = seen->amplitude() / whole().d;
  if (movesFar(seen)) return;  // solveLane() follows their hulls
  const double loose = loosenessOf(seen->a(), 0, *seen->a().outer) + loosenessOf(seen->b(), 0, *seen->b().outer);
  if (loose > speed * query().tolerance_time) return;
  const auto keepFrom = [&](double t) { e.mask &= ~((1u << static_cast<int>(kLanes * t)) - 1); };
  const Window window = windowOf(live);
  Candidate f = hullsOf(e, window.start);
  if (follower_.followToRoot(f, window.end(), false)) return keepFrom(window.end());
  if (!f.certain) follower_.proveBelowHulls(f);
  if (!f.certain) return keepFrom(f.t_lower);
  e.mask = 0;
  writer_.record(f);
}

/// Traverses the trees from open[begin, end) on, over the first batch. Entries that stay undecided are left in
/// `pieces_`.
inline void PairSearch::descendIntoPieces(const Buffer<Entry>& open, int begin, int end) {
  int first_of_pair = pieces_.size();
  for (int i = begin; i < end && !horizon_.isOver(); ++i) {
    Entry e = open[i];
    if (i == begin || open[i - 1].pair != e.pair) first_of_pair = pieces_.size();
    decideByHulls(e);
    if (!e.mask || horizon_.isOver()) continue;
    const Seen seen = motions_.of(e.pair, whole());
    bool whole_first = movesFar(seen) && !e.within;
    if (!whole_first && !e.within && !isLeafPair(e) && haveHulls(e) && (e.isWhole() || (e.mask & 1))) {
      GjkResult g;
      const double gap = abs(restingGapOfHulls(seen, e, __builtin_ctz(e.mask), g)) / seen->smallerRadius();
      whole_first = gap <= kBarely;
      if (!whole_first && gap <= kShallow && (e.mask & 1) && recordWhereTheyRest(e, 0)) continue;
    }
    if (whole_first) {
      Entry& piece = pieces_.grow() = {e.pair, e.a, e.b, e.mask};
      piece.deep = e.deep;
    } else {
      traversal_.descend(motions_.of(e.pair, whole()), {e.pair, e.a, e.b, e.mask}, aim(), pieces_, first_of_pair);
    }
  }
}

/// If entries of `pieces_` were put off in the next lane, the suspicion was wrong: then examines all entries that were
/// put off.
/// @param later  lanes of the first batch that are still to come.
inline void PairSearch::lookAtPutOff(unsigned later) {
  const int end = pieces_.size();
  const unsigned next = later & (~later + 1);
  bool any = false;
  for (int i = 0; i < end; ++i) any = any || (pieces_[i].put_off && (pieces_[i].mask & next));
  if (!any) return;
  horizon_.dropSuspicion();
  setBatch(whole());
  for (int i = 0; i < end; ++i) {
    const Entry e = pieces_[i];
    if (!e.put_off) continue;
    pieces_[i].mask = 0;
    pieces_[i].put_off = false;
    if (!(e.mask & later)) continue;
    traversal_.descend(motions_.of(e.pair, whole()), {e.pair, e.a, e.b, e.mask & later}, aim(), pieces_);
  }
}

/// Searches one part of the motion: the pairs that may touch in it, in the order in which they meet.
/// @param first_lanes  see Follower::followToRoot().
inline void PairSearch::solveLane(const Selection& of, const Window& window, unsigned first_lanes) {
  const Shortened shortened(stack_);
  const double stop = window.end();
  const bool suspected = of.lane == 0 && horizon_.contactLane() == 1;  // in this lane
  followHulls(of, window, first_lanes);
  while (!earliest_first_.empty() && !horizon_.isOver()) {
    Candidate f = candidates_[earliest_first_.take()];
    horizon_.provenFree(f.t_lower);
    if (f.t_lower >= horizon_.end()) break;
    if (f.isHulls()) {
      follower_.proveBelowHulls(f);
      if (!f.certain && stayNear(f) && recordWhereTheyRest(f.entry, f.t_lower)) continue;
    }
    if (f.isLeafPair() && !f.certain && follower_.decide(f, stop)) continue;
    if (f.certain) {
      writer_.record(f);
      continue;
    }
    horizon_.dropSuspicion();
    // If contact at t = 0 of another pair is proven or assumed, the search ends within the finest window. In lanes as
    // narrow as that nothing is put off, so every leaf of bodies deep in each other would be examined. For a link in a
    // table that takes 14 ms; recordAtStart() takes 0.1 ms.
    const bool ends_at_start = f.t_lower == 0 && horizon_.end() <= finestWidth();
    if (ends_at_start && recordAtStart({stack_, f.first, f.first + f.count, of.lane})) continue;
    splits_at_start_ = suspected ? 0 : 1;
    solvePieces(f, stop, of.lane);
  }
  FCL_ARTIC_ASSERT(horizon_.provenFreeUntil() <= stop);
  if (!horizon_.isOver()) horizon_.provenFree(stop);
}

/// Makes one candidate of all entries of a pair, in `candidates_` and `earliest_first_`:
/// - one leaf pair: it is followed at once;
/// - whole bodies: their hulls are followed;
/// - parts of bodies, to which the first batch has come already: they are not followed.
/// Candidates that are proven free in the window are left out.
inline void PairSearch::followHulls(const Selection& of, const Window& window, unsigned first_lanes) {
  using Target = Candidate::Target;
  candidates_.clear();
  earliest_first_.clear();
  for (int i = of.begin; i < of.end && !horizon_.isOver();) {
    const int first = stack_.size();
    const PairId pair = of.list[i].pair;
    bool leaves = true, hulls = false;
    int patches = 0;
    for (int j = i; j < of.end && of.list[j].pair == pair; ++j) patches += of.has(j) && isFollowed(of.list[j]);
    const bool many = patches > kFewPatches;
    for (; i < of.end && of.list[i].pair == pair && !hulls; ++i) {
      if (!of.has(i)) continue;
      hulls = !many && isFollowed(of.list[i]);
      if (hulls && stack_.size() > first) {
        hulls = false;  // it begins the next candidate
        break;
      }
      leaves = leaves && isLeafPair(of.list[i]);
      stack_.push(of.list[i]);
    }
    if (stack_.size() == first) continue;
    Candidate f = hulls ? hullsOf(stack_[first], window.start) : candidateOf(stack_[first], window.start);
    f.first = first;
    f.count = stack_.size() - first;
    if (!hulls) f.target = leaves && f.count == 1 ? Target::leafPair : Target::subtrees;
    if (f.t_lower >= window.end() ||
        (f.target != Target::subtrees && follower_.followToRoot(f, window.end(), false, first_lanes))) {
      stack_.truncate(first);
      continue;
    }
    if (f.certain) return writer_.record(f);
    earliest_first_.add(f.t_lower, candidates_.size());
    candidates_.push(f);
    horizon_.mustEnd();
  }
}

/// Searches the pieces of one pair, in a lane of the first batch. Windows of time start short, since surfaces are near
/// where hulls meet: the smaller body moves kFirstWindow of its radius. They grow eightfold.
inline void PairSearch::solvePieces(const Candidate& f, double stop, int lane) {
  const Selection of = {stack_, f.first, f.first + f.count, lane};
  const Shortened shortened(stack_);
  if (f.target == Candidate::Target::subtrees) {
    solveOpenLane(of, {f.t_lower, stop - f.t_lower});
    return;
  }
  motions_.setWitness(f.entry.pair, f.have_normal ? &f.normal : nullptr);
  const PairParts pair = problem().parts(f.entry.pair);
  const double size = kFirstWindow * min(body(pair.a).tree->nodes[0].radius, body(pair.b).tree->nodes[0].radius);
  stop = min(stop, horizon_.end());
  double span = f.speed * (stop - f.t_lower) > size ? max(size / f.speed, kNarrowestLane) : stop - f.t_lower;
  for (double t = f.t_lower; t < min(stop, horizon_.end()); span *= 8) {
    const double next = t + 1.5 * span < min(stop, horizon_.end()) ? t + span : min(stop, horizon_.end());
    if (solveInterval(of, {t, next - t}) == LaneResult::done) return;
    t = next;
  }
}

/// One batch over a window, for entries of one pair.
inline PairSearch::LaneResult PairSearch::solveInterval(const Selection& of, const Window& window) {
  FCL_ARTIC_ASSERT(of.begin < of.end);
  const TimeBatch batch = TimeBatch::partsOf(window.start, window.width);
  setBatch(batch);
  if (task_.ended()) return LaneResult::done;
  const Shortened shortened(stack_);
  const int begin = stack_.size();
  const bool finest = horizon_.isFinest();
  for (int i = of.begin; i < of.end; ++i) {
    if (!of.has(i)) continue;
    const Entry e = of.list[i];
    traversal_.descend(motions_.of(e.pair, batch), {e.pair, e.a, e.b, kAllLanes}, aim(), stack_);
    if (horizon_.isOver()) return LaneResult::done;
  }
  const int end = stack_.size();
  for (int lane = 0; lane < kLanes; ++lane) {
    if (batch.start[lane] >= horizon_.end()) break;
    const Window of_lane = {batch.start[lane], batch.width, finest};
    if (solveOpenLane({stack_, begin, end, lane}, of_lane) == LaneResult::done) return LaneResult::done;
  }
  return LaneResult::free;
}

/// Decides a lane that some entries of one pair leave undecided. A few leaf pairs are followed one by one. If there are
/// more, or the proofs fail, the lane is split.
inline PairSearch::LaneResult PairSearch::solveOpenLane(const Selection& of, const Window& window) {
  int count = 0;
  bool leaves = true;
  for (int i = of.begin; i < of.end && (window.finest || count <= kFewLeaves); ++i) {
    if (!of.has(i)) continue;
    ++count;
    leaves = leaves && isLeafPair(of.list[i]);
  }
  if (!count) return LaneResult::free;
  if (leaves && (window.finest || count <= kFewLeaves)) {
    const LaneResult step = followLeaves(of, window);
    if (step != LaneResult::split) return step;
  }
  if (window.start == 0 && splits_at_start_-- == 0 && recordAtStart(of)) return LaneResult::done;
  return solveInterval(of, window);
}

/// The leaf pairs that a lane leaves undecided, one by one: how far is each free, and is there contact?
/// @return LaneResult::split: the lane is to be split, as it is wider than the tolerance, or the pairs are farther
/// apart than the distance tolerance, and nothing is proven.
inline PairSearch::LaneResult PairSearch::followLeaves(const Selection& of, const Window& window) {
  leaves_.clear();
  for (int i = of.begin; i < of.end; ++i) {
    if (of.has(i)) leaves_.push(candidateOf(of.list[i], window.start));
  }
  followEach(window);
  if (task_.ended()) return LaneResult::done;
  const bool narrow = window.width <= kNarrowestLane;
  // (Where any contact will do and one is proven, it is recorded whatever is still open.)
  for (int i = 0; i < leaves_.size() && !horizon_.isOver(); ++i) {
    const Candidate& f = leaves_[i];
    if (!f.gap_closed || f.certain || f.t_lower >= horizon_.end()) continue;
    if (!narrow && (!window.finest || !isNear(f))) {
      // Contacts proven meanwhile are kept: the horizon ends at their time, and narrower lanes may prove later ones
      // only.
      for (int k = 0; k < leaves_.size(); ++k) {
        if (leaves_[k].certain) writer_.record(leaves_[k]);
      }
      return LaneResult::split;
    }
    horizon_.closeAt(f.t_lower + query().tolerance_time);
  }
  const int before = contacts_.size();
  for (int i = 0; i < leaves_.size(); ++i) {
    if (leaves_[i].gap_closed && leaves_[i].t_lower <= horizon_.end()) writer_.record(leaves_[i]);
  }
  return contacts_.size() > before ? LaneResult::done : LaneResult::free;
}

/// Follows the leaf pairs of `leaves_`. If many can be proven neither apart nor in contact, some are enough: leaf pairs
/// that are not looked at count as touching from the lane's begin on.
inline void PairSearch::followEach(const Window& window) {
  // They are taken from all over the list, for neighbours in it are alike.
  const int stride = leaves_.size() / kEnoughUncertain;
  for (int i = 1; stride > 1 && i < kEnoughUncertain; ++i) std::swap(leaves_[i], leaves_[i * stride]);
  int uncertain = 0;
  for (int i = 0; i < leaves_.size(); ++i) {
    Candidate& f = leaves_[i];
    if (!follower_.followToRoot(f, window.end(), false) && !f.certain) follower_.decide(f, window.end());
    if (horizon_.mustEnd()) return;
    uncertain += f.gap_closed && !f.certain && isNear(f);
    if (uncertain >= kEnoughUncertain && i + 1 < leaves_.size()) {
      f.t_lower = max(window.start, contacts_.watchFrom(f.entry.pair));
      leaves_.truncate(i + 1);
    }
    // This pair touches from the window's begin on: no contact is earlier, and of many such pairs some are enough.
    const bool enough = f.certain && f.t_lower <= window.start && i >= 64;
    if (enough || horizon_.isOver()) leaves_.truncate(i + 1);
  }
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
