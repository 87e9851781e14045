// SPDX-License-Identifier: BSD-3-Clause
//
// The result that a query leaves in the caller's hands when it can't answer: nothing that was true of another
// question. Every public query that writes to a result goes through one of these functions.
#pragma once

#include "fcl_artic/result.h"

namespace fcl_artic {

/// Nothing is proven of a motion over [begin, end]. Memory is kept.
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

/// The same, and no work has been done.
inline void claimNothing(CertifiedResult& result, double begin = 0, double end = 1) {
  withdrawClaims(result, begin, end);
  result.statistics = QueryStatistics();
}

/// Runs a query. When it throws, reset() is called: whatever the query has written by then.
template <class Reset, class Query>
auto resetUnlessAnswered(Reset&& reset, Query&& query) {
  try {
    return query();
  } catch (...) {
    reset();
    throw;
  }
}

/// Runs a query of a motion over [begin, end], which claims nothing from before it begins until it has answered. (Its
/// statistics are left to the answer: resetting them takes as long as a small query's fortieth.)
template <class Query>
void answerOrClaimNothing(CertifiedResult& result, double begin, double end, Query&& query) {
  withdrawClaims(result, begin, end);
  resetUnlessAnswered([&] { claimNothing(result, begin, end); }, query);
}

}  // namespace fcl_artic
