// SPDX-License-Identifier: BSD-3-Clause
//
// The solver: first contact over all pairs, eight time intervals at once.
//
//   solve            stage 1 (cull); then all pairs left, [0, 1] in eight lanes: boxes and hulls of whole bodies
//   solveLane        lane by lane from the earliest, the pairs that may touch in it: their hulls are followed to where
//                    they meet (advance), then the pieces below; the pair that meets first is solved first
//   solveInterval    one pair, eight equal parts of an interval: dual traversal, then, lane by lane from the earliest,
//                    the same again on what that lane left undecided
//   traverse         node pairs by swept boxes, leaf pairs by certificates; where GJK claims overlap, later lanes are
//                    put off
//   finishLane       a few leaf pairs left in a lane, each followed by itself: t_lower by the certificate's first root
//                    (advance: Newton's steps), then t_upper by proofs of contact
//
// Each of these has a file in solver/. What is discarded is discarded by the certificate (certificate.h) or by a swept
// box, which is the same certificate with the frames' axes as directions. All else here is order and effort.
#pragma once

#include <time.h>

#include "convex/chord.h"
#include "convex/contact_proof.h"
#include "model/answer.h"
#include "model/bracket.h"
#include "model/query.h"
#include "narrowphase/certificate.h"
#include "narrowphase/solver/swept_box.h"
#include "narrowphase/solver/swept_lss.h"
#include "narrowphase/swept_difference.h"
#include "numerics/assertion.h"
#include "numerics/buffer.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

using engine::Answer;
using engine::Body;
using engine::Ignored;
using engine::LeafContact;
using engine::LinkPair;
using engine::Node;
using engine::Problem;
using engine::Query;
using engine::Statistics;

/// Pieces whose `size` is a direction worth trying.
FCL_ARTIC_INLINE bool hasDirection(const Piece& piece) {
  return piece.kind == PieceKind::vertices || unbounded(piece);
}

/// The middle one of some lanes.
FCL_ARTIC_INLINE int middleLane(unsigned lanes) {
  for (int skip = __builtin_popcount(lanes) / 2; skip; --skip) lanes &= lanes - 1;
  return __builtin_ctz(lanes);
}

/// A pair of nodes that is not yet decided in the lanes of `mask`.
struct Entry {
  std::int32_t pair, a, b;
  unsigned mask;  ///< and the flags below
};
/// Not looked at, as contact was claimed before these lanes.
constexpr unsigned kPutOff = 0x100;
/// The one body is within the bounds of the other, a large mesh: hulls tell nothing.
constexpr unsigned kWithin = 0x200;

struct PlacedLink;

class Solver {
 public:
  void solve(const Problem& problem, const Query& query, Answer& answer);
  void pairMotion(int pair, double tm, double d, engine::PairMotion& motion);

 private:
  enum class Step { free, done };
  /// Whether directions are looked for that certify whole lanes, and what to begin with: `towards` (from A to B in A's
  /// frame, about, for each lane), or, null, the witness at a lane's middle where that does not do.
  struct Whole {
    bool wanted = false;
    const Lanes* towards = nullptr;
  };
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
  bool isLink(int mover) const { return mover < problem_->num_scene_movers; }
  void sweepMover(int mover);
  void meetObstacles(const SweptBox& box);
  unsigned lssMayTouch(int mover, int obstacle_number, unsigned mask, Lanes* direction);
  void sweptSegments(int mover, engine::SweptLink* parts);
  void refine();
  bool mayIgnore(int pair) const;
  void collectInitialContacts(int begin, int end);
  void findContained(int pair, double t, engine::Containment& found);
  bool mayBeContained(int pair, double t);
  void testAtStart(int pair);
  void findContainedAtStart();
  bool isContained(int pair) const;
  void reportContained();
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
  Final leafPair(const Entry& e, double start) const;
  static int pieceAtWitness(const TreeView& tree, const Simplex& simplex, bool of_a);
  void proveBelowHulls(Final& f);
  bool advance(Final& f, double stop, bool patient, unsigned first_lanes = 0);
  bool proveAhead(Final& f, int lane);
  bool settle(Final& f, double stop);
  bool prove(Final& f);
  void lookBack(Final& f);
  void describe(Final& f, LeafContact& contact);
  void orderContacts(int begin, double bracket);
  void traverse(int pair, int a, int b, unsigned mask);
  unsigned nodesMayTouch(int a, int b, unsigned mask);
  unsigned partsMayTouch(int a, int b, unsigned mask);
  unsigned apartFromUnbounded(int a, int b);
  template <class F>
  unsigned notSeparated(const Piece& a, const Piece& b, unsigned mask, int most, Simplex& last, Whole whole,
                        const F& onOverlap);
  Simplex& simplexOf(int pair);
  void claimOverlap(int lane);
  bool isWithin();
  unsigned hullsMayTouch(unsigned mask, int pair, bool claim, Whole whole);
  bool proveVertexInside(int pair, int lane);
  bool provePierced(int pair, int lane, const double* near);
  bool takeProof(int pair, double t);
  LeafContact* record(int pair, int piece_a, int piece_b, int lane);
  void record(Final& f);
  bool proveLeaves(int pair, int piece_a, int piece_b, int lane);
  bool proveAnywhere();
  void considerPose(int pair, Lanes square, double radii);
  PlacedLink placedLink(int mover, int lane);
  double reachOfBalls(int pair) const;
  bool proveByBalls(int pair, int lane);
  bool proveByBallInSolid(int pair, int lane);
  bool proveAtPoses();
  bool proveWhereLikely();
  bool proveAtPose(int pair, int lane);
  bool proveTriangles(int pair, int piece_a, int piece_b, int lane);
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
  unsigned live_ = 0;           ///< lanes that are worth work: not behind a contact that is proven or claimed
  unsigned contact_lane_ = 0;   ///< the lane with the earliest of these: it is split whatever else is found in it
  bool last_ = false;           ///< lanes are as narrow as the tolerance: descend to the leaves
  unsigned overlaps_ = 0;       ///< lanes in whose middles hulls overlap, as far as looked at
  /// Earliest time at which GJK claimed overlap; 2: none. Lanes after it are put off, not dropped.
  double claimed_ = 2;
  bool decide_only_ = false;  ///< only which lanes are free matters (initial contacts)
  /// It is known from when on each pair is watched. Before, with initial contacts to be ignored, no contact counts.
  bool watching_ = true;
  unsigned blocked_ = 0;  ///< lanes found not free, with decide_only_

  Buffer<FrameLanes> frames_;        ///< of all sweeps, one after the other
  Buffer<std::int32_t> first_step_;  ///< per sweep, into frames_ and bounds_
  Buffer<std::int32_t> sweep_epoch_;
  Buffer<StepBounds> bounds_;
  Buffer<std::int32_t> bounds_ready_;
  std::int32_t batch_ = 0;

  // The present pair.
  /// [0]: B seen from A; [1]: A seen from B. Certificates take them from side(), which makes what is missing.
  Side side_[2];
  bool side_ready_[2] = {false, false};
  double pad_ = 0, pose_error_ = 0, amplitude_ = 0, margin_ = 0;
  double witness_[3];  ///< the last direction that GJK found between pieces of this pair
  bool have_witness_ = false;
  std::int32_t witness_pair_ = -1;
  std::int32_t present_ = -1, present_batch_ = -1;  ///< the pair, and the batch it was set up for
  const std::uint64_t* free_nodes_ = nullptr;       ///< of A, a bit each; null: none (engine::CullCandidate)
  /// The last simplices of pairs' hulls: a small direct-mapped cache; what is pushed out is found again.
  static constexpr int kHullSimplices = 32;
  struct HullSimplex {
    std::int32_t pair;
    std::uint64_t query;
    Simplex simplex;
  };
  HullSimplex hull_simplices_[kHullSimplices] = {};
  std::uint64_t query_number_ = 0;
  std::int32_t roots_batch_ = -1;  ///< the batch whose node pairs (0, 0) have been tested
  /// Swept boxes of this pair and batch, by node of the moving tree of each side: a small direct-mapped cache stays in
  /// the processor's own; what is pushed out is made again.
  static constexpr int kCached = 2048;
  struct Cached {
    std::int32_t node, epoch, slot;
  };
  Cached cached_[2][kCached] = {};
  Buffer<SweptBox> pool_;
  std::int32_t pair_epoch_ = 0;

  Buffer<SweptBox> mover_box_;
  Buffer<SweptLss> mover_lss_;  ///< of links
  struct Met {
    std::int32_t obstacle;
    unsigned mask;  ///< lanes in which its box meets the link's
  };
  Buffer<Met> met_;
  Buffer<std::int32_t> open_nodes_;
  Buffer<engine::SweptLink> swept_links_;
  Buffer<engine::CullCandidate> candidate_pairs_;
  Buffer<engine::CullCandidate> partly_free_;  ///< those left of which stage 2 has proven nodes free
  /// From an obstacle to a link, in the obstacle's tree frame, in the middles of the first batch's lanes; of any
  /// length.
  struct Direction {
    Lanes l[3];
  };
  Buffer<Direction> directions_;  ///< of the first entries that stage 1 leaves, those of links and still obstacles
  Buffer<Entry> entries_;
  Buffer<Entry> overlapping_;  ///< pairs whose hulls overlap in the middles of lanes of the first batch
  /// A pose at which contact of two links is expected.
  struct Look {
    std::int32_t pair, lane;
    double distance;  ///< of their line swept spheres' segments, as part of the radii
    unsigned near;    ///< other lanes in which balls inside them may meet
  };
  Buffer<Look> looks_;
  Buffer<Entry> stack_[kLanes];  ///< node pairs to visit, by their earliest lane
  Buffer<Ignored> ignored_;
  Buffer<LeafContact> contained_;  ///< pairs in which one body lies within the other, a solid mesh, at t = 0
  /// What is followed by itself: a leaf pair, the hulls around a pair of bodies, or parts of these.
  struct Final {
    Entry entry;
    std::int32_t piece_a, piece_b;  ///< of a leaf pair
    bool hulls;                     ///< the hulls, not a leaf pair
    bool pieces;                    ///< neither: the entries only
    std::int32_t first, count;      ///< of a lane of the first batch: its entries
    double t_lower;                 ///< free before
    double normal[3];               ///< GJK's witness at t_lower
    double gap;                     ///< along it: a lower bound, when GJK ends early far below
    double apart;                   ///< an upper bound of the gap, from points of both
    double speed;                   ///< of the one body seen from the other, about
    bool have_normal;
    Simplex simplex;  ///< GJK's last
    bool stuck;       ///< the gap is gone at t_lower, as far as can be told
    bool certain;
    double t_upper, point[3];  ///< a proven contact
  };
  Buffer<Final> finals_, candidates_;
  Buffer<LeafContact> contacts_;

  double front_ = 0;            ///< all pairs are proven free before
  double t_upper_ = 2;          ///< earliest proven contact so far (with every pair: of the present one); 2: none
  engine::FirstContact found_;  ///< of all contacts of this query
  /// What lies after it does not matter any more: t_upper_, or the tolerance after an undecided contact.
  double limit_ = 2;
  bool out_of_budget_ = false;  ///< or the caller has ended the query
};

/// A node so many times larger than its partner is not seen from that one, unless it has been already. Measured: a
/// quarter less time for a link amid one large mesh, nothing elsewhere; 1 is slower.
constexpr double kLargerNode = 2;
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
/// A traversal that has left so many pairs open leaves the others as they are: that lane is to be split anyway.
/// Measured: 128 are slower for arms, without any bound a body of 40,000 triangles takes up to 20 ms.
constexpr int kMostOpen = 512;
/// What GJK claims to overlap is nearer than this part of the smaller body, about: rounding is 1e-15 of it, flat
/// simplices may lose more. Finer tolerances have such lanes divided on, which with the usual one costs what rests on
/// something 8 batches more for nothing.
constexpr double kOverlapAccuracy = 1e-9;
/// So many leaf pairs in a lane are followed one by one; more are split in time first.
constexpr int kFewLeaves = 12;
/// A body is expected to touch what is nearer to its line swept sphere's segment than this part of the radius.
/// Measured: from 0.7 on to 1 it makes no difference, below contacts are found later.
constexpr double kDeep = 0.7;
/// The same where its vertices do not.
constexpr double kVeryDeep = 0.35;
/// Links are expected to touch whose line swept spheres' segments are nearer than this part of the radii.
constexpr double kDeepLinks = 0.7;
/// So many pairs of boxes are looked at in one pose where any contact will do. Measured: twice as many prove more
/// contacts of a UR5, and make its free motions 5 % slower.
constexpr int kMostAtPose = 512;
/// In solids narrower than this part of a line swept sphere's radius vertices are looked for after chords.
constexpr double kThin = 0.5;
/// The first window of time in which pieces are looked at, as the part of the smaller body's radius that the motion
/// covers in it.
constexpr double kFirstWindow = 0.4;
/// Motion in half a lane of the first batch, as part of the smaller body's radius, above which its pieces are not
/// looked at.
constexpr double kLongMotion = 0.2;
/// GJK stops when it knows the gap to this part: enough for a direction.
constexpr double kWitnessAccuracy = 0.1;
/// The same where two directions are to tell how they turn. Measured: 0.1 takes 20 % more rounds, 0.001 a few per cent
/// fewer at more expense.
constexpr double kFollowingAccuracy = 0.02;

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic

#include "narrowphase/solver/any_contact.h"
#include "narrowphase/solver/batch.h"
#include "narrowphase/solver/culling.h"
#include "narrowphase/solver/following.h"
#include "narrowphase/solver/initial_contacts.h"
#include "narrowphase/solver/inner_balls.h"
#include "narrowphase/solver/search.h"
#include "narrowphase/solver/solid_contact.h"
#include "narrowphase/solver/solids.h"
#include "narrowphase/solver/traversal.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

inline void Solver::solve(const Problem& problem, const Query& query, Answer& answer) {
  FCL_ARTIC_ASSERT(query.tolerance_time > 0 && query.tolerance_distance > 0 && query.max_contacts >= 0);
  FCL_ARTIC_ASSERT(query.degree >= 1 && query.degree <= engine::kMaxDegree);
  problem_ = &problem;
  query_ = &query;
  ++query_number_;
  statistics_ = Statistics();
  entries_.clear();
  directions_.clear();
  contacts_.clear();
  overlapping_.clear();
  looks_.clear();
  ignored_.clear();
  contained_.clear();
  partly_free_.clear();
  front_ = 0;
  witness_pair_ = present_ = roots_batch_ = -1;
  t_upper_ = limit_ = claimed_ = 2;
  d_ = -1;
  out_of_budget_ = decide_only_ = false;
  watching_ = !query.ignore_initial;
  found_ = {};
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
  if (query.any && !finished()) proveAnywhere();
  if (query.any && !finished()) proveAtPoses();
  statistics_.culling_us = now() - time0;
  if (problem.contained && !finished()) findContainedAtStart();
  if (query.refine && !finished()) refine();
  const double time1 = now();
  if (query.ignore_initial && !finished()) {
    collectInitialContacts(0, entries_.size());
    beginBatch(0, 1);
  }
  if (contained_.size() && !out_of_budget_) {
    reportContained();
    updateLive();
  }

  if (!out_of_budget_ && limit_ > 0) solvePairs();

  // A pose proven in contact before the time up to which all is proven free would be a contradiction: a fault of ours,
  // and then contact is the answer that harms nobody.
  FCL_ARTIC_ASSERT(out_of_budget_ || found_.t_lower <= found_.t_upper);
  if (found_.t_upper < found_.t_lower) found_.t_lower = 0;
  const bool contact = found_.t_lower < engine::kNever;
  const bool certain = engine::isCertain(found_, query.tolerance_time, query.any);
  if (!query.every_pair) orderContacts(0, certain ? found_.t_upper : found_.t_lower + query.tolerance_time);
  // Where any contact ends the search, proven or not, other pairs have come to front_ only.
  if (query.any && contact) engine::joinLower(found_, front_);
  // Where the budget ended among the initial contacts, nothing is known of when they are over.
  const double proven_free = query.ignore_initial ? 0 : min(front_, found_.t_lower);
  static_cast<Bracket&>(answer) = out_of_budget_ ? engine::undecidedBracket(proven_free, found_)
                                                 : engine::bracketOf(found_, query.tolerance_time, query.any);
  FCL_ARTIC_ASSERT(answer.t_lower >= 0 && answer.t_lower <= answer.t_upper && answer.t_upper <= 1);
  answer.contacts = contacts_.data();
  answer.num_contacts = answer.status == Status::contact ? contacts_.size() : 0;
  FCL_ARTIC_ASSERT(answer.status != Status::contact || answer.num_contacts || !query.max_contacts);
  answer.ignored = ignored_.data();
  answer.num_ignored = ignored_.size();
  statistics_.narrowphase_us = now() - time1;
  answer.statistics = statistics_;
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
