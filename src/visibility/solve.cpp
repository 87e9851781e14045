// SPDX-License-Identifier: BSD-3-Clause
#include "visibility/solve.h"

#include <algorithm>

#include "model/add_fields.h"
#include "visibility/stage.h"

namespace fcl_artic {
namespace visibility {
namespace {

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
bool solveShortened(const VisibilityCuller& culler, ExecutorKind kind, const SolveFunction& solver,
                    const engine::Query& query, engine::Answer& answer, Report& report, const Microseconds& now) {
  Stage stage(culler, kind, query.tolerance_distance, now);
  engine::Query advised = query;
  advised.ask(stage.advisor());
  solver(advised, answer);
  static_cast<VisibilityStatistics&>(report) = stage.work;
  report.making_us = stage.making_us;
  report.executor = stage.executor;
  report.fallback = culler.fallbackReason();
  return isPlainlyFree(answer) || (stage.work.culled == 0 && stage.work.nodes == 0);
}

}  // namespace

bool takesPart(VisibilityMode mode, const engine::Problem& problem, const engine::Query& query) {
  const bool scene = query.check_scene && problem.num_obstacles > 0,
             moving = query.check_self && problem.num_link_pairs > 0;
  if (mode == VisibilityMode::off || !(scene || moving)) return false;
  return mode == VisibilityMode::atOnce || query.work_budget == 0;
}

void solve(const VisibilityCuller& culler, Choice& choice, VisibilityMode mode, const SolveFunction& solver,
           const engine::Problem& problem, engine::Query& query, engine::Answer& answer, Report& report,
           const Microseconds& now) {
  if (!takesPart(mode, problem, query)) {
    solver(query, answer);
    return;
  }
  if (mode == VisibilityMode::atOnce) {
    solveShortened(culler, ExecutorKind::own, solver, query, answer, report, now);
    return;
  }
  const bool automatic = mode == VisibilityMode::automatic, measured = automatic && choice.measuresNext();
  ExecutorKind kind = automatic ? choice.best() : ExecutorKind::own;
  // A second context saves no time: contexts take turns.
  if (automatic && kind == ExecutorKind::own && !ExecutorLoan::isMade(culler)) kind = ExecutorKind::none;
  TrialPermit trial;
  if (measured) trial = choice.mayTry(ExecutorLoan::isMade(culler));
  if (!trial.given() && kind == ExecutorKind::none && !measured) {
    solver(query, answer);
    return;
  }
  const bool on = kind != ExecutorKind::none;
  if (trial.given()) kind = trial.kind;
  Progress progress{query.progress, query.progress_context};
  if (query.progress) {
    query.progress = &Progress::update;
    query.progress_context = &progress;
  }

  double with_us = 0, without_us = 0;
  bool stands = false;
  engine::Statistics first;
  if (kind != ExecutorKind::none) {
    const double begin = now();
    stands = solveShortened(culler, kind, solver, query, answer, report, now);
    with_us = now() - begin - report.making_us;
    first = answer.statistics;
  }
  const bool again = (!stands || trial.given()) && !progress.ended;
  if (again) {
    const double begin = now();
    solver(query, answer);
    without_us = now() - begin;
    engine::addFields<StandardStatistics>(first, answer.statistics);
  }
  query.progress = progress.tell;
  query.progress_context = progress.context;
  report.repeated = on && !stands && again;
  report.trials = trial.given() && again;

  if (!measured || progress.ended) return;
  const double on_us = stands ? with_us : with_us + without_us;  // with the second solve, where it takes one
  const double own_us = on ? on_us : without_us;
  choice.addQueries(own_us);
  if (!trial.given()) return;
  const double extra_us = with_us + report.making_us + without_us - own_us;
  choice.addTrial(trial, {on_us, without_us, report.us, extra_us, report.pairs > 0});
}

}  // namespace visibility
}  // namespace fcl_artic
