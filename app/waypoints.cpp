// SPDX-License-Identifier: BSD-3-Clause
#include "waypoints.h"

#include <algorithm>
#include <set>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>

#include "files/files.h"
#include "plans/csv.h"
#include "plans/variables.h"

namespace fcl_artic::app {
namespace {

constexpr int kTime = -1;

/// Variable of each column.
std::vector<int> readHeader(const KinematicTree& tree, const std::vector<std::string>& names,
                            const std::string& where) {
  std::vector<int> columns;
  std::set<int> seen;
  for (const std::string& name : names) {
    const int column = name == "time" || name == "t" ? kTime : plans::variableOf(tree, name, where);
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
  const std::string file = fmt::format("'{}' ", path);
  const plans::Table table = plans::parseTable(content, file);
  std::vector<int> columns;
  if (table.header_line > 0) {
    const std::string where = fmt::format("{}line {}", file, table.header_line);
    if (table.columns.empty())
      throw std::invalid_argument(where + " names no columns: fcl_artic certify reads such files");
    columns = readHeader(tree, table.columns, where);
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if (!table.degrees[i] || (columns[i] != kTime && tree.isAngle(columns[i]))) continue;
      throw std::invalid_argument(
          fmt::format("{}: column '{}' is no angle, and a value of it ends with deg", where, table.columns[i]));
    }
  }
  Waypoints out;
  out.open_end = table.open_end;
  for (std::size_t k = 0; k < table.rows.size(); ++k) {
    const std::string where = file + table.where(k);
    Eigen::VectorXd q = tree.neutralConfiguration();
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const double value = table.rows[k][i];
      if (columns[i] != kTime) {
        q[columns[i]] = value;
        continue;
      }
      if (!out.times.empty() && !(value > out.times.back())) {
        throw std::invalid_argument(fmt::format("{}, column '{}': {} is not later than the time before, {}", where,
                                                table.columns[i], value, out.times.back()));
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
