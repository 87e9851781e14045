// SPDX-License-Identifier: BSD-3-Clause
#include "visibility/solve.h"

#include <algorithm>
#include <chrono>

#include "model/add_fields.h"
#include "visibility/stage.h"

namespace fcl_artic {
namespace visibility {
namespace {

using Clock = std::chrono::steady_clock;

double since(Clock::time_point begin) {
  return std::chrono::duration<double, std::micro>(Clock::now() - begin).count();
}

/// Passes progress on. A second solve begins at 0 again; what is proven stays proven. Who has said no is asked no more.
struct Progress {
  bool (*tell)(void* context, double t_lower);
  void* context;
  double proven = 0;
  bool ended = false;
  static bool update(void* self, double t_lower) {
    auto& progress = *static_cast<Progress*>(self);
    progress.proven = std::max(progress.proven, t_lower);
    progress.ended = !progress.tell(progress.context, progress.proven);
    return !progress.ended;
  }
};

/// With the stage.
/// @return whether this is the answer without it too: the motion is free, or nothing was taken out.
bool solveShortened(const VisibilityCuller& culler, const Solver& solver, const engine::Query& query,
                    engine::Answer& answer, Report& report) {
  Stage stage(culler, query.tolerance_distance);
  engine::Query advised = query;
  advised.ask(stage.advisor());
  solver(advised, answer);
  report.pairs = stage.pairs;
  report.culled = stage.culled;
  report.nodes = stage.nodes;
  report.pieces = stage.pieces;
  report.elapsed_us = stage.elapsed_us;
  report.executor = stage.executor;
  report.fallback = culler.fallbackReason();
  const bool free = answer.isFree() && answer.num_ignored == 0;
  return free || (stage.culled == 0 && stage.nodes == 0);
}

}  // namespace

void solve(const VisibilityCuller& culler, Choice& choice, VisibilityMode mode, const Solver& solver,
           const engine::Problem& problem, engine::Query& query, engine::Answer& answer, Report& report) {
  const bool nothing = !query.check_scene || problem.num_obstacles == 0;
  if (mode == VisibilityMode::off || nothing || query.work_budget) {
    solver(query, answer);
    return;
  }
  const bool automatic = mode == VisibilityMode::automatic;
  const bool on = !automatic || choice.pays();
  const bool trial = automatic && choice.mayTry();  // answered both ways
  Progress progress{query.progress, query.progress_context};
  if (query.progress) {
    query.progress = &Progress::update;
    query.progress_context = &progress;
  }

  double with_us = 0, without_us = 0;
  bool stands = false;
  engine::Statistics first;
  if (on || trial) {
    const Clock::time_point begin = Clock::now();
    stands = solveShortened(culler, solver, query, answer, report);
    with_us = since(begin);
    first = answer.statistics;
  }
  const bool again = (!stands || trial) && !progress.ended;
  if (again) {
    const Clock::time_point begin = Clock::now();
    solver(query, answer);
    without_us = since(begin);
    engine::addFields<StandardStatistics>(first, answer.statistics);
  }
  query.progress = progress.tell;
  query.progress_context = progress.context;
  report.repeated = on && !stands && again;
  report.trials = trial && again;

  if (!automatic || progress.ended) return;
  const double on_us = stands ? with_us : with_us + without_us;  // with the second solve, where it takes one
  const double own_us = on ? on_us : without_us;
  choice.addQuery(own_us);
  if (trial) choice.addTrial(with_us + without_us - own_us, on_us, without_us, report.pairs > 0);
}

}  // namespace visibility
}  // namespace fcl_artic
