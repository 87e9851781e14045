// SPDX-License-Identifier: BSD-3-Clause
//
// Stage 2 of a query: takes pairs of link and obstacle, and nodes of an obstacle's tree, out that visibility proves
// free (doc/VISIBILITY.md).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "model/query.h"
#include "visibility/culler.h"

namespace fcl_artic {
namespace visibility {

class Stage {
 public:
  /// @param tolerance_distance  of the query, m: what is nearer stays, since the solver alone may take it for a
  /// contact.
  Stage(const VisibilityCuller& culler, double tolerance_distance)
      : culler_(culler), tolerance_distance_(tolerance_distance) {}

  /// The solver's advisor that asks this stage.
  engine::Advisor advisor() {
    engine::Advisor advisor;
    advisor.self = this;
    advisor.clear = &Stage::clear;
    return advisor;
  }

  // What it did.
  std::uint64_t pairs = 0, culled = 0, nodes = 0, pieces = 0;
  double elapsed_us = 0;
  std::string executor;  ///< empty: nothing was asked of one
  std::string failure;   ///< it gave up in the midst of its work

 private:
  static void clear(void* stage, const engine::Problem& problem, const engine::SweptLink* links,
                    engine::CullCandidate* pairs, std::int32_t num_pairs);
  void run(const engine::Problem& problem, const engine::SweptLink* links, engine::CullCandidate* pairs,
           std::int32_t num_pairs, ExecutorLoan& loan);
  const VisibilityCuller& culler_;
  double tolerance_distance_;
  std::vector<std::uint64_t> free_nodes_;  ///< CullCandidate::free_nodes, one after the other
};

}  // namespace visibility
}  // namespace fcl_artic
