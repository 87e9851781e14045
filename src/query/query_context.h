// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "fcl_artic/manager.h"
#include "fcl_artic/trajectory.h"
#include "model/advisor.h"
#include "model/answer.h"
#include "motion/part_of_motion.h"

namespace fcl_artic {

/// Part of the whole trajectory's time that a piece takes.
inline TimePart partOfTime(const JointTrajectory& trajectory, std::size_t piece) {
  const double begin = trajectory.beginTime(), duration = trajectory.endTime() - begin;
  const auto at = [&](std::size_t k) {
    return k == trajectory.numPieces() ? 1 : std::min(1.0, (trajectory.times()[k] - begin) / duration);
  };
  return {at(piece), at(piece + 1)};
}

/// All that queries of other kinds ask of one motion, beyond the request.
struct ArticulatedCollisionManager::QueryContext {
  TimePart time;            ///< of the moving obstacles' motions, over the query's [0, 1]
  bool own_margins = true;  ///< pairs may have margins of their own; false: none has, but neighbours (clearance())
  /// Pairs of the engine's problem: the only ones whose initial contact may be ignored; null: that of all pairs may.
  const std::vector<engine::PairId>* may_ignore = nullptr;
  /// Pairs of the problem as the request's scope leaves it that are not checked, as if they were allowed; null: none.
  const std::vector<engine::PairId>* left_out = nullptr;
  std::vector<engine::PairId>* never_apart = nullptr;  ///< out: ignored pairs that have not separated by t = 1
  /// All that a certificate says beyond the public answer.
  struct Details {
    std::vector<engine::Ignored> ignored;        ///< all ignored pairs
    std::optional<engine::LeafContact> contact;  ///< proven, the first one
  };
  Details* details = nullptr;  ///< out
  /// Advises the solver in place of the request's stage 2, with Method::standard; null: the request's.
  const engine::Advisor* stage2 = nullptr;

  /// A query of clearance(): no pair has a margin of its own, but neighbours.
  static QueryContext ofClearance(const std::vector<engine::PairId>& left_out) {
    QueryContext context;
    context.own_margins = false;
    context.left_out = &left_out;
    return context;
  }
};

}  // namespace fcl_artic
