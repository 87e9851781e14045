// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cli_app.h"

namespace fcl_artic::app {

/// Adds the verb `check`: one motion of one robot in one scene.
/// @param[out] exit_status  set when the verb has run.
void addCheck(CLI::App& program, int& exit_status);

}  // namespace fcl_artic::app
