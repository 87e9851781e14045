// SPDX-License-Identifier: BSD-3-Clause
//
// Options about the joints of plans and edges, in the group "Plans".
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "plans/motion.h"

namespace fcl_artic::app {

struct PlanVariables {
  std::vector<std::string> joints;  ///< of plans without names, in their order
  std::vector<std::string> state;   ///< NAME=VALUE, of joints that plans do not name
  std::string turns = "ask";
  bool ignore_limits = false;
  double limit_tolerance = plans::kLimitTolerance;  ///< rad
};

/// Options about columns and units of files of plans.
struct PlanColumnOptions {
  plans::ColumnOptions columns;
  bool degrees = false;
};

/// Adds --columns, --skip, --time and --degrees.
void addPlanColumns(CLI::App& verb, PlanColumnOptions& options);

/// Adds --turns, --joints, --state, --ignore-limits and --limit-tolerance.
void addPlanVariables(CLI::App& verb, PlanVariables& options);

/// The curve between waypoints.
struct InterpolationOptions {
  std::string name = "auto";
  double blend = 0;  ///< s

  plans::Interpolation kind() const { return plans::interpolationNamed(name); }
  /// @throws CLI::RequiresError: blends without a duration, or a duration without blends.
  void require() const;
};

/// Adds --interpolation and --blend.
void addInterpolation(CLI::App& verb, InterpolationOptions& options, const std::string& group);

/// Adds --state.
void addState(CLI::App& verb, std::vector<std::string>& state, const std::string& group);

/// Arguments of fcl_artic_verify about plans, with what says how their waypoints are joined; empty where it knows no
/// such curve.
std::string verifierInterpolation(plans::Interpolation kind, const std::string& arguments);

plans::Turns turnsOf(const PlanVariables& options);

}  // namespace fcl_artic::app
