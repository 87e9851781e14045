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
  double making_us = 0;  ///< making an executor; not in `us`
  std::string executor;
  std::string fallback;
};

/// One of the library's solvers, ready for its problem: answers the query, with its stage 2 (engine::Advisor).
using SolveFunction = std::function<void(const engine::Query& query, engine::Answer& answer)>;

/// No contact, no doubt, nothing ignored: an answer that does not depend on what was taken out.
inline bool isPlainlyFree(const engine::Answer& answer) {
  return answer.isFree() && answer.num_ignored == 0;
}

/// Whether stage 2 has anything to do with such a query.
bool takesPart(VisibilityMode mode, const engine::Problem& problem, const engine::Query& query);

/// The solver's answer; with all modes but `atOnce` bit for bit the one without stage 2. There the stage only shortens
/// proofs that a motion is free: where it has taken something out and the answer is another one, the query is solved
/// again without. With the stage a work budget would be enough for something else, so that a query with one is solved
/// without the stage. With `atOnce` the answer is the first one.
/// @param choice  of this solver: what stage 2 is worth depends on it.
void solve(const VisibilityCuller& culler, Choice& choice, VisibilityMode mode, const SolveFunction& solver,
           const engine::Problem& problem, engine::Query& query, engine::Answer& answer, Report& report,
           const Microseconds& now = steadyMicroseconds);

}  // namespace visibility
}  // namespace fcl_artic
