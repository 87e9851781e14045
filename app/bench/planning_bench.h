// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace fcl_artic::app {

struct PlanningBenchOptions {
  std::string data;  ///< folder with robots/ and problems/
  std::string robot = "panda";
  std::vector<std::string> environments;  ///< none: all that the robot has
  int problems = 10;                      ///< of each environment, at most
  int seeds = 1;
  double seconds = 20;  ///< for a plan, and for its simplification
  double range = 0;     ///< longest motion that the planner tries, in the space's distance; 0: OMPL's default
  std::string out;      ///< folder for table, CSV, plot and picture; empty: the table only
};

/// Plans all problems with each validator in turn, and prints the table.
/// @return exit status: 1 when a plan made with our validator collides.
/// @throws std::runtime_error naming a file that is missing or can't be written; that this program was built without
/// OMPL.
int benchPlanning(PlanningBenchOptions& options);

}  // namespace fcl_artic::app
