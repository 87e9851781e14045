// SPDX-License-Identifier: BSD-3-Clause
//
// Stage 2 of a query, an advisor of the solver: takes pairs of a link and another body, and nodes of large bodies, out
// that visibility proves free (doc/VISIBILITY.md).
#pragma once

#include <functional>
#include <string>

#include "fcl_artic/statistics.h"
#include "fcl_artic/visibility.h"
#include "model/answer.h"
#include "model/query.h"

namespace fcl_artic {
namespace visibility {

/// The work of stage 2 in a query.
struct Report {
  VisibilityStatistics work;
  std::string executor;  ///< empty: nothing was asked of one
  std::string fallback;
};

/// One of the library's solvers, with its problem: answers a query, and asks the query's advisors.
using SolveFunction = std::function<void(const engine::Query& query, engine::Answer& answer)>;

/// Answers the query with stage 2, if there is something for it to look at. The answer has the same bits as without it.
/// If the stage has taken something out, only an answer that is free without ignored pairs stands. Any other is found
/// again without it. A query with a work budget is solved without it from the start, as a budget reaches farther with
/// it.
void solve(const VisibilityCuller& culler, const SolveFunction& solver, const engine::Query& query,
           engine::Answer& answer, Report& report);

}  // namespace visibility
}  // namespace fcl_artic
