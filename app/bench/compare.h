// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cli_app.h"

namespace fcl_artic::app {

/// Adds the verb `compare`: random pairs of moving bodies through FCL's ways and through this library.
/// @param[out] exit_status  set when the verb has run: kExitFree when this library was right throughout.
void addCompare(CLI::App& program, int& exit_status);

}  // namespace fcl_artic::app
