// SPDX-License-Identifier: BSD-3-Clause
#include "planning/plans.h"

#include <chrono>
#include <cmath>

#include <ompl/base/ScopedState.h>
#include <ompl/base/StateValidityChecker.h>
#include <ompl/geometric/SimpleSetup.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

#include "planning/fcl_state_check.h"

namespace fcl_artic::planning_data {
namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;
using planning::PlanningSetup;

using Clock = std::chrono::steady_clock;
double since(Clock::time_point begin, double unit) {
  return std::chrono::duration<double>(Clock::now() - begin).count() / unit;
}

Way toWay(const PlanningSetup& setup, const og::PathGeometric& path) {
  Way way;
  for (unsigned i = 0; i < path.getStateCount(); ++i) way.push_back(setup.values(path.getState(i)));
  return way;
}

/// FCL behind OMPL's interface.
class FclValidity : public ob::StateValidityChecker {
 public:
  FclValidity(const ob::SpaceInformationPtr& si, PlanningSetup setup, const Robot& robot,
              const Environment& environment, const Scene& scene)
      : StateValidityChecker(si),
        setup_(std::move(setup)),
        tree_(*robot.tree),
        environment_(environment),
        check_(robot, scene) {}
  bool isValid(const ob::State* state) const override {
    return !check_.collides(environment_.configuration(tree_, setup_.values(state)));
  }

 private:
  PlanningSetup setup_;  ///< for the mapping of states
  const KinematicTree& tree_;
  const Environment& environment_;
  mutable FclStateCheck check_;
};

}  // namespace

Plans plan(const ob::SpaceInformationPtr& si, const PlanningSetup& setup, const std::vector<double>& start,
           const std::vector<double>& goal, unsigned seed, double seconds, double range) {
  ompl::msg::noOutputHandler();
  ompl::RNG::setSeed(seed);  // of all generators that are made from here on
  og::SimpleSetup simple(si);
  ob::ScopedState<> from(si->getStateSpace()), to(si->getStateSpace());
  setup.setState(from.get(), start);
  setup.setState(to.get(), goal);
  simple.setStartAndGoalStates(from, to);
  const auto planner = std::make_shared<og::RRTConnect>(si);
  planner->setRange(range);  // 0: chosen in its setup()
  simple.setPlanner(planner);
  Plans plans;
  auto begin = Clock::now();
  plans.solved = simple.solve(seconds) == ob::PlannerStatus::EXACT_SOLUTION;
  plans.plan_ms = since(begin, 1e-3);
  if (!plans.solved) return plans;
  plans.raw = toWay(setup, simple.getSolutionPath());
  begin = Clock::now();
  simple.simplifySolution(seconds);
  plans.simplify_ms = since(begin, 1e-3);
  plans.simplified = toWay(setup, simple.getSolutionPath());
  return plans;
}

long firstSample(const PlanningSetup& setup, const Way& way,
                 const std::function<bool(const std::vector<double>&)>& collides) {
  const double step = 1e-4 * setup.space->getMaximumExtent();
  ob::ScopedState<> a(setup.space), b(setup.space), between(setup.space);
  long sample = 0;
  for (std::size_t i = 0; i < way.size(); ++i) {
    if (collides(way[i])) return sample;
    if (i + 1 == way.size()) break;
    setup.setState(a.get(), way[i]);
    setup.setState(b.get(), way[i + 1]);
    const int steps = static_cast<int>(std::ceil(setup.space->distance(a.get(), b.get()) / step));
    for (int k = 1; k < steps; ++k, ++sample) {
      setup.space->interpolate(a.get(), b.get(), static_cast<double>(k) / steps, between.get());
      if (collides(setup.values(between.get()))) return sample;
    }
  }
  return -1;
}

PlanningSetup setUp(const Robot& robot, const Environment& environment, const Problem& problem) {
  planning::SetupOptions options;
  options.fixed = environment.locked;
  return planning::setUpPlanning(makeManager(robot, problem.scene), environment.joints, options);
}

ob::SpaceInformationPtr discreteOverFcl(const Robot& robot, const Environment& environment, const Problem& problem,
                                        double resolution) {
  const PlanningSetup setup = setUp(robot, environment, problem);  // a space of its own: the resolution belongs to it
  const auto si = std::make_shared<ob::SpaceInformation>(setup.space);
  si->setStateValidityChecker(std::make_shared<FclValidity>(si, setup, robot, environment, problem.scene));
  si->setStateValidityCheckingResolution(resolution);
  si->setup();
  return si;
}

std::shared_ptr<TimedMotionValidator> TimedMotionValidator::wrap(const ob::SpaceInformationPtr& si) {
  const std::shared_ptr<TimedMotionValidator> timed(new TimedMotionValidator(si));
  si->setMotionValidator(timed);
  return timed;
}

template <class Ask>
bool TimedMotionValidator::timed(const Ask& ask) const {
  const auto begin = Clock::now();
  const bool valid = ask();
  (valid ? valid_us : invalid_us).push_back(since(begin, 1e-6));
  return valid;
}

bool TimedMotionValidator::checkMotion(const ob::State* s1, const ob::State* s2) const {
  return timed([&] { return inner_->checkMotion(s1, s2); });
}

bool TimedMotionValidator::checkMotion(const ob::State* s1, const ob::State* s2,
                                       std::pair<ob::State*, double>& lastValid) const {
  return timed([&] { return inner_->checkMotion(s1, s2, lastValid); });
}

}  // namespace fcl_artic::planning_data
