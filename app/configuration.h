// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "fcl_artic/kinematic_tree.h"

namespace fcl_artic::app {

/// Reads a configuration as it is typed: values of all joint variables in the tree's order ("0, 1.57 -90deg"), or
/// name=value pairs in any order ("elbow=1.57, wrist=-90deg"), joints that are not named at 0 (a quaternion at no
/// rotation). Separators are commas and white space. Values are rad or m; the ending "deg" is for angles.
/// @param words  the words that followed the option.
/// @param option  name of the option, for messages.
/// @throws std::invalid_argument naming option, joint and reason. A wrong number of values lists the joints.
Eigen::VectorXd parseConfiguration(const KinematicTree& tree, const std::vector<std::string>& words,
                                   const std::string& option);

/// Reads name=value pairs, as parseConfiguration() does, and no others.
std::map<std::string, double> parseValues(const KinematicTree& tree, const std::vector<std::string>& words,
                                          const std::string& option);

}  // namespace fcl_artic::app
