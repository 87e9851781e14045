// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "fcl_artic/kinematic_tree.h"

namespace fcl_artic::app {

/// Reads a configuration as it is typed: values of all joint variables in the tree's order ("0, 1.57 -90deg"), or
/// name=value pairs in any order ("elbow=1.57, wrist=-90deg"). Separators are commas and white space. Values are rad or
/// m; the ending "deg" is for angles.
/// @param words  the words that followed the option.
/// @param option  name of the option, for messages.
/// @param state  values of joints that pairs do not name; a list may be of all others.
/// @throws std::invalid_argument naming option, joint and reason: also a joint without a value, and one whose value is
///   another in `state`. A wrong number of values lists the joints.
Eigen::VectorXd parseConfiguration(const KinematicTree& tree, const std::vector<std::string>& words,
                                   const std::string& option, const std::map<std::string, double>& state = {});

/// Reads name=value pairs, as parseConfiguration() does, and no others.
std::map<std::string, double> parseValues(const KinematicTree& tree, const std::vector<std::string>& words,
                                          const std::string& option);

}  // namespace fcl_artic::app
