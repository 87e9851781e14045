// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cli_app.h"

namespace fcl_artic::app {

/// The verb `bench`: `planning` (plans with OMPL's discrete validator over FCL and with ours, side by side), `table1`,
/// `ideas` and `depth` (the paper's own method).
void addBench(CLI::App& program, int& exit_status);

}  // namespace fcl_artic::app
