// SPDX-License-Identifier: BSD-3-Clause
//
// Stage 2, culling by visibility, as options of the program.
#pragma once

#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "fcl_artic/manager.h"
#include "report/stage2.h"

namespace fcl_artic::app {

struct VisibilityChoice {
  VisibilityMode mode = VisibilityMode::off;
  std::string executor = "cpu";
};

/// Adds --visibility and --executor.
void addVisibilityOptions(CLI::App& verb, VisibilityChoice& options);

/// Executors that this program was built with.
const std::vector<std::string>& executorNames();
/// A culler by an executor. Its driver is opened when a query first needs it.
/// @throws std::invalid_argument for one that this program was built without.
std::shared_ptr<const VisibilityCuller> makeCuller(const std::string& executor);
/// Gives the manager the culler that is asked for, and makes its executor, so that no query waits for a driver.
/// @throws std::invalid_argument as makeCuller().
void useVisibility(const VisibilityChoice& options, ArticulatedCollisionManager& manager);

}  // namespace fcl_artic::app
