// SPDX-License-Identifier: BSD-3-Clause
//
// The motion of a pair's two bodies against each other over one batch. RelativeMotions makes it when it is asked for,
// and keeps the last one: mostly the search asks for the same pair over the same batch again.
#pragma once

#include "convex/cloud.h"
#include "convex/contact_proof.h"
#include "narrowphase/certificate.h"
#include "narrowphase/solver/strays.h"
#include "narrowphase/solver/swept_box.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

/// Two pieces, of A and of B.
struct PiecePair {
  PieceRoom room_a, room_b;
  const Piece &a, &b;

  PiecePair(const Piece& piece_a, const Piece& piece_b) : a(piece_a), b(piece_b) {}
  /// By their numbers.
  PiecePair(const TreeView& tree_a, int piece_a, const TreeView& tree_b, int piece_b)
      : a(pieceOf(tree_a, piece_a, room_a)), b(pieceOf(tree_b, piece_b, room_b)) {}
  PiecePair(const PiecePair&) = delete;
  PiecePair& operator=(const PiecePair&) = delete;

  bool areBounded() const { return !unbounded(a) && !unbounded(b); }
};

class RelativeMotion : PartOfSolver {
 public:
  RelativeMotion(Task& task, SweptFrames& frames) : PartOfSolver(task), frames_(frames), strays_(task, frames) {}

  PairId pair() const { return pair_; }
  const TimeBatch& batch() const {
    FCL_ARTIC_ASSERT(of_batch_ == frames_.number());
    return frames_.batch();
  }
  /// The number of its batch: another batch has another one.
  std::int32_t batchNumber() const { return of_batch_; }
  const TreeView& a() const { return *side_[0].still; }
  const TreeView& b() const { return *side_[0].moving; }
  double smallerRadius() const { return min(a().nodes[0].radius, b().nodes[0].radius); }

  /// One body seen from the other, ready for certificates. s = 0: B seen from A; s = 1: A seen from B. Made when first
  /// asked for: many pairs need only one of the two, or none.
  const Side& side(int s) {
    if (!side_ready_[s]) {
      if (s) invert(side_[0].m, side_[1].m);
      side_[s].m.makeBernstein();
      side_ready_[s] = true;
    }
    return side_[s];
  }
  /// B seen from A, as it is evaluated: without what certificates need.
  const RigidLanes& seenFromA() const { return side_[0].m; }
  /// The way of a point p of the moving body's tree frame as seen from the other's, in side(s).
  /// @param[out] x  its quadratic.
  /// @return radius: at each time the point is no farther than this from x.
  double seePoint(int s, const Vec3& p, PointLanes& x) {
    const RigidLanes& m = s ? side(1).m : side_[0].m;
    for (int order = 0; order < 3; ++order) x.c[order] = mulAdd(m.R[order], spread(p), m.c[order]);
    // The pad is for points no farther out than the bodies' own; it scales with sizes.
    const double reach = norm(p) * (1 + 8 * kUlp), sizes = max(a().extent + b().extent, kLeastLength);
    return m.rem_c + m.rem_R * reach + pad() * (1 + reach / sizes);
  }
  /// The trees of side(s): of the body from which is seen, and of the one that moves as seen from it.
  const TreeView& still(int s) const { return *side_[s].still; }
  const TreeView& moving(int s) const { return *side_[s].moving; }

  /// Farther apart than this, the bodies are certainly more than their margin apart in all of the tube, over the batch.
  double apartMargin() const { return side_[0].margin; }
  /// The pair's margin, without the tube.
  double margin() const { return side_[0].own_margin; }
  /// In the middle of a lane: nearer than this along n, two pieces may be in contact in the tube.
  /// @param n  unit, in A's tree frame.
  double touchMargin(const Piece& a, const Piece& b, const Vec3& n, int lane) const {
    if (!side_[0].tube) return margin();
    const TubePieces pieces = {this->a(), this->b(), a, b, side_[0].m};
    return margin() + tubeAlong(tube_, pieces, spread(n), Lanes(1.0), false, 1u << lane)[lane];
  }
  /// Upper bound of the tube's part, over the batch.
  double stray() const { return tube_.over; }
  double pad() const { return side_[0].pad; }
  /// Bound on the error of a pose, for proofs of contact.
  double poseError() const { return pose_error_; }
  /// About how far the body moves in half an interval: B seen from A, or A seen from an unbounded B.
  double amplitude() const { return amplitude_; }

  /// The last direction that GJK found between pieces of this pair; null: none.
  const Vec3* witness() const { return have_witness_ ? &witness_ : nullptr; }
  void setWitness(const Vec3& direction) {
    witness_ = direction;
    have_witness_ = true;
  }
  /// The pieces at a lane's middle, or, but for the remainder, at any tau of it.
  DifferenceBody differenceAt(const Piece& piece_a, const Piece& piece_b, int lane, double tau = 0) const {
    DifferenceBody body;
    body.tree_a = side_[0].still;
    body.tree_b = side_[0].moving;
    body.a = &piece_a;
    body.b = &piece_b;
    const RigidLanes& m = side_[0].m;
    body.pose = {laneOf(m.R[0], lane), laneOf(m.c[0], lane)};
    if (tau != 0) {
      body.pose.R = body.pose.R + (laneOf(m.R[1], lane) + laneOf(m.R[2], lane) * tau) * tau;
      body.pose.c = body.pose.c + (laneOf(m.c[1], lane) + laneOf(m.c[2], lane) * tau) * tau;
    }
    return body;
  }

  /// A node's swept box in the still body's frame, pad and margin included. One box serves every partner that the node
  /// meets in this batch.
  /// @param at  the node with this number.
  const SweptBox& sweptNode(int s, int node, const Node& at) {
    Cached& cached = cached_[s][node & (kCached - 1)];
    if (!isSwept(s, node)) {
      cached = {node, epoch_, pool_.size()};
      sweepNode(side(s).m, at, pad() + apartMargin(), pool_.grow());
    }
    return pool_[cached.slot];
  }
  /// Whether a node's swept box is there already.
  bool isSwept(int s, int node) const {
    const Cached& cached = cached_[s][node & (kCached - 1)];
    return cached.epoch == epoch_ && cached.node == node;
  }
  /// A number: it is another one for another pair or batch.
  std::int32_t epoch() const { return epoch_; }

 private:
  friend class RelativeMotions;

  void begin();
  void set(PairId pair, const TimeBatch& batch);
  void relate();

  SweptFrames& frames_;
  Strays strays_;
  PairId pair_ = engine::kNoPair;
  std::int32_t of_batch_ = -1;
  Side side_[2];
  bool side_ready_[2] = {false, false};
  Tube tube_;
  double pose_error_ = 0, amplitude_ = 0;
  Vec3 witness_;
  bool have_witness_ = false;
  PairId witness_pair_ = engine::kNoPair;

  /// Swept boxes by node of the moving tree of each side: a small direct-mapped cache stays in the processor's own;
  /// what is pushed out is made again.
  static constexpr int kCached = 2048;
  struct Cached {
    std::int32_t node, epoch, slot;
  };
  Cached cached_[2][kCached] = {};
  Buffer<SweptBox> pool_;
  std::int32_t epoch_ = 0;
};

/// A new query: nothing is known.
inline void RelativeMotion::begin() {
  pair_ = witness_pair_ = engine::kNoPair;
  of_batch_ = -1;
  // Epochs only ever grow; long before they overflow the stamps are made new.
  if (epoch_ > 1 << 30) {
    epoch_ = 0;
    __builtin_memset(cached_, -1, sizeof cached_);
  }
}

inline void RelativeMotion::set(PairId pair, const TimeBatch& batch) {
  FCL_ARTIC_ASSERT(engine::indexOf(pair) < static_cast<std::size_t>(problem().numPairs()));
  frames_.set(batch);
  if (pair_ == pair && of_batch_ == frames_.number()) return;
  pair_ = pair;
  of_batch_ = frames_.number();
  relate();
  ++epoch_;
  pool_.clear();
  if (witness_pair_ != pair) have_witness_ = false;
  witness_pair_ = pair;
}

/// Both ways, with remainders and pads.
inline void RelativeMotion::relate() {
  const double margin = query().margins.of(pair_);
  FCL_ARTIC_ASSERT(margin >= 0 && margin <= query().margins.largest());
  const PairParts parts = problem().parts(pair_);
  const Body &A = body(parts.a), &B = body(parts.b);
  const FrameLanes* frame = parts.step_b >= 0 ? &frames_.of(parts.sweep, parts.step_b) : nullptr;
  const StepBounds& bounds = frames_.bounds(parts.sweep, parts.step_b);
  const double d = batch().d;
  RigidLanes& m = side_[0].m;
  const PairPads pads =
      relateBodies({frame, bounds, problem().sweeps[parts.sweep].first_order, d},
                   {*parts.inverse_a, *parts.placement_b, A.tree->extent + B.tree->extent}, margin, m, side_[1].m);
  side_ready_[0] = side_ready_[1] = false;
  pose_error_ = pads.pose;
  strays_.between(pair_, pose_error_, tube_);
  side_[0].still = side_[1].moving = A.tree;
  side_[0].moving = side_[1].still = B.tree;
  for (Side& side : side_) {
    side.margin = margin + tube_.over;
    side.own_margin = margin;
    side.tube = tube_.over > 0 ? &tube_ : nullptr;
    side.direct = &side_[0];
    side.pad = pads.pad;
  }

  const bool from_a = B.tree->nodes[0].radius < engine::kUnbounded;
  const Side& seen = from_a ? side_[0] : side(1);
  const Node& root = seen.moving->nodes[0];
  const Vec3Lanes v = seen.m.R[1] * middleOf(root) + seen.m.c[1];
  amplitude_ = sqrt(maxLane(dot(v, v))) + bounds.rates.a * d * root.radius;
}

/// The motion of one pair over one batch, handed down to all that looks at it. It is valid until another pair or batch
/// is asked for. After that it must not be used, but asked for again.
class Seen {
 public:
  explicit Seen(RelativeMotion& motion) : motion_(&motion), epoch_(motion.epoch()) {}
  RelativeMotion& operator*() const {
    FCL_ARTIC_ASSERT(motion_->epoch() == epoch_);
    return *motion_;
  }
  RelativeMotion* operator->() const { return &**this; }

 private:
  RelativeMotion* motion_;
  std::int32_t epoch_;
};

/// Makes the motions of pairs over batches, and holds one at a time.
class RelativeMotions {
 public:
  RelativeMotions(Task& task, SweptFrames& frames) : motion_(task, frames) {}

  /// A new query: nothing is known.
  void begin() { motion_.begin(); }
  Seen of(PairId pair, const TimeBatch& batch) {
    motion_.set(pair, batch);
    return Seen(motion_);
  }
  /// Sets the direction that witness() returns when this pair is asked for next; null: none.
  void setWitness(PairId pair, const Vec3* direction) {
    motion_.witness_pair_ = pair;
    motion_.have_witness_ = false;
    if (direction) motion_.setWitness(*direction);
  }

 private:
  RelativeMotion motion_;
};

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
