// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "fcl_artic/request.h"
#include "fcl_artic/result.h"

namespace fcl_artic {

/// Request of ArticulatedCollisionManager::toleranceLeft(). Margins count as in a query, and pairs that have margins of
/// their own keep them. All defaults are safe: nothing has to be tuned. toleranceLeft() throws std::invalid_argument,
/// naming the value, for values outside the ranges given here.
struct ToleranceLeftRequest : Tolerances, Scope {
  /// Wanted accuracy: upper - lower is at most the larger one of accuracy_relative * upper (at least 0, below 1) and
  /// accuracy_factor (above 0).
  double accuracy_relative = 0.01, accuracy_factor = 1e-3;
  /// Largest factor of interest, above 0, at most 1e6: if that is still free, it is the answer.
  double most = 100;
  /// Maximum number of node and leaf tests; after it the search ends with what is proven so far; 0: no limit.
  std::uint64_t work_budget = 0;
  /// Called now and then, from the querying thread, with what is known so far (ToleranceLeft). May be empty. If it
  /// returns false, the search ends with that, and ToleranceLeft::within_accuracy is false.
  std::function<bool(double lower, double upper)> progress;
  /// Whether pairs that CertifiedRequest::ignore_initial_contact ignores, with the tolerances as they are set, are left
  /// out over the whole motion.
  bool ignore_initial_contact = false;
};

/// How many times all tolerances of a manager may be as large, so that the motion is still free. Each joint, the base
/// and each object then has its tolerance times one factor. It is found by queries with such factors.
struct ToleranceLeft : ToleranceWitness {
  /// Proven: with all tolerances times this, and so with any smaller ones, every path is free. It is 0 if nothing
  /// larger is proven.
  double lower = 0;
  /// A query with all tolerances times this is not free: `body1` and `body2` can't be proven apart then. Infinite if no
  /// query has failed, up to ToleranceLeftRequest::most. It is 0 if the motion itself is not proven free, without any
  /// tolerance.
  ///
  /// That is no proof that the robot can touch, unless the contact is `certain`. For the bound adds up the worst of all
  /// joints, though they may not get there together (doc/PROMISE.md, "Tolerances"). So more than `upper` may be free.
  /// Within about a percent of its limit a query may miss a proof, though one with a larger factor has found it.
  double upper = std::numeric_limits<double>::infinity();
  /// With tolerances times `upper`, the time from which on the pair can't be proven apart; all is proven free before
  /// it. If `certain`, the time of the contact. In [0, 1], for a trajectory its own time; 0 if `upper` is infinite.
  double time = 0;
  /// The pair that limits the factor; without names if `upper` is infinite.
  BodyRef body1, body2;
  /// Whether the two are proven to touch, or to be within their margin, at `time`: at `q_witness`, within the
  /// tolerances times `upper`. (It is empty, too, if the motion itself touches: `upper` is 0.)
  bool certain = false;
  /// Whether upper - lower is within the wanted accuracy, or ToleranceLeftRequest::most is free. False if the work
  /// budget ran out, or if `progress` ended the search.
  bool within_accuracy = false;
  /// Work of all queries together.
  QueryStatistics statistics;
  /// Pairs that were left out (ToleranceLeftRequest::ignore_initial_contact): nothing here is said of them.
  std::vector<std::pair<BodyRef, BodyRef>> ignored_initial_contacts;
};

}  // namespace fcl_artic
