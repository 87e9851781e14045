// SPDX-License-Identifier: BSD-3-Clause
//
// The query at hand: what is asked, of which problem, and what it has cost so far.
#pragma once

#include <time.h>

#include "model/answer.h"
#include "model/query.h"
#include "narrowphase/solver/time_batch.h"
#include "numerics/assertion.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

using engine::Body;
using engine::LinkPair;
using engine::PairId;
using engine::PairParts;
using engine::Placement;
using engine::Problem;
using engine::Query;
using engine::Statistics;

class Task {
 public:
  const Problem* problem = nullptr;
  const Query* query = nullptr;
  Statistics statistics;
  const TimeBatch whole = TimeBatch::partsOf(0, 1);  ///< the first batch

  void begin(const Problem& asked_of, const Query& asked) {
    FCL_ARTIC_ASSERT(asked.tolerance_time > 0 && asked.tolerance_distance > 0 && asked.max_contacts >= 0);
    FCL_ARTIC_ASSERT(asked.degree >= 1 && asked.degree <= engine::kMaxDegree);
    problem = &asked_of;
    query = &asked;
    statistics = Statistics();
    ended_ = false;
    told_at_ = 0;
  }

  /// The budget is spent, or the caller has ended the query.
  bool ended() const { return ended_; }
  /// Whether the query must end: its budget is spent, or the caller has cancelled it. Every kToldEvery tests the caller
  /// learns up to which time all is proven free.
  bool mustEnd(double proven_free_until) {
    const std::uint64_t work = statistics.node_tests + statistics.leaf_tests;
    if (query->work_budget && work > query->work_budget) ended_ = true;
    if (query->progress && work >= told_at_ + kToldEvery && !ended_) {
      told_at_ = work;
      ended_ = !query->progress(query->progress_context, proven_free_until);
    }
    return ended_;
  }

  /// Microseconds; 0 where times are not asked for.
  double now() const {
    if (!query->measure_times) return 0;
    timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e6 * static_cast<double>(t.tv_sec) + 1e-3 * static_cast<double>(t.tv_nsec);
  }

  /// A mover is a link of the robot, not an obstacle that moves.
  bool isLink(int mover) const { return mover < problem->num_scene_movers; }

 private:
  /// Tests from one report of progress to the next: a fraction of a millisecond.
  static constexpr std::uint64_t kToldEvery = 1024;
  bool ended_ = false;
  std::uint64_t told_at_ = 0;  ///< number of tests at the last report of progress
};

/// A part of the solver: it reads the query at hand and counts its work.
class PartOfSolver {
 protected:
  explicit PartOfSolver(Task& task) : task_(task) {}
  const Problem& problem() const { return *task_.problem; }
  const Query& query() const { return *task_.query; }
  Statistics& statistics() { return task_.statistics; }
  const Body& body(int index) const { return task_.problem->bodies[index]; }
  const TimeBatch& whole() const { return task_.whole; }

  Task& task_;
};

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
