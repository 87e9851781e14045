// SPDX-License-Identifier: BSD-3-Clause
#include "plans/variables.h"

#include <cmath>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "text/nearest_name.h"

namespace fcl_artic::plans {

std::string variableNames(const KinematicTree& tree) {
  std::string names;
  for (int v = 0; v < tree.dof(); ++v) names += (v ? ", " : "") + tree.variableName(v);
  return names;
}

bool isVariable(const KinematicTree& tree, const std::string& name) {
  return tree.findVariable(name) >= 0;
}

int variableOf(const KinematicTree& tree, const std::string& name, const std::string& what) {
  if (const int v = tree.findVariable(name); v >= 0) return v;
  if (const JointId j = tree.findJoint(name); j >= 0) {
    const Joint& joint = tree.joint(j);
    if (tree.numVariables(j) > 1) {
      throw std::invalid_argument(fmt::format("{}: joint '{}' has {} values, from '{}' on", what, name,
                                              tree.numVariables(j), tree.variableName(tree.jointVariable(j))));
    }
    throw std::invalid_argument(joint.mimics ? fmt::format("{}: joint '{}' follows joint '{}' and takes no value", what,
                                                           name, joint.mimic.master)
                                             : fmt::format("{}: joint '{}' is fixed and takes no value", what, name));
  }
  std::vector<std::string> names;
  for (int v = 0; v < tree.dof(); ++v) names.push_back(tree.variableName(v));
  throw std::invalid_argument(fmt::format("{}: robot '{}' has no joint '{}'; its joints are: {}{}", what, tree.name(),
                                          name, variableNames(tree), text::didYouMean(name, names)));
}

void refuseUnnamed(const std::vector<std::string>& joints, const std::string& what) {
  throw std::invalid_argument(
      fmt::format("{} has no joint '{}': --state {}=VALUE gives its value (Python: state={{...}})", what,
                  fmt::join(joints, "', '"), fmt::join(joints, "=VALUE,")));
}

void requireGiven(const std::string& joint, double given, double value, const std::string& where) {
  if (std::abs(given - value) <= kSameValue) return;
  throw std::invalid_argument(
      fmt::format("--state (Python: state) has joint '{}' at {:g}, and {} has it at {:g}: "
                  "leave it out of the one or the other",
                  joint, given, where, value));
}

}  // namespace fcl_artic::plans
