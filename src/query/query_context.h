// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "fcl_artic/manager.h"
#include "fcl_artic/trajectory.h"
#include "model/answer.h"
#include "model/query.h"
#include "motion/part_of_motion.h"

namespace fcl_artic {

/// The part of the whole trajectory's time that a piece takes; the whole is [0, 1].
inline TimePart partOfTime(const JointTrajectory& trajectory, std::size_t piece) {
  const double begin = trajectory.beginTime(), duration = trajectory.endTime() - begin;
  const auto at = [&](std::size_t k) {
    return k == trajectory.numPieces() ? 1 : std::min(1.0, (trajectory.times()[k] - begin) / duration);
  };
  return {at(piece), at(piece + 1)};
}

/// Settings beyond the request of a query of one motion: for trajectories, and for searches that ask many queries.
struct ArticulatedCollisionManager::QueryContext {
  TimePart time;            ///< the part of the moving obstacles' motions that the query's [0, 1] is
  engine::Clock clock;      ///< the time that has passed since the motion's begin, in the motion's unit
  double duration = 1;      ///< no more than the whole motion takes, in that unit
  bool own_margins = true;  ///< pairs' own margins hold; false: those of neighbours alone (clearance())
  double stray_factor = 1;  ///< times which tolerances of joints, base and objects count; 0: they do not
  /// Pairs of the engine's problem: only their initial contacts may be ignored; null: those of all pairs may.
  const std::vector<engine::PairId>* may_ignore = nullptr;
  /// Pairs that are not checked, as if they were allowed; null: none. Their numbers are of the problem that the
  /// request's scope leaves.
  const std::vector<engine::PairId>* left_out = nullptr;
  std::vector<engine::PairId>* never_apart = nullptr;  ///< out: ignored pairs that have not separated by t = 1
  /// All that a certificate says beyond the public answer.
  struct Details {
    std::vector<engine::Ignored> ignored;        ///< all ignored pairs
    std::optional<engine::LeafContact> contact;  ///< the first contact, if it is proven
  };
  Details* details = nullptr;  ///< out
  /// Out, for those who want no more than a bracket and the pair that limits it; null: the answer is reported in full.
  /// The result then has no contacts, no witnesses and no poses.
  std::optional<engine::LeafContact>* limit = nullptr;
  const double* variable_strays = nullptr;  ///< rad or m, by variable, in place of the set-up's

  /// The settings of a query of one piece.
  void setPiece(const JointTrajectory& trajectory, std::size_t piece) {
    time = partOfTime(trajectory, piece);
    const double begin = trajectory.beginTime();
    clock = {trajectory.times()[piece] - begin, trajectory.times()[piece + 1] - begin};
    duration = (trajectory.endTime() - begin) * (1 - 0x1p-50);  // rounded down
  }
};

/// The queries about one motion or trajectory that a search asks (query/bracket_search.h).
struct ArticulatedCollisionManager::MotionQueries {
  using Context = QueryContext;
  using Ask = std::function<void(const CertifiedRequest& request, const Context& context, CertifiedResult& result)>;
  double duration;  ///< in the unit that its times are in
  Ask whole;
  Ask beginning;  ///< of the motion, or of a trajectory's first piece
};

}  // namespace fcl_artic
