// SPDX-License-Identifier: BSD-3-Clause
#include "visibility/solve.h"

#include <chrono>

#include "visibility/stage.h"

namespace fcl_artic {
namespace visibility {
namespace {

using Clock = std::chrono::steady_clock;

/// @return time taken, us.
double solveOnce(const VisibilityCuller* culler, const Solver& solver, engine::Query& query, engine::Answer& answer,
                 Report& report) {
  const Clock::time_point begin = Clock::now();
  if (!culler) {
    query.refine = nullptr;
    solver(query, answer);
  } else {
    Stage stage(*culler);
    query.refine = &Stage::refine;
    query.refine_context = &stage;
    solver(query, answer);
    report.pairs += stage.pairs;
    report.culled += stage.culled;
    report.pieces += stage.pieces;
    report.elapsed_us += stage.elapsed_us;
    report.executor = stage.executor;
    report.fallback = culler->fallbackReason();
  }
  return std::chrono::duration<double, std::micro>(Clock::now() - begin).count();
}

}  // namespace

void solve(const VisibilityCuller& culler, Choice& choice, VisibilityMode mode, const Solver& solver,
           const engine::Problem& problem, engine::Query& query, engine::Answer& answer, Report& report) {
  const bool nothing = !query.check_scene || problem.num_obstacles == 0;
  if (mode == VisibilityMode::off || nothing || (mode == VisibilityMode::automatic && query.work_budget)) {
    solver(query, answer);
    return;
  }
  if (mode == VisibilityMode::on) {
    solveOnce(&culler, solver, query, answer, report);
    return;
  }
  const bool on = choice.pays();
  double trial_us = 0;
  const bool trial = choice.mayTry();
  Report tried;
  if (trial) {  // the other way first, unseen: the answer lives in the workspace until the next
    engine::Query other = query;
    other.progress = nullptr;
    trial_us = solveOnce(on ? nullptr : &culler, solver, other, answer, tried);
  }
  const double us = solveOnce(on ? &culler : nullptr, solver, query, answer, report);
  choice.addQuery(us);
  if (!trial) return;
  report.trials = 1;
  report.elapsed_us += tried.elapsed_us;
  if (report.fallback.empty()) report.fallback = tried.fallback;
  choice.addTrial(trial_us, on ? us : trial_us, on ? trial_us : us, (on ? report : tried).pairs > 0);
}

}  // namespace visibility
}  // namespace fcl_artic
