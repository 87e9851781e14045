// SPDX-License-Identifier: BSD-3-Clause
#include "tool_line.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "exit_status.h"
#include "kinematics/angles.h"
#include "robot_options.h"

namespace fcl_artic::app {
namespace {

using Units = std::initializer_list<std::pair<std::string_view, double>>;

/// A number of at least 0, with one of the units.
std::optional<double> quantity(std::string_view text, const Units& units) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || !std::isfinite(value) || value < 0) return std::nullopt;
  const std::string_view unit = text.substr(static_cast<std::size_t>(end - text.data()));
  for (const auto& [name, factor] : units) {
    if (unit == name) return value * factor;
  }
  return std::nullopt;
}

}  // namespace

void addToolLine(CLI::App& verb, ToolLineOptions& options, const std::string& group) {
  CLI::Option* line =
      verb.add_option(
              "--line", options.line,
              "The tool's origin is to keep that near to the straight line between its ends, and its orientation that "
              "near to the turn between them: proven, or the plan counts as one in contact")
          ->allow_extra_args(false)
          ->group(group)
          ->type_name("LINK=1mm[,0.5deg][@POSE]");
  verb.add_option("--via", options.via,
                  "Instead of the straight line, the arc of a circle through this point of the world (m), along which "
                  "the orientation turns, too")
      ->needs(line)
      ->allow_extra_args(false)
      ->group(group)
      ->type_name("X,Y,Z");
}

ToolLine parseToolLine(const KinematicTree& tree, const ToolLineOptions& options) {
  const std::string& text = options.line;
  const auto refuse = [&](const std::string& reason) {
    throw std::invalid_argument(fmt::format("--line {}: {}", text, reason));
  };
  ToolLine line;
  if (!options.via.empty()) {
    if (std::count(options.via.begin(), options.via.end(), ',') != 2) {
      throw std::invalid_argument(fmt::format("--via {}: is no point x,y,z in m", options.via));
    }
    line.via = parsePose(options.via, "--via").translation();
  }
  const std::size_t equals = text.find('='), at = text.find('@');
  if (equals == std::string::npos || equals == 0) refuse("is not LINK=DISTANCE[,ANGLE][@POSE], as tool0=1mm,0.5deg");
  line.link = text.substr(0, equals);
  try {
    tree.linkId(line.link);
  } catch (const std::out_of_range& error) {
    refuse(error.what());
  }
  if (at != std::string::npos) line.tool = parsePose(text.substr(at + 1), "--line");
  const std::string limits = text.substr(equals + 1, at == std::string::npos ? at : at - equals - 1);
  const std::size_t comma = limits.find(',');
  const std::optional<double> distance = quantity(limits.substr(0, comma), {{"mm", 1e-3}, {"m", 1}});
  if (!distance) refuse(fmt::format("'{}' is no distance with its unit, as 1mm or 0.001m", limits.substr(0, comma)));
  line.distance = *distance;
  if (comma == std::string::npos) return line;
  const std::optional<double> angle = quantity(limits.substr(comma + 1), {{"deg", kRadiansPerDegree}, {"rad", 1}});
  if (!angle) refuse(fmt::format("'{}' is no angle with its unit, as 0.5deg or 0.01rad", limits.substr(comma + 1)));
  line.angle = *angle;
  return line;
}

int ToolLineAnswer::exitStatus() const {
  return kept() ? kExitFree : left() ? kExitContact : kExitUndecided;
}

const char* ToolLineAnswer::verdict() const {
  return kept() ? "kept" : left() ? "left" : "undecided";
}

std::string ToolLineAnswer::text() const {
  const auto limit = [](const std::string& most, bool any) { return any ? std::string() : " (allowed: " + most + ")"; };
  return fmt::format(
      "'{}' {} its {} of {:.4g} m: at most {:.6g} mm off{}, proven, at t = {:.6g}; turned by at most {:.4g} deg{}",
      asked.link,
      kept()   ? "keeps to"
      : left() ? "LEAVES"
               : "may leave",
      asked.via ? "arc" : "line", found.length, 1e3 * found.distance_upper,
      limit(fmt::format("{:g} mm", 1e3 * asked.distance), false), found.distance_time,
      found.angle_upper / kRadiansPerDegree,
      limit(fmt::format("{:g} deg", asked.angle / kRadiansPerDegree), asked.anyAngle()));
}

nlohmann::ordered_json ToolLineAnswer::json() const {
  nlohmann::ordered_json via;
  if (asked.via) via = std::vector<double>(asked.via->begin(), asked.via->end());
  return {{"status", verdict()},
          {"link", asked.link},
          {"via", via},
          {"length", found.length},
          {"distance_allowed", asked.distance},
          {"distance_lower", found.distance_lower},
          {"distance_upper", found.distance_upper},
          {"distance_t", found.distance_time},
          {"angle_allowed", asked.anyAngle() ? nlohmann::ordered_json() : nlohmann::ordered_json(asked.angle)},
          {"angle_lower", found.angle_lower},
          {"angle_upper", found.angle_upper},
          {"angle_t", found.angle_time}};
}

ToolLineAnswer askToolLine(const KinematicTree& tree, const JointTrajectory& motion, const ToolLine& line) {
  // The brackets are narrow: an answer is open only within this part of the allowed deviation.
  constexpr double kPart = 0.01;
  // Work of some seconds. If a limit is so narrow against the motion that this is not enough, the answer is undecided.
  constexpr std::uint64_t kMaxPoses = 1 << 21;
  ToolLineRequest request;
  request.work_budget = kMaxPoses;
  request.tool = line.tool;
  request.via = line.via;
  if (line.distance > 0) request.tolerance_distance = kPart * line.distance;
  if (line.angle > 0 && !line.anyAngle()) request.tolerance_angle = kPart * line.angle;
  return {line, toolDeviation(tree, motion, line.link, request)};
}

}  // namespace fcl_artic::app
