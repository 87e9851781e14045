// SPDX-License-Identifier: BSD-3-Clause
//
// Motions as `check` takes them, on the command line and in lines.
#pragma once

#include <string>

#include "fcl_artic/trajectory.h"
#include "plans/motion.h"

namespace fcl_artic::app {

/// Whether a motion from one configuration to another is of this kind: it needs no waypoints between.
bool isOfTwoEnds(plans::Interpolation interpolation);

/// A motion of such a kind. @throws std::invalid_argument as JointMotion::linear(), shortest(), tangentHalfAngle().
JointMotion motionBetween(const KinematicTree& tree, const Eigen::VectorXd& q0, const Eigen::VectorXd& q1,
                          const plans::MotionOptions& options);

/// The motion of a file's only plan, comma separated values.
/// @throws std::invalid_argument naming file, line or waypoint, and column or joint; std::runtime_error for a file that
/// can't be read to its end.
plans::PlanMotion readTrajectory(const KinematicTree& tree, const std::string& path,
                                 const plans::MotionOptions& options);

}  // namespace fcl_artic::app
