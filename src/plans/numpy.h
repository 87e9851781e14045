// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>
#include <vector>

#include "plans/plan.h"

namespace fcl_artic::plans {

/// Plans of one array (.npy): waypoints by joints, or plans by waypoints by joints.
/// @throws std::invalid_argument for what is no such array of real numbers.
std::vector<Plan> parseArray(std::string_view content);

/// Plans of an archive (.npz), either
/// - `positions` (or `waypoints`, `q`), waypoints by joints or plans by waypoints by joints. Where they are given,
///   also `times` (`time`, `t`; of all plans or of each), `velocities` (`velocity`, `qd`), `accelerations`
///   (`acceleration`, `qdd`), and `joint_names` (`joints`). `lengths`, where it is given, says how many of its
///   waypoints each plan has; or
/// - a plan for each array, named by it, and `joint_names`.
/// @throws std::invalid_argument naming the array.
std::vector<Plan> parseArchive(std::string_view content);

}  // namespace fcl_artic::plans
