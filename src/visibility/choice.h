// SPDX-License-Identifier: BSD-3-Clause
//
// Whether stage 2 pays, and by which executor (doc/VISIBILITY.md, "Automatic"): by what queries cost with it and
// without. Only time depends on it, no answer does. It has no clock: callers pass the times.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>

namespace fcl_artic {
namespace visibility {

/// A clock, µs since some time of its own.
using Microseconds = std::function<double()>;
/// The machine's steady clock.
double steadyMicroseconds();

/// Who does stage 2: nobody, the executor cpu, or a culler's own executor, which draws by OpenGL.
enum class ExecutorKind { none, cpu, own };

/// Permission to answer a query both ways: by an executor, and without stage 2.
struct TrialPermit {
  ExecutorKind kind = ExecutorKind::none;  ///< to compare with going without; none: no trial
  double reserved_us = 0;
  bool given() const { return kind != ExecutorKind::none; }
};

/// The cost of a query both ways, µs; or of several queries together.
struct TrialCosts {
  double with_us, without_us;  ///< with: the second solve included, where it takes one; making an executor is not
  double stage_us;             ///< of with_us, what the stage itself took
  double extra_us;             ///< beyond what was chosen anyway, all included
  bool telling;                ///< the stage had something to do
};

/// One for each manager and solver, shared by its threads.
class Choice {
 public:
  /// @param making_us  what making the culler's own executor may take; below 0: there is none but cpu.
  explicit Choice(double making_us = -1) : making_us_(making_us) {}

  /// The executor that takes the least time as far as trials have shown; none until they have shown another one.
  ExecutorKind best() const { return best_.load(std::memory_order_relaxed); }
  /// Whether to measure the time of what is asked next, one query of kMeasured: clocks take time too. (A prime: callers
  /// may ask in turns.)
  bool measuresNext() { return counter_.fetch_add(1, std::memory_order_relaxed) % kMeasured == 0; }
  /// Adds the time of queries that were measured, of a trial that of what was chosen.
  /// @param stand_for  how many times as many they stand for.
  void addQueries(double us, double queries = 1, double stand_for = kMeasured);
  /// Permits a trial, or none. Trials take at most kShare of the time of all queries, the one at hand included. They
  /// take less where they have shown that the stage is far from paying.
  /// @param own_is_made  an executor of the culler's own is ready. Before, it is tried only where the trials of cpu
  /// show that enough would be saved if drawing took no time.
  TrialPermit mayTry(bool own_is_made, double queries = 1);
  /// Adds what a trial has shown. One that ended in an exception is not added: its time stays reserved.
  void addTrial(const TrialPermit& permit, const TrialCosts& trial, double queries = 1);

  static constexpr std::uint32_t kMeasured = 31;
  static constexpr double kShare = 0.02;

 private:
  /// The costs of one executor, as far as they are known.
  struct MeasuredCosts {
    double cost_us;                                     ///< that a query's trial is expected to take
    double spent_us = 0;                                ///< by trials
    double on_us = 0, off_us = 0, stage_us = 0, n = 0;  ///< sums over trials; old ones are forgotten
    int trials = 0;                                     ///< only those whose times count
    bool pays() const;
    bool isFarFromPaying() const;
  };
  bool ownMayPay() const;

  std::atomic<ExecutorKind> best_{ExecutorKind::none};
  std::atomic<std::uint32_t> counter_{0};
  std::atomic<std::uint64_t> queries_{0}, all_ns_{0};
  const double making_us_;
  std::mutex mutex_;
  MeasuredCosts cpu_{100}, own_{1000};
};

}  // namespace visibility
}  // namespace fcl_artic
