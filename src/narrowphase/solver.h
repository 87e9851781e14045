// SPDX-License-Identifier: BSD-3-Clause
//
// The solver: the first contact over all pairs, eight time intervals ("lanes") at once. What is discarded is discarded
// by the certificate (certificate.h), or by a swept box or line swept sphere, which are the same certificate with the
// directions of an axis or of the nearest points. All else is order and effort.
//
// Its parts, each of which knows only those above it:
//
//   Task             the query at hand, its budget and what it has cost
//   TimeBatch        eight intervals of time: a value
//   SweptFrames      the links' frames over a batch
//   RelativeMotion   two bodies against each other over a batch
//   Horizon          when the first contact is, as far as known: the only writer of these times
//   ContactList      contacts, and the gate through which every proof of contact comes
//   PoseProofs, BallProofs   contact at one pose, where any will do
//   Traversal        a pair's node pairs and leaf pairs over a batch
//   Follower         a leaf pair, or two hulls, followed to where they meet
//   AnyContact       poses at which contact is likely
//   StageOne         pairs whose swept bounds meet; and what advisors prove free of them
//   Containment, InitialContacts   solid meshes within each other, and what is ignored at t = 0
//   PairSearch       the order of the search: by time, then by pair
#pragma once

#include "narrowphase/solver/initial_contacts.h"
#include "narrowphase/solver/pair_search.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

using engine::Answer;

class Solver {
 public:
  /// One query. The answer's contacts lie in this solver until its next one.
  void solve(const Problem& problem, const Query& query, Answer& answer);
  /// Motion of one pair over [tm - d, tm + d], for the report. The problem and the query of the last solve() must still
  /// be there.
  void pairMotion(int pair, double tm, double d, engine::PairMotion& motion);

 private:
  void begin(const Problem& problem, const Query& query);
  void answerWithWhatIsFound(Answer& answer);

  Task task_;
  SweptFrames frames_{task_};
  RelativeMotion motion_{task_, frames_};
  Horizon horizon_{task_};
  ContactList contacts_{task_, horizon_};
  PoseProofs proofs_{task_, motion_, contacts_};
  BallProofs balls_{task_, frames_, contacts_};
  Traversal traversal_{task_, motion_, horizon_, contacts_, proofs_};
  Follower follower_{task_, motion_, horizon_, contacts_};
  AnyContact any_{task_, frames_, motion_, horizon_, balls_, proofs_, traversal_};
  StageOne stage_one_{task_, frames_, horizon_, contacts_, any_};
  Containment containment_{task_, motion_, horizon_, contacts_, stage_one_};
  InitialContacts initial_{task_, motion_, horizon_, contacts_, traversal_, containment_};
  PairSearch search_{task_, motion_, horizon_, contacts_, traversal_, follower_, any_};
  const TimeBatch whole_ = TimeBatch::partsOf(0, 1);
  Buffer<Entry> open_;  ///< what is not yet decided
};

inline void Solver::begin(const Problem& problem, const Query& query) {
  task_.begin(problem, query);
  frames_.begin();
  motion_.begin();
  horizon_.begin();
  contacts_.begin();
  traversal_.begin();
  any_.begin();
  containment_.begin();
  open_.clear();
}

inline void Solver::solve(const Problem& problem, const Query& query, Answer& answer) {
  begin(problem, query);
  Statistics& statistics = task_.statistics;

  const double time0 = task_.now();
  ++statistics.batches;
  horizon_.watch(whole_);
  stage_one_.cull(open_);
  if (query.any && !horizon_.isOver()) any_.tryOverlaps(open_);
  if (query.any && !horizon_.isOver()) any_.tryLinks();
  statistics.culling_us = task_.now() - time0;

  if (problem.contained && !horizon_.isOver()) containment_.findAtStart();
  if (query.num_advisors && !horizon_.isOver()) stage_one_.refine(traversal_, open_);
  const double time1 = task_.now();
  if (query.ignore_initial && !horizon_.isOver()) {
    initial_.collect(open_);
    horizon_.watch(whole_);
  }
  if (!task_.ended()) containment_.report(open_);
  if (!task_.ended() && horizon_.end() > 0) {
    search_.testHulls(open_, [&](int i) { return stage_one_.direction(i); });
    const bool over = horizon_.isOver() || (query.any && any_.tryOverlaps(open_));
    if (!over) search_.run(open_);
  }
  statistics.narrowphase_us = task_.now() - time1;
  answerWithWhatIsFound(answer);
}

inline void Solver::answerWithWhatIsFound(Answer& answer) {
  const Query& query = *task_.query;
  // A pose proven in contact before the time up to which all is proven free would be a contradiction: a fault of ours,
  // and then contact is the answer that harms nobody.
  FCL_ARTIC_ASSERT(task_.ended() || horizon_.first().t_lower <= horizon_.first().t_upper);
  if (horizon_.first().t_upper < horizon_.first().t_lower) horizon_.joinLower(0);
  const bool contact = horizon_.first().t_lower < kNever;
  const bool certain = engine::isCertain(horizon_.first(), query.tolerance_time, query.any);
  if (!query.every_pair) {
    contacts_.order(0, certain ? horizon_.first().t_upper : horizon_.first().t_lower + query.tolerance_time);
  }
  // Where any contact ends the search, proven or not, other pairs are proven free up to here only.
  if (query.any && contact) horizon_.joinLower(horizon_.provenFreeUntil());
  // Where the budget ended among the initial contacts, nothing is known of when they are over; with every pair, of
  // those that were still to come.
  const engine::FirstContact& first = horizon_.first();
  const bool known = !query.ignore_initial && !query.every_pair;
  const double proven_free = known ? min(horizon_.provenFreeUntil(), first.t_lower) : 0;
  static_cast<Bracket&>(answer) = task_.ended() ? engine::undecidedBracket(proven_free, first)
                                                : engine::bracketOf(first, query.tolerance_time, query.any);
  FCL_ARTIC_ASSERT(answer.t_lower >= 0 && answer.t_lower <= answer.t_upper && answer.t_upper <= 1);
  answer.contacts = contacts_.data();
  answer.num_contacts = answer.status == Status::contact ? contacts_.size() : 0;
  FCL_ARTIC_ASSERT(answer.status != Status::contact || answer.num_contacts || !query.max_contacts);
  answer.ignored = contacts_.ignored();
  answer.num_ignored = contacts_.numIgnored();
  answer.statistics = task_.statistics;
}

inline void Solver::pairMotion(int pair, double tm, double d, engine::PairMotion& motion) {
  motion_.set(pair, TimeBatch::around(tm, d));
  const RigidLanes& m = motion_.seenFromA();
  for (int order = 0; order < 3; ++order) {
    for (int i = 0; i < 9; ++i) motion.R[order][i] = m.R[order][i][0];
    for (int i = 0; i < 3; ++i) motion.c[order][i] = m.c[order][i][0];
  }
  motion.rem_c = m.rem_c;
  motion.rem_R = m.rem_R;
  motion.pad = motion_.pad();
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
