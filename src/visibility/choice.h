// SPDX-License-Identifier: BSD-3-Clause
//
// Whether stage 2 pays (doc/VISIBILITY.md, "Automatic"): by what queries cost with it and without. Time only: no answer
// depends on it.
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>

namespace fcl_artic {
namespace visibility {

/// One for each manager, shared by its threads.
class Choice {
 public:
  /// @param first_trial_us  what a first trial may cost.
  explicit Choice(double first_trial_us) : trial_us_(first_trial_us) {}

  bool pays() const { return pays_.load(std::memory_order_relaxed); }
  /// Time for a trial, a query that is answered both ways: trials take at most 1 % of all queries' time, the present
  /// one's own included.
  bool mayTry();
  /// Adds a query's time, of a trial that of the way chosen.
  void addQuery(double us) { query_ns_.fetch_add(static_cast<std::uint64_t>(1e3 * us), std::memory_order_relaxed); }
  /// Adds what a trial took beyond that, and what both ways took.
  /// @param telling  the stage had something to do.
  void addTrial(double extra_us, double on_us, double off_us, bool telling);

 private:
  std::atomic<bool> pays_{false};
  std::atomic<std::uint64_t> query_ns_{0};
  std::mutex mutex_;
  double spent_us_ = 0, trial_us_;  ///< all trials; what one takes
  double on_us_ = 0, off_us_ = 0;   ///< sums that forget
};

}  // namespace visibility
}  // namespace fcl_artic
