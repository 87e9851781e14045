// SPDX-License-Identifier: BSD-3-Clause
//
// Pairs in contact at t = 0 that are ignored until they have separated: until the begin of the first lane in which they
// are proven free. If they are solid meshes, neither may lie within the other there.
#pragma once

#include "narrowphase/solver/containment.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

/// Separation is looked for in lanes down to this width, whatever the tolerance, so that all queries ignore the same
/// contacts.
constexpr double kSeparationLane = 1.0 / 512;

class InitialContacts : PartOfSolver {
 public:
  InitialContacts(SearchState& state, Traversal& traversal, Containment& containment)
      : PartOfSolver(state.task),
        motions_(state.motions),
        horizon_(state.horizon),
        contacts_(state.contacts),
        traversal_(traversal),
        containment_(containment) {}

  /// Finds the pairs in contact at t = 0 that are to be ignored, and from when they are watched.
  void collect(const Buffer<Entry>& open);

 private:
  bool mayIgnore(PairId pair) const;
  double firstFreeTime(PairId pair, double start, double width);

  RelativeMotions& motions_;
  Horizon& horizon_;
  ContactList& contacts_;
  Traversal& traversal_;
  Containment& containment_;
};

/// Time from which a pair in contact at t = 0 is watched: the start of the first lane in which it is proven free.
/// kNever: there is none.
inline double InitialContacts::firstFreeTime(PairId pair, double start, double width) {
  const TimeBatch batch = TimeBatch::partsOf(start, width);
  ++statistics().batches;
  horizon_.setBatch(batch);
  const unsigned blocked = traversal_.blockedLanes(motions_.of(pair, batch), kAllLanes);
  for (int lane = 0; lane < kLanes; ++lane) {
    if (!(blocked >> lane & 1)) {
      if (task_.ended()) return kNever;
      if (containment_.mayBeContained(pair, batch.start[lane])) continue;  // and so it stays over the lane
      return batch.start[lane];
    }
    if (batch.width > kSeparationLane) {
      const double t = firstFreeTime(pair, batch.start[lane], batch.width);
      if (t < kNever) return t;
    }
  }
  return kNever;
}

inline bool InitialContacts::mayIgnore(PairId pair) const {
  if (query().num_may_ignore < 0) return true;
  for (int i = 0; i < query().num_may_ignore; ++i) {
    if (query().may_ignore[i] == pair) return true;
  }
  return false;
}

inline void InitialContacts::collect(const Buffer<Entry>& open) {
  const TimeBatch at_start = TimeBatch::around(0);
  for (int i = 0; i < open.size(); i = endOfPair(open, i)) {
    const PairId pair = open[i].pair;
    if (!mayIgnore(pair)) continue;
    horizon_.setBatch(at_start);
    if (traversal_.blockedLanes(motions_.of(pair, at_start), 1) || containment_.isContainedAtStart(pair)) {
      contacts_.ignore(pair, firstFreeTime(pair, 0, 1));
    }
  }
  // If one body lies within the other, and their surfaces are proven apart over the whole motion, it stays there.
  for (int i = 0; i < containment_.size(); ++i) {
    const PairId pair = containment_.pair(i);
    if (mayIgnore(pair) && !contacts_.isIgnored(pair)) contacts_.ignore(pair, kNever);
  }
  contacts_.beginWatching();
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
