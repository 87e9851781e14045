// SPDX-License-Identifier: BSD-3-Clause
//
// Eight time intervals at once: frames, and one pair's motion, made when first asked for.
#pragma once

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

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
  FCL_ARTIC_ASSERT(start >= 0 && width > 0 && start + width <= 1 + 1e-12);
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

inline Solver::PairParts Solver::parts(int index) const {
  if (index >= problem_->num_scene_pairs) {
    const LinkPair& pair = problem_->link_pairs[index - problem_->num_scene_pairs];
    return {pair.a, pair.b, pair.sweep, pair.step_b, &pair.inverse_a, &pair.placement_b};
  }
  const int a = problem_->obstacles[index % problem_->num_obstacles],
            b = problem_->movers[index / problem_->num_obstacles];
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
  FCL_ARTIC_ASSERT(index >= 0 && index < problem_->num_scene_pairs + problem_->num_link_pairs);
  if (present_ == index && present_batch_ == batch_) return;
  present_ = index;
  present_batch_ = batch_;
  margin_ = query_->margins.of(index);
  FCL_ARTIC_ASSERT(margin_ >= 0 && margin_ <= query_->margins.largest());
  const PairParts pair = parts(index);
  const Body &A = problem_->bodies[pair.a], &B = problem_->bodies[pair.b];
  const FrameLanes* frame = frames(pair.sweep);
  static const StepBounds kStill = {};
  const StepBounds& b = pair.step_b >= 0 ? bounds_[first_step_[pair.sweep] + pair.step_b] : kStill;
  RigidLanes& m = side_[0].m;
  const PairPads pads =
      relateBodies(pair.step_b >= 0 ? frame + pair.step_b : nullptr, b, problem_->sweeps[pair.sweep].first_order,
                   *pair.inverse_a, *pair.placement_b, A.tree->extent + B.tree->extent, margin_, d_, m, side_[1].m);
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
  free_nodes_ = nullptr;
  for (int i = 0; i < partly_free_.size(); ++i) {
    if (partly_free_[i].pair == index) free_nodes_ = partly_free_[i].free_nodes;
  }
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

/// One pair's motion over one interval, for the report. The problem and the query of the last solve() must still be
/// there.
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

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
