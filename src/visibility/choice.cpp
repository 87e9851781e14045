// SPDX-License-Identifier: BSD-3-Clause
#include "visibility/choice.h"

#include <algorithm>

namespace fcl_artic {
namespace visibility {
namespace {

/// Of all queries' time, for trials.
constexpr double kTrialShare = 0.01;
/// How fast old trials are forgotten; the least advantage that counts (the second of two runs finds its data in the
/// caches).
constexpr double kForget = 0.9, kAdvantage = 0.8;

}  // namespace

bool Choice::mayTry() {
  const double all_us = 1e-3 * static_cast<double>(query_ns_.load(std::memory_order_relaxed));
  const std::unique_lock<std::mutex> lock(mutex_, std::try_to_lock);
  if (!lock || spent_us_ + trial_us_ > kTrialShare * all_us) return false;
  spent_us_ += trial_us_;  // taken now, so that other threads see it
  return true;
}

void Choice::addTrial(double extra_us, double on_us, double off_us, bool telling) {
  const std::lock_guard<std::mutex> lock(mutex_);
  spent_us_ += extra_us - trial_us_;
  trial_us_ = std::max(extra_us, kForget * trial_us_);
  if (!telling) return;
  on_us_ = kForget * on_us_ + on_us;
  off_us_ = kForget * off_us_ + off_us;
  pays_.store(on_us_ < kAdvantage * off_us_, std::memory_order_relaxed);
}

}  // namespace visibility
}  // namespace fcl_artic
