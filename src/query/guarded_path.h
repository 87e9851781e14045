// SPDX-License-Identifier: BSD-3-Clause
//
// The trajectory that a guard watches: how fast it goes where, and parts of its pieces.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "fcl_artic/trajectory.h"
#include "motion/part_of_motion.h"

namespace fcl_artic {

/// Sums and products of a few positive numbers, rounded, times this are no less than the true ones.
constexpr double kUp = 1 + 0x1p-48;

class GuardedPath {
 public:
  /// @param deceleration  of each variable, above 0.
  GuardedPath(const JointTrajectory& trajectory, const KinematicTree& tree, const Eigen::VectorXd& deceleration);

  double begin() const { return trajectory_.beginTime(); }
  double end() const { return trajectory_.endTime(); }
  const JointTrajectory& trajectory() const { return trajectory_; }
  /// The piece that is under way at a time.
  std::size_t pieceAt(double time) const;

  /// 1/s: the least deceleration over speed of any variable, over a range of time.
  double brakingOver(double from, double to) const;
  /// Upper bound of a weighted sum of all variables' speeds over a range of time.
  double fastestOver(double from, double to, const Eigen::VectorXd& weight) const;
  /// Upper bounds of the variables' sizes, rad or m.
  const Eigen::VectorXd& largest() const { return largest_; }
  /// How far the variables of a part of a piece may be off by rounding, rad or m.
  const Eigen::VectorXd& partError() const { return part_error_; }
  /// A part of a piece as a motion over [0, 1]; valid until the next one. It allocates nothing.
  const JointMotion& partOf(std::size_t piece, const TimePart& part);

 private:
  void measurePiece(std::size_t piece);
  std::size_t binAt(double time) const;
  template <class F>
  void forEachBin(double from, double to, const F& f) const;

  static constexpr std::size_t kBins = 8;  ///< parts of a piece that are bounded by themselves
  struct Bin {
    double begin = 0, braking = std::numeric_limits<double>::infinity();  ///< s; 1/s
  };
  JointTrajectory trajectory_;
  std::vector<Bin> bins_;
  Eigen::MatrixXd rates_;  ///< rad or m per s: upper bounds, by variable and bin
  Eigen::VectorXd part_error_, largest_;
  /// Parts of pieces, by their number of columns: their memory is used again.
  std::array<std::optional<JointMotion>, 8> parts_;
};

}  // namespace fcl_artic
