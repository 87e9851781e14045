// SPDX-License-Identifier: BSD-3-Clause
//
// What planners are asked: problems of a robot, by MotionBenchMaker.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace fcl_artic::app {

struct PlanOptions {
  std::string data;  ///< folder with robots/ and problems/
  std::string robot = "panda";
  std::vector<std::string> environments;  ///< none: all that the robot has
  int problems = 10;                      ///< of each environment, at most
  int seeds = 1;
  double range = 0;     ///< longest motion that the planner tries, in the space's distance; 0: OMPL's default
  double seconds = 20;  ///< for a plan, and for its simplification
  std::string csv;      ///< file of a row for each plan; empty: none
};

/// Adds --seeds, --time-limit and --csv.
template <class Options>
void addRunOptions(CLI::App& verb, Options& o) {
  verb.add_option("--seeds", o.seeds, "Seeds for each problem")->check(CLI::PositiveNumber)->capture_default_str();
  verb.add_option("--time-limit", o.seconds, "Seconds for a plan, and for its simplification")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  verb.add_option("--csv", o.csv, "Write a row for each plan")->type_name("FILE");
}

/// Adds these, --data, --robot, --environment, --problems and --range.
inline void addPlanOptions(CLI::App& verb, PlanOptions& o) {
  verb.add_option("--data", o.data,
                  "Folder with robots/ROBOT/ROBOT.urdf and .srdf and problems/ROBOT/ENVIRONMENT.json, as "
                  "scripts/planning_data makes it")
      ->envname("FCL_ARTIC_DATA")
      ->required()
      ->type_name("FOLDER");
  verb.add_option("--robot", o.robot, "panda, ur5, ur5_coarse or baxter (both arms; --range 1.5)")
      ->capture_default_str()
      ->type_name("NAME");
  verb.add_option("--environment", o.environments, "Only these; may be repeated")->type_name("NAME...");
  verb.add_option("--problems", o.problems, "Problems of each environment, at most")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  verb.add_option("--range", o.range,
                  "Longest motion that the planner tries: root of the sum of squares over the joints, rad or m; 0:\n"
                  "OMPL's default, a fifth of the space's extent")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  addRunOptions(verb, o);
}

}  // namespace fcl_artic::app
