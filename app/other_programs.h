// SPDX-License-Identifier: BSD-3-Clause
//
// Verbs that stand in programs of their own, so that fcl_artic stays small: fcl_artic runs them as git runs its verbs.
#pragma once

#include <optional>

#include "cli_app.h"

namespace fcl_artic::app {

/// Runs the program that has the verb of this command line, in place of this one. The program lies beside this one.
/// @return nothing when the verb is this program's own; kExitError, after a message, when the other can't be run. Else
///   it doesn't return.
std::optional<int> runOtherProgram(int argc, char** argv);

/// Adds these verbs, so that --help and messages on unknown verbs name them.
void describeOtherPrograms(CLI::App& program);

}  // namespace fcl_artic::app
