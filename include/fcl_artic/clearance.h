// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "fcl_artic/request.h"
#include "fcl_artic/result.h"

namespace fcl_artic {

/// Request of ArticulatedCollisionManager::clearance(). All defaults are safe: nothing has to be tuned. clearance()
/// throws std::invalid_argument, naming the value, for values outside the ranges given here.
struct ClearanceRequest : Scope {
  /// Wanted accuracy: upper - lower is at most the larger one of tolerance_relative * upper (at least 0, below 1) and
  /// tolerance_distance (m, above 0).
  double tolerance_relative = 0.01, tolerance_distance = 1e-4;
  /// Largest distance of interest, m, above 0: if nothing comes within it, that is the answer.
  double most = 1;
  /// Maximum number of node and leaf tests; after it the search ends with what is proven so far; 0: no limit.
  std::uint64_t work_budget = 0;
  /// Called now and then, from the querying thread, with what is proven so far (Clearance). May be empty. If it returns
  /// false, the search ends with that, and Clearance::within_tolerance is false.
  std::function<bool(double lower, double upper)> progress;
  /// Whether pairs that touch at the motion's begin, or are within their margin then, are left out, over the whole
  /// motion. (Strictly, a pair that is not proven apart then counts as touching.) These are the pairs that
  /// CertifiedRequest::ignore_initial_contact ignores.
  bool ignore_initial_contact = false;
  /// Margin of pairs that have none of their own, by which ignore_initial_contact goes; m, finite, at least 0.
  double ignored_margin = 0;
};

/// The smallest distance of any checked pair over a whole motion: lower <= distance <= upper, both proven. It is found
/// by queries with margins (CertifiedRequest::margin).
struct Clearance {
  /// No checked pair comes nearer than this, in m, at any time. Neighbours that are checked for touching only
  /// (ArticulatedCollisionManager::setAllowedCollisions()) are an exception: of these it says only that they do not
  /// touch. It is 0 if something touches, and if nothing larger is proven.
  double lower = 0;
  /// At `time`, body1 and body2 are proven to be no farther apart than this, in m. Infinite if nothing is proven to
  /// come within ClearanceRequest::most.
  double upper = std::numeric_limits<double>::infinity();
  /// Time to which `upper` belongs: in [0, 1], for a trajectory its own time. 0 if `upper` is infinite.
  double time = 0;
  /// The pair to which `upper` belongs; without names if `upper` is infinite.
  BodyRef body1, body2;
  /// Whether upper - lower is within the tolerances, or nothing comes within ClearanceRequest::most. False if the work
  /// budget ran out, if `progress` ended the search, or if a query could not be decided.
  bool within_tolerance = false;
  /// Work of all queries together.
  QueryStatistics statistics;
  /// Pairs that were left out (ClearanceRequest::ignore_initial_contact): nothing here is said of them.
  std::vector<std::pair<BodyRef, BodyRef>> ignored_initial_contacts;
};

}  // namespace fcl_artic
