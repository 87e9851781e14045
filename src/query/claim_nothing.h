// SPDX-License-Identifier: BSD-3-Clause
//
// What a query leaves in the caller's hands when it can't answer: nothing that was true of another question. Every
// public query goes through one of these two functions.
#pragma once

#include "fcl_artic/result.h"

namespace fcl_artic {

/// Nothing is proven of a motion over [begin, end]. Memory is kept.
inline void claimNothing(CertifiedResult& result, double begin = 0, double end = 1) {
  result.status = Status::undecided;
  result.t_lower = begin;
  result.t_upper = end;
  result.certain = false;
  result.contacts.clear();
  result.M_0_at_lower.clear();
  result.ignored_initial_contacts.clear();
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

/// The same, reset before it begins too. Not for input that may lie in the result.
template <class Reset, class Query>
auto resetAndAnswer(Reset&& reset, Query&& query) {
  reset();
  return resetUnlessAnswered(reset, query);
}

}  // namespace fcl_artic
