// SPDX-License-Identifier: BSD-3-Clause
#include "configuration.h"

#include <charconv>
#include <cmath>
#include <map>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>

#include "kinematics/angles.h"
#include "plans/variables.h"
#include "text/counted.h"

namespace fcl_artic::app {
namespace {

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

/// Values by variable, of tokens that all carry a joint's name.
std::map<int, double> namedValues(const KinematicTree& tree, const std::vector<std::string>& tokens,
                                  const std::string& option) {
  std::map<int, double> values;
  for (const std::string& token : tokens) {
    const std::size_t equals = token.find('=');
    if (equals == std::string::npos) {
      throw std::invalid_argument(
          fmt::format("{}: '{}': either all values carry a joint's name or none does", option, token));
    }
    const int variable = plans::variableOf(tree, token.substr(0, equals), option);
    const double value = parseValue(tree, variable, std::string_view(token).substr(equals + 1), option);
    if (!values.emplace(variable, value).second) {
      throw std::invalid_argument(fmt::format("{}: joint '{}' is given twice", option, tree.variableName(variable)));
    }
  }
  return values;
}

}  // namespace

Eigen::VectorXd parseConfiguration(const KinematicTree& tree, const std::vector<std::string>& words,
                                   const std::string& option, const std::map<std::string, double>& state) {
  const std::vector<std::string> tokens = splitTokens(words);
  Eigen::VectorXd q(tree.dof());
  if (!tokens.empty() && tokens.front().find('=') != std::string::npos) {
    const std::map<int, double> named = namedValues(tree, tokens, option);
    std::vector<std::string> unnamed;
    for (int v = 0; v < tree.dof(); ++v) {
      const auto value = named.find(v);
      const auto given = state.find(tree.variableName(v));
      if (value == named.end() && given == state.end()) {
        unnamed.push_back(tree.variableName(v));
        continue;
      }
      q[v] = value != named.end() ? value->second : given->second;
      if (given != state.end()) plans::requireGiven(given->first, given->second, q[v], option);
    }
    if (!unnamed.empty()) plans::refuseUnnamed(unnamed, option);
    return q;
  }
  std::vector<int> variables;  // of the values
  for (int v = 0; v < tree.dof(); ++v) {
    const auto given = state.find(tree.variableName(v));
    const bool all = static_cast<int>(tokens.size()) == tree.dof();
    if (all || given == state.end()) variables.push_back(v);
    if (!all && given != state.end()) q[v] = given->second;
  }
  if (tokens.size() != variables.size()) {
    throw std::invalid_argument(
        fmt::format("{} has {}, robot '{}' has {}: {}", option, text::counted(tokens.size(), "value"), tree.name(),
                    text::counted(static_cast<std::size_t>(tree.dof()), "joint"), plans::variableNames(tree)));
  }
  for (std::size_t i = 0; i < tokens.size(); ++i) {
    const std::string& token = tokens[i];
    const int v = variables[i];
    if (token.find('=') != std::string::npos) {
      throw std::invalid_argument(
          fmt::format("{}: '{}': either all values carry a joint's name or none does", option, token));
    }
    q[v] = parseValue(tree, v, token, option);
    const auto given = state.find(tree.variableName(v));
    if (given != state.end()) plans::requireGiven(given->first, given->second, q[v], option);
  }
  return q;
}

std::map<std::string, double> parseValues(const KinematicTree& tree, const std::vector<std::string>& words,
                                          const std::string& option) {
  std::map<std::string, double> values;
  for (const auto& [variable, value] : namedValues(tree, splitTokens(words), option)) {
    values[tree.variableName(variable)] = value;
  }
  return values;
}

}  // namespace fcl_artic::app
