// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "fcl_artic/kinematic_tree.h"

namespace fcl_artic::plans {

constexpr double kRadiansPerDegree = 3.14159265358979323846 / 180;

/// Names of all variables, separated by commas.
std::string variableNames(const KinematicTree& tree);

bool isVariable(const KinematicTree& tree, const std::string& name);

/// Variable of that name.
/// @param what  begins the message.
/// @throws std::invalid_argument: no such joint, or one that takes no value.
int variableOf(const KinematicTree& tree, const std::string& name, const std::string& what);

}  // namespace fcl_artic::plans
