// SPDX-License-Identifier: BSD-3-Clause
//
// How far the real robot and its scene may be from the model. A manager with tolerances answers for every path within
// them (doc/PROMISE.md, "Tolerances").
#pragma once

#include <Eigen/Geometry>

namespace fcl_artic {

/// How far a joint may be from the value that the motion gives it, at each time. Both numbers are finite and at
/// least 0.
struct JointTolerance {
  /// rad: the angle of a joint that turns. A spherical or floating joint may be turned by it about any axis.
  double angle = 0;
  /// m: the length of a joint that slides. The origin of a planar or floating joint may be off by it in any direction.
  double length = 0;

  /// Whether one of both is above 0.
  bool any() const { return angle > 0 || length > 0; }
};

/// How far an object may be from the pose that it is said to have. It may be turned by at most `angle` about a fixed
/// point, around any axis, and then moved by at most `length`. The numbers are finite, the first two at least 0.
struct PoseTolerance {
  double length = 0;                                ///< m
  double angle = 0;                                 ///< rad
  Eigen::Vector3d pivot = Eigen::Vector3d::Zero();  ///< The fixed point, in the object's own frame, m.

  /// Whether angle or length is above 0.
  bool any() const { return angle > 0 || length > 0; }
};

/// How fast an object may move by itself, in any direction and along any path, as a person does.
struct ObjectSpeed {
  /// m per unit of the motion's time, finite, at least 0. A trajectory's unit is mostly a second; a JointMotion, and a
  /// query at one configuration, take 1 unit.
  double speed = 0;
  /// Time from which on it may move, after the motion's begin; finite. Negative: it was seen so long before.
  double since = 0;
};

/// A contact within the tolerances: what is off, and by how much. At the time of the contact's t_upper the two bodies
/// are proven in contact there.
struct ToleranceWitness {
  /// Joint values within the joints' tolerances of the motion's, rad or m; KinematicTree::dof() of them. They are the
  /// motion's own if the bodies touch at these. Empty if the contact is not certain, and without tolerances.
  Eigen::VectorXd q_witness;
  /// Where the robot's base is, within its tolerance: a link whose pose in the world is M_0i at q_witness stands at
  /// base_deviation * M_0i, m. The identity if it is in its place.
  Eigen::Isometry3d base_deviation = Eigen::Isometry3d::Identity();
  /// Where body 1 and body 2 are, each in the frame of its geometry: one whose pose is M stands at M * deviation, m. It
  /// is within the object's pose tolerance and the way that its speed lets it go until then. The identity if the body
  /// is in its place, and for geometry of a link. (A rotation is the proper one next to the nine numbers. By their
  /// rounding alone a pivot may be off its place.)
  Eigen::Isometry3d deviation1 = Eigen::Isometry3d::Identity(), deviation2 = Eigen::Isometry3d::Identity();
};

}  // namespace fcl_artic
