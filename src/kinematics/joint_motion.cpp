// SPDX-License-Identifier: BSD-3-Clause
#include "fcl_artic/joint_motion.h"

#include <cmath>
#include <stdexcept>
#include <utility>

#include "kinematics/angles.h"
#include "kinematics/exact_motion.h"
#include "kinematics/largest_joint_value.h"
#include "kinematics/rotation_vector.h"
#include "model/sweep.h"
#include "numerics/rotation.h"
#include "numerics/shown.h"

namespace fcl_artic {
namespace {

Eigen::Quaterniond quaternionAt(const Eigen::Ref<const Eigen::VectorXd>& q, int v) {
  return Eigen::Quaterniond(Eigen::Vector4d(q.segment<4>(v))).normalized();
}

/// Adds the rows of an orientation.
void addRowsOf(const Eigen::Quaterniond& orientation, std::vector<double>& rows) {
  const Eigen::Matrix3d R = Rotation::within12Ulps(orientation.toRotationMatrix(), 1e-12).value();
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) rows.push_back(R(i, k));
  }
}

/// Refuses values beyond 1e5. A mimic joint's multiple and offset may cancel, so the sum of their sizes counts.
/// @param sizes  of each variable, sums of absolute numbers.
void requireSizes(const KinematicTree& tree, const Eigen::VectorXd& sizes, const std::string& what) {
  const auto refuse = [&](const std::string& size, const std::string& joint) {
    throw std::invalid_argument(what + ": " + size + " of joint '" + joint + "' is beyond 1e5");
  };
  for (int v = 0; v < tree.dof(); ++v) {
    if (!(sizes[v] <= kLargestJointValue)) refuse("the value " + shown(sizes[v]), tree.variableName(v));
  }
  for (const JointId j : tree.mimicJoints()) {
    const Joint& joint = tree.joint(j);
    const double multiple = std::abs(joint.mimic.multiplier) * sizes[tree.jointVariable(j)];
    if (multiple + std::abs(joint.mimic.offset) <= kLargestJointValue) continue;
    refuse("the sum of the multiple " + shown(multiple) + " and the offset " + shown(std::abs(joint.mimic.offset)),
           joint.name);
  }
}

void requireEnd(const KinematicTree& tree, const Eigen::VectorXd& q, const std::string& what) {
  tree.requireConfiguration(q, what);
  requireSizes(tree, q.cwiseAbs(), what);
}

/// The references of a tangent half-angle law: those given, or 0.
Eigen::VectorXd referencesOf(const KinematicTree& tree, const Eigen::VectorXd& reference) {
  if (reference.size() == 0) return Eigen::VectorXd::Zero(tree.dof());
  if (reference.size() != tree.dof()) {
    throw std::invalid_argument("reference has " + std::to_string(reference.size()) + " entries, robot '" +
                                tree.name() + "' has " + std::to_string(tree.dof()));
  }
  for (int v = 0; v < tree.dof(); ++v) {
    if (std::abs(reference[v]) <= kLargestJointValue) continue;
    throw std::invalid_argument("reference: the value " + shown(reference[v]) + " of joint '" + tree.variableName(v) +
                                "' is beyond 1e5 or not finite");
  }
  return reference;
}

/// tan(angle / 2) of an angle that is less than half a turn.
double tangentOfHalf(const KinematicTree& tree, int v, double q, double reference, const char* what) {
  const double angle = q - reference, s = std::tan(angle / 2);
  if (std::abs(angle) < kTwoPi / 2 && std::abs(s) <= kLargestJointValue) return s;
  throw std::invalid_argument(
      std::string(what) + ": joint '" + tree.variableName(v) + "' at " + shown(q) + " is " + shown(angle) +
      " rad from its reference: a tangent half-angle law reaches less than pi, " + "by at least 2e-5");
}

bool turnsForever(const KinematicTree& tree, int v) {
  const JointType type = tree.joint(tree.variableJoint(v)).type;
  return type == JointType::continuous || (type == JointType::planar && tree.isAngle(v));
}

}  // namespace

JointMotion::JointMotion(const KinematicTree& tree, Eigen::MatrixXd coefficients)
    : joint_space_(tree.jointSpace()), tree_name_(tree.name()), variables_(std::move(coefficients)) {
  if (variables_.cols() == 1) variables_.conservativeResizeLike(Eigen::MatrixXd::Zero(variables_.rows(), 2));
  for (const JointId j : tree.quaternionJoints()) {
    const int v = tree.quaternionVariable(j);
    const Eigen::Quaterniond start = quaternionAt(variables_.col(0), v);
    addRowsOf(start, orientations_);
    starts_.push_back({v, {start.x(), start.y(), start.z(), start.w()}});
    variables_.block<4, 1>(v, 0).setZero();
  }
}

JointMotion ExactMotion::motion(const KinematicTree& tree, const Eigen::MatrixXd& coefficients,
                                const Eigen::VectorXd& references) {
  JointMotion motion = references.size() == 0 ? JointMotion::polynomial(tree, coefficients)
                                              : JointMotion::tangentHalfAnglePolynomial(tree, coefficients, references);
  motion.orientations_.clear();
  for (JointMotion::Start& start : motion.starts_) {
    const Eigen::Vector4d given = coefficients.block<4, 1>(start.row, 0);
    // With u = 2^-52, in any rounding mode: a computed square is off by 4u, its root by 3u, a quotient by u more. So
    // the length of a normalised quaternion is off by 4u, its square by 8u, and by 12u as computed.
    if (std::abs(given.squaredNorm() - 1) <= 12 * 0x1p-52) Eigen::Vector4d::Map(start.quaternion) = given;
    addRowsOf(Eigen::Quaterniond(Eigen::Vector4d(Eigen::Vector4d::Map(start.quaternion))), motion.orientations_);
  }
  return motion;
}

JointMotion JointMotion::linear(const KinematicTree& tree, const Eigen::VectorXd& q0, const Eigen::VectorXd& q1) {
  requireEnd(tree, q0, "q0");
  requireEnd(tree, q1, "q1");
  Eigen::MatrixXd coefficients(q0.size(), 2);
  coefficients << q0, q1 - q0;
  for (const JointId j : tree.quaternionJoints()) {
    const int v = tree.quaternionVariable(j);
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
    if (m == 0 || (turns && m == std::round(m))) continue;  // whole turns of its master turn this joint by whole turns
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
  for (const JointId j : tree.quaternionJoints()) {
    const int v = tree.quaternionVariable(j);
    if (coefficients.row(v + 3).tail(coefficients.cols() - 1).isZero(0)) continue;
    refuse("of '" + tree.variableName(v + 3) + "' are not 0 from t^1 on: a quaternion turns by a rotation vector");
  }
  requireSizes(tree, coefficients.cwiseAbs().rowwise().sum(), "coefficients");
  return {tree, coefficients};
}

JointMotion JointMotion::tangentHalfAngle(const KinematicTree& tree, const Eigen::VectorXd& q0,
                                          const Eigen::VectorXd& q1, const Eigen::VectorXd& reference) {
  JointMotion motion = linear(tree, q0, q1);
  const Eigen::VectorXd references = referencesOf(tree, reference);
  for (int v = 0; v < tree.dof(); ++v) {
    if (!tree.isAngle(v)) continue;
    const double s0 = tangentOfHalf(tree, v, q0[v], references[v], "q0");
    const double s1 = tangentOfHalf(tree, v, q1[v], references[v], "q1");
    motion.variables_.row(v) << s0, s1 - s0;
  }
  motion.goByHalfAngles(tree, references);
  return motion;
}

JointMotion JointMotion::tangentHalfAnglePolynomial(const KinematicTree& tree, const Eigen::MatrixXd& coefficients,
                                                    const Eigen::VectorXd& reference) {
  JointMotion motion = polynomial(tree, coefficients);
  motion.goByHalfAngles(tree, referencesOf(tree, reference));
  return motion;
}

/// The checks of polynomials hold for mimic joints' angles too: an angle is within pi of its reference.
void JointMotion::goByHalfAngles(const KinematicTree& tree, const Eigen::VectorXd& reference) {
  half_angles_.assign(static_cast<std::size_t>(tree.dof()), 0);
  references_.setZero(tree.dof());
  Eigen::VectorXd sizes = variables_.cwiseAbs().rowwise().sum();
  for (int v = 0; v < tree.dof(); ++v) {
    if (!tree.isAngle(v)) continue;
    if (!(sizes[v] <= kLargestJointValue)) {
      throw std::invalid_argument("the coefficients of the tangent of half the angle of joint '" +
                                  tree.variableName(v) + "' sum to " + shown(sizes[v]) + ", beyond 1e5");
    }
    half_angles_[static_cast<std::size_t>(v)] = 1;
    references_[v] = reference[v];
    sizes[v] = std::abs(reference[v]) + kTwoPi / 2;
  }
  requireSizes(tree, sizes, "reference");
  // The bounds of such a law change with time, as those of polynomials of degree 2 and more: so it is stored with that
  // degree.
  const Eigen::Index columns = variables_.cols();
  if (columns < 3) {
    variables_.conservativeResize(Eigen::NoChange, 3);
    variables_.rightCols(3 - columns).setZero();
  }
}

void JointMotion::requirePolynomial(const char* who) const {
  if (isPolynomial()) return;
  throw std::invalid_argument(std::string(who) + ": the motion's angles go by a tangent half-angle law, not by " +
                              "polynomials of time; motions by linear() and polynomial() are taken");
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
  for (std::size_t v = 0; v < half_angles_.size(); ++v) {
    const auto row = static_cast<Eigen::Index>(v);
    if (half_angles_[v]) q[row] = references_[row] + 2 * std::atan(q[row]);
  }
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
