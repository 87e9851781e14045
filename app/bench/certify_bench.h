// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace fcl_artic::app {

struct CertifyBenchOptions {
  std::string data;  ///< folder with robots/ and problems/
  std::string robot = "panda";
  std::vector<std::string> environments;  ///< none: all that the robot has
  int problems = 10;                      ///< of each environment, at most
  int seeds = 1;
  double range = 0;  ///< longest motion that the planner tries, in the space's distance; 0: OMPL's default
  double seconds = 20, mend_seconds = 5;  ///< for a plan and for its simplification; for mending one
  std::string plans;  ///< file or folder of another planner's plans, each named ENVIRONMENT/PROBLEM; empty: plan here
  std::string csv;    ///< file of a row for each plan; empty: none
};

/// Plans problems with OMPL's RRTConnect and its discrete validator over FCL at OMPL's default resolution, and
/// simplifies the plans, or takes those of `plans`; certifies them, looks at them with FCL in steps 100 times finer,
/// mends those that touch, and prints the table.
/// @return exit status: 1 when a plan certified free, mended or not, is seen to collide.
/// @throws std::runtime_error naming a file that is missing or can't be written; a plan that is wrong or names no
/// problem; that this program was built without OMPL.
int benchCertify(CertifyBenchOptions& options);

}  // namespace fcl_artic::app
