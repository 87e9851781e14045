// SPDX-License-Identifier: BSD-3-Clause
#include "bench/bench.h"

#include <memory>

#include <CLI/CLI.hpp>

#include "bench/certify_bench.h"
#include "bench/planning_bench.h"
#include "bench/rigid_bench.h"
#include "bench/robot_bench.h"
#include "bench/table1.h"

namespace fcl_artic::app {

void addBench(CLI::App& program, int& exit_status) {
  CLI::App* bench = program.add_subcommand("bench", "Benchmarks on one's own machine");
  bench->require_subcommand(1);
  addRobotBench(*bench, exit_status);
  addTable1(*bench, exit_status);
  addIdeas(*bench, exit_status);
  addDepth(*bench, exit_status);
  auto options = std::make_shared<PlanningBenchOptions>();
  PlanningBenchOptions& o = *options;
  CLI::App* planning = bench->add_subcommand(
      "planning",
      "RRTConnect with OMPL's discrete validator over FCL, at its default and ten times finer, and with ours");
  planning->footer(
      "The data is a folder with robots/ROBOT/ROBOT.urdf and .srdf and problems/ROBOT/ENVIRONMENT.json "
      "(MotionBenchMaker's\n"
      "problems in the format planning-problems/1); scripts/planning_data makes it of public repositories. Every plan "
      "is looked at by FCL in steps 100 times finer than "
      "OMPL's\n"
      "default, and its motions are checked with proof.\n"
      "Exit status: 0 no plan made with fcl_artic collides, 1 one does, 2 error.");
  planning->add_option("--data", o.data, "Folder with robots/ and problems/")
      ->envname("FCL_ARTIC_DATA")
      ->required()
      ->type_name("FOLDER");
  planning->add_option("--robot", o.robot, "panda, ur5, ur5_coarse or baxter (both arms)")
      ->capture_default_str()
      ->type_name("NAME");
  planning->add_option("--environment", o.environments, "Only these; may be repeated")->type_name("NAME...");
  planning->add_option("--problems", o.problems, "Problems of each environment, at most")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  planning->add_option("--seeds", o.seeds, "Seeds for each problem")->check(CLI::PositiveNumber)->capture_default_str();
  planning
      ->add_option("--range", o.range,
                   "Longest motion that the planner tries: root of the sum of squares over the joints, rad or m; 0:\n"
                   "OMPL's default, a fifth of the space's extent")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  planning->add_option("--time-limit", o.seconds, "Seconds for a plan, and for its simplification")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  planning
      ->add_option("--out", o.out,
                   "Folder to write planning.txt, .csv and .svg to, and planning.png: a plan that sampling\n"
                   "accepted, at the moment of contact")
      ->type_name("FOLDER");
  planning->callback([options, &exit_status] { exit_status = benchPlanning(*options); });

  auto certify_options = std::make_shared<CertifyBenchOptions>();
  CertifyBenchOptions& c = *certify_options;
  CLI::App* certify = bench->add_subcommand(
      "certify",
      "Plans of RRTConnect at OMPL's default resolution, or another planner's: how many collide, what certify\n"
      "finds and mends");
  certify->footer(
      "The data is that of bench planning. Every plan is certified, looked at by FCL in steps 100 times finer than\n"
      "OMPL's default, and mended where it touches. --plans takes plans that any planner made for these problems: "
      "each\n"
      "has the name ENVIRONMENT/PROBLEM, with the problem's index as its file has it, as in the JSON line\n"
      "{\"name\": \"box/1\", \"waypoints\": [[...], [...]]}\n"
      "Exit status: 0, 1 a plan certified free is seen to collide, 2 error.");
  certify->add_option("--data", c.data, "Folder with robots/ and problems/")
      ->envname("FCL_ARTIC_DATA")
      ->required()
      ->type_name("FOLDER");
  certify->add_option("--robot", c.robot, "panda, ur5, ur5_coarse or baxter (both arms; --range 1.5)")
      ->capture_default_str()
      ->type_name("NAME");
  certify->add_option("--environment", c.environments, "Only these; may be repeated")->type_name("NAME...");
  certify->add_option("--problems", c.problems, "Problems of each environment, at most")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  certify->add_option("--seeds", c.seeds, "Seeds for each problem")->check(CLI::PositiveNumber)->capture_default_str();
  certify->add_option("--range", c.range, "As of bench planning")->check(CLI::NonNegativeNumber)->capture_default_str();
  certify
      ->add_option("--plans", c.plans,
                   "Plans of another planner in place of RRTConnect's: a file or folder in a format that certify\n"
                   "reads; straight between waypoints")
      ->check(CLI::ExistingPath)
      ->excludes("--problems")
      ->excludes("--seeds")
      ->type_name("FILE");
  certify->add_option("--time-limit", c.seconds, "Seconds for a plan, and for its simplification")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  certify->add_option("--mend-time", c.mend_seconds, "Seconds to mend a plan")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  certify->add_option("--csv", c.csv, "Write a row for each plan")->type_name("FILE");
  certify->callback([certify_options, &exit_status] { exit_status = benchCertify(*certify_options); });

  auto rigid_options = std::make_shared<RigidBenchOptions>();
  RigidBenchOptions& r = *rigid_options;
  CLI::App* rigid = bench->add_subcommand(
      "rigid", "A mesh among meshes, planned with OMPL's discrete validator over FCL, FCL's continuous one, and ours");
  rigid->footer(
      "PROBLEM is a file of OMPL.app (resources/3D of its sources): names of two meshes beside it, start, goal and "
      "the\n"
      "bounds of the position. Every plan is looked at by FCL in steps 100 times finer than OMPL's default.\n"
      "Exit status: 0 no plan made with fcl_artic collides, 1 one does, 2 error.");
  rigid->add_option("problems", r.problems, "Files of OMPL.app")
      ->required()
      ->check(CLI::ExistingFile)
      ->type_name("PROBLEM.cfg...");
  rigid->add_option("--seeds", r.seeds, "Seeds for each problem")->check(CLI::PositiveNumber)->capture_default_str();
  rigid->add_option("--time-limit", r.seconds, "Seconds for a plan, and for its simplification")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  rigid->add_option("--csv", r.csv, "Write a row for each plan")->type_name("FILE");
  rigid->callback([rigid_options, &exit_status] { exit_status = benchRigid(*rigid_options); });
}

}  // namespace fcl_artic::app
