// SPDX-License-Identifier: BSD-3-Clause
#include "configuration.h"

#include <charconv>
#include <cmath>
#include <set>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>

#include "text/nearest_name.h"

namespace fcl_artic::app {
namespace {

constexpr double kRadiansPerDegree = 3.14159265358979323846 / 180;

std::vector<std::string> splitTokens(const std::vector<std::string>& words) {
  std::vector<std::string> tokens;
  for (const std::string& word : words) {
    std::size_t at = 0;
    while ((at = word.find_first_not_of(", \t\r\n", at)) != std::string::npos) {
      const std::size_t end = word.find_first_of(", \t\r\n", at);
      tokens.push_back(word.substr(at, end - at));
      if (end == std::string::npos) break;
      at = end;
    }
  }
  return tokens;
}

std::string variableNames(const KinematicTree& tree) {
  std::string names;
  for (int v = 0; v < tree.dof(); ++v) names += (v ? ", " : "") + tree.variableName(v);
  return names;
}

double parseValue(const KinematicTree& tree, int variable, std::string_view text, const std::string& option) {
  const std::string& name = tree.variableName(variable);
  const std::string whole(text);
  const bool degrees = text.size() > 3 && text.substr(text.size() - 3) == "deg";
  if (degrees) text.remove_suffix(3);
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);  // from_chars takes no plus
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
    throw std::invalid_argument(fmt::format(
        "{}: '{}' for joint '{}' is not a finite number (rad or m, or an angle as 90deg)", option, whole, name));
  }
  if (degrees && !tree.isAngle(variable)) {
    const bool prismatic = tree.joint(tree.variableJoint(variable)).type == JointType::prismatic;
    throw std::invalid_argument(
        prismatic
            ? fmt::format("{}: '{}' for joint '{}': the joint is prismatic, its value is in m", option, whole, name)
            : fmt::format("{}: '{}' for '{}', which is no angle", option, whole, name));
  }
  return degrees ? value * kRadiansPerDegree : value;
}

}  // namespace

int variableOf(const KinematicTree& tree, const std::string& name, const std::string& option) {
  for (int v = 0; v < tree.dof(); ++v) {
    if (tree.variableName(v) == name) return v;
  }
  for (JointId j = 0; j < tree.numJoints(); ++j) {
    const Joint& joint = tree.joint(j);
    if (joint.name != name) continue;
    if (tree.numVariables(j) > 1) {
      throw std::invalid_argument(fmt::format("{}: joint '{}' has {} values, from '{}' on", option, name,
                                              tree.numVariables(j), tree.variableName(tree.jointVariable(j))));
    }
    throw std::invalid_argument(joint.mimics ? fmt::format("{}: joint '{}' follows joint '{}' and takes no value",
                                                           option, name, joint.mimic.master)
                                             : fmt::format("{}: joint '{}' is fixed and takes no value", option, name));
  }
  std::vector<std::string> names;
  for (int v = 0; v < tree.dof(); ++v) names.push_back(tree.variableName(v));
  throw std::invalid_argument(fmt::format("{}: robot '{}' has no joint '{}'; its joints are: {}{}", option, tree.name(),
                                          name, variableNames(tree), text::didYouMean(name, names)));
}

Eigen::VectorXd parseConfiguration(const KinematicTree& tree, const std::vector<std::string>& words,
                                   const std::string& option) {
  const std::vector<std::string> tokens = splitTokens(words);
  const bool named = !tokens.empty() && tokens.front().find('=') != std::string::npos;
  if (!named && static_cast<int>(tokens.size()) != tree.dof()) {
    throw std::invalid_argument(fmt::format("{} has {} value{}, robot '{}' has {} joint{}: {}", option, tokens.size(),
                                            tokens.size() == 1 ? "" : "s", tree.name(), tree.dof(),
                                            tree.dof() == 1 ? "" : "s", variableNames(tree)));
  }
  Eigen::VectorXd q = tree.neutralConfiguration();
  std::set<int> seen;
  for (std::size_t i = 0; i < tokens.size(); ++i) {
    const std::string& token = tokens[i];
    const std::size_t equals = token.find('=');
    if ((equals != std::string::npos) != named) {
      throw std::invalid_argument(
          fmt::format("{}: '{}': either all values carry a joint's name or none does", option, token));
    }
    const int variable = named ? variableOf(tree, token.substr(0, equals), option) : static_cast<int>(i);
    if (!seen.insert(variable).second) {
      throw std::invalid_argument(fmt::format("{}: joint '{}' is given twice", option, tree.variableName(variable)));
    }
    q[variable] = parseValue(tree, variable, std::string_view(token).substr(named ? equals + 1 : 0), option);
  }
  return q;
}

}  // namespace fcl_artic::app
