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
/// is c I + [v]x + v v^T / (1 + c) with v = e_z x normal and c = normal_z; below, where 1 + c cancels, v v^T / (1 + c)
/// is (1 - c) w w^T with w the unit vector along v, however short v is. About -z itself it turns over x.
inline Rotation planeFrame(const UnitVector& normal) {
  const double c = normal[2];
  Eigen::Vector3d v(-normal[1], normal[0], 0), w = v;  // [v]x + k w w^T
  double k = 1 / (1 + c);
  if (c < 0) {
    const std::optional<UnitVector> across = UnitVector::within3Ulps(v);
    w = across ? across->vector() : Eigen::Vector3d(Eigen::Vector3d::UnitX());
    k = 1 - c;
  }
  const double x = w[0], y = w[1];
  Eigen::Matrix3d frame;
  frame << c + k * x * x, k * x * y, v[1], k * x * y, c + k * y * y, -v[0], -v[1], v[0], c;
  return Rotation::within12Ulps(frame, 1e-13).value();
}

/// How far R^T R of a joint's origin may be from the identity, in each entry; it is made orthonormal then.
constexpr double kOriginDefect = 1e-9;

/// The origin of a tree's joint.
inline RigidTransform originOf(const Joint& joint) {
  return RigidTransform::within12Ulps(joint.origin, kOriginDefect).value();
}

struct JointFactor {
  enum class Kind {
    revolute,   ///< rotation about `axis` by the variable
    prismatic,  ///< translation along `axis` by the variable
    slide,      ///< translation by a vector of three variables
    turn,       ///< the three variables' rotation vector, after the orientation at t = 0: exp([w]) R0
  };
  Kind kind;
  int variable;     ///< offset of its first variable from the joint's
  UnitVector axis;  ///< in the joint's frame
};

/// The axis of a tree's joint.
inline UnitVector axisOf(const Joint& joint) {
  return UnitVector::within3Ulps(joint.axis).value();
}

/// Factors in the order from parent to child, of a tree's joint.
inline std::vector<JointFactor> factorsOf(const Joint& joint) {
  using Kind = JointFactor::Kind;
  switch (joint.type) {
    case JointType::fixed:
      return {};
    case JointType::revolute:
    case JointType::continuous:
      return {{Kind::revolute, 0, axisOf(joint)}};
    case JointType::prismatic:
      return {{Kind::prismatic, 0, axisOf(joint)}};
    case JointType::planar: {
      const UnitVector normal = axisOf(joint);
      const Eigen::Matrix3d frame = planeFrame(normal);
      return {{Kind::prismatic, 0, UnitVector::within3Ulps(frame.col(0)).value()},
              {Kind::prismatic, 1, UnitVector::within3Ulps(frame.col(1)).value()},
              {Kind::revolute, 2, normal}};
    }
    case JointType::spherical:
      return {{Kind::turn, 0, {}}};
    case JointType::floating:
      return {{Kind::slide, 0, {}}, {Kind::turn, 3, {}}};
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
