// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cli_app.h"

namespace fcl_artic::app {

/// Adds the verb `roadmap` with `make` and `certify`.
/// @param[out] exit_status  set when it runs.
void addRoadmap(CLI::App& program, int& exit_status);

}  // namespace fcl_artic::app
