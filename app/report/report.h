// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "fcl_artic/clearance.h"
#include "fcl_artic/kinematic_tree.h"
#include "fcl_artic/request.h"
#include "fcl_artic/result.h"
#include "fcl_artic/tolerance_left.h"

namespace fcl_artic::app {

/// A query and its answer, as they are reported.
struct Report {
  const KinematicTree& tree;
  const CertifiedRequest& request;
  const CertifiedResult& result;
  const std::vector<std::string>& notes;  ///< one line each
  std::function<Eigen::VectorXd(double t)> configuration;
  double begin = 0, end = 1;             ///< of the motion
  const Clearance* clearance = nullptr;  ///< null: not asked for
  std::size_t pieces = 1;                ///< of a trajectory
  /// Whether `request` is what `result` answers. If not, as with an answer that comes from elsewhere, it is not
  /// printed.
  bool request_known = true;
  std::string tolerances = {};                    ///< ArticulatedCollisionManager::describeTolerances()
  const ToleranceLeft* tolerance_left = nullptr;  ///< null: not asked for
};

/// "(0.5, -0.25, 0)": a place, m, in so many digits. No coordinate is "-0", or a 0 that rounding has changed.
std::string placeText(const Eigen::Vector3d& place, int digits = 6);
/// The same of a direction: a vector of length 1, with so many decimals.
std::string directionText(const Eigen::Vector3d& direction, int decimals = 6);

/// The verdict in one sentence.
std::string headline(const Report& report);

/// The pairs that a request leaves out; empty: none.
std::string scopeText(const CertifiedRequest& request);

/// The answer for a reader.
std::string textReport(const Report& report);

/// The answer for a program, with the keys of fcl_artic(1). Numbers keep all their digits.
nlohmann::ordered_json jsonReport(const Report& report);
/// The keys for pairs that `free` leaves out: no short form of the answer leaves them out.
constexpr const char* kExceptions[] = {"ignored_initial_contacts", "never_apart_pairs", "unproven_allowed_pairs",
                                       "unproven_neighbours"};

}  // namespace fcl_artic::app
