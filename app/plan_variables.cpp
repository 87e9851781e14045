// SPDX-License-Identifier: BSD-3-Clause
#include "plan_variables.h"

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

plans::Turns turnsOf(const PlanVariables& options) {
  if (options.turns == "given") return plans::Turns::given;
  return options.turns == "shortest" ? plans::Turns::shortest : plans::Turns::ask;
}

}  // namespace fcl_artic::app
