// SPDX-License-Identifier: BSD-3-Clause
//
// Stage 2, culling by visibility, in answers.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "fcl_artic/request.h"
#include "fcl_artic/result.h"
#include "fcl_artic/statistics.h"

namespace fcl_artic::app {

/// The work of stage 2 in JSON: whether it was used, by which executor, its counts; null if it was off.
nlohmann::ordered_json visibilityJson(VisibilityMode mode, const QueryStatistics& statistics);
/// The same for a reader, in a line without an end.
std::string visibilityText(const QueryStatistics& statistics);

}  // namespace fcl_artic::app
