// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "cli_app.h"
#include "fcl_artic/link_pairs.h"
#include "fcl_artic/urdf/urdf.h"

namespace fcl_artic::app {

/// Adds the verb `srdf`: which pairs of a robot's links need no check, and whether an SRDF's are right.
void addSrdf(CLI::App& program, int& exit_status);

/// All pairs of the robot's links; a bar of progress on a terminal.
LinkPairReport classify(const Robot& robot, LinkPairOptions options);

/// How many pairs are of which kind: one line.
std::string summaryOf(const LinkPairReport& report);

/// Lines about pairs that an SRDF disables: those that do touch, those that are not proven apart. There are none if all
/// is proven.
/// @param margin  by which they were looked at, m.
std::vector<std::string> doubtsOf(const KinematicTree& tree, const LinkPairReport& disabled, double margin);

}  // namespace fcl_artic::app
