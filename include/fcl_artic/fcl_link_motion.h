// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include <fcl/math/motion/motion_base.h>

#include "fcl_artic/abi.h"
#include "fcl_artic/joint_motion.h"

namespace fcl_artic {

struct BodyMotion;

/// Motion of a geometry that is fixed to one link, as FCL's motion type. It lets FCL's own conservative advancement
/// and naive stepping run on exactly the motion of a certified query. This library's queries take it too.
///
/// Trust only one routine of FCL's advancement, the oriented one for meshes:
/// `fcl::detail::conservativeAdvancementMeshOriented` on RSS or OBBRSS. The public entry loses most mesh contacts
/// whatever the motion. Two habits of FCL to know:
/// - advancement starts from the state that integrate() left, so call integrate(0) before each query;
/// - integrate() is const but writes that state: give each thread its own copy. pose(), speedBound() and
///   accelerationBound() touch no state.
class FCL_ARTIC_EXPORT FclLinkMotion : public fcl::MotionBased {
 public:
  /// Copies what it needs of tree and motion; starts at t = 0.
  /// @param motion  of degree 1: joints at constant speed, as JointMotion::linear() makes it.
  /// @param offset  pose of the geometry's frame in the link's frame, rigid to 1e-9; its rotation is made orthonormal.
  /// @throws std::out_of_range for an unknown link.
  /// @throws std::invalid_argument if the motion is not one of this tree or of a higher degree, or for an offset that
  ///   is not rigid or farther than 1e9 m away.
  FclLinkMotion(const KinematicTree& tree, const JointMotion& motion, LinkId link,
                const Eigen::Isometry3d& offset = Eigen::Isometry3d::Identity());
  /// Copies a motion with its state; there is no move that would leave one without.
  FclLinkMotion(const FclLinkMotion&) = default;
  /// Copies a motion with its state.
  FclLinkMotion& operator=(const FclLinkMotion&) = default;

  /// Returns the pose of the geometry in the world at t in [0, 1].
  Eigen::Isometry3d pose(double t) const;

  /// Returns a bound on |x'(t)| over [0, 1], in m per unit of t, for every point x within `radius` (m) of the geometry
  /// frame's origin. Not rounded outward, as all bounds of this class: FCL's advancement proves nothing anyway.
  double speedBound(double radius) const;
  /// Returns a bound on |x''(t)| over [0, 1], in m per unit of t squared, for the same points as speedBound().
  double accelerationBound(double radius) const;

  /// FCL's overload that returns the rotation and the translation of the current state.
  using fcl::MotionBased::getCurrentTransform;

  /// Moves the state to time t, clamped to [0, 1]. Always returns true.
  bool integrate(double t) const override;
  /// Writes the pose of the geometry in the world at the time of the last integrate().
  void getCurrentTransform(fcl::Transform3d& M_0g) const override;

  /// Returns a bound, in m per unit of t, on the displacement of the visitor's bounding volume along the visitor's
  /// direction over the rest of the motion.
  /// @throws std::invalid_argument for bounding volumes other than RSS and OBBRSS: FCL's oriented routine knows no
  ///   other, and a number made up for them could let a contact pass.
  double computeMotionBound(const fcl::BVMotionBoundVisitor<double>& visitor) const override;
  /// Returns a bound, in m per unit of t, on the displacement of the visitor's triangle along the visitor's direction
  /// over the rest of the motion.
  double computeMotionBound(const fcl::TriangleMotionBoundVisitor<double>& visitor) const override;

  /// Writes a Taylor model: a constant with a remainder that holds for all of [0, 1]. It makes
  /// fcl::ContinuousCollisionObjectd::computeAABB() give a box that contains the motion (wide for long motions); FCL's
  /// own trigonometric Taylor models don't.
  void getTaylorModel(fcl::TMatrix3<double>& R, fcl::TVector3<double>& T) const override;

 private:
  /// Pose and velocity field at one time: the point x of the world moves with velocity + angular x x.
  struct State {
    double t = 0;
    Eigen::Isometry3d M_0g = Eigen::Isometry3d::Identity();
    Eigen::Vector3d angular = Eigen::Vector3d::Zero();
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  };

  friend const BodyMotion& bodyMotion(const FclLinkMotion& motion);  ///< as the library's own queries see it

  State stateAt(double t) const;
  double directedBound(const Eigen::Vector3d* points_g, int count, double radius, const Eigen::Vector3d& n) const;

  /// The moving joints of the link's chain, each with the fixed ones before it; copies share it.
  std::shared_ptr<const BodyMotion> chain_;
  double angle_ = 0;  ///< bound on the angular speed, rad per unit of t
  double speed_ = 0;  ///< bounds for the geometry frame's origin
  double acceleration_ = 0;
  mutable State state_;
};

}  // namespace fcl_artic
