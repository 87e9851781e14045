// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>

#include "fcl_artic/result.h"

namespace fcl_artic {

/// What ArticulatedCollisionManager::clearance() is asked. All defaults are safe: nothing has to be tuned.
struct ClearanceRequest {
  /// Wanted: upper - lower is below the larger one of this part of `upper` and this length, m.
  /// From 0 to below 1, and above 0.
  double tolerance_relative = 0.01, tolerance_distance = 1e-4;
  /// Nothing farther apart than this, in m, is of interest: where nothing comes so near, that is the answer.
  double most = 1;
  bool check_scene = true;  ///< links against obstacles
  bool check_self = true;   ///< links against links
  /// Node and leaf tests after which the search ends with what is proven so far; 0: no limit.
  std::uint64_t work_budget = 0;
};

/// The smallest distance of any checked pair over a whole motion. lower <= distance <= upper, both proven.
struct Clearance {
  /// No checked pair comes nearer than this, in m, at any time. 0 when something touches.
  double lower = 0;
  /// body1 and body2 are no farther apart than this, in m, at `time`; infinite where nothing comes within `most`.
  double upper = std::numeric_limits<double>::infinity();
  double time = 0;  ///< 0 to 1, of a trajectory in its own time
  BodyRef body1, body2;
  /// upper - lower is within the tolerances, or nothing comes within `most`. False where the work budget ended first.
  bool within_tolerance = false;
  QueryStatistics statistics;  ///< of all queries together
};

}  // namespace fcl_artic
