// SPDX-License-Identifier: BSD-3-Clause
#include "plan.h"

#include <gtest/gtest.h>

namespace fcl_artic::planning {

std::ostream& operator<<(std::ostream& out, const PlanCount& count) {
  return out << count.problems << " problems, " << count.solved << " solved, " << count.samples << " samples, "
             << count.colliding << " plans in collision";
}

PlanCount collidingPlans(const std::filesystem::path& data, const std::string& robot_name,
                         const std::string& environment_name, int problems, int seeds) {
  const Robot robot = planning_data::readRobot(data, robot_name);
  const planning_data::Environment environment =
      planning_data::readEnvironment(planning_data::problemsPath(data, robot_name, environment_name), *robot.tree);
  PlanCount count;
  for (const planning_data::Problem& problem : environment.problems) {
    if (problems-- == 0) break;
    const PlanningSetup setup = setUp(robot, environment, problem);
    planning_data::FclStateCheck check(robot, problem.scene);
    for (int seed = 1; seed <= seeds; ++seed) {
      ++count.problems;
      const Plans plans = plan(setup, problem.start, problem.goal, static_cast<unsigned>(seed), 20.0);
      count.solved += plans.solved;
      for (const Way* way : {&plans.raw, &plans.simplified}) {
        const long sample = firstSample(setup, *way, [&](const std::vector<double>& q) {
          ++count.samples;
          return check.collides(environment.configuration(*robot.tree, q));
        });
        if (sample < 0) continue;
        ++count.colliding;
        ADD_FAILURE() << robot_name << ' ' << environment_name << " problem " << problem.index << " seed " << seed
                      << (way == &plans.raw ? ", raw" : ", simplified") << " plan: sample " << sample << " collides";
      }
    }
  }
  EXPECT_GE(count.solved, count.problems * 9 / 10) << "the counts above say little";
  std::cout << robot_name << ' ' << environment_name << ": " << count << '\n';
  return count;
}

}  // namespace fcl_artic::planning
