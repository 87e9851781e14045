// SPDX-License-Identifier: BSD-3-Clause
//
// Chooses whether queries use stage 2, and by which executor, from the times that they take with it and without
// (doc/VISIBILITY.md, "Automatic"). No answer depends on the choice, only its time does. It has no clock: callers pass
// the times.
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
  double with_us, without_us;  ///< with_us: includes the second solve, if there is one, but no making of an executor
  double stage_us;             ///< the part of with_us that the stage itself took
  double extra_us;             ///< time beyond that of the way that was chosen anyway; making an executor included
  bool telling;                ///< the stage had something to do
};

/// One for each manager and solver, shared by its threads.
class Choice {
 public:
  /// @param making_us  the time that making the culler's own executor may take; below 0: the culler has cpu only.
  explicit Choice(double making_us = -1) : making_us_(making_us) {}

  /// The executor that takes the least time as far as trials have shown; `none` until trials show that one saves time.
  ExecutorKind best() const { return best_.load(std::memory_order_relaxed); }
  /// Whether to measure the time of the next query: of one in kMeasured, as clocks take time too. (kMeasured is a
  /// prime: callers may repeat queries in a fixed order.)
  bool measuresNext() { return counter_.fetch_add(1, std::memory_order_relaxed) % kMeasured == 0; }
  /// Adds the time of queries that were measured; for a trial, that of the way that was chosen.
  /// @param stand_for  each measured query stands for this many.
  void addQueries(double us, double queries = 1, double stand_for = kMeasured);
  /// Permits a trial, or none. Trials take at most kShare of the time of all queries, the one at hand included. They
  /// take less if they have shown that the stage is far from paying.
  /// @param own_is_made  whether an executor of the culler's own is ready. If none is, one is tried only if trials of
  /// cpu show that it would save enough if its drawing took next to no time.
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
    int trials = 0;                                     ///< only those that were telling
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
