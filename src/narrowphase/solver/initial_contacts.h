// SPDX-License-Identifier: BSD-3-Clause
//
// Pairs that touch at t = 0 and are ignored until they have separated. Solid meshes have where their surfaces are apart
// and neither body lies within the other.
#pragma once

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

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
    if (!(blocked >> lane & 1)) {
      if (out_of_budget_) return 2;
      if (mayBeContained(entries_[begin].pair, lane_start)) continue;  // and so it stays over the lane
      return lane_start;
    }
    if (w > 1.0 / 512) {  // whatever the tolerance: all queries are to leave out the same
      const double t = firstFreeTime(lane_start, w, begin, end);
      if (t < 2) return t;
    }
  }
  return 2;
}

inline bool Solver::mayIgnore(int pair) const {
  if (query_->num_may_ignore < 0) return true;
  for (int i = 0; i < query_->num_may_ignore; ++i) {
    if (query_->may_ignore[i] == pair) return true;
  }
  return false;
}

/// Finds the pairs in contact at t = 0 that are to be ignored, and from when they are watched.
inline void Solver::collectInitialContacts(int begin, int end) {
  decide_only_ = true;
  for (int i = begin; i < end; ++i) {
    const Entry e = entries_[i];
    if (!mayIgnore(e.pair)) continue;
    const double tm[kLanes] = {0, 0, 0, 0, 0, 0, 0, 0};
    for (int k = 0; k < kLanes; ++k) lane_start_[k] = lane_end_[k] = 0;
    evaluateAt(tm, 0);
    live_ = 1;
    last_ = true;
    blocked_ = 0;
    setupPair(e.pair);
    traverse(e.pair, e.a, e.b, 1);
    if (!blocked_ && !isContained(e.pair)) continue;
    entries_.push(e);
    const PairParts pair = parts(e.pair);
    ignored_.push({e.pair, pair.a, pair.b, firstFreeTime(0, 1, entries_.size() - 1, entries_.size())});
    entries_.truncate(entries_.size() - 1);
  }
  // One within the other, with surfaces that are proven apart over the whole motion: that does not end.
  for (int i = 0; i < contained_.size(); ++i) {
    bool known = !mayIgnore(contained_[i].pair);
    for (int j = 0; j < ignored_.size(); ++j) known = known || ignored_[j].pair == contained_[i].pair;
    if (!known) ignored_.push({contained_[i].pair, contained_[i].body_a, contained_[i].body_b, 2});
  }
  decide_only_ = false;
  watching_ = true;
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
