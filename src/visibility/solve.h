// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "fcl_artic/request.h"
#include "fcl_artic/result.h"
#include "model/answer.h"
#include "model/query.h"
#include "visibility/choice.h"
#include "visibility/culler.h"

namespace fcl_artic {
namespace visibility {

/// The work of stage 2 in a query.
struct Report : VisibilityStatistics {
  double making_us = 0;  ///< time of making an executor; `us` does not include it
  std::string executor;
  std::string fallback;
};

/// One of the library's solvers, with its problem: answers a query, and asks the query's advisors (engine::Advisor).
using SolveFunction = std::function<void(const engine::Query& query, engine::Answer& answer)>;

/// Whether the answer is free, with nothing ignored: such an answer does not depend on what stage 2 has taken out.
inline bool isPlainlyFree(const engine::Answer& answer) {
  return answer.isFree() && answer.num_ignored == 0;
}

/// Whether such a query is solved with stage 2.
bool takesPart(VisibilityMode mode, const engine::Problem& problem, const engine::Query& query);

/// Answers the query. In all modes but `atOnce` the answer has the same bits as without stage 2: the stage only
/// shortens proofs that a motion is free. If it has taken something out and the answer is not plainly free, the query
/// is solved again without it. A query with a work budget is solved without it from the start, as a budget reaches
/// farther with it. With `atOnce` the first answer stands, with a budget too.
/// @param choice  that of this solver: the gain of stage 2 differs from solver to solver.
void solve(const VisibilityCuller& culler, Choice& choice, VisibilityMode mode, const SolveFunction& solver,
           const engine::Problem& problem, engine::Query& query, engine::Answer& answer, Report& report,
           const Microseconds& now = steadyMicroseconds);

}  // namespace visibility
}  // namespace fcl_artic
