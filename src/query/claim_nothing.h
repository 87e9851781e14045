// SPDX-License-Identifier: BSD-3-Clause
//
// If a query can't answer, it leaves a result that claims nothing. So no answer to an earlier question stays in the
// caller's hands. Every public query that writes to a result goes through one of these functions.
#pragma once

#include "fcl_artic/result.h"

namespace fcl_artic {

/// Makes a result that claims nothing of a motion over [begin, end]. Its vectors keep their memory; its statistics
/// stay.
inline void withdrawClaims(CertifiedResult& result, double begin, double end) {
  result.status = Status::undecided;
  result.t_lower = begin;
  result.t_upper = end;
  result.certain = false;
  result.contacts.clear();
  result.M_0_at_lower.clear();
  result.ignored_initial_contacts.clear();
  result.never_apart_pairs = 0;
  result.unproven_allowed_pairs = 0;
  result.unproven_neighbours.reset();
  result.certificate.reset();
}

/// The same, and resets the statistics.
inline void claimNothing(CertifiedResult& result, double begin = 0, double end = 1) {
  withdrawClaims(result, begin, end);
  result.statistics = QueryStatistics();
}

/// Runs a query. If it throws, reset() is called, whatever the query has written by then, and the exception is passed
/// on.
template <class Reset, class Query>
auto resetUnlessAnswered(Reset&& reset, Query&& query) {
  try {
    return query();
  } catch (...) {
    reset();
    throw;
  }
}

/// Runs a query of a motion over [begin, end]. Until the query has answered, the result claims nothing. (The query sets
/// its statistics anew: to reset them before would take a fortieth of a small query's time.)
template <class Query>
void answerOrClaimNothing(CertifiedResult& result, double begin, double end, Query&& query) {
  withdrawClaims(result, begin, end);
  resetUnlessAnswered([&] { claimNothing(result, begin, end); }, query);
}

}  // namespace fcl_artic
