// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>

namespace fcl_artic::app {

/// The verb `bench planning`: plans with OMPL's discrete validator over FCL and with ours, side by side.
void addBench(CLI::App& program, int& exit_status);

}  // namespace fcl_artic::app
