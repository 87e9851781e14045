// SPDX-License-Identifier: BSD-3-Clause
//
// A joint as a product of moving factors, each of one kind that the engine knows. Their constant transforms are none:
// the joint's origin stands before the first.
#pragma once

#include <vector>

#include "fcl_artic/kinematic_tree.h"
#include "numerics/rotation.h"

namespace fcl_artic {

/// Axes x, y, z of a planar joint in its frame: z is the unit normal, x and y are turned there the shortest way. That
/// is c I + [v]x + v v^T / (1 + c) with v = e_z x normal and c = normal_z; next to -z, where 1 + c cancels, it is |v|^2
/// / (1 - c).
inline Eigen::Matrix3d planeFrame(const Eigen::Vector3d& normal) {
  const double x = -normal.y(), y = normal.x(), c = normal.z(), square = x * x + y * y;
  if (square == 0) return Eigen::Vector3d(1, c < 0 ? -1 : 1, c < 0 ? -1 : 1).asDiagonal();
  const double k = c < 0 ? (1 - c) / square : 1 / (1 + c);
  Eigen::Matrix3d frame;
  frame << c + k * x * x, k * x * y, y, k * x * y, c + k * y * y, -x, -y, x, c;
  return orthonormal(frame);
}

struct JointFactor {
  enum class Kind {
    revolute,   ///< rotation about `axis` by the variable
    prismatic,  ///< translation along `axis` by the variable
    slide,      ///< translation by a vector of three variables
    turn,       ///< the three variables' rotation vector, after the orientation at t = 0: exp([w]) R0
  };
  Kind kind;
  int variable;                                     ///< offset of its first variable from the joint's
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  ///< in the joint's frame
};

/// Factors in the order from parent to child.
inline std::vector<JointFactor> factorsOf(const Joint& joint) {
  using Kind = JointFactor::Kind;
  switch (joint.type) {
    case JointType::fixed:
      return {};
    case JointType::revolute:
    case JointType::continuous:
      return {{Kind::revolute, 0, joint.axis}};
    case JointType::prismatic:
      return {{Kind::prismatic, 0, joint.axis}};
    case JointType::planar: {
      const Eigen::Matrix3d frame = planeFrame(joint.axis);
      return {{Kind::prismatic, 0, frame.col(0)}, {Kind::prismatic, 1, frame.col(1)}, {Kind::revolute, 2, joint.axis}};
    }
    case JointType::spherical:
      return {{Kind::turn, 0}};
    case JointType::floating:
      return {{Kind::slide, 0}, {Kind::turn, 3}};
  }
  return {};
}

/// Number of the joint's quaternion among those of the tree, in the order of the joints.
inline int quaternionNumber(const KinematicTree& tree, JointId joint) {
  int number = 0;
  for (JointId j = 0; j < joint; ++j) number += tree.quaternionVariable(j) >= 0;
  return number;
}

}  // namespace fcl_artic
