// SPDX-License-Identifier: BSD-3-Clause
//
// How near bodies come to each other in the course of a motion.
#pragma once

#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "fcl_artic/manager.h"

namespace fcl_artic::app {

/// The robot's motion: over [0, 1], or in a trajectory's own time.
using RobotMotion = std::variant<JointMotion, JointTrajectory>;

/// Where a motion's time begins and ends.
std::pair<double, double> timeOf(const RobotMotion& motion);
/// The joint values at time t of the motion's own, rad or m.
Eigen::VectorXd configurationAt(const RobotMotion& motion, double t);

/// The part of a motion from t = a to t = b as a motion over [0, 1], up to rounding.
/// @throws std::invalid_argument for a joint with a quaternion whose rotation vector is of higher degree than 1: its
///   part is no such motion.
JointMotion partOf(const KinematicTree& tree, const JointMotion& motion, double a, double b);

/// How near bodies come over [begin, end] of the motion's time; of each Clearance `time` is of the motion's time too.
/// Its lower bound holds at all times of the step, its upper bound at one of them. Where a search was cut off, they are
/// 0 and infinite.
struct DistanceStep {
  double begin = 0, end = 0;
  Clearance obstacles;  ///< of links from obstacles
  Clearance links;      ///< of links from each other
};

struct Distances {
  std::string missing;              ///< why there are none, as the end of a sentence; empty: they are there
  double most = 0;                  ///< larger ones are not looked for, m
  std::vector<DistanceStep> steps;  ///< one after the other, from the motion's begin to its end
};

struct DistanceOptions {
  bool obstacles = true, links = true;  ///< which of them are measured
  double most = 1;                      ///< largest distance of interest, m, above 0
  /// Called with the part that is done, in [0, 1], from any thread; false ends it, and there are none. May be empty.
  std::function<bool(double part)> progress;
};

/// Measures distances over a hundred steps of a motion, on all cores.
/// @param manager  after setup().
/// @throws what ArticulatedCollisionManager::clearance() throws.
Distances measureDistances(const ArticulatedCollisionManager& manager, const RobotMotion& motion,
                           const DistanceOptions& options);

}  // namespace fcl_artic::app
