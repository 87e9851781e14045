// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cli_app.h"

namespace fcl_artic::app {

/// The verbs `bench table1` (the paper's Table 1 measured anew), `bench ideas` (the worth of each option of its method)
/// and `bench depth` (its two ways to solve equations as chains get deeper).
void addTable1(CLI::App& bench, int& exit_status);
void addIdeas(CLI::App& bench, int& exit_status);
void addDepth(CLI::App& bench, int& exit_status);

}  // namespace fcl_artic::app
