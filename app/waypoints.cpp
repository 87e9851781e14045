// SPDX-License-Identifier: BSD-3-Clause
#include "waypoints.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>

#include "configuration.h"
#include "files/files.h"

namespace fcl_artic::app {
namespace {

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t\r\"");
  return begin == std::string_view::npos ? std::string_view()
                                         : text.substr(begin, text.find_last_not_of(" \t\r\"") + 1 - begin);
}

std::vector<std::string_view> splitLine(std::string_view line) {
  std::vector<std::string_view> fields;
  for (std::size_t at = 0;;) {
    const std::size_t end = line.find(',', at);
    fields.push_back(trimmed(line.substr(at, end == std::string_view::npos ? end : end - at)));
    if (end == std::string_view::npos) return fields;
    at = end + 1;
  }
}

double parseNumber(std::string_view text, const std::string& where, const std::string& column) {
  const std::string whole(text);
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);  // from_chars takes no plus
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
    throw std::invalid_argument(fmt::format("{}, column '{}': '{}' is not a finite number", where, column, whole));
  }
  return value;
}

constexpr int kTime = -1;

/// Variable of each column.
std::vector<int> readHeader(const KinematicTree& tree, const std::vector<std::string_view>& names,
                            const std::string& where) {
  std::vector<int> columns;
  std::set<int> seen;
  for (const std::string_view text : names) {
    const std::string name(text);
    const int column = name == "time" || name == "t" ? kTime : variableOf(tree, name, where);
    if (!seen.insert(column).second)
      throw std::invalid_argument(fmt::format("{}: column '{}' is there twice", where, name));
    columns.push_back(column);
  }
  if (!seen.count(kTime)) throw std::invalid_argument(where + ": no column 'time'");
  return columns;
}

}  // namespace

Waypoints readWaypoints(const KinematicTree& tree, const std::string& path) {
  return parseWaypoints(tree, files::read(path), path);
}

Waypoints parseWaypoints(const KinematicTree& tree, std::string_view content, const std::string& path) {
  Waypoints out;
  out.open_end = !content.empty() && content.back() != '\n';
  std::vector<int> columns;
  std::vector<std::string> names;
  for (int number = 1; !content.empty(); ++number) {
    const std::size_t end = std::min(content.find('\n'), content.size());
    std::string_view line = content.substr(0, end);
    content.remove_prefix(std::min(end + 1, content.size()));
    if (number == 1 && line.substr(0, 3) == "\xEF\xBB\xBF") line.remove_prefix(3);  // a byte order mark
    if (trimmed(line).empty() || trimmed(line)[0] == '#') continue;
    const std::string where = fmt::format("'{}' line {}", path, number);
    const std::vector<std::string_view> fields = splitLine(line);
    if (columns.empty()) {
      columns = readHeader(tree, fields, where);
      names.assign(fields.begin(), fields.end());
      continue;
    }
    if (fields.size() != columns.size()) {
      throw std::invalid_argument(
          fmt::format("{} has {} columns, the first line names {}", where, fields.size(), columns.size()));
    }
    Eigen::VectorXd q = tree.neutralConfiguration();
    for (std::size_t i = 0; i < fields.size(); ++i) {
      const double value = parseNumber(fields[i], where, names[i]);
      if (columns[i] != kTime) {
        q[columns[i]] = value;
        continue;
      }
      if (!out.times.empty() && !(value > out.times.back())) {
        throw std::invalid_argument(fmt::format("{}, column '{}': {} is not later than the time before, {}", where,
                                                names[i], value, out.times.back()));
      }
      out.times.push_back(value);
    }
    tree.requireConfiguration(q, where);
    out.configurations.push_back(std::move(q));
  }
  for (int v = 0; v < tree.dof(); ++v) {
    const bool named = std::find(columns.begin(), columns.end(), v) != columns.end();
    if (!named) out.unnamed += (out.unnamed.empty() ? "" : ", ") + tree.variableName(v);
  }
  if (out.times.size() < 2) {
    throw std::invalid_argument(fmt::format("'{}' has {} waypoint{}, a trajectory needs two", path, out.times.size(),
                                            out.times.size() == 1 ? "" : "s"));
  }
  return out;
}

Interpolation interpolationNamed(const std::string& name) {
  if (name == "cubic") return Interpolation::cubic;
  return name == "tangent-half-angle" ? Interpolation::tangentHalfAngle : Interpolation::linear;
}

JointMotion motionBetween(const KinematicTree& tree, const Eigen::VectorXd& q0, const Eigen::VectorXd& q1,
                          Interpolation interpolation, bool shortest) {
  if (interpolation == Interpolation::tangentHalfAngle) return JointMotion::tangentHalfAngle(tree, q0, q1);
  return shortest ? JointMotion::shortest(tree, q0, q1) : JointMotion::linear(tree, q0, q1);
}

JointTrajectory interpolate(const KinematicTree& tree, const Waypoints& waypoints, Interpolation interpolation,
                            bool shortest) {
  const std::vector<double>& t = waypoints.times;
  const std::vector<Eigen::VectorXd>& q = waypoints.configurations;
  const auto unwrap = shortest ? JointTrajectory::Unwrap::yes : JointTrajectory::Unwrap::no;
  if (interpolation == Interpolation::tangentHalfAngle) return JointTrajectory::tangentHalfAngle(tree, t, q);
  if (interpolation == Interpolation::linear) return JointTrajectory::linear(tree, t, q, unwrap);
  std::vector<Eigen::VectorXd> slopes, velocities(q.size(), Eigen::VectorXd::Zero(tree.dof()));
  for (std::size_t k = 0; k + 1 < q.size(); ++k) {
    const JointMotion way =
        shortest ? JointMotion::shortest(tree, q[k], q[k + 1]) : JointMotion::linear(tree, q[k], q[k + 1]);
    slopes.push_back(way.dq() / (t[k + 1] - t[k]));  // of a quaternion: its angular velocity
  }
  for (std::size_t k = 1; k + 1 < q.size(); ++k) {
    const double before = t[k] - t[k - 1], after = t[k + 1] - t[k];
    velocities[k] = (after * slopes[k - 1] + before * slopes[k]) / (before + after);
  }
  return JointTrajectory::cubic(tree, t, q, velocities, unwrap);
}

}  // namespace fcl_artic::app
