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
  verb.add_option("--state", options.state, "Values of joints that plans do not name: NAME=VALUE; may be repeated")
      ->allow_extra_args(false)
      ->group("Plans")
      ->type_name("NAME=VALUE");
  verb.add_flag("--ignore-limits", options.ignore_limits,
                "Waypoints beyond the joints' limits are noted, and certified all the same")
      ->group("Plans");
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
  verb.add_option(
          "--limit-tolerance", options.limit_tolerance,
          "By so much a waypoint may be beyond a joint's limits, as sensors are, and is noted: rad; for lengths "
          "a tenth of it, in m")
      ->check(requireNotNegative)
      ->group("Plans")
      ->capture_default_str();
}

plans::Turns turnsOf(const PlanVariables& options) {
  if (options.turns == "given") return plans::Turns::given;
  return options.turns == "shortest" ? plans::Turns::shortest : plans::Turns::ask;
}

}  // namespace fcl_artic::app
