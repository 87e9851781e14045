// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "cli_app.h"

#include "bench/motion_timing.h"

namespace fcl_artic::app {

/// Adds `bench robot`: what queries cost on a user's own robot and scene.
void addRobotBench(CLI::App& bench, int& exit_status);

/// Names answers that contradict each other on standard error, the first ten.
/// @param commandOf  the command that asks about a motion.
/// @return exit status of `bench robot`: 0 if there are none, else 1.
int tellContradictions(const std::vector<Contradiction>& contradictions,
                       const std::function<std::string(const MotionEnds&)>& commandOf);

}  // namespace fcl_artic::app
