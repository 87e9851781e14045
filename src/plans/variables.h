// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "fcl_artic/kinematic_tree.h"

namespace fcl_artic::plans {

/// Rad or m. Values of a joint that differ by no more say the same: they have been printed and read in between.
constexpr double kSameValue = 1e-6;

/// Names of all variables, separated by commas.
std::string variableNames(const KinematicTree& tree);

bool isVariable(const KinematicTree& tree, const std::string& name);

/// Variable of that name.
/// @param what  begins the message.
/// @throws std::invalid_argument: no such joint, or one that takes no value.
int variableOf(const KinematicTree& tree, const std::string& name, const std::string& what);

/// The rule of all verbs for joints that a motion does not name: their values are given, or it is an error.
/// @param what  begins the message: what names no such joint.
/// @throws std::invalid_argument always.
[[noreturn]] void refuseUnnamed(const std::vector<std::string>& joints, const std::string& what);

/// If the motion names a joint too, the value given of it has to be the same.
/// @param where  that has the value, as "waypoint 1".
/// @throws std::invalid_argument naming the joint and both values.
void requireGiven(const std::string& joint, double given, double value, const std::string& where);

}  // namespace fcl_artic::plans
