// SPDX-License-Identifier: BSD-3-Clause
//
// Documents of names, lists and values, in JSON or YAML, and the plans in them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "plans/plan.h"
#include "text/document.h"

namespace fcl_artic::plans {

using Json = text::Json;

/// A JSON document. NaN, Infinity and -Infinity, which JSON lacks and programs write, become texts of that name.
/// @throws std::invalid_argument for what is no JSON, and for a key that an object has twice.
Json parseJson(std::string_view content);

/// The documents of a YAML stream (between ---). Plain scalars that are numbers become numbers.
/// @throws std::invalid_argument naming line and column for what is no YAML, a key that a mapping has twice, or an
///   alias, which no message has; that this build has no YAML.
std::vector<Json> parseYaml(std::string_view content);

/// The plans of a document, which may be
/// - trajectory_msgs/JointTrajectory, MultiDOFJointTrajectory, moveit_msgs/RobotTrajectory, DisplayTrajectory, and
///   messages that hold one of these as `trajectory`, `planned_trajectory`, `goal` or `msg`, with `trajectory_start`,
///   or `multi_dof_trajectory` beside `trajectory`;
/// - a plan: {"name", "joints": [..], "times": [..], "waypoints": [[..], ..], "velocities", "accelerations"}, or with
///   "from" and "to"; a waypoint may be an object from names to values;
/// - {"plans": [..]}, or a list of any of these.
/// Keys that are neither read nor on a list of what is no place and no motion make the plan one with an error.
/// @param label  begins the plans' names, as "line 3"; may be empty.
/// @param[in,out] out  gets them.
void readDocument(const KinematicTree& tree, const Json& document, const std::string& label, std::vector<Plan>& out);

}  // namespace fcl_artic::plans
