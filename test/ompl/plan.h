// SPDX-License-Identifier: BSD-3-Clause
//
// Plans by RRTConnect with our validator, and a close look at them.
#pragma once

#include <ostream>
#include <vector>

#include <ompl/base/DiscreteMotionValidator.h>

#include "fcl_artic/ompl/planning_setup.h"
#include "planning/fcl_state_check.h"
#include "planning/plans.h"
#include "slide.h"

namespace fcl_artic::planning {

using planning_data::firstSample;
using planning_data::Plans;
using planning_data::setUp;
using planning_data::Way;

/// RRTConnect with our validator.
inline Plans plan(const PlanningSetup& setup, const std::vector<double>& start, const std::vector<double>& goal,
                  unsigned seed, double seconds) {
  return planning_data::plan(setup.si, setup, start, goal, seed, seconds);
}

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
