// SPDX-License-Identifier: BSD-3-Clause
//
// Stage 2 of a query: takes pairs of a link and another body, and nodes of that body's tree, out that visibility proves
// free (doc/VISIBILITY.md).
#pragma once

#include <cstdint>
#include <deque>
#include <string>

#include "model/query.h"
#include "visibility/choice.h"
#include "visibility/culler.h"
#include "visibility/query_volumes.h"

namespace fcl_artic {
namespace visibility {

/// An empty batch by the culler's options, of which only groups are asked.
void beginBatch(const VisibilityCuller& culler, Batch& batch);

class Stage {
 public:
  /// @param kind  the culler's own executor, or cpu.
  /// @param tolerance_distance  of the query, m: see QueryVolumes::add().
  Stage(const VisibilityCuller& culler, ExecutorKind kind, double tolerance_distance, const Microseconds& now)
      : culler_(culler), kind_(kind), tolerance_distance_(tolerance_distance), now_(now) {}

  /// The solver's advisor that asks this stage.
  engine::Advisor advisor() {
    engine::Advisor advisor;
    advisor.self = this;
    advisor.clear = &Stage::clear;
    return advisor;
  }

  // Its work.
  VisibilityStatistics work;  ///< its time is without the making
  double making_us = 0;       ///< of an executor
  std::string executor;       ///< empty: nothing was asked of one

 private:
  static void clear(void* stage, const engine::Problem& problem, const engine::SweptLink* links,
                    engine::CullCandidate* pairs, std::int32_t num_pairs);
  void run(const engine::Problem& problem, const engine::SweptLink* links, engine::CullCandidate* pairs,
           std::int32_t num_pairs, ExecutorLoan& loan);
  const VisibilityCuller& culler_;
  ExecutorKind kind_;
  double tolerance_distance_;
  const Microseconds& now_;
  std::deque<QueryVolumes> volumes_;  ///< of each call: free nodes are to be there until the solver returns
};

}  // namespace visibility
}  // namespace fcl_artic
