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

/// What stage 2 did in a query.
struct Report {
  std::uint64_t pairs = 0, culled = 0, nodes = 0, pieces = 0, trials = 0, repeated = 0;
  double elapsed_us = 0;
  std::string executor;
  std::string fallback;
};

/// One of the library's solvers, ready for its problem: answers the query, with its stage 2 (engine::Advisor).
using Solver = std::function<void(const engine::Query& query, engine::Answer& answer)>;

/// The solver's answer, bit for bit the one without stage 2. The stage only shortens proofs that a motion is free:
/// where it has taken something out and the answer is another one, the query is solved again without. What a work
/// budget is enough for would depend on it, so that a query with one is solved without.
/// @param choice  of this solver: what stage 2 is worth depends on it.
void solve(const VisibilityCuller& culler, Choice& choice, VisibilityMode mode, const Solver& solver,
           const engine::Problem& problem, engine::Query& query, engine::Answer& answer, Report& report);

}  // namespace visibility
}  // namespace fcl_artic
