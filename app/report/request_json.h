// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>

#include "fcl_artic/request.h"

namespace fcl_artic::app {

/// The request, by the names of the options (query/request_options.h) in their order.
nlohmann::ordered_json requestJson(const CertifiedRequest& request);

}  // namespace fcl_artic::app
