// SPDX-License-Identifier: BSD-3-Clause
#include "motions.h"

#include <stdexcept>

#include <fmt/format.h>

#include "files/files.h"
#include "plans/plan.h"

namespace fcl_artic::app {

using plans::Interpolation;

bool isOfTwoEnds(Interpolation interpolation) {
  return interpolation == Interpolation::automatic || interpolation == Interpolation::linear ||
         interpolation == Interpolation::jtc || interpolation == Interpolation::tangentHalfAngle;
}

JointMotion motionBetween(const KinematicTree& tree, const Eigen::VectorXd& q0, const Eigen::VectorXd& q1,
                          const plans::MotionOptions& options) {
  if (options.interpolation == Interpolation::tangentHalfAngle) return JointMotion::tangentHalfAngle(tree, q0, q1);
  return options.turns == plans::Turns::shortest ? JointMotion::shortest(tree, q0, q1)
                                                 : JointMotion::linear(tree, q0, q1);
}

plans::PlanMotion readTrajectory(const KinematicTree& tree, const std::string& path,
                                 const plans::MotionOptions& options) {
  const std::string content = files::read(path);
  try {
    plans::ColumnOptions columns;
    columns.joints = plans::unnamedColumns(tree, options);
    return toMotion(tree, plans::parsePlans(tree, content, plans::Format::csv, columns).front(), options);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(fmt::format("'{}': {}", path, error.what()));
  }
}

}  // namespace fcl_artic::app
