// SPDX-License-Identifier: BSD-3-Clause
//
// The known bounds of the first contact's time. They are kept here alone: ContactList, ContactWriter and Containment
// hand in contacts' times, PairSearch the time up to which all is free. They say which lanes are worth work.
#pragma once

#include "model/bracket.h"
#include "narrowphase/solver/task.h"
#include "narrowphase/solver/time_batch.h"
#include "numerics/assertion.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

using engine::kNever;

/// Width below which time is not split any more.
constexpr double kNarrowestLane = 1.0 / (1ull << 45);

class Horizon : PartOfSolver {
 public:
  explicit Horizon(Task& task) : PartOfSolver(task) {}

  /// A new query: nothing is known.
  void begin() {
    first_ = {};
    suspected_ = kNever;
    beginSearch();
  }
  /// A search begins: of all pairs, or with Query::every_pair of each pair by itself. first() keeps what earlier ones
  /// found.
  void beginSearch() {
    end_ = kNever;
    proven_free_until_ = 0;
    update();
  }

  /// Sets the batch: live() and contactLane() name lanes of it.
  void setBatch(const TimeBatch& batch) {
    if (suspected_ <= batch.start[0]) suspected_ = kNever;  // the search has come past it: it was no contact
    start_ = batch.start;
    finish_ = batch.end;
    finest_ = batch.width <= max(query().tolerance_time, kNarrowestLane);
    update();
  }
  /// Whether the batch's lanes are as narrow as the tolerance: then none of them is put off.
  bool isFinest() const { return finest_; }
  /// Lanes that are worth work: they begin before each contact that is proven or suspected.
  unsigned live() const { return live_; }
  /// A bit for the lane in which the earliest of these contacts lies; 0: there is none, or isFinest(). Nodes that are
  /// undecided in this lane alone are left to narrower lanes.
  unsigned contactLane() const { return contact_lane_; }

  /// The time at which the search ends: a later contact can't change the answer.
  double end() const { return end_; }
  /// Nothing is left to search: any contact will do and one is found, or the query has ended.
  bool isOver() const { return task_.ended() || isFound(); }
  /// Whether the search must end, as its budget is spent or its caller ends it; asked at every step. (With every pair
  /// searched by itself nothing is known of the pairs that are still to come.)
  bool mustEnd() { return task_.mustEnd(query().every_pair ? 0 : freeUntil()); }
  /// Ends the search at t: contact by then is proven, or is assumed as no proof can decide. Later times don't matter.
  void closeAt(double t) {
    end_ = min(end_, t);
    update();
  }

  /// Contact is suspected at t: GJK claims overlap, or a link is deep in a solid. Nothing is proven by it: later lanes
  /// are put off, not dropped.
  void suspect(double t) {
    if (finest_ || t >= suspected_) return;
    suspected_ = t;
    update();
  }
  /// Withdraws the suspicion: it was no contact, or it is examined now.
  void dropSuspicion() { suspected_ = kNever; }

  /// The time that this search has reached: before it all pairs without a known contact are proven free.
  double provenFreeUntil() const { return proven_free_until_; }
  /// The time before which all pairs are proven free, those with a known contact included. (The search may go on past a
  /// contact in the other pairs: then provenFreeUntil() is later.)
  double freeUntil() const { return min(proven_free_until_, first_.t_lower); }
  void provenFree(double t) { proven_free_until_ = max(proven_free_until_, t); }

  /// The bracket of the first contact, joined of all contacts of this query.
  const engine::FirstContact& first() const { return first_; }
  void joinLower(double t) { engine::joinLower(first_, t); }
  void joinUpper(double t) { engine::joinUpper(first_, t); }

 private:
  void update() {
    const Lanes end(finest_ ? end_ : min(end_, suspected_));
    live_ = isFound() ? 0 : greater(end, start_);
    contact_lane_ = finest_ ? 0 : live_ & greater(finish_, end);
  }
  bool isFound() const { return query().any && end_ < kNever; }

  bool finest_ = false;
  double end_ = kNever, suspected_ = kNever, proven_free_until_ = 0;
  engine::FirstContact first_;
  Lanes start_{0.0}, finish_{0.0};  ///< of the batch's lanes
  unsigned live_ = 0, contact_lane_ = 0;
};

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
