// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <fcl/math/motion/motion_base.h>

#include "fcl_artic/joint_motion.h"

namespace fcl_artic {

struct BodyMotion;

/// Motion of a geometry that is fixed to one link, as FCL's motion type: FCL's own conservative advancement, and its
/// naive stepping, then run on exactly the motion of a certified query.
///
/// Trust FCL's oriented routine for meshes only, `fcl::detail::conservativeAdvancementMeshOriented` on RSS or OBBRSS;
/// the public entry loses most mesh contacts whatever the motion. Two habits of FCL to know:
/// - advancement starts from the state that integrate() left behind, so call integrate(0) before each query;
/// - integrate() is const but writes that state: give each thread its own copy. pose(), speedBound() and
///   accelerationBound() touch no state.
class FCL_ARTIC_EXPORT FclLinkMotion : public fcl::MotionBased {
 public:
  /// Copies what it needs of tree and motion; starts at t = 0.
  /// @param offset  geometry frame in the link's frame, rigid.
  /// @throws std::out_of_range for an unknown link.
  /// @throws std::invalid_argument when the motion is not one of this tree, or for an offset that is not rigid.
  FclLinkMotion(const KinematicTree& tree, const JointMotion& motion, LinkId link,
                const Eigen::Isometry3d& offset = Eigen::Isometry3d::Identity());

  /// Pose of the geometry in the world at t in [0, 1].
  Eigen::Isometry3d pose(double t) const;

  /// Bounds |x'(t)|, in m per unit of t, over [0, 1] for every point x within `radius` of the geometry frame's origin.
  double speedBound(double radius) const;
  /// Bounds |x''(t)|, in m per unit of t squared, for the same points.
  double accelerationBound(double radius) const;

  using fcl::MotionBased::getCurrentTransform;

  /// Goes to time t, clamped to [0, 1]. Always true.
  bool integrate(double t) const override;
  void getCurrentTransform(fcl::Transform3d& M_0g) const override;

  /// Bounds the displacement along the visitor's direction over the rest of the motion, per unit of t.
  /// @throws std::invalid_argument for bounding volumes other than RSS and OBBRSS: FCL's oriented routine knows no
  ///   other, and a number made up for them could let a contact pass.
  double computeMotionBound(const fcl::BVMotionBoundVisitor<double>& visitor) const override;
  double computeMotionBound(const fcl::TriangleMotionBoundVisitor<double>& visitor) const override;

  /// A constant with a remainder that holds for all of [0, 1]: fcl::ContinuousCollisionObjectd::computeAABB() then
  /// gives a box that contains the motion (wide for long motions). FCL's own trigonometric Taylor models don't.
  void getTaylorModel(fcl::TMatrix3<double>& R, fcl::TVector3<double>& T) const override;

 private:
  /// A moving joint of the link's chain, with the fixed ones before it merged into its origin.
  struct Step {
    Eigen::Isometry3d origin;
    Eigen::Vector3d axis;
    bool prismatic;
    double q0, rate;  ///< q(t) = q0 + t * rate
  };
  /// Pose and velocity field at one time: the point x of the world moves with velocity + angular x x.
  struct State {
    double t = 0;
    Eigen::Isometry3d M_0g = Eigen::Isometry3d::Identity();
    Eigen::Vector3d angular = Eigen::Vector3d::Zero();
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  };

  friend BodyMotion bodyMotion(const FclLinkMotion& motion);  ///< as the library's own queries see it

  State stateAt(double t) const;
  double directedBound(const Eigen::Vector3d* points_g, int count, double radius, const Eigen::Vector3d& n) const;

  std::vector<Step> chain_;
  Eigen::Isometry3d tail_;  ///< geometry frame in the last moving joint's frame
  double angle_ = 0;        ///< bound on the angular speed, rad per unit of t
  double speed_ = 0;        ///< bounds for the geometry frame's origin
  double acceleration_ = 0;
  mutable State state_;
};

}  // namespace fcl_artic
