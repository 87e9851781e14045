// SPDX-License-Identifier: BSD-3-Clause
//
// The solver: the first contact over all pairs, eight time intervals ("lanes") at once. Only the certificate
// (certificate.h) discards anything. A swept box or line swept sphere is the same certificate, with the directions of
// an axis or of the nearest points. All else is order and effort.
//
// Its parts: solver/parts.h.
#pragma once

#include "narrowphase/solver/parts.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

using engine::Answer;

class Solver : SolverParts {
 public:
  /// One query. The answer's contacts lie in this solver until its next one.
  void solve(const Problem& problem, const Query& query, Answer& answer);
  /// Motion of one pair over [tm - d, tm + d], for the report. The problem and the query of the last solve() must still
  /// be there.
  void pairMotion(PairId pair, double tm, double d, engine::PairMotion& seen);

 private:
  void answerWithWhatIsFound(Answer& answer);
};

inline void Solver::solve(const Problem& problem, const Query& query, Answer& answer) {
  begin(problem, query);
  Statistics& statistics = task.statistics;

  const double time0 = task.now();
  ++statistics.batches;
  horizon.setBatch(task.whole);
  stage_one.cull(open);
  if (query.any && !horizon.isOver()) any.tryOverlaps(open);
  statistics.culling_us = task.now() - time0;

  if (problem.contained && !horizon.isOver()) containment.findAtStart();
  if (query.num_advisors && !horizon.isOver()) stage_one.refine(open);
  const double time1 = task.now();
  if (query.ignore_initial && !horizon.isOver()) {
    initial.collect(open);
    horizon.setBatch(task.whole);
  }
  if (!task.ended()) containment.report(open);
  if (!task.ended() && horizon.end() > 0) {
    search.testHulls(open, stage_one);
    if (query.any && !horizon.isOver() && !any.tryOverlaps(open)) any.tryEnds(open);
    if (!horizon.isOver()) search.run(open);
  }
  statistics.narrowphase_us = task.now() - time1;
  answerWithWhatIsFound(answer);
}

inline void Solver::answerWithWhatIsFound(Answer& answer) {
  const Query& query = *task.query;
  // A pose proven in contact before the time up to which all is proven free would be a contradiction: a fault of ours.
  // Contact is then the answer that harms nobody.
  FCL_ARTIC_ASSERT(task.ended() || horizon.first().t_lower <= horizon.first().t_upper);
  if (horizon.first().t_upper < horizon.first().t_lower) horizon.joinLower(0);
  const bool found = horizon.first().t_lower < kNever;
  const bool certain = engine::isCertain(horizon.first(), query.tolerance_time, query.any);
  if (!query.every_pair) {
    contacts.order(0, certain ? horizon.first().t_upper : horizon.first().t_lower + query.tolerance_time);
  }
  // Where any contact ends the search, proven or not, other pairs are proven free up to here only.
  if (query.any && found) horizon.joinLower(horizon.provenFreeUntil());
  // Where the budget ended among the initial contacts, nothing is known of when they are over; with every pair, of
  // those that were still to come.
  const engine::FirstContact& first = horizon.first();
  const bool known = !query.ignore_initial && !query.every_pair;
  const double proven_free = known ? horizon.freeUntil() : 0;
  static_cast<Bracket&>(answer) = task.ended() ? engine::undecidedBracket(proven_free, first)
                                               : engine::bracketOf(first, query.tolerance_time, query.any);
  FCL_ARTIC_ASSERT(answer.t_lower >= 0 && answer.t_lower <= answer.t_upper && answer.t_upper <= 1);
  answer.contacts = contacts.data();
  answer.num_contacts = answer.status == Status::contact ? contacts.size() : 0;
  FCL_ARTIC_ASSERT(answer.status != Status::contact || answer.num_contacts || !query.max_contacts);
  answer.ignored = contacts.ignored();
  answer.num_ignored = contacts.numIgnored();
  answer.statistics = task.statistics;
}

inline void Solver::pairMotion(PairId pair, double tm, double d, engine::PairMotion& seen) {
  const Seen motion = motions.of(pair, TimeBatch::around(tm, d));
  const RigidLanes& m = motion->seenFromA();
  for (int order = 0; order < 3; ++order) {
    laneOf(m.R[order], 0).store(seen.R[order]);
    laneOf(m.c[order], 0).store(seen.c[order]);
  }
  seen.rem_c = m.rem_c;
  seen.rem_R = m.rem_R;
  seen.pad = motion->pad();
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
