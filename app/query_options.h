// SPDX-License-Identifier: BSD-3-Clause
//
// Options about a query, in the group "Query".
#pragma once

#include <CLI/CLI.hpp>

#include "fcl_artic/clearance.h"
#include "fcl_artic/request.h"
#include "fcl_artic/tolerance_left.h"

namespace fcl_artic::app {

/// Adds --margin, --tolerance-time, --tolerance-distance, --budget, --ignore-initial-contact, --no-self and --no-scene.
void addQueryOptions(CLI::App& verb, CertifiedRequest& request);

/// Adds --clearance and --clearance-most.
/// @return --clearance, for what excludes it.
CLI::Option* addClearanceOptions(CLI::App& verb, bool& wanted, ClearanceRequest& request);

/// The request with the query's scope, budget and ignored pairs, as the clearance of its motion is asked for.
ClearanceRequest clearanceOf(const ClearanceRequest& request, const CertifiedRequest& query);
/// The request for the tolerance left, with the query's margins, scope, budget and ignored pairs.
ToleranceLeftRequest toleranceLeftOf(const CertifiedRequest& query);

}  // namespace fcl_artic::app
