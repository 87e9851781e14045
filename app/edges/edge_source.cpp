// SPDX-License-Identifier: BSD-3-Clause
#include "edges/edge_source.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "certificate/sha256.h"
#include "edges/first_rows.h"
#include "text/nearest_name.h"

namespace fcl_artic::app {
namespace {

std::vector<std::string> variableNames(const KinematicTree& tree) {
  std::vector<std::string> names;
  for (int v = 0; v < tree.dof(); ++v) names.push_back(tree.variableName(v));
  return names;
}

}  // namespace

EdgeSource::EdgeSource(const KinematicTree& tree, const std::string& path, EdgeOptions options)
    : tree_(tree),
      file_(path),
      options_(std::move(options)),
      limits_(tree, options_.limit_tolerance, options_.ignore_limits) {
  const bool ends = file_.has("from") || file_.has("to");
  if (ends + file_.has("configurations") + file_.has("waypoints") > 1) {
    throw std::runtime_error(
        fmt::format("'{}': there are edges in more than one form: 'from' and 'to', 'configurations' and 'edges', "
                    "'waypoints' and 'first'; a file holds one of them",
                    path));
  }
  if (file_.has("waypoints")) {
    kind_ = Kind::waypoints;
    readColumns("waypoints");
    const std::vector<std::size_t> first = file_.shape("first");
    if (first.size() != 1 || first[0] < 1) {
      throw std::runtime_error(fmt::format("'{}': dataset 'first' is to be one column of row numbers", path));
    }
    size_ = first[0] - 1;
    requireAllRows(file_, "first", "waypoints");
    has_times_ = file_.has("times");
    if (has_times_ && file_.shape("times") != std::vector<std::size_t>{file_.shape("waypoints")[0]}) {
      throw std::runtime_error(
          fmt::format("'{}': dataset 'times' is to be one column of {} rows, one for each waypoint", path,
                      file_.shape("waypoints")[0]));
    }
  } else if (file_.has("configurations")) {
    kind_ = Kind::numbers;
    readColumns("configurations");
    const std::vector<std::size_t> edges = file_.shape("edges");
    if (edges.size() != 2 || edges[1] != 2) {
      throw std::runtime_error(
          fmt::format("'{}': dataset 'edges' is to have two columns, row numbers of configurations", path));
    }
    size_ = edges[0];
    num_vertices_ = file_.shape("configurations")[0];
    file_.read("configurations", 0, num_vertices_, vertices_);
  } else if (ends) {
    readColumns("from");
    const std::vector<std::size_t> from = file_.shape("from"), to = file_.shape("to");
    if (from != to) {
      throw std::runtime_error(
          fmt::format("'{}': datasets 'from' and 'to' are of different sizes, {} rows of {} and {} rows of {}", path,
                      from[0], from.size() > 1 ? from[1] : 0, to.empty() ? 0 : to[0], to.size() > 1 ? to[1] : 0));
    }
    size_ = from[0];
  } else {
    std::string found;
    for (const std::string& name : file_.datasets()) found += (found.empty() ? "'" : ", '") + name + "'";
    throw std::runtime_error(
        fmt::format("'{}': there are no edges: datasets 'from' and 'to', 'configurations' and "
                    "'edges', or 'waypoints' and 'first' are needed; found {}",
                    path, found.empty() ? "none" : found));
  }
  has_scenes_ = file_.has("scene");
  if (has_scenes_ && file_.shape("scene") != std::vector<std::size_t>{size_}) {
    throw std::runtime_error(
        fmt::format("'{}': dataset 'scene' is to be one column of {} rows, one for each edge", path, size_));
  }
  if (size_ == 0) throw std::runtime_error(fmt::format("'{}': there is no edge", path));
  hash_ = hashAll();
}

/// Finds the variable that each column of configurations stands for.
void EdgeSource::readColumns(const std::string& dataset) {
  const std::vector<std::size_t> shape = file_.shape(dataset);
  if (shape.size() != 2) {
    throw std::runtime_error(fmt::format("'{}': dataset '{}' is to have two dimensions, a row for each configuration",
                                         file_.path(), dataset));
  }
  std::vector<std::string> names = file_.strings(dataset, "joints");
  if (names.empty()) names = file_.strings("", "joints");
  const bool named = !names.empty();
  if (named && !options_.joints.empty() && options_.joints != names) {
    throw std::invalid_argument(
        fmt::format("--joints is {}, and dataset '{}' of '{}' names its joints itself: {}; leave --joints out",
                    fmt::join(options_.joints, ", "), dataset, file_.path(), fmt::join(names, ", ")));
  }
  if (!named) names = options_.joints;
  const std::vector<std::string> known = variableNames(tree_);
  if (names.empty()) names = known;
  if (names.size() != shape[1]) {
    throw std::invalid_argument(fmt::format(
        "'{}': dataset '{}' has {} columns, {} {} joints{}", file_.path(), dataset, shape[1],
        named                     ? "its attribute 'joints' names"
        : options_.joints.empty() ? "robot '" + tree_.name() + "' has"
                                  : "--joints names",
        names.size(),
        named || !options_.joints.empty() ? "" : "; an attribute 'joints', or --joints, says which they are"));
  }
  rest_ = tree_.neutralConfiguration();
  std::vector<bool> given(known.size(), false);
  for (std::size_t c = 0; c < names.size(); ++c) {
    const auto at = std::find(known.begin(), known.end(), names[c]);
    if (at == known.end()) {
      throw std::invalid_argument(
          fmt::format("'{}': column {} of dataset '{}' is of joint '{}', which robot '{}' does not have{}",
                      file_.path(), c, dataset, names[c], tree_.name(), text::didYouMean(names[c], known)));
    }
    const auto v = static_cast<std::size_t>(at - known.begin());
    if (given[v])
      throw std::invalid_argument(
          fmt::format("'{}': dataset '{}' has joint '{}' twice", file_.path(), dataset, names[c]));
    given[v] = true;
    variables_.push_back(static_cast<int>(v));
  }
  for (const auto& [name, value] : options_.state) {
    const auto v = static_cast<std::size_t>(std::find(known.begin(), known.end(), name) - known.begin());
    if (given.at(v))
      throw std::invalid_argument(fmt::format("--state {}: '{}' has a column of it", name, file_.path()));
    rest_[static_cast<Eigen::Index>(v)] = value;
    given[v] = true;
  }
  for (std::size_t v = 0; v < known.size(); ++v) {
    if (given[v]) continue;
    throw std::invalid_argument(
        fmt::format("'{}': dataset '{}' has no column of joint '{}'; --state {}=VALUE says where it stands",
                    file_.path(), dataset, known[v], known[v]));
  }
}

std::string EdgeSource::hashAll() const {
  std::string hashes = fmt::format("{} {} {}\n", static_cast<int>(kind_), size_, has_scenes_);
  for (const int v : variables_) hashes += tree_.variableName(v) + "\n";
  for (Eigen::Index v = 0; v < rest_.size(); ++v) hashes += fmt::format("{:a} ", rest_[v]);
  std::vector<double> values;
  for (const char* name : {"from", "to", "configurations", "edges", "waypoints", "first", "times", "scene"}) {
    if (!file_.has(name)) continue;
    const std::size_t rows = file_.shape(name).at(0);
    for (std::size_t begin = 0; begin < rows; begin += kRowsAtOnce) {
      file_.read(name, begin, std::min(kRowsAtOnce, rows - begin), values);
      hashes += name +
                (' ' + certificate::sha256Text(
                           {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(double)})) +
                '\n';
    }
  }
  return certificate::sha256Text(hashes);
}

std::vector<std::int64_t> EdgeSource::scenes(std::size_t begin, std::size_t count) const {
  std::vector<std::int64_t> scenes;
  file_.read("scene", begin, count, scenes);
  return scenes;
}

std::string EdgeSource::place(std::size_t row) const {
  return fmt::format("'{}', {} {}", file_.path(), areTrajectories() ? "trajectory" : "edge", row);
}

Eigen::VectorXd EdgeSource::configuration(const double* row) const {
  Eigen::VectorXd q = rest_;
  for (std::size_t c = 0; c < variables_.size(); ++c) q[variables_[c]] = row[c];
  return q;
}

/// The reason why a configuration is not one of the robot's; empty: it is one.
std::string EdgeSource::faultOf(const Eigen::VectorXd& q) {
  for (Eigen::Index v = 0; v < q.size(); ++v) {
    if (!std::isfinite(q[v])) return fmt::format("joint '{}' is {}", tree_.variableName(static_cast<int>(v)), q[v]);
  }
  for (const int v : variables_) {
    if (const std::string why = limits_.refusal(v, q[v]); !why.empty()) {
      return why + "; --ignore-limits has it certified all the same";
    }
  }
  return {};
}

/// A turn of which values alone do not say which way round it goes.
std::string EdgeSource::turnFaultOf(const Eigen::VectorXd& q0, const Eigen::VectorXd& q1) const {
  if (options_.turns != plans::Turns::ask) return {};
  for (const int v : variables_) {
    const Joint& joint = tree_.joint(tree_.variableJoint(v));
    if (joint.type == JointType::continuous && std::abs(q1[v] - q0[v]) > M_PI) {
      return fmt::format(
          "joint '{}' goes from {} to {}, more than half a turn: --turns says whether as given or the shortest way",
          joint.name, q0[v], q1[v]);
    }
  }
  return {};
}

void EdgeSource::addEdge(std::size_t row, const double* from, const double* to, EdgeRows& rows) {
  const Eigen::VectorXd q0 = configuration(from), q1 = configuration(to);
  std::string fault = faultOf(q0);
  if (fault.empty()) fault = faultOf(q1);
  if (fault.empty()) fault = turnFaultOf(q0, q1);
  if (fault.empty()) {
    try {
      const bool shortest = options_.turns == plans::Turns::shortest;
      rows.motions.push_back(shortest ? JointMotion::shortest(tree_, q0, q1) : JointMotion::linear(tree_, q0, q1));
      rows.asked.push_back(row);
      return;
    } catch (const std::invalid_argument& error) {
      fault = error.what();
    }
  }
  rows.refused.emplace_back(row, std::move(fault));
}

void EdgeSource::addTrajectory(std::size_t row, const double* waypoints, std::size_t count, const double* times,
                               EdgeRows& rows) {
  std::string fault;
  std::vector<Eigen::VectorXd> way;
  std::vector<double> at;
  for (std::size_t i = 0; i < count && fault.empty(); ++i) {
    way.push_back(configuration(waypoints + i * variables_.size()));
    at.push_back(times ? times[i] : static_cast<double>(i));
    fault = faultOf(way.back());
    if (fault.empty() && i > 0) fault = turnFaultOf(way[i - 1], way[i]);
    if (!fault.empty()) fault = fmt::format("waypoint {}: {}", i, fault);
  }
  if (fault.empty() && count < 2) fault = "it has fewer than two waypoints";
  if (fault.empty()) {
    try {
      const auto turns =
          options_.turns == plans::Turns::shortest ? JointTrajectory::Unwrap::yes : JointTrajectory::Unwrap::no;
      rows.trajectories.push_back(JointTrajectory::linear(tree_, at, way, turns));
      rows.asked.push_back(row);
      return;
    } catch (const std::invalid_argument& error) {
      fault = error.what();
    }
  }
  rows.refused.emplace_back(row, std::move(fault));
}

void EdgeSource::read(std::size_t begin, std::size_t count, EdgeRows& rows) {
  rows = EdgeRows();
  const std::size_t n = variables_.size();
  if (kind_ == Kind::ends) {
    Table from, to;
    file_.read("from", begin, count, from);
    file_.read("to", begin, count, to);
    rows.motions.reserve(count);
    for (std::size_t i = 0; i < count; ++i) addEdge(begin + i, &from[i * n], &to[i * n], rows);
  } else if (kind_ == Kind::numbers) {
    std::vector<std::int64_t> edges;
    file_.read("edges", begin, count, edges);
    for (std::size_t i = 0; i < count; ++i) {
      for (int end = 0; end < 2; ++end) {
        const std::int64_t vertex = edges[2 * i + static_cast<std::size_t>(end)];
        if (vertex >= 0 && static_cast<std::size_t>(vertex) < num_vertices_) continue;
        throw std::runtime_error(fmt::format("{}: there is no configuration {}, they are numbered 0 to {}",
                                             place(begin + i), vertex, num_vertices_ - 1));
      }
      addEdge(begin + i, &vertices_[static_cast<std::size_t>(edges[2 * i]) * n],
              &vertices_[static_cast<std::size_t>(edges[2 * i + 1]) * n], rows);
    }
  } else {
    std::vector<std::int64_t> first;
    file_.read("first", begin, count + 1, first);
    const std::size_t num_waypoints = file_.shape("waypoints")[0];
    for (std::size_t i = 0; i < count; ++i) {
      if (first[i] >= 0 && first[i] <= first[i + 1] && static_cast<std::size_t>(first[i + 1]) <= num_waypoints)
        continue;
      throw std::runtime_error(fmt::format("{}: 'first' has it go from row {} to row {} of {} waypoints",
                                           place(begin + i), first[i], first[i + 1], num_waypoints));
    }
    const auto at = static_cast<std::size_t>(first[0]), all = static_cast<std::size_t>(first[count]) - at;
    Table waypoints, times;
    file_.read("waypoints", at, all, waypoints);
    if (has_times_) file_.read("times", at, all, times);
    for (std::size_t i = 0; i < count; ++i) {
      const auto from = static_cast<std::size_t>(first[i]) - at;
      addTrajectory(begin + i, waypoints.data() + from * n, static_cast<std::size_t>(first[i + 1] - first[i]),
                    has_times_ ? times.data() + from : nullptr, rows);
    }
  }
  for (auto& [row, fault] : rows.refused) {
    fault = place(row) + ": " + fault;
    row -= begin;
  }
  for (std::size_t& row : rows.asked) row -= begin;
}

}  // namespace fcl_artic::app
