// SPDX-License-Identifier: BSD-3-Clause
//
// Options about a tool that has to follow a straight line or an arc.
#pragma once

#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "fcl_artic/tool_line.h"

namespace fcl_artic::app {

/// The options as they were typed.
struct ToolLineOptions {
  std::string line, via;
};

/// A tool, its path, and how far it may leave that.
struct ToolLine {
  std::string link;
  Eigen::Isometry3d tool = Eigen::Isometry3d::Identity();
  std::optional<Eigen::Vector3d> via;                      ///< of an arc; m, in the world
  double distance = 0;                                     ///< m
  double angle = std::numeric_limits<double>::infinity();  ///< rad; infinite: any

  bool anyAngle() const { return std::isinf(angle); }
};

/// Adds --line and --via to the group.
void addToolLine(CLI::App& verb, ToolLineOptions& options, const std::string& group);
/// Reads "LINK=1mm", "LINK=1mm,0.5deg" or, with the tool's frame in the link's, "LINK=1mm,0.5deg@POSE", and the point
/// "X,Y,Z".
/// @throws std::invalid_argument beginning with the option, also for a link that the robot does not have.
ToolLine parseToolLine(const KinematicTree& tree, const ToolLineOptions& options);

/// The tool's deviation on one motion.
struct ToolLineAnswer {
  ToolLine asked;
  ToolDeviation found;

  bool kept() const { return found.certainlyKeeps(asked.distance, asked.angle); }
  bool left() const { return found.certainlyLeaves(asked.distance, asked.angle); }
  int exitStatus() const;
  /// "kept", "left" or "undecided".
  const char* verdict() const;
  std::string text() const;
  nlohmann::ordered_json json() const;
};
ToolLineAnswer askToolLine(const KinematicTree& tree, const JointTrajectory& motion, const ToolLine& line);

}  // namespace fcl_artic::app
