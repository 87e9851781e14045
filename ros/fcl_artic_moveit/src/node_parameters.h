// SPDX-License-Identifier: BSD-3-Clause
//
// Parameters of a node below a prefix: those of adapter and guard alike.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include <rclcpp/rclcpp.hpp>

#include "fcl_artic_moveit/certifier.h"

namespace fcl_artic_moveit {

class NodeParameters {
 public:
  NodeParameters(rclcpp::Node& node, std::string prefix);

  /// Declares one, with the value of the node's YAML files.
  /// @param least  of a number; below 0: of a text.
  void declare(const std::string& name, rclcpp::ParameterValue value, const std::string& description, double least = -1,
               bool read_only = false);
  /// Declares those that certifier() reads.
  /// @param budget  0: no limit.
  void declareCertifier(std::int64_t budget);

  // @param changed  values that count before the node's.
  // @throws std::invalid_argument naming parameter and value.
  /// All but the time limit.
  CertifierOptions certifier(const std::vector<rclcpp::Parameter>& changed = {}) const;
  rclcpp::Parameter parameter(const std::string& name, const std::vector<rclcpp::Parameter>& changed = {}) const;
  std::string text(const std::string& name, const std::vector<rclcpp::Parameter>& changed = {}) const;
  double number(const std::string& name, const std::vector<rclcpp::Parameter>& changed = {}) const;
  /// A list of NAME=NUMBER.
  std::map<std::string, double> numbers(const std::string& name,
                                        const std::vector<rclcpp::Parameter>& changed = {}) const;

  /// Has `check` refuse changes of parameters below the prefix, by what it throws.
  /// @param fixed  names of those that count when they are declared, and not after.
  rclcpp::node_interfaces::OnSetParametersCallbackHandle::SharedPtr onChange(
      std::vector<std::string> fixed, std::function<void(const std::vector<rclcpp::Parameter>&)> check);
  const std::string& prefix() const { return prefix_; }

 private:
  rclcpp::Node& node_;
  const std::string prefix_;
};

}  // namespace fcl_artic_moveit
