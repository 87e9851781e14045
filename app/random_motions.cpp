// SPDX-License-Identifier: BSD-3-Clause
#include "random_motions.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "kinematics/angles.h"
#include "kinematics/largest_joint_value.h"

namespace fcl_artic::app {
namespace {

constexpr double kPlaces = 1e6;  // a multiple of its inverse is what its six decimals read as

/// Whether values are drawn within the limits. Limits beyond the joint values of any motion, as a virtual joint's
/// +-999999 m, don't count.
bool isLimited(const Joint& joint) {
  return hasLimits(joint) && std::max(std::abs(joint.lower), std::abs(joint.upper)) <= kLargestJointValue;
}

/// The values that variable v may begin with; v is no part of a quaternion.
struct Range {
  double low, high;
};
Range rangeOf(const KinematicTree& tree, int v) {
  const Joint& joint = tree.joint(tree.variableJoint(v));
  if (isLimited(joint)) return {joint.lower, joint.upper};
  const double reach = tree.isAngle(v) ? kPi : 1;
  return {-reach, reach};
}

/// Whether v is one of the four parts of a quaternion.
bool inQuaternion(const KinematicTree& tree, int v) {
  const int first = tree.quaternionVariable(tree.variableJoint(v));
  return first >= 0 && v >= first && v < first + 4;
}

}  // namespace

RandomMotions::RandomMotions(const KinematicTree& tree, double angle, std::uint64_t seed)
    : tree_(tree), angle_(angle), random_(seed) {
  if (tree.dof() == 0) throw std::invalid_argument(fmt::format("robot '{}' has no joint that moves", tree.name()));
}

double RandomMotions::between(double low, double high) {
  const double rounded = std::round(random_.uniform(low, high) * kPlaces) / kPlaces;
  return std::clamp(rounded, low, high) + 0.0;  // no -0
}

void RandomMotions::drawQuaternion(int first, MotionEnds& ends) {
  // A point of a cube that lies within the unit ball, or in four dimensions, points in any direction alike.
  const auto direction = [&](auto vector) {
    do {
      for (double& x : vector) x = random_.uniform(-1, 1);
    } while (vector.squaredNorm() > 1 || vector.squaredNorm() < 1e-4);
    return decltype(vector)(vector.normalized());
  };
  const Eigen::Quaterniond start(direction(Eigen::Vector4d()));
  const Eigen::AngleAxisd turn(random_.uniform(0, angle_), direction(Eigen::Vector3d()));
  ends.from.segment<4>(first) = start.coeffs();
  ends.to.segment<4>(first) = (turn * start).coeffs();
}

MotionEnds RandomMotions::next() {
  MotionEnds ends{Eigen::VectorXd(tree_.dof()), Eigen::VectorXd(tree_.dof())};
  for (int v = 0; v < tree_.dof(); ++v) {
    if (inQuaternion(tree_, v)) {
      drawQuaternion(v, ends);
      v += 3;
      continue;
    }
    const Range range = rangeOf(tree_, v);
    const double step = tree_.isAngle(v) ? angle_ : angle_ / (2 * kPi) * (range.high - range.low);
    ends.from[v] = between(range.low, range.high);
    // Within the limits, in which pairs of links are proven apart.
    ends.to[v] = between(std::max(range.low, ends.from[v] - step), std::min(range.high, ends.from[v] + step));
  }
  return ends;
}

int numSteps(const KinematicTree& tree, const MotionEnds& ends, double resolution) {
  double most = 0;  // lengths of the motion in a space, in parts of the space's extent
  double square = 0, extent_square = 0;
  for (int v = 0; v < tree.dof(); ++v) {
    if (inQuaternion(tree, v)) {
      const double cosine = std::abs(ends.from.segment<4>(v).dot(ends.to.segment<4>(v)));
      most = std::max(most, std::acos(std::min(1.0, cosine)) / (kPi / 2));
      v += 3;
      continue;
    }
    const double moved = std::abs(ends.to[v] - ends.from[v]);
    const Range range = rangeOf(tree, v);
    if (isLimited(tree.joint(tree.variableJoint(v)))) {
      square += moved * moved;
      extent_square += (range.high - range.low) * (range.high - range.low);
    } else {
      most = std::max(most, moved / (tree.isAngle(v) ? kPi : range.high - range.low));
    }
  }
  if (extent_square > 0) most = std::max(most, std::sqrt(square / extent_square));
  return std::max(1, static_cast<int>(std::ceil(most / resolution)));
}

std::string configurationText(const Eigen::VectorXd& q) {
  std::string text;
  for (const double value : q) text += fmt::format("{}{}", text.empty() ? "" : ",", value);
  return text;
}

}  // namespace fcl_artic::app
