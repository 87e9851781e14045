// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "certification.h"
#include "report/report.h"

namespace fcl_artic::app {

/// The answers, and the settings with which they are shown.
struct CertifyReport {
  const KinematicTree& tree;
  const CertifiedRequest& request;
  const std::vector<CertifiedPlan>& plans;
  const std::vector<std::string>& notes;  ///< of robot and scene
  double seconds = 0;                     ///< that all queries took
  bool failed_only = false;               ///< rows of the table
  std::string tolerances = {};            ///< as Report's
};

/// The answer to a plan that has a motion. It refers to the report's members and to the plan.
Report reportOf(const CertifyReport& all, const CertifiedPlan& plan);
/// One plan in full; several as a table, with totals.
std::string textReport(const CertifyReport& report);
/// With the keys of fcl_artic(1).
nlohmann::ordered_json jsonReport(const CertifyReport& report);
/// A row for each plan.
std::string csvReport(const CertifyReport& report);

}  // namespace fcl_artic::app
