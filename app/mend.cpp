// SPDX-License-Identifier: BSD-3-Clause
#include "mend.h"

#include <string>
#include <vector>

#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

#include "plans/variables.h"

namespace fcl_artic::app {

void requireMending() {}

Mended mend(const std::shared_ptr<const ArticulatedCollisionManager>& manager, const plans::PlanMotion& motion,
            plans::Turns turns, const MendOptions& options) {
  ompl::msg::noOutputHandler();
  [[maybe_unused]] static const bool seeded = (ompl::RNG::setSeed(1), true);  // the same detours each time
  std::vector<int> variables;
  for (const std::string& name : motion.joints) {
    variables.push_back(plans::variableOf(manager->tree(), name, "the plan"));
  }
  const auto unwrap = turns == plans::Turns::shortest ? JointTrajectory::Unwrap::yes : JointTrajectory::Unwrap::no;
  Mended out;
  static_cast<planning::Mended&>(out) =
      planning::mend(manager, {motion.times, motion.waypoints, {}, {}}, variables, unwrap, options);
  out.plan.joints = motion.joints;
  if (motion.timed) out.plan.times = out.waypoints.times;
  for (const Eigen::VectorXd& q : out.waypoints.positions) {
    std::vector<double>& row = out.plan.positions.emplace_back();
    for (const int v : variables) row.push_back(q[v]);
  }
  out.plan.state = motion.rest;
  return out;
}

}  // namespace fcl_artic::app
