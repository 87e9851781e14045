// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "fcl_artic/manager.h"
#include "fcl_artic/urdf/urdf.h"

namespace fcl_artic::planning_data {

/// One scene with a start and a goal.
struct Problem {
  int index = 0;  ///< as edges name it
  std::vector<double> start, goal;
  Scene scene;
};

/// The problems of one environment (format planning-problems/1).
struct Environment {
  std::string name;
  std::vector<std::string> joints;       ///< order of start, goal and edges
  std::map<std::string, double> locked;  ///< all other joints, those of `tree` that have a value of their own
  std::vector<Problem> problems;

  const Problem& problem(int index) const;
  /// All variables of the tree, from the values of `joints`.
  Eigen::VectorXd configuration(const KinematicTree& tree, const std::vector<double>& values) const;
};

/// A motion that a planner asked about (formats edge-trace/1 and missed-edges/1).
struct Edge {
  std::string environment;
  int problem = 0;
  std::vector<double> from, to;
  bool hit = false;    ///< dense sampling saw a collision
  double seen_at = 2;  ///< the first sample in collision
};

/// @throws std::runtime_error naming the file.
Environment readEnvironment(const std::filesystem::path& path, const KinematicTree& tree);
std::vector<Edge> readTrace(const std::filesystem::path& path);
std::vector<Edge> readMissed(const std::filesystem::path& path);

/// Where a robot's problems of an environment are. (A robot may share another one's: ur5_coarse those of ur5.)
std::filesystem::path problemsPath(const std::filesystem::path& data, const std::string& robot,
                                   const std::string& environment);
/// The environments that a robot has problems of, by name. @throws std::runtime_error when it has none.
std::vector<std::string> environmentsOf(const std::filesystem::path& data, const std::string& robot);

/// Robot NAME with its SRDF, from the folder of shared data.
Robot readRobot(const std::filesystem::path& data, const std::string& name);

/// Set up with robot and scene, and holding on to copies of both.
std::shared_ptr<const ArticulatedCollisionManager> makeManager(const Robot& robot, const Scene& scene);

/// The folder that FCL_ARTIC_DATA names, when it has robots/, problems/ and edges/; else empty.
std::filesystem::path sharedData();

}  // namespace fcl_artic::planning_data
