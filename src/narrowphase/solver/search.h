// SPDX-License-Identifier: BSD-3-Clause
//
// The order of the search: earliest part of the motion first, and in it the pair that meets first.
#pragma once

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

/// A lane that entries_[begin, end) of one pair leave open, some of them: few leaf pairs are followed one by one, else
/// the lane is split.
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
  FCL_ARTIC_ASSERT(begin < end);
  const double w = width / kLanes;
  beginBatch(start, width);
  if (query_->progress && (statistics_.batches & 63) == 0) {
    // With every pair front_ is the present pair's: of those that are still to come nothing is known.
    out_of_budget_ |= !query_->progress(query_->progress_context, query_->every_pair ? 0 : front_);
    if (out_of_budget_) return Step::done;
  }
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

/// The pieces of one pair, in a lane of the first batch, in windows that begin with how long the motion takes for a
/// small part of the smaller body: where hulls meet, the surfaces are not far.
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
    Final f = leafPair(entries_[first], start);
    f.first = first;
    f.count = count;
    // What is left may be one leaf pair, which is followed at once; whole bodies, of which the hulls are followed; or
    // parts of them that the first batch has come to already.
    const PairParts pair = parts(pair_index);
    const bool whole = f.entry.a == 0 && f.entry.b == 0;
    f.hulls = whole && !leaves && problem_->bodies[pair.a].tree->outer && problem_->bodies[pair.b].tree->outer;
    f.pieces = !(leaves && count == 1) && !f.hulls;
    if (f.hulls) f.simplex = simplexOf(pair_index);
    if (f.t_lower >= stop || (!f.pieces && advance(f, stop, false, first_lanes))) {
      entries_.truncate(first);
      continue;
    }
    if (f.certain) {
      record(f);
      return;
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
    if (f.hulls) proveBelowHulls(f);
    if (!f.hulls && !f.pieces && !f.certain && settle(f, stop)) continue;
    if (f.certain) {
      record(f);
      continue;
    }
    claimed_ = 2;
    solvePieces(f, stop, f.first, f.first + f.count, lane);
  }
  entries_.truncate(roots);
  FCL_ARTIC_ASSERT(front_ <= stop);
  if (!finished()) front_ = stop;
}

/// A lane takes the present pair so far that little can be told of its pieces before the lane is split; of its hulls
/// can.
inline bool Solver::movesFar() const {
  return amplitude_ > kLongMotion * min(side_[0].still->nodes[0].radius, side_[0].moving->nodes[0].radius);
}

/// Goes down from entries_[begin, end) over the batch at hand, in the lanes of `mask`; what stays undecided is
/// appended.
inline void Solver::descend(int begin, int end, unsigned mask) {
  int present = -1;
  for (int i = begin; i < end && !finished(); ++i) {
    const Entry e = entries_[i];
    if (!(e.mask & mask)) continue;
    if (e.pair != present) setupPair(present = e.pair);
    if (movesFar() && !(e.mask & kWithin)) {
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
    if (!(e.mask & live_)) continue;  // put off
    setupPair(e.pair);
    overlaps_ = 0;
    e.mask = nodesMayTouch(0, 0, e.mask);
    const Whole whole = {true, i < directions_.size() ? directions_[i].l : nullptr};
    if (e.mask) e.mask = hullsMayTouch(e.mask, e.pair, !query_->every_pair && movesFar(), whole);
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
    if (problem_->num_movers == 0 && end - begin == 1) {
      // A problem of one pair needs no order among pairs: it is followed from its first open lane to its last. (Where
      // stage 1 or 2 has left one of many, it goes the way of the others: what they discard is not to change an
      // answer's bits.)
      const Entry& e = entries_[begin];
      setupPair(e.pair);
      if (isLeafPair(e) || (side_[0].still->outer && side_[1].still->outer && movesFar())) {
        const unsigned lanes = e.mask & kAllLanes;
        const double start = 0.125 * __builtin_ctz(lanes), stop = 0.125 * (32 - __builtin_clz(lanes));
        return solveLane(start, stop, -1, begin, end, watchFrom(e.pair) > 0 ? 0 : lanes);
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
  for (int i = 0; i < open && !out_of_budget_; ++i) {
    const int before = contacts_.size();
    entries_.truncate(open);
    beginBatch(0, 1);
    claimed_ = 2;
    updateLive();
    search(i, i + 1);
    orderContacts(before, limit_);
  }
  front_ = 0;
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
