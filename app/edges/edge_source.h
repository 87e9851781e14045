// SPDX-License-Identifier: BSD-3-Clause
//
// Edges or trajectories of an HDF5 file, read block by block.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "fcl_artic/joint_motion.h"
#include "fcl_artic/trajectory.h"
#include "hdf5/hdf5.h"
#include "plans/motion.h"

namespace fcl_artic::app {

struct EdgeOptions {
  std::vector<std::string> joints;      ///< names of the columns, for files without them
  std::map<std::string, double> state;  ///< of variables that have no column
  plans::Turns turns = plans::Turns::ask;
  bool ignore_limits = false;
  double limit_tolerance = plans::kLimitTolerance;
};

/// Motions of some rows.
struct EdgeRows {
  std::vector<std::size_t> asked;                            ///< rows, counted from the first one, of each motion
  std::vector<JointMotion> motions;                          ///< of edges
  std::vector<JointTrajectory> trajectories;                 ///< of trajectories
  std::vector<std::pair<std::size_t, std::string>> refused;  ///< rows without a motion, and why
};

/// A file of edges: the datasets `from` and `to` of configurations, a row each; or `configurations` and `edges` of two
/// row numbers each; or of trajectories: `waypoints`, of which trajectory k takes the rows from first[k] to first[k +
/// 1], with `times` where there are any. The attribute `joints` of the configurations, or of the file, names their
/// columns. `scene`, where it is there, has for each row the number of the one scene that it is for.
class EdgeSource {
 public:
  /// @param tree  must outlive this object.
  /// @throws std::runtime_error, std::invalid_argument naming file, dataset and column.
  EdgeSource(const KinematicTree& tree, const std::string& path, EdgeOptions options);

  std::size_t size() const { return size_; }
  bool areTrajectories() const { return kind_ == Kind::waypoints; }
  bool hasScenes() const { return has_scenes_; }
  /// SHA-256 of all that rows are made of.
  const std::string& hash() const { return hash_; }

  /// Scenes of rows; of files that have them.
  std::vector<std::int64_t> scenes(std::size_t begin, std::size_t count) const;
  /// Motions of rows [begin, begin + count).
  void read(std::size_t begin, std::size_t count, EdgeRows& rows);
  /// Notes on values beyond a limit that were accepted in rows.
  std::vector<std::string> limitNotes() const { return limits_.notes(); }

 private:
  enum class Kind { ends, numbers, waypoints };
  using Table = std::vector<double>;
  void readColumns(const std::string& dataset);
  std::string hashAll() const;
  Eigen::VectorXd configuration(const double* row) const;
  std::string faultOf(const Eigen::VectorXd& q);
  std::string turnFaultOf(const Eigen::VectorXd& q0, const Eigen::VectorXd& q1) const;
  void addEdge(std::size_t row, const double* from, const double* to, EdgeRows& rows);
  void addTrajectory(std::size_t row, const double* waypoints, std::size_t count, const double* times, EdgeRows& rows);
  std::string place(std::size_t row) const;

  const KinematicTree& tree_;
  hdf5::File file_;
  EdgeOptions options_;
  plans::LimitJudge limits_;
  Kind kind_ = Kind::ends;
  std::size_t size_ = 0;
  bool has_scenes_ = false, has_times_ = false;
  std::vector<int> variables_;  ///< of each column
  Eigen::VectorXd rest_;        ///< values of all others
  Table vertices_;              ///< of files with numbers of configurations
  std::size_t num_vertices_ = 0;
  std::string hash_;
};

}  // namespace fcl_artic::app
