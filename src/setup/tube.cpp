// SPDX-License-Identifier: BSD-3-Clause
#include "setup/tube.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <stdexcept>

#include "numerics/constants.h"
#include "numerics/require.h"

namespace fcl_artic {
namespace {

bool turns(JointType type) {
  return type != JointType::fixed && type != JointType::prismatic;
}

bool slides(JointType type) {
  return type == JointType::prismatic || type == JointType::planar || type == JointType::floating;
}

JointTolerance restrictTo(JointType type, const JointTolerance& tolerance) {
  return {turns(type) ? tolerance.angle : 0, slides(type) ? tolerance.length : 0};
}

void requirePose(const PoseTolerance& tolerance, const std::string& of) {
  requireNotNegative(tolerance.length, "the length of the tolerance of " + of);
  requireNotNegative(tolerance.angle, "the angle of the tolerance of " + of);
  if (!tolerance.pivot.allFinite())
    throw std::invalid_argument("the pivot of the tolerance of " + of + " is not finite");
}

const Joint& jointNamed(const KinematicTree& tree, const std::string& name, const std::string& what) {
  const JointId joint = tree.findJoint(name);
  if (joint < 0) throw std::invalid_argument(what + ": robot '" + tree.name() + "' has no joint '" + name + "'");
  return tree.joint(joint);
}

void requireFits(const Joint& joint, const JointTolerance& tolerance, const std::string& what) {
  const std::string of = what + ": joint '" + joint.name + "' ";
  if (joint.mimics)
    throw std::invalid_argument(of + "follows '" + joint.mimic.master + "': set that joint's tolerance");
  if (joint.type == JointType::fixed) throw std::invalid_argument(of + "is fixed");
  if (tolerance.length > 0 && !slides(joint.type)) {
    throw std::invalid_argument(of + "does not slide: its tolerance is an angle");
  }
  if (tolerance.angle > 0 && !turns(joint.type)) {
    throw std::invalid_argument(of + "does not turn: its tolerance is a length");
  }
}

}  // namespace

void NamedTolerances::setAllJoints(const JointTolerance& tolerance) {
  requireNotNegative(tolerance.angle, "the angle of the joints' tolerance");
  requireNotNegative(tolerance.length, "the length of the joints' tolerance");
  of_all_joints_ = tolerance;
}

void NamedTolerances::setJoint(const KinematicTree& tree, const std::string& name, const JointTolerance& tolerance,
                               const std::string& what) {
  requireNotNegative(tolerance.angle, "the angle of the tolerance of '" + name + "'");
  requireNotNegative(tolerance.length, "the length of the tolerance of '" + name + "'");
  requireFits(jointNamed(tree, name, what), tolerance, what);
  of_joint_[name] = tolerance;
}

void NamedTolerances::setBase(const PoseTolerance& tolerance) {
  requirePose(tolerance, "the base");
  of_base_ = tolerance;
}

void NamedTolerances::setObject(const std::string& name, const PoseTolerance& tolerance) {
  requirePose(tolerance, "'" + name + "'");
  of_object_[name] = tolerance;
}

void NamedTolerances::setSpeed(const std::string& name, const ObjectSpeed& speed) {
  requireNotNegative(speed.speed, "the speed of '" + name + "'");
  requireFinite(speed.since, "the time since which '" + name + "' may move");
  speed_of_[name] = speed;
}

void NamedTolerances::setTime(double time) {
  requireNotNegative(time, "the tolerance of time");
  of_time_ = time;
}

ObjectSpeed NamedTolerances::speedOf(const std::string& object) const {
  const auto found = speed_of_.find(object);
  return found == speed_of_.end() ? ObjectSpeed() : found->second;
}

void NamedTolerances::clear() {
  *this = NamedTolerances();
}

void NamedTolerances::keep(const std::function<bool(const std::string& name)>& isKept) {
  const auto keepIn = [&](auto& named) {
    for (auto at = named.begin(); at != named.end();) at = isKept(at->first) ? std::next(at) : named.erase(at);
  };
  keepIn(of_object_);
  keepIn(speed_of_);
}

bool NamedTolerances::anySpeed() const {
  return std::any_of(speed_of_.begin(), speed_of_.end(), [](const auto& entry) { return entry.second.speed > 0; });
}

bool NamedTolerances::any() const {
  const auto anyOf = [](const auto& named) {
    return std::any_of(named.begin(), named.end(), [](const auto& entry) { return entry.second.any(); });
  };
  return anySpeed() || of_all_joints_.any() || of_base_.any() || anyOf(of_joint_) || anyOf(of_object_);
}

TreeStrays NamedTolerances::straysOf(const KinematicTree& tree) const {
  TreeStrays of;
  for (const auto& [name, tolerance] : of_joint_) {
    requireFits(jointNamed(tree, name, "setup()"), tolerance, "setup()");
  }
  const auto ownOf = [&](const Joint& joint) {
    const auto own = of_joint_.find(joint.name);
    return restrictTo(joint.type, own == of_joint_.end() ? of_all_joints_ : own->second);
  };
  bool any = false;
  std::vector<JointTolerance> of_joint(static_cast<std::size_t>(tree.numJoints()));
  std::vector<double> of_variable(static_cast<std::size_t>(tree.dof()), 0);
  for (JointId j = 0; j < tree.numJoints(); ++j) {
    const Joint& joint = tree.joint(j);
    JointTolerance& own = of_joint[static_cast<std::size_t>(j)];
    if (!joint.mimics) {
      own = ownOf(joint);
      any = any || own.any();
      const auto first = static_cast<std::size_t>(std::max(tree.jointVariable(j), 0));
      const auto count = static_cast<std::size_t>(tree.numVariables(j));
      for (std::size_t k = 0; k < count && own.any(); ++k) {
        of_variable[first + k] = count == 1 ? own.angle + own.length : std::numeric_limits<double>::infinity();
      }
    }
  }
  if (!any) return of;
  // A joint that follows another one strays by the multiple of what that one's variable does.
  for (JointId j = 0; j < tree.numJoints(); ++j) {
    const Joint& joint = tree.joint(j);
    if (!joint.mimics) continue;
    const double value =
        std::abs(joint.mimic.multiplier) * of_variable[static_cast<std::size_t>(tree.jointVariable(j))] * (1 + kUlp);
    of_joint[static_cast<std::size_t>(j)] = restrictTo(joint.type, {value, value});
  }
  of.of_joint = std::move(of_joint);
  of.of_variable = std::move(of_variable);
  return of;
}

double NamedTolerances::strayOf(const std::string& object, const ShapeTree& shape) const {
  const auto found = of_object_.find(object);
  if (found == of_object_.end()) return 0;
  const PoseTolerance& tolerance = found->second;
  if (tolerance.angle == 0) return tolerance.length;
  // The root's box holds the geometry, and the chord of an angle is no longer than the angle.
  const engine::Node& root = shape.view().nodes[0];
  const auto corner = [&](const float* ends) -> Eigen::Array3d {
    return (Eigen::Vector3f::Map(ends).cast<double>() - tolerance.pivot).array().abs();
  };
  const double farthest = corner(root.lo).max(corner(root.hi)).matrix().norm();
  return (tolerance.length + tolerance.angle * farthest) * (1 + 8 * kUlp);
}

double NamedTolerances::lagOf(const std::string& object, const ShapeTree& shape, const BodyMotion& motion) const {
  if (!(of_time_ > 0) || motion.elements.empty()) return 0;
  const double speed = boundPath(motion, reachOf(motion, shape.lower(), shape.upper())).speed;
  if (!std::isfinite(speed)) {
    throw std::invalid_argument("setup(): nothing bounds the speed of obstacle '" + object +
                                "', as setTimeTolerance() needs it");
  }
  if (speed == 0) return 0;
  return of_time_ * speed * (1 + 0x1p-40) + std::numeric_limits<double>::min();  // the product may underflow
}

}  // namespace fcl_artic
