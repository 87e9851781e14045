// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cli_app.h"

namespace fcl_artic::app {

/// Adds the verb `generate` (robot and scene data of our own).
/// @param[out] exit_status  set when the verb has run.
void addGenerate(CLI::App& program, int& exit_status);

}  // namespace fcl_artic::app
