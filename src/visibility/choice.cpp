// SPDX-License-Identifier: BSD-3-Clause
#include "visibility/choice.h"

#include <algorithm>
#include <chrono>

namespace fcl_artic {
namespace visibility {
namespace {

/// The rate at which old trials are forgotten. The least advantage that counts (the second of two runs finds its data
/// in the caches). And the number of trials before anything is chosen.
constexpr double kForget = 0.9, kAdvantage = 0.8;
constexpr int kLeastTrials = 6;
/// The least time that drawing by OpenGL and reading back takes, us. (On a processor it takes 30 and more.)
constexpr double kLeastDrawing = 20;
/// If trials take this many times as long, the stage is far from paying. Then trials get this part of the share.
constexpr double kFar = 2, kWhenFar = 0.25;
/// The part of the share for trials of the culler's own executor, where that may pay, its making included.
constexpr double kForOwn = 0.75;

}  // namespace

double steadyMicroseconds() {
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

bool Choice::MeasuredCosts::pays() const {
  return trials >= kLeastTrials && on_us < kAdvantage * off_us;
}

bool Choice::MeasuredCosts::isFarFromPaying() const {
  return trials >= kLeastTrials && on_us > kFar * off_us;
}

/// Whether the culler's own executor would save time if it drew as fast as any.
bool Choice::ownMayPay() const {
  return cpu_.trials >= kLeastTrials && cpu_.off_us - (cpu_.on_us - cpu_.stage_us) > kLeastDrawing * cpu_.n;
}

void Choice::addQueries(double us, double queries, double stand_for) {
  all_ns_.fetch_add(static_cast<std::uint64_t>(1e3 * us * stand_for), std::memory_order_relaxed);
  queries_.fetch_add(static_cast<std::uint64_t>(queries * stand_for), std::memory_order_relaxed);
}

TrialPermit Choice::mayTry(bool own_is_made, double queries) {
  const std::unique_lock<std::mutex> lock(mutex_, std::try_to_lock);
  if (!lock) return {};
  const double all_us = 1e-3 * static_cast<double>(all_ns_.load(std::memory_order_relaxed));
  const auto asked = static_cast<double>(queries_.load(std::memory_order_relaxed));
  const double one_us = asked > 0 ? all_us / asked : 0;  // a trial takes about as long as a query
  const auto permit = [&](ExecutorKind kind, MeasuredCosts& known, double part, double making_us) -> TrialPermit {
    const double cost_us = queries * std::max(known.cost_us, one_us) + making_us;
    const double share = part * (known.isFarFromPaying() ? kWhenFar : 1) * kShare;
    if (known.spent_us + cost_us > share * all_us || cpu_.spent_us + own_.spent_us + cost_us > kShare * all_us) {
      return {};
    }
    known.spent_us += cost_us;  // taken now, so that other threads see it
    return {kind, cost_us};
  };
  const bool has_own = making_us_ >= 0 && (own_is_made || ownMayPay());
  const double of_own = has_own ? kForOwn : 0;
  const TrialPermit own =
      has_own ? permit(ExecutorKind::own, own_, of_own, own_is_made ? 0 : making_us_) : TrialPermit();
  return own.given() ? own : permit(ExecutorKind::cpu, cpu_, 1 - of_own, 0);
}

void Choice::addTrial(const TrialPermit& permit, const TrialCosts& trial, double queries) {
  const std::lock_guard<std::mutex> lock(mutex_);
  MeasuredCosts& known = permit.kind == ExecutorKind::own ? own_ : cpu_;
  known.spent_us += trial.extra_us - permit.reserved_us;
  known.cost_us =
      std::max(std::min(trial.extra_us, trial.with_us + trial.without_us) / queries, kForget * known.cost_us);
  if (!trial.telling) return;
  for (double* sum : {&known.on_us, &known.off_us, &known.stage_us, &known.n}) *sum *= kForget;
  known.on_us += trial.with_us;
  known.off_us += trial.without_us;
  known.stage_us += trial.stage_us;
  known.n += queries;
  ++known.trials;
  // The one that takes the smaller part of the time without it.
  ExecutorKind best = cpu_.pays() ? ExecutorKind::cpu : ExecutorKind::none;
  if (own_.pays() && (!cpu_.pays() || own_.on_us * cpu_.off_us < cpu_.on_us * own_.off_us)) best = ExecutorKind::own;
  best_.store(best, std::memory_order_relaxed);
}

}  // namespace visibility
}  // namespace fcl_artic
