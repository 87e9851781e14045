// SPDX-License-Identifier: BSD-3-Clause
#include "plan.h"

#include <cmath>

#include <gtest/gtest.h>
#include <ompl/geometric/SimpleSetup.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/RandomNumbers.h>

namespace fcl_artic::planning {
namespace {

namespace ob = ::ompl::base;
namespace og = ::ompl::geometric;

Way toWay(const PlanningSetup& setup, const og::PathGeometric& path) {
  Way way;
  for (std::size_t i = 0; i < path.getStateCount(); ++i) way.push_back(setup.values(path.getState(static_cast<unsigned>(i))));
  return way;
}

}  // namespace

Plans plan(const PlanningSetup& setup, const std::vector<double>& start, const std::vector<double>& goal, unsigned seed,
           double seconds) {
  ::ompl::msg::noOutputHandler();
  ::ompl::RNG::setSeed(seed);  // of all generators that are made from here on
  og::SimpleSetup simple(setup.si);
  ob::ScopedState<> from(setup.space), to(setup.space);
  setup.setState(from.get(), start);
  setup.setState(to.get(), goal);
  simple.setStartAndGoalStates(from, to);
  simple.setPlanner(std::make_shared<og::RRTConnect>(setup.si));
  Plans plans;
  plans.solved = simple.solve(seconds) == ob::PlannerStatus::EXACT_SOLUTION;
  if (!plans.solved) return plans;
  plans.raw = toWay(setup, simple.getSolutionPath());
  simple.simplifySolution(seconds);
  plans.simplified = toWay(setup, simple.getSolutionPath());
  return plans;
}

long firstSample(const PlanningSetup& setup, const Way& way, const std::function<bool(const std::vector<double>&)>& collides) {
  const double step = 1e-4 * setup.space->getMaximumExtent();
  long sample = 0;
  for (std::size_t i = 0; i < way.size(); ++i) {
    if (collides(way[i])) return sample;
    if (i + 1 == way.size()) break;
    const TestState a(setup.space, way[i]), b(setup.space, way[i + 1]), between(setup.space, way[i]);
    const int steps = static_cast<int>(std::ceil(setup.space->distance(a, b) / step));
    for (int k = 1; k < steps; ++k, ++sample) {
      setup.space->interpolate(a, b, static_cast<double>(k) / steps, between);
      if (collides(setup.values(between))) return sample;
    }
  }
  return -1;
}

PlanningSetup setUp(const Robot& robot, const planning_data::Environment& environment,
                    const planning_data::Problem& problem) {
  SetupOptions options;
  options.fixed = environment.locked;
  return setUpPlanning(planning_data::makeManager(robot, problem.scene), environment.joints, options);
}

std::ostream& operator<<(std::ostream& out, const PlanCount& count) {
  return out << count.problems << " problems, " << count.solved << " solved, " << count.samples << " samples, "
             << count.colliding << " plans in collision";
}

PlanCount collidingPlans(const std::filesystem::path& data, const std::string& robot_name,
                         const std::string& environment_name, int problems, int seeds) {
  const Robot robot = planning_data::readRobot(data, robot_name);
  const std::string folder = robot_name == "ur5_coarse" ? "ur5" : robot_name;
  const planning_data::Environment environment =
      planning_data::readEnvironment(data / "problems" / folder / (environment_name + ".json"), *robot.tree);
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
