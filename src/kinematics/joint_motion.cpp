// SPDX-License-Identifier: BSD-3-Clause
#include "fcl_artic/joint_motion.h"

#include <cmath>
#include <stdexcept>

namespace fcl_artic {
namespace {

/// Beyond this, rad or m, the error pads of the motion's bounds do not hold.
constexpr double kLargestJointValue = 1e5;
constexpr double kTwoPi = 6.283185307179586;

void requireEnd(const KinematicTree& tree, const Eigen::VectorXd& q, const std::string& what) {
  tree.requireConfiguration(q, what);
  for (JointId j = 0; j < tree.numJoints(); ++j) {  // mimic joints too: their multiplier may be large
    const double value = tree.jointValue(j, q);
    if (!(std::abs(value) <= kLargestJointValue)) {
      throw std::invalid_argument(what + ": the value " + std::to_string(value) + " of joint '" + tree.joint(j).name +
                                  "' is beyond 1e5");
    }
  }
}

}  // namespace

JointMotion JointMotion::linear(const KinematicTree& tree, const Eigen::VectorXd& q0, const Eigen::VectorXd& q1) {
  requireEnd(tree, q0, "q0");
  requireEnd(tree, q1, "q1");
  return {q0, q1 - q0};
}

JointMotion JointMotion::shortest(const KinematicTree& tree, const Eigen::VectorXd& q0, const Eigen::VectorXd& q1) {
  JointMotion motion = linear(tree, q0, q1);
  Eigen::Array<bool, Eigen::Dynamic, 1> wrapped(tree.dof());
  for (int v = 0; v < tree.dof(); ++v) {
    const bool continuous = tree.joint(tree.variableJoint(v)).type == JointType::continuous;
    double& dq = motion.coefficients_(v, 1);
    wrapped[v] = continuous && std::abs(dq) > kTwoPi / 2;
    if (wrapped[v]) dq = std::remainder(dq, kTwoPi);
  }
  for (JointId j = 0; j < tree.numJoints(); ++j) {
    const Joint& joint = tree.joint(j);
    if (!joint.mimics || !wrapped[tree.jointVariable(j)]) continue;
    const double m = joint.mimic.multiplier;
    const bool turns = joint.type != JointType::prismatic;
    if (m == 0 || (turns && m == std::round(m))) continue;  // whole turns of the master are whole turns of this one
    throw std::invalid_argument("joint '" + joint.name + "' mimics the continuous joint '" + joint.mimic.master +
                                "', which cannot take the shorter way: '" + joint.name +
                                "' would end in another pose than that of q1");
  }
  return motion;
}

}  // namespace fcl_artic
