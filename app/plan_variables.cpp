// SPDX-License-Identifier: BSD-3-Clause
#include "plan_variables.h"

#include "usage.h"

namespace fcl_artic::app {

void addPlanVariables(CLI::App& verb, PlanVariables& options) {
  verb.add_option("--turns", options.turns,
                  "Joints that turn forever: as the values are given, or the shortest way round; ask: an error where "
                  "that makes a difference")
      ->check(CLI::IsMember({"ask", "given", "shortest"}))
      ->group("Plans")
      ->capture_default_str();
  verb.add_option("--joints", options.joints, "Joints of plans without names (OMPL's, NumPy's), in their order")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->group("Plans")
      ->type_name("NAME,...");
  addState(verb, options.state, "Plans");
  verb.add_flag("--ignore-limits", options.ignore_limits,
                "Waypoints beyond the joints' limits are noted, and certified all the same")
      ->group("Plans");
  verb.add_option(
          "--limit-tolerance", options.limit_tolerance,
          "By so much a waypoint may be beyond a joint's limits, as sensors are, and is noted: rad; for lengths "
          "a tenth of it, in m")
      ->check(requireNotNegative)
      ->group("Plans")
      ->capture_default_str();
}

void addPlanColumns(CLI::App& verb, PlanColumnOptions& options) {
  CLI::Option* columns =
      verb.add_option("--columns", options.columns.columns,
                      "What the columns of CSV files are, in their order: joints, JOINT/velocity, JOINT/acceleration, "
                      "time, - for one that is left out")
          ->delimiter(',')
          ->allow_extra_args(false)
          ->group("Plans")
          ->type_name("NAME,...");
  verb.add_option("--skip", options.columns.skip, "Columns of CSV files that are left out, by their names there")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->excludes(columns)
      ->group("Plans")
      ->type_name("NAME,...");
  verb.add_option("--time", options.columns.time, "The column of times of CSV files, in s, by its name there")
      ->excludes(columns)
      ->group("Plans")
      ->type_name("NAME");
  verb.add_flag("--degrees", options.degrees, "Angles in the plans are in degrees")->group("Plans");
}

void InterpolationOptions::require() const {
  if ((kind() == plans::Interpolation::blends) != (blend > 0)) {
    throw CLI::RequiresError("--interpolation blends", "--blend");
  }
}

void addInterpolation(CLI::App& verb, InterpolationOptions& options, const std::string& group) {
  const auto known = [](const std::string& text) {
    try {
      (void)plans::interpolationNamed(text);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  verb.add_option(
          "--interpolation", options.name,
          "Between waypoints: linear; cubic by their velocities; quintic by their velocities and accelerations; "
          "auto: as much as each plan gives; jtc: the same, as joint_trajectory_controller runs it; "
          "jtc-upsampled: one smooth spline from rest to rest, as it does by positions_upsampling; jtc-none: as "
          "by interpolation_method none; blends: lines joined by parabolas; tangent-half-angle: the tangent of "
          "half of each angle goes straight")
      ->check(CLI::Validator(known, "KIND"))
      ->group(group)
      ->capture_default_str();
  verb.add_option("--blend", options.blend, "Half the duration of a blend, in s")->check(requirePositive)->group(group);
}

void addState(CLI::App& verb, std::vector<std::string>& state, const std::string& group) {
  verb.add_option("--state", state, "Values of joints that nobody else names: NAME=VALUE; may be repeated")
      ->allow_extra_args(false)
      ->group(group)
      ->type_name("NAME=VALUE");
}

std::string verifierInterpolation(plans::Interpolation kind, const std::string& arguments) {
  using plans::Interpolation;
  if (kind == Interpolation::automatic || kind == Interpolation::jtc) return arguments;
  const bool known = kind == Interpolation::linear || kind == Interpolation::cubic || kind == Interpolation::quintic ||
                     kind == Interpolation::jtcUpsampled;
  return known ? arguments + " --interpolation " + plans::toString(kind) : "";
}

plans::Turns turnsOf(const PlanVariables& options) {
  return plans::turnsNamed(options.turns);
}

}  // namespace fcl_artic::app
