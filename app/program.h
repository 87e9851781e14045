// SPDX-License-Identifier: BSD-3-Clause
//
// A command line from its parsing to its exit status, for fcl_artic and the programs that have verbs of their own.
#pragma once

#include <functional>

#include "cli_app.h"

namespace fcl_artic::app {

/// Parses the command line, runs the verb that it names, and prints errors to standard error.
/// @param add_verbs  adds the verbs; each sets the exit status when it runs.
/// @return the exit status; kExitError for wrong usage, an exception, or output that can't be written.
int runProgram(int argc, char** argv, const std::function<void(CLI::App& program, int& exit_status)>& add_verbs);

}  // namespace fcl_artic::app
