// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cli_app.h"

namespace fcl_artic::app {

/// The verb `bench table1` measures the paper's Table 1 anew, `bench ideas` the worth of each option of its method.
/// `bench depth` compares its two ways to solve equations as chains get deeper.
void addTable1(CLI::App& bench, int& exit_status);
void addIdeas(CLI::App& bench, int& exit_status);
void addDepth(CLI::App& bench, int& exit_status);

}  // namespace fcl_artic::app
