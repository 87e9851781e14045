// SPDX-License-Identifier: BSD-3-Clause
#include "motion/link_motion.h"

#include <vector>

#include "kinematics/joint_factors.h"

namespace fcl_artic {

BodyMotion linkMotion(const KinematicTree& tree, const JointMotion& motion, LinkId link, const RigidTransform& offset) {
  using Kind = MotionElement::Kind;
  std::vector<JointId> path;  // from the link up to its root
  for (LinkId l = link; tree.parentJoint(l) >= 0; l = tree.parentLink(l)) path.push_back(tree.parentJoint(l));
  const Eigen::MatrixXd& q = motion.variables();
  BodyMotion chain;
  RigidTransform fixed;
  const auto addElement = [&](Kind kind, const UnitVector& axis) -> MotionElement& {
    MotionElement& element = chain.elements.emplace_back();
    element.kind = kind;
    element.before = fixed;
    element.axis = axis;
    fixed = RigidTransform();
    return element;
  };
  const auto addScalar = [&](Kind kind, const UnitVector& axis, int variable, double factor) {
    addElement(kind, axis).coefficients.row(0).head(q.cols()) = factor * q.row(variable);
  };
  for (auto j = path.rbegin(); j != path.rend(); ++j) {
    const Joint& joint = tree.joint(*j);
    fixed = fixed * originOf(joint);
    for (const JointFactor& factor : factorsOf(joint)) {
      const int v = tree.jointVariable(*j) + factor.variable;
      switch (factor.kind) {
        case JointFactor::Kind::revolute:
        case JointFactor::Kind::prismatic: {
          const Kind kind = factor.kind == JointFactor::Kind::prismatic ? Kind::prismatic : Kind::revolute;
          addScalar(kind, factor.axis, v, joint.mimics ? joint.mimic.multiplier : 1);
          // The offset gets an element of its own: if it were added and the sum cancelled, the error would be far
          // larger than the sum.
          if (joint.mimics && joint.mimic.offset != 0)
            addElement(kind, factor.axis).coefficients(0, 0) = joint.mimic.offset;
          break;
        }
        case JointFactor::Kind::slide:
          for (int k = 0; k < 3; ++k) addScalar(Kind::prismatic, UnitVector::along(k), v + k, 1);
          break;
        case JointFactor::Kind::turn: {  // applied to the orientation at the start
          const Eigen::Vector3d rate = q.block<3, 1>(v, 1);
          if (motion.degree() == 1) {
            const std::optional<UnitVector> axis = UnitVector::within3Ulps(rate);
            if (axis) addElement(Kind::revolute, *axis).coefficients(0, 1) = lengthAlong(*axis, rate);
          } else {
            addElement(Kind::turn, {}).coefficients.leftCols(q.cols()) = q.middleRows<3>(v);
          }
          using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
          const Eigen::Matrix3d R0 = RowMajor::Map(&motion.orientations()[9 * quaternionNumber(tree, *j)]);
          fixed = fixed * RigidTransform(Rotation::within12Ulps(R0, 1e-12).value(), Eigen::Vector3d::Zero());
          break;
        }
      }
    }
  }
  chain.after = fixed * offset;
  return chain;
}

}  // namespace fcl_artic
