// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "plans/plan.h"

namespace fcl_artic::plans {

/// The plans as a file's content, with all digits: CSV (one plan), JSON, JSON lines, YAML (the same JSON, which YAML
/// is), OMPL's matrix (one plan). JSON has moveit_msgs/RobotTrajectory for plans with times, and {"joints",
/// "waypoints"} for others, in a list if there are several. The values that other joints keep (Plan::state) are a
/// `state` there and columns of CSV; OMPL's matrix has no place for them. parsePlans() reads the same numbers back,
/// but for times in JSON, which are rounded to nanoseconds as messages have them.
/// @throws std::invalid_argument for a format that is not written, or that holds one plan only, and plans without names
///   of joints.
std::string writePlans(const std::vector<Plan>& plans, Format format);

}  // namespace fcl_artic::plans
