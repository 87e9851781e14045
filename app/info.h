// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cli_app.h"

namespace fcl_artic::app {

/// Adds the verb `info`, which shows what the files of a robot hold.
void addInfo(CLI::App& program, int& exit_status);

}  // namespace fcl_artic::app
