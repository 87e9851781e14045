// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cli_app.h"

namespace fcl_artic::app {

/// Adds `generate edges` and `generate scenes`: files for `certify --edges`.
void addGenerateEdges(CLI::App& generate, int& exit_status);

}  // namespace fcl_artic::app
