// SPDX-License-Identifier: BSD-3-Clause
#include "fcl_artic/joint_motion.h"

#include <cmath>
#include <stdexcept>
#include <utility>

#include "kinematics/angles.h"
#include "kinematics/rotation_vector.h"
#include "model/sweep.h"
#include "numerics/rotation.h"
#include "numerics/shown.h"

namespace fcl_artic {
namespace {

/// Beyond this, rad or m, the error pads of the motion's bounds do not hold.
constexpr double kLargestJointValue = 1e5;

Eigen::Quaterniond quaternionAt(const Eigen::Ref<const Eigen::VectorXd>& q, int v) {
  return Eigen::Quaterniond(Eigen::Vector4d(q.segment<4>(v))).normalized();
}

/// Refuses values beyond 1e5, of mimic joints too: their multiplier may be large.
/// @param sizes  of each variable, sums of absolute numbers.
void requireSizes(const KinematicTree& tree, const Eigen::VectorXd& sizes, const std::string& what) {
  for (JointId j = 0; j < tree.numJoints(); ++j) {
    const Joint& joint = tree.joint(j);
    for (int i = 0; i < tree.numVariables(j); ++i) {
      const double own = sizes[tree.jointVariable(j) + i];
      const double value = joint.mimics ? std::abs(joint.mimic.multiplier) * own + std::abs(joint.mimic.offset) : own;
      if (value <= kLargestJointValue) continue;
      throw std::invalid_argument(what + ": the value " + shown(value) + " of joint '" + joint.name +
                                  "' is beyond 1e5");
    }
  }
}

void requireEnd(const KinematicTree& tree, const Eigen::VectorXd& q, const std::string& what) {
  tree.requireConfiguration(q, what);
  for (JointId j = 0; j < tree.numJoints(); ++j) {
    if (tree.numVariables(j) != 1) continue;
    const double value = tree.jointValue(j, q);
    if (!(std::abs(value) <= kLargestJointValue)) {
      throw std::invalid_argument(what + ": the value " + shown(value) + " of joint '" + tree.joint(j).name +
                                  "' is beyond 1e5");
    }
  }
  for (int v = 0; v < tree.dof(); ++v) {
    if (std::abs(q[v]) <= kLargestJointValue) continue;
    throw std::invalid_argument(what + ": the value " + shown(q[v]) + " of joint '" + tree.variableName(v) +
                                "' is beyond 1e5");
  }
}

bool turnsForever(const KinematicTree& tree, int v) {
  const JointType type = tree.joint(tree.variableJoint(v)).type;
  return type == JointType::continuous || (type == JointType::planar && tree.isAngle(v));
}

}  // namespace

JointMotion::JointMotion(const KinematicTree& tree, Eigen::MatrixXd coefficients)
    : joint_space_(tree.jointSpace()), tree_name_(tree.name()), variables_(std::move(coefficients)) {
  if (variables_.cols() == 1) variables_.conservativeResizeLike(Eigen::MatrixXd::Zero(variables_.rows(), 2));
  for (JointId j = 0; j < tree.numJoints(); ++j) {
    const int v = tree.quaternionVariable(j);
    if (v < 0) continue;
    const Eigen::Quaterniond start = quaternionAt(variables_.col(0), v);
    const Eigen::Matrix3d R = orthonormal(start.toRotationMatrix());
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) orientations_.push_back(R(i, k));
    }
    starts_.push_back({v, {start.x(), start.y(), start.z(), start.w()}});
    variables_.block<4, 1>(v, 0).setZero();
  }
}

JointMotion JointMotion::linear(const KinematicTree& tree, const Eigen::VectorXd& q0, const Eigen::VectorXd& q1) {
  requireEnd(tree, q0, "q0");
  requireEnd(tree, q1, "q1");
  Eigen::MatrixXd coefficients(q0.size(), 2);
  coefficients << q0, q1 - q0;
  for (JointId j = 0; j < tree.numJoints(); ++j) {
    const int v = tree.quaternionVariable(j);
    if (v < 0) continue;
    const Eigen::Vector3d w = rotationVectorOf(quaternionAt(q1, v) * quaternionAt(q0, v).conjugate());
    coefficients.block<4, 1>(v, 1) << w, 0;
  }
  return {tree, std::move(coefficients)};
}

JointMotion JointMotion::still(const KinematicTree& tree, const Eigen::VectorXd& q) {
  requireEnd(tree, q, "q");
  Eigen::MatrixXd coefficients = Eigen::MatrixXd::Zero(q.size(), 2);
  coefficients.col(0) = q;
  return {tree, std::move(coefficients)};
}

JointMotion JointMotion::shortest(const KinematicTree& tree, const Eigen::VectorXd& q0, const Eigen::VectorXd& q1) {
  JointMotion motion = linear(tree, q0, q1);
  Eigen::Array<bool, Eigen::Dynamic, 1> wrapped(tree.dof());
  for (int v = 0; v < tree.dof(); ++v) {
    double& dq = motion.variables_(v, 1);
    wrapped[v] = turnsForever(tree, v) && std::abs(dq) > kTwoPi / 2;
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

JointMotion JointMotion::polynomial(const KinematicTree& tree, const Eigen::MatrixXd& coefficients) {
  const auto refuse = [&](const std::string& reason) { throw std::invalid_argument("coefficients " + reason); };
  if (coefficients.cols() < 1 || coefficients.cols() > engine::kMaxDegree + 1) {
    refuse("have " + std::to_string(coefficients.cols()) + " columns, not 1 to 6: degrees go up to 5");
  }
  if (coefficients.rows() != tree.dof()) {
    refuse("have " + std::to_string(coefficients.rows()) + " rows, robot '" + tree.name() + "' has " +
           std::to_string(tree.dof()) + " joint values");
  }
  tree.requireConfiguration(coefficients.col(0), "coefficients of t^0");
  for (int v = 0; v < tree.dof(); ++v) {
    if (!coefficients.row(v).allFinite()) refuse("of joint '" + tree.variableName(v) + "' are not finite");
  }
  for (JointId j = 0; j < tree.numJoints(); ++j) {
    const int v = tree.quaternionVariable(j);
    if (v < 0 || coefficients.row(v + 3).tail(coefficients.cols() - 1).isZero(0)) continue;
    refuse("of '" + tree.variableName(v + 3) + "' are not 0 from t^1 on: a quaternion turns by a rotation vector");
  }
  requireSizes(tree, coefficients.cwiseAbs().rowwise().sum(), "coefficients");
  return {tree, coefficients};
}

void JointMotion::refuse(const KinematicTree& tree, const char* what) const {
  if (joint_space_.none()) throw std::invalid_argument(std::string(what) + " has been moved from");
  throw std::invalid_argument(std::string(what) + " was made for robot '" + tree_name_ + "', with " +
                              std::to_string(size()) + " joint values; robot '" + tree.name() + "' has " +
                              std::to_string(tree.dof()) + (size() == tree.dof() ? ", of other joints" : ""));
}

Eigen::VectorXd JointMotion::configuration(double t) const {
  if (joint_space_.none()) throw std::invalid_argument("JointMotion: the motion has been moved from");
  Eigen::VectorXd q = variables_.col(degree());
  for (Eigen::Index k = degree() - 1; k >= 0; --k) q = q * t + variables_.col(k);
  for (const Start& start : starts_) {
    const Eigen::Quaterniond R0(Eigen::Vector4d::Map(start.quaternion));
    const Eigen::Vector3d w = q.segment<3>(start.row);
    q.segment<4>(start.row) = (quaternionOf(w) * R0).coeffs();
  }
  return q;
}

Eigen::MatrixXd JointMotion::coefficients() const {
  Eigen::MatrixXd out = variables_;
  for (const Start& start : starts_) out.block<4, 1>(start.row, 0) = Eigen::Vector4d::Map(start.quaternion);
  return out;
}

}  // namespace fcl_artic
