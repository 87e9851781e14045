// SPDX-License-Identifier: BSD-3-Clause
//
// Plans by RRTConnect with our validator, and a close look at them.
#pragma once

#include <functional>
#include <ostream>
#include <vector>

#include <ompl/base/DiscreteMotionValidator.h>

#include "fcl_artic/ompl/planning_setup.h"
#include "planning/fcl_state_check.h"
#include "planning/problems.h"
#include "slide.h"

namespace fcl_artic::planning {

/// A path as joint values, in the order of PlanningSetup::joints.
using Way = std::vector<std::vector<double>>;

struct Plans {
  bool solved = false;
  Way raw, simplified;
};

/// RRTConnect, then simplification. @param seconds  at most.
Plans plan(const PlanningSetup& setup, const std::vector<double>& start, const std::vector<double>& goal, unsigned seed,
           double seconds);

/// Steps of 1/100 of OMPL's default resolution (1 % of the space's extent) along a way.
/// @return number of the first sample that collides, -1 for none.
long firstSample(const PlanningSetup& setup, const Way& way, const std::function<bool(const std::vector<double>&)>& collides);

PlanningSetup setUp(const Robot& robot, const planning_data::Environment& environment,
                    const planning_data::Problem& problem);

struct PlanCount {
  int problems = 0, solved = 0, colliding = 0;  ///< of the last, raw and simplified plans each count
  long samples = 0;
};
std::ostream& operator<<(std::ostream& out, const PlanCount& count);

/// Plans problems of an environment and re-samples the plans with FCL's own state check.
/// @param problems  at most so many. @param seeds  1, 2, ... seeds.
PlanCount collidingPlans(const std::filesystem::path& data, const std::string& robot, const std::string& environment,
                         int problems, int seeds);

}  // namespace fcl_artic::planning
