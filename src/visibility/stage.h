// SPDX-License-Identifier: BSD-3-Clause
//
// Stage 2 of a query: takes pairs of link and obstacle out that visibility proves free (doc/VISIBILITY.md).
#pragma once

#include <cstdint>
#include <string>

#include "narrowphase/problem.h"
#include "visibility/culler.h"

namespace fcl_artic {
namespace visibility {

class Stage {
 public:
  explicit Stage(const VisibilityCuller& culler) : culler_(culler) {}

  /// engine::Query::refine, with a Stage as its context.
  static void refine(void* stage, const engine::Problem& problem, const engine::SweptLink* links,
                     engine::CullCandidate* pairs, std::int32_t num_pairs);

  // What it did.
  std::uint64_t pairs = 0, culled = 0, pieces = 0;
  double elapsed_us = 0;
  std::string executor;  ///< empty: nothing was asked of one
  std::string failure;   ///< it gave up in the midst of its work

 private:
  void run(const engine::Problem& problem, const engine::SweptLink* links, engine::CullCandidate* pairs,
           std::int32_t num_pairs, ExecutorLoan& loan);
  const VisibilityCuller& culler_;
};

}  // namespace visibility
}  // namespace fcl_artic
