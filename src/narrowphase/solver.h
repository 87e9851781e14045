// SPDX-License-Identifier: BSD-3-Clause
//
// The solver: first contact over all pairs, eight time intervals at once.
//
//   solve            stage 1 (cull), the query's own stage (refine), then all pairs left on one batch, [0, 1] in eight lanes:
//                    boxes and hulls of whole bodies
//   solveLane        lane by lane from the earliest, the pairs that may touch in it: hulls followed to where they meet
//                    (advance), then the pieces below from there on, the pair that meets first before the others
//   solveInterval    one pair: eight equal parts of an interval; dual traversal; then, lane by lane from the earliest, the
//                    same again on what that lane left undecided
//   traverse         node pairs by swept boxes, leaf pairs by certificates; where GJK claims overlap, later lanes are put off
//   finishLane       a few leaf pairs are left in a lane: each is followed by itself (advance: t_lower by the certificate's
//                    first root, a Newton step), then t_upper by proofs of contact
//
// What is discarded is discarded by the certificate (certificate.h) or by a swept box (boxes along the frames' axes are the
// same certificate with n an axis). Everything else here is order and effort.
#pragma once

#include <time.h>

#include "narrowphase/buffer.h"
#include "narrowphase/certificate.h"
#include "narrowphase/contact_proof.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

using engine::Answer;
using engine::Body;
using engine::Node;
using engine::Ignored;
using engine::LeafContact;
using engine::LinkPair;
using engine::Problem;
using engine::Query;
using engine::Statistics;
using engine::Verdict;

/// Swept bounds of a node in the other body's frame, remainder, pad and margin included.
struct SweptBox {
  FloatLanes lo[3], hi[3];
};

/// Pieces whose `size` is a direction worth trying.
FCL_ARTIC_INLINE bool hasDirection(const Piece& piece) { return piece.kind == PieceKind::vertices || unbounded(piece); }

/// Bounds of a moving node in the still body's frame, grown by `slack` and the remainder.
FCL_ARTIC_INLINE void sweepNode(const RigidLanes& m, const Node& node, double slack, SweptBox& box) {
  double c[3], h[3], far2 = 0;  // c and h: sums of floats, exact but for far smaller addends
  for (int k = 0; k < 3; ++k) {
    const double lo = node.lo[k], hi = node.hi[k], far = max(-lo, hi);
    c[k] = 0.5 * (lo + hi);
    h[k] = 0.5 * (hi - lo);
    far2 += far * far;
  }
  // |p| over the box; a square, two sums and a root are off by less than 8 ulp.
  const Lanes grow(m.rem_c + m.rem_R * (sqrt(far2) * (1 + 8 * kUlp)) + slack);
  for (int i = 0; i < 3; ++i) {
    const Lanes* S = m.spread + 3 * i;
    const Lanes half = mulAdd(S[0], h[0], mulAdd(S[1], h[1], mulAdd(S[2], h[2], grow)));
    Lanes lo, hi;
    for (int k = 0; k < 3; ++k) {
      const Lanes* R = m.Rb[k] + 3 * i;
      const Lanes center = mulAdd(R[0], c[0], mulAdd(R[1], c[1], mulAdd(R[2], c[2], m.cb[k][i])));
      lo = k ? min(lo, center) : center;
      hi = k ? max(hi, center) : center;
    }
    box.lo[i] = narrowDown(lo - half);
    box.hi[i] = narrowUp(hi + half);
  }
}

/// A pair of nodes that is not yet decided in the lanes of `mask`.
struct Entry {
  std::int32_t pair, a, b;
  unsigned mask;  ///< with kPutOff: not looked at, as contact was claimed before these lanes
};
constexpr unsigned kPutOff = 0x100;

class Solver {
 public:
  void solve(const Problem& problem, const Query& query, Answer& answer);
  void pairMotion(int pair, double tm, double d, engine::PairMotion& motion);

 private:
  enum class Step { free, done };
  struct Final;

  /// Bodies and placements of a pair: B is carried by a step of the sweep, A stands in its base frame.
  struct PairParts {
    std::int32_t a, b, sweep, step_b;
    const Placement *inverse_a, *placement_b;
  };
  PairParts parts(int pair) const;
  bool linkAllowed(int link_pair) const { return problem_->link_allowed && problem_->link_allowed[link_pair]; }
  double watchFrom(int pair) const;

  // Time batches.
  void beginBatch(double start, double width);
  void evaluateAt(const double* tm, double d);
  const FrameLanes* frames(int sweep);
  void setupPair(int pair);
  const Side& side(int s);
  void updateLive();
  bool isLeafPair(const Entry& e) const;

  // Stages.
  void cull();
  void sweptLss(int mover, SweptBox& box);
  void sweptSegments(int mover, engine::SweptLink* parts);
  void refine();
  void collectInitialContacts(int begin, int end);
  double firstFreeTime(double start, double width, int begin, int end);
  void solvePairs();
  bool movesFar() const;
  void solveLane(double start, double stop, int lane, int begin, int end, unsigned first_lanes = 0);
  Step solveOpenLane(double start, double width, int begin, int end, int lane, bool last);
  void solvePieces(const Final& f, double stop, int begin, int end, int lane);
  void descend(int begin, int end, unsigned mask);
  Step solveInterval(double start, double width, int begin, int end, int parent_lane);
  Step finishLane(double start, double width, int begin, int end, int lane, bool* refine);
  void piecesOf(const Final& f, const Piece*& a, const Piece*& b) const;
  bool advance(Final& f, double stop, bool patient, unsigned first_lanes = 0);
  bool settle(Final& f, double stop);
  bool prove(Final& f);
  void lookBack(Final& f);
  void describe(Final& f, LeafContact& contact);
  void orderContacts(int begin, double bracket);
  void traverse(int pair, int a, int b, unsigned mask);
  unsigned nodesMayTouch(int a, int b, unsigned mask);
  unsigned apartFromUnbounded(int a, int b);
  template <class F>
  unsigned notSeparated(const Piece& a, const Piece& b, unsigned mask, int most, const F& onOverlap);
  void claimOverlap(int lane);
  unsigned hullsMayTouch(unsigned mask, int pair, bool claim);
  bool proveVertexInside(int pair, int lane);
  bool proveLeaves(int pair, int piece_a, int piece_b, int lane);
  bool proveAnywhere();
  bool finished() const { return out_of_budget_ || (query_->any && limit_ < 2); }
  unsigned leavesMayTouch(int pair, int piece_a, int piece_b, unsigned mask);
  int sweptNode(int side, int node);
  bool isSwept(int side, int node) const {
    const Cached& cached = cached_[side][node & (kCached - 1)];
    return cached.epoch == pair_epoch_ && cached.node == node;
  }
  DifferenceBody differenceAt(const Piece& a, const Piece& b, int lane, double tau = 0) const;
  bool outOfBudget();
  double now() const;

  const Problem* problem_ = nullptr;
  const Query* query_ = nullptr;
  Statistics statistics_;

  // The present batch.
  Lanes tm_;
  double lane_start_[kLanes], lane_end_[kLanes], tm_at_[kLanes], d_ = 0;
  double begin_ = 0, end_ = 1;  ///< hull of all intervals
  unsigned live_ = 0;   ///< lanes that are worth work: not behind a contact that is proven or claimed
  unsigned contact_lane_ = 0;  ///< the lane with the earliest of these: it is split whatever else is found in it
  bool last_ = false;   ///< lanes are as narrow as the tolerance: descend to the leaves
  unsigned overlaps_ = 0;  ///< lanes in whose middles hulls overlap, as far as looked at
  double claimed_ = 2;  ///< earliest time at which GJK claimed overlap; 2: none. Lanes behind it are put off, not dropped.
  bool decide_only_ = false;  ///< only which lanes are free matters (initial contacts)
  unsigned blocked_ = 0;      ///< lanes found not free, with decide_only_

  Buffer<FrameLanes> frames_;       ///< of all sweeps, one after the other
  Buffer<std::int32_t> first_step_;  ///< per sweep, into frames_ and bounds_
  Buffer<std::int32_t> sweep_epoch_;
  Buffer<StepBounds> bounds_;
  Buffer<std::int32_t> bounds_ready_;
  std::int32_t batch_ = 0;

  // The present pair.
  Side side_[2];  ///< [0]: B seen from A; [1]: A seen from B. Certificates take them from side(), which makes what is missing.
  bool side_ready_[2] = {false, false};
  double pad_ = 0, pose_error_ = 0, amplitude_ = 0, margin_ = 0;
  double witness_[3];          ///< the last direction that GJK found between pieces of this pair
  bool have_witness_ = false;
  std::int32_t witness_pair_ = -1;
  std::int32_t present_ = -1, present_batch_ = -1;  ///< the pair, and the batch it was set up for
  std::int32_t roots_batch_ = -1;  ///< the batch whose node pairs (0, 0) have been tested
  /// Swept boxes of this pair and batch, by node of the moving tree of each side: a small direct-mapped cache stays in the
  /// processor's own; what is pushed out is made again.
  static constexpr int kCached = 2048;
  struct Cached {
    std::int32_t node, epoch, slot;
  };
  Cached cached_[2][kCached] = {};
  Buffer<SweptBox> pool_;
  std::int32_t pair_epoch_ = 0;

  Buffer<SweptBox> mover_box_;
  Buffer<engine::SweptLink> swept_links_;
  Buffer<engine::CullCandidate> candidate_pairs_;
  Buffer<Entry> entries_;
  Buffer<Entry> overlapping_;  ///< pairs whose hulls overlap in the middles of lanes of the first batch
  Buffer<Entry> stack_[kLanes];  ///< node pairs to visit, by their earliest lane
  Buffer<Ignored> ignored_;
  /// What is followed by itself: a leaf pair, the hulls around a pair of bodies, or parts of these.
  struct Final {
    Entry entry;
    bool hulls;        ///< the hulls, not a leaf pair
    bool pieces;       ///< neither: the entries only
    std::int32_t first, count;  ///< of a lane of the first batch: its entries
    double t_lower;    ///< free before
    double normal[3];  ///< GJK's witness at t_lower
    double gap;        ///< along it
    double speed;      ///< of the one body seen from the other, about
    bool have_normal;
    Simplex simplex;   ///< GJK's last
    bool stuck;        ///< the gap is gone at t_lower, as far as can be told
    bool certain;
    double t_upper, point[3];  ///< a proven contact
  };
  Buffer<Final> finals_, candidates_;
  Buffer<LeafContact> contacts_;

  double front_ = 0;   ///< all pairs are proven free before
  double t_upper_ = 2;  ///< earliest proven contact so far; 2: none
  double limit_ = 2;    ///< what lies behind does not matter any more: t_upper_, or the tolerance behind an undecided contact
  bool out_of_budget_ = false;
};

/// Nodes smaller than this part of the motion are split in time before they are split in space. Measured: anything from
/// 0.35 to 1.4 is within 30 % (doc/NUMERICS.md).
constexpr double kSplitTime = 0.7;
/// Width below which time is not split any more.
constexpr double kNarrowestLane = 1.0 / (1ull << 45);
/// Lanes are certified a little wider than they are, so that rounding of their ends and middles, numbers up to 1, loses
/// nothing (doc/NUMERICS.md, "Time").
constexpr double kLaneSlack = 8 * kUlp;
/// Hulls that overlap in so many lanes are left to their triangles.
constexpr int kMostHullOverlaps = 2;
/// So many leaf pairs in a lane are followed one by one; more are split in time first.
constexpr int kFewLeaves = 6;
/// The first window of time in which pieces are looked at, as the part of the smaller body's radius that the motion covers
/// in it.
constexpr double kFirstWindow = 0.4;
/// Motion in half a lane of the first batch, as part of the smaller body's radius, above which its pieces are not looked at.
constexpr double kLongMotion = 0.2;
/// GJK stops when it knows the gap to this part: enough for a direction (SHAPES, section 3).
constexpr double kWitnessAccuracy = 0.1;

inline double Solver::now() const {
  if (!query_->measure_times) return 0;
  timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return 1e6 * static_cast<double>(t.tv_sec) + 1e-3 * static_cast<double>(t.tv_nsec);
}

inline bool Solver::outOfBudget() {
  if (query_->work_budget && statistics_.node_tests + statistics_.leaf_tests > query_->work_budget) {
    out_of_budget_ = true;
  }
  return out_of_budget_;
}

inline void Solver::beginBatch(double start, double width) {
  if (claimed_ <= start) claimed_ = 2;  // all is proven free up to here: it was no contact
  double tm[kLanes];
  const double w = width / kLanes;
  for (int i = 0; i < kLanes; ++i) {
    lane_start_[i] = start + i * w;
    lane_end_[i] = start + (i + 1) * w;
    tm[i] = start + (i + 0.5) * w;
  }
  evaluateAt(tm, 0.5 * w + kLaneSlack);
  ++statistics_.batches;
  last_ = w <= max(query_->tolerance_time, kNarrowestLane);
  updateLive();
}

inline void Solver::evaluateAt(const double* tm, double d) {
  bool same = d == d_;
  for (int i = 0; i < kLanes; ++i) same = same && tm[i] == tm_at_[i];
  if (same) return;  // what is evaluated already serves
  for (int i = 0; i < kLanes; ++i) {
    tm_at_[i] = tm[i];
    tm_.set(i, tm[i]);
    begin_ = i ? min(begin_, tm[i]) : tm[i];
    end_ = i ? max(end_, tm[i]) : tm[i];
  }
  // What the intervals are claimed for lies in [0, 1]; kUlp: rounding of the ends.
  begin_ = max(0.0, begin_ - d - kUlp);
  end_ = min(1.0, end_ + d + kUlp);
  d_ = d;
  ++batch_;
  pair_epoch_ += 1;
}

inline void Solver::updateLive() {
  live_ = contact_lane_ = 0;
  for (int i = 0; i < kLanes; ++i) {
    const double end = last_ ? limit_ : min(limit_, claimed_);  // nothing is put off in the last lanes
    live_ |= static_cast<unsigned>(lane_start_[i] < end) << i;
    contact_lane_ |= static_cast<unsigned>(lane_start_[i] < end && end < lane_end_[i]) << i;
  }
  if (last_) contact_lane_ = 0;
  if (query_->any && limit_ < 2) live_ = 0;
}

/// Frames of a sweep in this batch, evaluated when first asked for.
inline const FrameLanes* Solver::frames(int sweep) {
  const engine::SweepView& view = problem_->sweeps[sweep];
  const int first = first_step_[sweep];
  if (sweep_epoch_[sweep] != batch_) {
    const bool local = query_->degree > 1 || view.local_bounds;
    if (local || !bounds_ready_[sweep]) {
      boundSteps(view, *query_, local ? begin_ : 0, local ? end_ : 1, bounds_.data() + first);
      bounds_ready_[sweep] = 1;
    }
    evaluateSweep(view, bounds_.data() + first, tm_, d_, frames_.data() + first);
    sweep_epoch_[sweep] = batch_;
    ++statistics_.motion_evaluations;
  }
  return frames_.data() + first;
}

FCL_ARTIC_INLINE void middleOf(const Node& node, double* center) {
  for (int k = 0; k < 3; ++k) center[k] = 0.5 * (static_cast<double>(node.lo[k]) + static_cast<double>(node.hi[k]));
}

inline Solver::PairParts Solver::parts(int index) const {
  if (index >= problem_->num_scene_pairs) {
    const LinkPair& pair = problem_->link_pairs[index - problem_->num_scene_pairs];
    return {pair.a, pair.b, pair.sweep, pair.step_b, &pair.inverse_a, &pair.placement_b};
  }
  const int a = problem_->obstacles[index % problem_->num_obstacles], b = problem_->movers[index / problem_->num_obstacles];
  return {a, b, 0, problem_->bodies[b].step, &problem_->bodies[a].inverse, &problem_->bodies[b].placement};
}

inline bool Solver::isLeafPair(const Entry& e) const {
  const PairParts pair = parts(e.pair);
  return problem_->bodies[pair.a].tree->nodes[e.a].isLeaf() && problem_->bodies[pair.b].tree->nodes[e.b].isLeaf();
}

/// Time from which a pair is watched: 0 but for ignored initial contacts.
inline double Solver::watchFrom(int pair) const {
  for (int i = 0; i < ignored_.size(); ++i) {
    if (ignored_[i].pair == pair) return ignored_[i].watch_from;
  }
  return 0;
}

/// Relative motion of a pair over this batch, both ways, with remainders and pads.
inline void Solver::setupPair(int index) {
  if (present_ == index && present_batch_ == batch_) return;
  present_ = index;
  present_batch_ = batch_;
  margin_ = engine::marginOf(*problem_, query_->margin, index);
  const PairParts pair = parts(index);
  const Body &A = problem_->bodies[pair.a], &B = problem_->bodies[pair.b];
  const FrameLanes* frame = frames(pair.sweep);
  static const StepBounds kStill = {};
  const StepBounds& b = pair.step_b >= 0 ? bounds_[first_step_[pair.sweep] + pair.step_b] : kStill;
  RigidLanes& m = side_[0].m;
  const PairPads pads = relateBodies(pair.step_b >= 0 ? frame + pair.step_b : nullptr, b,
                                     problem_->sweeps[pair.sweep].first_order, *pair.inverse_a, *pair.placement_b,
                                     A.tree->extent + B.tree->extent, margin_, d_, m, side_[1].m);
  side_ready_[0] = side_ready_[1] = false;
  pad_ = pads.pad;
  pose_error_ = pads.pose;
  side_[0].still = side_[1].moving = A.tree;
  side_[0].moving = side_[1].still = B.tree;

  // How far the motion takes the body in half an interval: B seen from A, or A from a B that is unbounded.
  const bool from_a = B.tree->nodes[0].radius < engine::kUnbounded;
  const Side& side = from_a ? side_[0] : this->side(1);
  const Node& root = side.moving->nodes[0];
  double center[3];
  middleOf(root, center);
  Lanes v[3];
  for (int k = 0; k < 3; ++k) v[k] = dot(side.m.R[1] + 3 * k, center) + side.m.c[1][k];
  amplitude_ = sqrt(maxLane(dot(v, v))) + b.rates.a * d_ * root.radius;
  ++pair_epoch_;
  pool_.clear();
  if (witness_pair_ != index) have_witness_ = false;
  witness_pair_ = index;
}

/// One body seen from the other, ready for certificates: many a look needs one of both only, or none.
inline const Side& Solver::side(int s) {
  if (!side_ready_[s]) {
    if (s) invert(side_[0].m, side_[1].m);
    side_[s].m.makeBernstein();
    side_ready_[s] = true;
  }
  return side_[s];
}

/// One pair's motion over one interval, for the report. The problem and the query of the last solve() must still be there.
inline void Solver::pairMotion(int pair, double tm, double d, engine::PairMotion& motion) {
  const double middles[kLanes] = {tm, tm, tm, tm, tm, tm, tm, tm};
  evaluateAt(middles, d);
  setupPair(pair);
  const RigidLanes& m = side_[0].m;
  for (int order = 0; order < 3; ++order) {
    for (int i = 0; i < 9; ++i) motion.R[order][i] = m.R[order][i][0];
    for (int i = 0; i < 3; ++i) motion.c[order][i] = m.c[order][i][0];
  }
  motion.rem_c = m.rem_c;
  motion.rem_R = m.rem_R;
  motion.pad = pad_;
}

/// Slot of a node's swept box in the still body's frame. One box serves every partner that the node meets in this batch.
inline int Solver::sweptNode(int side, int index) {
  Cached& cached = cached_[side][index & (kCached - 1)];
  if (isSwept(side, index)) return cached.slot;
  cached.epoch = pair_epoch_;
  cached.node = index;
  cached.slot = pool_.size();
  sweepNode(this->side(side).m, side_[side].moving->nodes[index], pad_ + margin_, pool_.grow());
  return cached.slot;
}

/// Lanes in which a swept box and a still one are apart along an axis.
FCL_ARTIC_INLINE unsigned apart(const SweptBox& box, const Node& node) {
  FloatLanes out = greater(box.lo[0], spread(node.hi[0])) | greater(spread(node.lo[0]), box.hi[0]);
  for (int i = 1; i < 3; ++i) out = out | greater(box.lo[i], spread(node.hi[i])) | greater(spread(node.lo[i]), box.hi[i]);
  return lanesOf(out);
}

inline unsigned Solver::nodesMayTouch(int a, int b, unsigned mask) {
  ++statistics_.node_tests;
  const Node &A = side_[0].still->nodes[a], &B = side_[0].moving->nodes[b];
  // Of two nodes one has mostly been met before: its swept box is there.
  const int known = isSwept(0, b) ? 0 : 1;
  const auto box = [&](int s) { return apart(pool_[s ? sweptNode(1, a) : sweptNode(0, b)], s ? B : A); };
  mask &= ~box(known);
  if (!mask) return 0;
  mask &= ~box(1 - known);
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
    separated |= certainlySeparated(side, still, box, still.size, margin_, pad_, sign);
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

/// Lanes of `mask` in which no direction tried keeps the pieces apart. Directions are GJK's witnesses at the middles of
/// lanes, each frozen in one frame and in the other and tried on all lanes.
/// @param most  so many overlapping middles end the search.
/// @param onOverlap  called with a lane at whose middle GJK claims overlap.
template <class F>
inline unsigned Solver::notSeparated(const Piece& a, const Piece& b, unsigned mask, int most, const F& onOverlap) {
  double guess[3], sign = 0;
  bool have_guess = false;
  Simplex last;
  unsigned untried = mask;
  while (most > 0 && (untried &= live_ & ~contact_lane_) != 0) {
    // The middle one of the lanes left: its direction serves neighbours on both sides, its contact ends the later half.
    int lane = 0;
    for (int skip = __builtin_popcount(untried) / 2, m = static_cast<int>(untried); m; m &= m - 1, --skip) {
      lane = __builtin_ctz(static_cast<unsigned>(m));
      if (skip == 0) break;
    }
    untried &= ~(1u << lane);
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
    // In the frame of the piece with more vertices first: the still piece's range takes one direction, the moving one's 24.
    double n[3];
    body.opposite(g.n, n);
    const int first = a.num_vertices > b.num_vertices ? 0 : 1;
    unsigned separated = 0;
    for (int i = 0; i < 2 && (mask & ~separated); ++i) {
      ++statistics_.certificates;
      separated |= (first + i) & 1 ? certainlySeparated(side(1), b, a, n, margin_, pad_, sign)
                                   : certainlySeparated(side(0), a, b, g.n, margin_, pad_, sign);
    }
    mask &= ~separated;
    untried &= mask;
  }
  return mask;
}

/// Puts the lanes behind this one off: there seems to be contact at its middle.
inline void Solver::claimOverlap(int lane) {
  if (decide_only_ || last_ || tm_at_[lane] >= claimed_) return;
  claimed_ = tm_at_[lane];
  updateLive();
}

/// Lanes of `mask` in which the hulls around both bodies are not certainly apart: what most pairs of neighbours need,
/// before any of their triangles is looked at.
/// @param claim  overlapping hulls count as a claim of contact.
inline unsigned Solver::hullsMayTouch(unsigned mask, int pair, bool claim) {
  const TreeView &A = *side_[0].still, &B = *side_[0].moving;
  if (A.num_pieces == 1 && B.num_pieces == 1) return query_->any ? leavesMayTouch(pair, 0, 0, mask) : mask;
  if (!A.outer || !B.outer) return mask;
  for (int s = 0; s < 2; ++s) {  // a small body within the bounds of a large mesh: its hull would say nothing
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
    if (inside) return mask;
  }
  return notSeparated(*A.outer, *B.outer, mask, kMostHullOverlaps, [&](int lane) {
    overlaps_ |= 1u << lane;
    if (query_->any && tm_at_[lane] >= watchFrom(pair) && proveVertexInside(pair, lane)) return;
    if (claim) claimOverlap(lane);
  });
}

/// Lanes of `mask` in which two leaves are not certainly apart.
inline unsigned Solver::leavesMayTouch(int pair, int piece_a, int piece_b, unsigned mask) {
  ++statistics_.leaf_tests;
  const Piece &a = side_[0].still->pieces[piece_a], &b = side_[0].moving->pieces[piece_b];
  double sign = 0;
  if (hasDirection(a)) {
    ++statistics_.certificates;
    mask &= ~certainlySeparated(side(0), a, b, a.size, margin_, pad_, sign);
    if (!mask) return 0;
  }
  if (hasDirection(b)) {
    ++statistics_.certificates;
    mask &= ~certainlySeparated(side(1), b, a, b.size, margin_, pad_, sign);
    if (!mask) return 0;
  }
  if (have_witness_) {
    ++statistics_.certificates;
    mask &= ~certainlySeparated(side(0), a, b, witness_, margin_, pad_, sign);
    if (!mask) return 0;
  }
  return notSeparated(a, b, mask, kLanes, [&](int lane) {
    if (tm_at_[lane] < watchFrom(pair)) return;
    if (query_->any && !decide_only_ && proveLeaves(pair, piece_a, piece_b, lane)) return;
    claimOverlap(lane);
  });
}

/// Dual traversal from one node pair; what stays undecided is appended to entries_.
inline void Solver::traverse(int pair, int a, int b, unsigned mask) {
  const Node *A = side_[0].still->nodes, *B = side_[0].moving->nodes;
  // Earliest lane first: once a contact is found, nothing was spent on later lanes alone.
  const auto push = [&](const Entry& e) { stack_[__builtin_ctz(e.mask)].push(e); };
  if (decide_only_ && a == 0 && b == 0) {
    mask = nodesMayTouch(0, 0, mask);
    if (mask) mask = hullsMayTouch(mask, pair, false);
    if (!mask) return;
  }
  const double split_time = last_ ? 0 : kSplitTime * amplitude_;
  Entry e = {pair, a, b, mask};
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
    if (e.a != 0 || e.b != 0 || roots_batch_ != batch_) e.mask = nodesMayTouch(e.a, e.b, e.mask);
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
    } else if (e.mask == contact_lane_ || max(x.radius, y.radius) < split_time) {
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

/// Swept box of a body's line swept sphere in the world, one per lane (Redon 2004, Section 4).
inline void Solver::sweptLss(int mover, SweptBox& box) {
  const Body& body = problem_->bodies[problem_->movers[mover]];
  const double margin = max(query_->margin, problem_->largest_margin);  // whatever the partner
  if (body.step < 0) {
    for (int k = 0; k < 3; ++k) {
      box.lo[k] = narrowDown(Lanes(body.lo[k] - margin));
      box.hi[k] = narrowUp(Lanes(body.hi[k] + margin));
    }
    return;
  }
  const FrameLanes& f = frames(0)[body.step];
  const StepBounds& b = bounds_[first_step_[0] + body.step];
  const double radius = (body.lss[6] + margin) * (1 + 4 * kUlp);
  const bool first_order = problem_->sweeps[0].first_order;
  Lanes lo[2][3], hi[2][3];
  for (int end = 0; end < 2; ++end) sweepBall(f, b, first_order, body.lss + 3 * end, radius, d_, lo[end], hi[end]);
  for (int k = 0; k < 3; ++k) {
    box.lo[k] = narrowDown(min(lo[0][k], lo[1][k]));
    box.hi[k] = narrowUp(max(hi[0][k], hi[1][k]));
  }
}

/// Stage 1: pairs whose swept bounds meet, with the lanes in which they do, to entries_.
inline void Solver::cull() {
  beginBatch(0, 1);
  mover_box_.resize(problem_->num_movers);
  for (int m = 0; m < problem_->num_movers; ++m) sweptLss(m, mover_box_[m]);
  if (query_->check_scene && problem_->obstacle_tree) {
    statistics_.pairs += static_cast<std::uint64_t>(problem_->num_scene_pairs);
    for (int m = 0; m < problem_->num_scene_movers; ++m) {
      const SweptBox& box = mover_box_[m];
      Buffer<Entry>& stack = stack_[0];
      stack.push({0, 0, 0, 0});
      while (stack.size()) {
        const Node& node = problem_->obstacle_tree[stack[stack.size() - 1].a];
        stack.truncate(stack.size() - 1);
        const unsigned mask = kAllLanes & ~apart(box, node);
        if (!mask) continue;
        if (!node.isLeaf()) {
          stack.push({0, node.right(), 0, 0});
          stack.push({0, node.left(), 0, 0});
          continue;
        }
        const int pair = m * problem_->num_obstacles + node.piece();
        if (!problem_->scene_allowed || !problem_->scene_allowed[pair]) entries_.push({pair, 0, 0, mask});
      }
    }
  }
  if (query_->check_self && !problem_->num_movers) {  // no stage 1: pairs of free bodies
    statistics_.pairs += static_cast<std::uint64_t>(problem_->num_link_pairs);
    for (int p = 0; p < problem_->num_link_pairs; ++p) {
      if (!linkAllowed(p)) entries_.push({problem_->num_scene_pairs + p, 0, 0, kAllLanes});
    }
  } else if (query_->check_self) {
    statistics_.pairs += static_cast<std::uint64_t>(problem_->num_link_pairs);
    for (int p = 0; p < problem_->num_link_pairs; ++p) {
      if (linkAllowed(p)) continue;
      const LinkPair& pair = problem_->link_pairs[p];
      const SweptBox& a = mover_box_[problem_->bodies[pair.a].mover];
      const SweptBox& b = mover_box_[problem_->bodies[pair.b].mover];
      FloatLanes out = greater(a.lo[0], b.hi[0]) | greater(b.lo[0], a.hi[0]);
      for (int k = 1; k < 3; ++k) out = out | greater(a.lo[k], b.hi[k]) | greater(b.lo[k], a.hi[k]);
      const unsigned mask = kAllLanes & ~lanesOf(out);
      if (mask) entries_.push({problem_->num_scene_pairs + p, 0, 0, mask});
    }
  }
  statistics_.pairs_after_culling += static_cast<std::uint64_t>(entries_.size());
}

/// A body's line swept sphere in each lane of [0, 1]: both ends' Bernstein points, and the larger of their radii.
inline void Solver::sweptSegments(int mover, engine::SweptLink* parts) {
  const Body& body = problem_->bodies[problem_->movers[mover]];
  const double radius = body.lss[6];
  double slack = radius;
  for (int end = 0; end < 2; ++end) {
    const double* p = body.lss + 3 * end;
    Lanes c[3][3];
    if (body.step < 0) {
      for (int k = 0; k < 3; ++k) {
        c[0][k] = Lanes(p[k]);
        c[1][k] = c[2][k] = Lanes(0.0);
      }
    } else {
      const StepBounds& b = bounds_[first_step_[0] + body.step];
      slack = max(slack, sweepCenter(frames(0)[body.step], b, problem_->sweeps[0].first_order, p, radius, d_, c));
    }
    for (int lane = 0; lane < kLanes; ++lane) {
      for (int k = 0; k < 3; ++k) {
        const double c0 = c[0][k][lane], c1 = c[1][k][lane], c2 = c[2][k][lane];
        parts[lane].points[end][k] = c0 - c1 + c2;
        parts[lane].points[2 + end][k] = c0 + c1 + c2;
        parts[lane].points[4 + end][k] = c0 - c2;
      }
    }
  }
  for (int lane = 0; lane < kLanes; ++lane) parts[lane].radius = slack * (1 + 4 * kUlp);
}

/// Stage 2, where the query brings one: pairs of links and still obstacles that it proves free are left out. (Pairs that are
/// not its business come behind them.)
inline void Solver::refine() {
  candidate_pairs_.clear();
  swept_links_.resize(kLanes * problem_->num_movers);
  int previous = -1;
  for (int i = 0; i < entries_.size() && entries_[i].pair < problem_->num_scene_pairs; ++i) {
    const Entry& e = entries_[i];
    const int mover = e.pair / problem_->num_obstacles;
    if (mover != previous) sweptSegments(previous = mover, swept_links_.data() + kLanes * mover);
    candidate_pairs_.push({e.pair, mover, problem_->obstacles[e.pair % problem_->num_obstacles], e.mask,
                           engine::marginOf(*problem_, query_->margin, e.pair)});
  }
  const int asked = candidate_pairs_.size();
  if (!asked) return;
  query_->refine(query_->refine_context, *problem_, swept_links_.data(), candidate_pairs_.data(), asked);
  int kept = 0;
  for (int i = 0; i < entries_.size(); ++i) {
    Entry e = entries_[i];
    if (i < asked) e.mask &= candidate_pairs_[i].lanes;
    if (e.mask) entries_[kept++] = e;
  }
  entries_.truncate(kept);
}

/// Time from which a pair in contact at t = 0 is watched: the start of its first free lane, on lanes down to 1/512.
/// 2 when it never separates.
inline double Solver::firstFreeTime(double start, double width, int begin, int end) {
  const double w = width / kLanes;
  beginBatch(start, width);
  last_ = true;  // down to the leaves
  blocked_ = 0;
  int present = -1;
  for (int i = begin; i < end; ++i) {
    const Entry e = entries_[i];
    if (e.pair != present) setupPair(present = e.pair);
    traverse(e.pair, e.a, e.b, kAllLanes);
  }
  const unsigned blocked = blocked_;
  for (int lane = 0; lane < kLanes; ++lane) {
    const double lane_start = start + lane * w;
    if (!(blocked >> lane & 1)) return out_of_budget_ ? 2 : lane_start;
    if (w > 1.0 / 512 && w > query_->tolerance_time) {
      const double t = firstFreeTime(lane_start, w, begin, end);
      if (t < 2) return t;
    }
  }
  return 2;
}

/// Finds the pairs in contact at t = 0 and from when they are watched.
inline void Solver::collectInitialContacts(int begin, int end) {
  decide_only_ = true;
  for (int i = begin; i < end; ++i) {
    const Entry e = entries_[i];
    const double tm[kLanes] = {0, 0, 0, 0, 0, 0, 0, 0};
    for (int k = 0; k < kLanes; ++k) lane_start_[k] = lane_end_[k] = 0;
    evaluateAt(tm, 0);
    live_ = 1;
    last_ = true;
    blocked_ = 0;
    setupPair(e.pair);
    traverse(e.pair, e.a, e.b, 1);
    if (!blocked_) continue;
    entries_.push(e);
    const PairParts pair = parts(e.pair);
    ignored_.push({e.pair, pair.a, pair.b, firstFreeTime(0, 1, entries_.size() - 1, entries_.size())});
    entries_.truncate(entries_.size() - 1);
  }
  decide_only_ = false;
}

/// A lane that entries_[begin, end) of one pair leave open, some of them: few leaf pairs are followed one by one, else the lane
/// is split.
inline Solver::Step Solver::solveOpenLane(double start, double width, int begin, int end, int lane, bool last) {
  int open = 0;
  bool leaves = true;
  for (int i = begin; i < end && (last || open <= kFewLeaves); ++i) {
    const Entry& e = entries_[i];
    if (!(e.mask >> lane & 1)) continue;
    ++open;
    leaves = leaves && isLeafPair(e);
  }
  if (!open) return Step::free;
  bool refine = true;
  if (leaves && (last || open <= kFewLeaves)) {
    last_ = last;
    if (finishLane(start, width, begin, end, lane, &refine) == Step::done) return Step::done;
  }
  return refine ? solveInterval(start, width, begin, end, lane) : Step::free;
}

/// One batch over [start, start + width] for entries_[begin, end), of which those with parent_lane set count (all, when
/// parent_lane < 0). The pair is proven free before `start`.
inline Solver::Step Solver::solveInterval(double start, double width, int begin, int end, int parent_lane) {
  const double w = width / kLanes;
  beginBatch(start, width);
  if (query_->progress && (statistics_.batches & 63) == 0) query_->progress(query_->progress_context, front_);
  const int out_begin = entries_.size();
  setupPair(entries_[begin].pair);
  for (int i = begin; i < end; ++i) {
    const Entry e = entries_[i];
    if (parent_lane >= 0 && !(e.mask >> parent_lane & 1)) continue;
    traverse(e.pair, e.a, e.b, kAllLanes);
    if (finished()) return Step::done;
  }
  const int out_end = entries_.size();
  const bool last = last_;
  for (int lane = 0; lane < kLanes; ++lane) {
    const double lane_start = start + lane * w;
    if (lane_start >= limit_) break;
    if (solveOpenLane(lane_start, w, out_begin, out_end, lane, last) == Step::done) return Step::done;
    entries_.truncate(out_end);
  }
  return Step::free;
}

/// Contact of two leaves at a lane's middle, where any contact is asked for.
inline bool Solver::proveLeaves(int pair, int piece_a, int piece_b, int lane) {
  const Piece &a = side_[0].still->pieces[piece_a], &b = side_[0].moving->pieces[piece_b];
  const DifferenceBody body = differenceAt(a, b, lane);
  LeafContact contact = {};
  ++statistics_.contact_proofs;
  const double* start = have_witness_ ? witness_ : body.pose.c;
  if (!certainlyTouching(body, margin_, pose_error_, start, contact.point)) return false;
  const PairParts bodies = parts(pair);
  contact.pair = pair;
  contact.body_a = bodies.a;
  contact.body_b = bodies.b;
  contact.piece_a = piece_a;
  contact.piece_b = piece_b;
  contact.certain = true;
  contact.t = contact.t_upper = tm_at_[lane];
  double size = norm(start);
  for (int k = 0; k < 3; ++k) contact.normal[k] = size > 0 ? start[k] / size : (k == 2);
  contacts_.push(contact);
  t_upper_ = limit_ = tm_at_[lane];
  updateLive();
  return true;
}

/// Where any contact is asked for: a vertex of the one body's mesh that lies within the other, a single solid piece, at a
/// lane's middle. The vertex of the mesh's hull that lies deepest in the solid's box is tried.
inline bool Solver::proveVertexInside(int pair, int lane) {
  for (int s = 0; s < 2; ++s) {
    const Side& side = this->side(s);
    const TreeView &mesh = *side.moving, &solid = *side.still;
    if (mesh.pieces[0].kind != PieceKind::vertices || !mesh.outer || mesh.outer->kind != PieceKind::hull) continue;
    if (solid.num_pieces != 1 || solid.pieces[0].kind == PieceKind::vertices || unbounded(solid.pieces[0])) continue;
    DifferenceBody body;
    for (int i = 0; i < 9; ++i) body.pose.R[i] = side.m.R[0][i][lane];
    for (int i = 0; i < 3; ++i) body.pose.c[i] = side.m.c[0][i][lane];
    const Node& box = solid.nodes[0];
    double center[3];
    middleOf(box, center);
    const double* x = mesh.hulls + mesh.outer->first_vertex;
    const int n = mesh.outer->num_vertices;
    double best = 1;
    int vertex = -1;
    for (int i = 0; i < n; i += kLanes) {  // lanes go over vertices
      Lanes depth(0.0);
      for (int k = 0; k < 3; ++k) {
        const double reach = 2 / (static_cast<double>(box.hi[k]) - static_cast<double>(box.lo[k]));
        const Lanes y = hullValues(x, n, i, body.pose.R + 3 * k) + Lanes(body.pose.c[k] - center[k]);
        depth = max(depth, abs(y) * Lanes(reach));
      }
      const double least = minLane(depth);
      if (least >= best) continue;
      best = least;
      vertex = i + __builtin_ctz(kAllLanes & ~greater(depth, Lanes(least)));
    }
    if (vertex < 0) continue;
    Piece point;
    point.kind = PieceKind::point;
    for (int k = 0; k < 3; ++k) point.center[k] = x[k * n + vertex];
    body.tree_a = &solid;
    body.a = &solid.pieces[0];
    body.tree_b = &mesh;
    body.b = &point;
    double guess[3], where[3];
    for (int k = 0; k < 3; ++k) guess[k] = dot(body.pose.R + 3 * k, point.center) + body.pose.c[k] - center[k];
    ++statistics_.contact_proofs;
    // Seen from the other side a pose errs by twice as much (doc/NUMERICS.md, "Pads").
    if (!certainlyTouching(body, margin_, (s ? 2.5 : 1) * pose_error_, guess, where)) continue;
    LeafContact contact = {};
    const PairParts bodies = parts(pair);
    contact.pair = pair;
    contact.body_a = bodies.a;
    contact.body_b = bodies.b;
    int piece = 0;  // a triangle with that vertex
    for (int i = 0; i < mesh.num_pieces; ++i) {
      const double* v = mesh.vertices + 3 * static_cast<std::ptrdiff_t>(mesh.pieces[i].first_vertex);
      for (int j = 0; j < mesh.pieces[i].num_vertices; ++j, v += 3) {
        if (v[0] == point.center[0] && v[1] == point.center[1] && v[2] == point.center[2]) piece = i;
      }
      if (piece == i && i) break;
    }
    (s ? contact.piece_a : contact.piece_b) = piece;
    contact.certain = true;
    contact.t = contact.t_upper = tm_at_[lane];
    // Outwards from the solid, through the side of its box that is nearest.
    double n_solid[3] = {0, 0, 0}, most = -1;
    int axis = 0;
    for (int k = 0; k < 3; ++k) {
      const double part = abs(guess[k]) / (static_cast<double>(box.hi[k]) - static_cast<double>(box.lo[k]));
      if (part > most) {
        most = part;
        axis = k;
      }
    }
    n_solid[axis] = guess[axis] < 0 ? -1 : 1;
    for (int k = 0; k < 3; ++k) {
      if (s == 0) {
        contact.point[k] = where[k];
        contact.normal[k] = n_solid[k];
      } else {  // the solid is B
        double p = side_[0].m.c[0][k][lane], m = 0;
        for (int j = 0; j < 3; ++j) {
          p += side_[0].m.R[0][3 * k + j][lane] * where[j];
          m -= side_[0].m.R[0][3 * k + j][lane] * n_solid[j];
        }
        contact.point[k] = p;
        contact.normal[k] = m;
      }
    }
    contacts_.push(contact);
    t_upper_ = limit_ = tm_at_[lane];
    updateLive();
    return true;
  }
  return false;
}

/// Where any contact is asked for: the poses in the middles of the lanes in which hulls overlap, pieces and all.
inline bool Solver::proveAnywhere() {
  if (overlapping_.size() == 0) return false;
  const double middles[kLanes] = {0.0625, 0.1875, 0.3125, 0.4375, 0.5625, 0.6875, 0.8125, 0.9375};
  evaluateAt(middles, 0);
  for (int k = 0; k < kLanes; ++k) lane_start_[k] = lane_end_[k] = middles[k];
  claimed_ = 2;
  last_ = true;  // down to the leaves
  updateLive();
  const int roots = entries_.size();
  for (int i = 0; i < overlapping_.size() && !finished(); ++i) {
    const Entry e = overlapping_[i];
    setupPair(e.pair);
    traverse(e.pair, e.a, e.b, e.mask);
    entries_.truncate(roots);
  }
  if (finished()) return true;
  claimed_ = 2;
  beginBatch(0, 1);
  return false;
}

/// The pieces of one pair, in a lane of the first batch, in windows that begin with how long the motion takes for a small
/// part of the smaller body: where hulls meet, the surfaces are not far.
inline void Solver::solvePieces(const Final& f, double stop, int begin, int end, int lane) {
  if (f.pieces) {
    const int roots = entries_.size();
    solveOpenLane(f.t_lower, stop - f.t_lower, begin, end, lane, false);
    entries_.truncate(roots);
    return;
  }
  setupPair(f.entry.pair);
  for (int k = 0; k < 3; ++k) witness_[k] = f.normal[k];
  have_witness_ = f.have_normal;
  const double size = kFirstWindow * min(side_[0].still->nodes[0].radius, side_[0].moving->nodes[0].radius);
  stop = min(stop, limit_);
  double span = f.speed * (stop - f.t_lower) > size ? max(size / f.speed, kNarrowestLane) : stop - f.t_lower;
  const int roots = entries_.size();
  for (double t = f.t_lower; t < min(stop, limit_); span *= 8) {
    const double next = t + 1.5 * span < min(stop, limit_) ? t + span : min(stop, limit_);
    const Step step = solveInterval(t, next - t, begin, end, lane);
    entries_.truncate(roots);
    if (step == Step::done) return;
    t = next;
  }
}

/// Part of the motion: the pairs that may touch in it, those that meet first before the others.
/// @param lane  of the first batch, whose entries count; -1: all do.
/// @param first_lanes  see advance().
inline void Solver::solveLane(double start, double stop, int lane, int begin, int end, unsigned first_lanes) {
  candidates_.clear();
  const int roots = entries_.size();
  for (int i = begin; i < end && !finished();) {
    // A run of entries of one pair.
    const int first = entries_.size(), pair_index = entries_[i].pair;
    bool leaves = true;
    for (; i < end && entries_[i].pair == pair_index; ++i) {
      const Entry e = entries_[i];
      if (lane >= 0 && !(e.mask >> lane & 1)) continue;
      leaves = leaves && isLeafPair(e);
      entries_.push(e);
    }
    const int count = entries_.size() - first;
    if (count == 0) continue;
    Final f = {};
    f.entry = entries_[first];
    f.t_lower = max(start, watchFrom(pair_index));
    f.first = first;
    f.count = count;
    // What is left may be one leaf pair, which is followed at once; whole bodies, of which the hulls are followed; or parts of
    // them that the first batch has come to already.
    const PairParts pair = parts(pair_index);
    const bool whole = f.entry.a == 0 && f.entry.b == 0;
    f.hulls = whole && !leaves && problem_->bodies[pair.a].tree->outer && problem_->bodies[pair.b].tree->outer;
    f.pieces = !(leaves && count == 1) && !f.hulls;
    if (f.t_lower >= stop || (!f.pieces && advance(f, stop, false, first_lanes))) {
      entries_.truncate(first);
      continue;
    }
    candidates_.push(f);
    outOfBudget();
  }
  for (int done = 0; done < candidates_.size() && !finished(); ++done) {
    int first = done;
    for (int i = done + 1; i < candidates_.size(); ++i) {
      if (candidates_[i].t_lower < candidates_[first].t_lower) first = i;
    }
    Final f = candidates_[first];
    candidates_[first] = candidates_[done];
    front_ = max(front_, f.t_lower);
    if (f.t_lower >= limit_) break;
    if (!f.hulls && !f.pieces) {
      if (settle(f, stop)) continue;
      if (f.certain) {
        describe(f, contacts_.grow());
        continue;
      }
    }
    claimed_ = 2;
    solvePieces(f, stop, f.first, f.first + f.count, lane);
  }
  entries_.truncate(roots);
  if (!finished()) front_ = stop;
}

/// A lane takes the present pair so far that little can be told of its pieces before the lane is split; of its hulls can.
inline bool Solver::movesFar() const {
  return amplitude_ > kLongMotion * min(side_[0].still->nodes[0].radius, side_[0].moving->nodes[0].radius);
}

/// Goes down from entries_[begin, end) over the batch at hand, in the lanes of `mask`; what stays undecided is appended.
inline void Solver::descend(int begin, int end, unsigned mask) {
  int present = -1;
  for (int i = begin; i < end && !finished(); ++i) {
    const Entry e = entries_[i];
    if (!(e.mask & mask)) continue;
    if (e.pair != present) setupPair(present = e.pair);
    if (movesFar()) {
      entries_.push({e.pair, e.a, e.b, e.mask & mask});
    } else {
      traverse(e.pair, e.a, e.b, e.mask & mask);
    }
  }
}

/// All pairs on one batch over [0, 1]; then lane by lane.
inline void Solver::solvePairs() {
  int roots = entries_.size();
  roots_batch_ = batch_;
  overlapping_.clear();
  for (int i = 0; i < roots && !finished(); ++i) {
    Entry& e = entries_[i];
    setupPair(e.pair);
    overlaps_ = 0;
    e.mask = nodesMayTouch(0, 0, e.mask);
    if (e.mask) e.mask = hullsMayTouch(e.mask, e.pair, !query_->every_pair && movesFar());
    if (overlaps_) overlapping_.push({e.pair, 0, 0, overlaps_});
    outOfBudget();
  }
  if (finished()) return;
  int open = 0;
  for (int i = 0; i < roots; ++i) {
    if (entries_[i].mask) entries_[open++] = entries_[i];
  }
  entries_.truncate(roots = open);
  if (query_->any && proveAnywhere()) return;
  const auto search = [&](int begin, int end) {
    t_upper_ = limit_ = 2;
    front_ = 0;
    const int from = entries_.size();
    if (end - begin == 1) {
      // One pair alone needs no order among pairs: it is followed from its first open lane to its last.
      const Entry& e = entries_[begin];
      setupPair(e.pair);
      if (isLeafPair(e) || (side_[0].still->outer && side_[1].still->outer && movesFar())) {
        const double start = 0.125 * __builtin_ctz(e.mask), stop = 0.125 * (32 - __builtin_clz(e.mask));
        return solveLane(start, stop, -1, begin, end, watchFrom(e.pair) > 0 ? 0 : e.mask);
      }
    }
    descend(begin, end, kAllLanes);
    for (int lane = 0; lane < kLanes && 0.125 * lane < limit_ && !finished(); ++lane) {
      solveLane(0.125 * lane, 0.125 * (lane + 1), lane, from, entries_.size());
      const unsigned later = kAllLanes & ~((2u << lane) - 1);
      if (!later || limit_ <= 0.125 * (lane + 1)) continue;
      bool put_off = false;
      const int end_now = entries_.size();
      for (int i = from; i < end_now; ++i) {
        put_off = put_off || ((entries_[i].mask & kPutOff) && (entries_[i].mask >> (lane + 1) & 1));
      }
      if (!put_off) continue;
      // What was claimed was no contact: the lanes that were put off are looked at after all, all at once.
      claimed_ = 2;
      beginBatch(0, 1);
      int present = -1;
      for (int i = from; i < end_now; ++i) {
        const Entry e = entries_[i];
        if (!(e.mask & kPutOff)) continue;
        entries_[i].mask = 0;
        if (e.pair != present) setupPair(present = e.pair);
        traverse(e.pair, e.a, e.b, e.mask & later);
      }
    }
  };
  if (!query_->every_pair) return search(0, open);
  double t_upper = 2;
  for (int i = 0; i < open && !out_of_budget_; ++i) {
    const int before = contacts_.size();
    entries_.truncate(open);
    beginBatch(0, 1);
    claimed_ = 2;
    updateLive();
    search(i, i + 1);
    orderContacts(before, limit_);
    t_upper = min(t_upper, t_upper_);
  }
  t_upper_ = t_upper;
  front_ = 0;
}

/// Follows a leaf pair from its t_lower towards `stop`: certificates over eight lanes with one direction, up to the first
/// root of the gap's bound; there a new direction, and lanes as wide as the gap will last at the speed seen so far. Two
/// directions tell how they turn: from then on the certificate's turns likewise, and the steps are a secant method's.
/// @param patient  goes on to the last; else the search ends where contact is to be expected within the tolerance.
/// @param first_lanes  not 0: begin with the first batch's lanes, of which all but these are free.
/// @return false where it ended before `stop` (and before the earliest proven contact).
inline bool Solver::advance(Final& f, double stop, bool patient, unsigned first_lanes) {
  const double expected = query_->tolerance_time / 16;
  double span = stop - f.t_lower, accuracy = patient ? 1e-7 : 0.02;
  double seen = f.t_lower, turn[3] = {0, 0, 0};  // when f.normal was found; how it turns, per unit of time
  bool turns = false;
  f.stuck = false;
  for (int round = 0; round < (patient ? 48 : 24); ++round) {
    const double t = f.t_lower;
    stop = min(stop, limit_);
    if (t >= stop) return true;
    const bool first = round == 0 && first_lanes;
    const double from = first ? 0 : t;
    span = first ? 1 : min(span, stop - t);
    const double w = span / kLanes, d = 0.5 * w + kLaneSlack;
    double tm[kLanes];
    for (int k = 0; k < kLanes; ++k) tm[k] = from + (k + 0.5) * w;
    evaluateAt(tm, d);
    setupPair(f.entry.pair);
    f.speed = amplitude_ / d;
    ++statistics_.leaf_tests;
    const Piece *piece_a, *piece_b;
    piecesOf(f, piece_a, piece_b);
    const Piece &a = *piece_a, &b = *piece_b;
    const double radii = a.radius + b.radius + margin_;
    // A witness at some time of the present lanes; false: the gap is gone there, or so it seems.
    const auto look = [&](int lane, double tau) {
      const DifferenceBody body = differenceAt(a, b, lane, tau);
      GjkResult g;
      gjk(body, f.have_normal ? f.normal : body.pose.c, accuracy, radii, 64, g, &f.simplex);
      ++statistics_.gjk;
      f.simplex = g.simplex;
      if (g.overlap) return false;
      for (int k = 0; k < 3; ++k) f.normal[k] = witness_[k] = g.n[k];
      f.gap = g.lower - radii;
      return f.have_normal = have_witness_ = true;
    };
    if (!f.have_normal && !look(first ? __builtin_ctz(first_lanes) : 0, -1)) break;

    // One bound along a direction that turns, or two along one that does not, in either frame.
    Lanes G[2][3];
    const int bounds = turns ? 1 : 2;
    if (turns) {
      TurningDirection n;
      const Lanes begin = tm_ - Lanes(seen + d);
      for (int k = 0; k < 3; ++k) {
        n.begin[k] = mulAdd(begin, turn[k], f.normal[k]);
        n.end[k] = n.begin[k] + Lanes(2 * d * turn[k]);
      }
      gapBound(side(0), a, b, n, margin_, pad_, G[0]);
    } else {
      const DifferenceBody here = differenceAt(a, b, 0);
      double n[3];
      here.opposite(f.normal, n);
      gapBound(side(0), a, b, f.normal, margin_, pad_, G[0]);
      gapBound(side(1), b, a, n, margin_, pad_, G[1]);
    }
    statistics_.certificates += static_cast<std::uint64_t>(bounds);
    unsigned separated = first ? kAllLanes & ~first_lanes : 0;
    for (int i = 0; i < bounds; ++i) separated |= greater(min(min(G[i][0], G[i][1]), G[i][2]), Lanes(0.0));
    if (separated == kAllLanes) {
      f.t_lower = min(stop, from + span);
      span *= 4;
      continue;
    }
    const int lane = __builtin_ctz(~separated);
    double x = 0;
    for (int i = 0; i < bounds; ++i) {
      const double coefficients[3] = {G[i][0][lane], G[i][1][lane], G[i][2][lane]};
      x = max(x, positivePrefix(coefficients));
    }
    // Lanes before it are free, and it is [tm - d, tm + d].
    const double root = (x >= 1 ? tm[lane] + d : (tm[lane] - d) + 2 * d * x) - 4 * kUlp;
    f.t_lower = max(t, min(stop, max(root, lane ? tm[lane] - 0.5 * w : t)));
    const double progress = f.t_lower - seen, gap = f.gap, before[3] = {f.normal[0], f.normal[1], f.normal[2]};
    if (!look(lane, (f.t_lower - tm[lane]) / d)) break;
    turns = progress > 0 && dot(before, f.normal) > 0.5 && !unbounded(a) && !unbounded(b);
    for (int k = 0; k < 3; ++k) turn[k] = turns ? (f.normal[k] - before[k]) / progress : 0;
    seen = f.t_lower;
    if (seen > t && gap > 0) {
      const double left = max(0.0, f.gap) * (progress / gap);  // time until the gap is closed, at the speed seen
      if (!patient && left < expected) break;
      span = min(4 * span, max(2 * left, kNarrowestLane));
    } else {
      // Not even a beginning: a better witness, narrower lanes.
      if (w < 64 * kUlp) break;
      accuracy = 1e-7;
      span *= 0.125;
    }
  }
  f.stuck = f.t_lower < min(stop, limit_);
  return !f.stuck;
}

inline void Solver::piecesOf(const Final& f, const Piece*& a, const Piece*& b) const {
  const TreeView &A = *side_[0].still, &B = *side_[0].moving;
  a = f.hulls ? A.outer : &A.pieces[A.nodes[f.entry.a].piece()];
  b = f.hulls ? B.outer : &B.pieces[B.nodes[f.entry.b].piece()];
}

/// Decides a leaf pair that is stuck, as far as can be: true when it is free after all; else f.certain tells.
inline bool Solver::settle(Final& f, double stop) {
  if (prove(f)) return false;
  if (advance(f, stop, true)) return true;
  prove(f);
  return false;
}

/// Proof of contact within the tolerance behind t_lower.
inline bool Solver::prove(Final& f) {
  // Not quite 1: the sum rounds, and the bracket is to be no wider than the tolerance.
  static const double kOffsets[kLanes] = {0.25, 0.5, 0.999, 0x1p-4, 0x1p-6, 0x1p-9, 0x1p-14, 0};
  double tm[kLanes];
  for (int k = 0; k < kLanes; ++k) tm[k] = min(1.0, f.t_lower + kOffsets[k] * query_->tolerance_time);
  evaluateAt(tm, 0);
  setupPair(f.entry.pair);
  const Piece& a = side_[0].still->pieces[side_[0].still->nodes[f.entry.a].piece()];
  const Piece& b = side_[0].moving->pieces[side_[0].moving->nodes[f.entry.b].piece()];
  const int head = f.have_normal ? 0 : kLanes - 1;  // never seen apart: in contact at t_lower itself
  for (int i = 0; i < kLanes; ++i) {
    const int k = (head + i) % kLanes;
    const DifferenceBody body = differenceAt(a, b, k);
    ++statistics_.contact_proofs;
    if (certainlyTouching(body, margin_, pose_error_, f.have_normal ? f.normal : body.pose.c, f.point,
                          &f.simplex)) {
      f.certain = true;
      f.t_upper = tm[k];
      t_upper_ = min(t_upper_, tm[k]);
      limit_ = min(limit_, tm[k]);
      return true;
    }
  }
  return false;
}

/// A pair that was never seen apart, as it touches where its window begins: looks back, ever farther, to where it was.
inline void Solver::lookBack(Final& f) {
  double tm[kLanes], step = query_->tolerance_time;
  for (double& t : tm) {
    t = max(0.0, f.t_lower - step);
    step *= 4;
  }
  evaluateAt(tm, 0);
  setupPair(f.entry.pair);
  const Piece *a, *b;
  piecesOf(f, a, b);
  for (int k = 0; k < kLanes && !f.have_normal; ++k) {
    const DifferenceBody body = differenceAt(*a, *b, k);
    GjkResult g;
    gjk(body, body.pose.c, 1e-7, a->radius + b->radius + margin_, 64, g);
    ++statistics_.gjk;
    if (g.overlap) continue;
    for (int j = 0; j < 3; ++j) f.normal[j] = g.n[j];
    f.have_normal = true;
  }
}

/// Point and normal of a pair that is stuck.
inline void Solver::describe(Final& f, LeafContact& contact) {
  if (!f.have_normal && f.t_lower > 0) lookBack(f);
  if (!(f.certain && f.have_normal)) {  // what is missing is seen at t_lower
    const double tm[kLanes] = {f.t_lower, f.t_lower, f.t_lower, f.t_lower, f.t_lower, f.t_lower, f.t_lower, f.t_lower};
    evaluateAt(tm, 0);
  }
  setupPair(f.entry.pair);
  const PairParts bodies = parts(f.entry.pair);
  contact = {};
  contact.pair = f.entry.pair;
  contact.body_a = bodies.a;
  contact.body_b = bodies.b;
  contact.piece_a = side_[0].still->nodes[f.entry.a].piece();
  contact.piece_b = side_[0].moving->nodes[f.entry.b].piece();
  contact.t_lower = f.t_lower;
  contact.certain = f.certain;
  contact.t_upper = f.certain ? f.t_upper : 1;
  contact.t = f.certain ? f.t_upper : f.t_lower;
  const Piece &a = side_[0].still->pieces[contact.piece_a], &b = side_[0].moving->pieces[contact.piece_b];
  const DifferenceBody body = differenceAt(a, b, 0);
  for (int k = 0; k < 3; ++k) contact.point[k] = f.point[k];
  if (!f.certain) {
    GjkResult g;
    gjk(body, f.have_normal ? f.normal : body.pose.c, 1e-7, 0, 64, g);
    originWeights(g.simplex);
    if (!f.have_normal && !g.overlap) {
      for (int k = 0; k < 3; ++k) f.normal[k] = g.n[k];
      f.have_normal = true;
    }
    // Midway between the surfaces: the cores' nearest points, each moved out by its radius.
    const double out = f.have_normal ? 0.5 * (a.radius - b.radius) : 0;
    double x[3], y[3];
    combine(body, g.simplex, x, y);
    for (int k = 0; k < 3; ++k) contact.point[k] = out * f.normal[k] + 0.5 * (x[k] + y[k]);
  }
  if (!f.have_normal) {
    // In contact from the start: an unbounded piece's own direction, or the one between the pieces' middles.
    double x[3], y[3], m[3], size = 0;
    middleOf(side_[0].still->nodes[f.entry.a], x);
    middleOf(side_[0].moving->nodes[f.entry.b], y);
    for (int k = 0; k < 3; ++k) {
      m[k] = dot(body.pose.R + 3 * k, y) + body.pose.c[k] - x[k];
      if (unbounded(a)) m[k] = a.size[k];
      if (unbounded(b)) m[k] = -dot(body.pose.R + 3 * k, b.size);
      size += m[k] * m[k];
    }
    for (int k = 0; k < 3; ++k) f.normal[k] = size > 0 ? m[k] / sqrt(size) : (k == 2);
  }
  for (int k = 0; k < 3; ++k) contact.normal[k] = f.normal[k];
}

/// Of contacts_[begin, ...) those that begin within the bracket, the first contact first, as many as are asked for.
inline void Solver::orderContacts(int begin, double bracket) {
  int kept = begin;
  for (int i = begin; i < contacts_.size(); ++i) {
    if (contacts_[i].t_lower <= bracket) contacts_[kept++] = contacts_[i];
  }
  const int end = min(kept, begin + query_->max_contacts);
  for (int i = begin; i < end; ++i) {  // a few: selection sort by certainty, then time
    int best = i;
    for (int j = i + 1; j < kept; ++j) {
      const LeafContact &x = contacts_[j], &y = contacts_[best];
      const bool better = x.certain != y.certain ? x.certain
                          : x.certain            ? x.t_upper < y.t_upper
                                                 : x.t_lower < y.t_lower;
      if (better) best = j;
    }
    const LeafContact swap = contacts_[i];
    contacts_[i] = contacts_[best];
    contacts_[best] = swap;
  }
  contacts_.truncate(end);
}

/// The leaf pairs that a lane leaves undecided, one by one: how far is each free, and is there contact?
/// @param[out] refine  the lane is to be split: it is wider than the tolerance, or the pairs are farther apart than the
///   distance tolerance, and nothing is proven.
inline Solver::Step Solver::finishLane(double start, double width, int begin, int end, int lane, bool* refine) {
  const bool last = last_;
  const double stop = start + width;
  finals_.clear();
  for (int i = begin; i < end; ++i) {
    const Entry& e = entries_[i];
    if (!(e.mask >> lane & 1)) continue;
    Final f = {};
    f.entry = e;
    f.t_lower = max(start, watchFrom(e.pair));
    finals_.push(f);
  }
  *refine = false;
  for (int i = 0; i < finals_.size(); ++i) {
    Final& f = finals_[i];
    if (!advance(f, stop, false)) settle(f, stop);
    if (outOfBudget()) return Step::done;
    // It touches from the beginning on: nothing can be earlier, and of many such pairs some are enough.
    const bool enough = f.certain && f.t_lower <= start && i >= max(64, query_->max_contacts);
    if (enough || finished()) finals_.truncate(i + 1);
  }
  const bool narrow = width <= kNarrowestLane;
  for (int i = 0; i < finals_.size(); ++i) {
    const Final& f = finals_[i];
    if (!f.stuck || f.certain || f.t_lower >= limit_) continue;
    if (!narrow && (!last || (f.have_normal && f.gap > 0.5 * query_->tolerance_distance))) {
      *refine = true;
      return Step::free;
    }
    limit_ = min(limit_, f.t_lower + query_->tolerance_time);
  }
  const int before = contacts_.size();
  for (int i = 0; i < finals_.size(); ++i) {
    if (finals_[i].stuck && finals_[i].t_lower <= limit_) describe(finals_[i], contacts_.grow());
  }
  return contacts_.size() > before ? Step::done : Step::free;
}

inline void Solver::solve(const Problem& problem, const Query& query, Answer& answer) {
  problem_ = &problem;
  query_ = &query;
  statistics_ = Statistics();
  entries_.clear();
  contacts_.clear();
  ignored_.clear();
  front_ = 0;
  witness_pair_ = present_ = roots_batch_ = -1;
  t_upper_ = limit_ = claimed_ = 2;
  d_ = -1;
  out_of_budget_ = decide_only_ = false;
  first_step_.resize(problem.num_sweeps);
  bounds_ready_.resize(problem.num_sweeps);
  sweep_epoch_.resize(problem.num_sweeps);
  int steps = 0;
  for (int i = 0; i < problem.num_sweeps; ++i) {
    first_step_[i] = steps;
    steps += problem.sweeps[i].num_steps;
    bounds_ready_[i] = 0;
    sweep_epoch_[i] = -1;
  }
  frames_.resize(max(frames_.size(), steps));
  bounds_.resize(max(bounds_.size(), steps));
  // Epochs only ever grow; long before they overflow the stamps are made new.
  if (batch_ > 1 << 30 || pair_epoch_ > 1 << 30) {
    batch_ = pair_epoch_ = 0;
    __builtin_memset(cached_, -1, sizeof cached_);
  }

  const double time0 = now();
  cull();
  statistics_.culling_us = now() - time0;
  if (query.refine) refine();
  const double time1 = now();
  if (query.ignore_initial) {
    collectInitialContacts(0, entries_.size());
    beginBatch(0, 1);
  }

  if (!out_of_budget_) solvePairs();

  double t_lower = 2;
  for (int i = 0; i < contacts_.size(); ++i) t_lower = min(t_lower, contacts_[i].t_lower);
  // A pose proven in contact and a proof that all of [0, 1] is free would contradict each other: a fault of ours, and then
  // contact is the answer that harms nobody.
  if (t_upper_ < t_lower) t_lower = 0;
  const bool contact = t_lower < 2;
  // Where the budget ended among the initial contacts, nothing is known of when they are over.
  if (out_of_budget_) t_lower = query.ignore_initial ? 0 : min(front_, t_lower);
  const bool certain = contact && (query.any ? t_upper_ < 2 : t_upper_ - t_lower <= query.tolerance_time * (1 + 1e-9));
  if (query.any && t_upper_ < 2) t_lower = min(t_lower, front_);
  if (!query.every_pair) orderContacts(0, certain ? t_upper_ : t_lower + query.tolerance_time);
  answer.verdict = out_of_budget_ ? Verdict::undecided : contact ? Verdict::contact : Verdict::free;
  answer.certain = answer.verdict == Verdict::contact && certain;
  answer.t_lower = answer.verdict == Verdict::free ? 1 : t_lower;
  answer.t_upper = answer.verdict == Verdict::free ? 1 : min(1.0, t_upper_);
  answer.contacts = contacts_.data();
  answer.num_contacts = answer.verdict == Verdict::contact ? contacts_.size() : 0;
  answer.ignored = ignored_.data();
  answer.num_ignored = ignored_.size();
  statistics_.narrowphase_us = now() - time1;
  answer.statistics = statistics_;
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
