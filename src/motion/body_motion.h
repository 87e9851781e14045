// SPDX-License-Identifier: BSD-3-Clause
//
// The motion of one rigid body as plain data: what every kind of motion, FCL's included, is read into.
#pragma once

#include <Eigen/Geometry>

#include "fcl_artic/bounded_motion.h"
#include "motion/element_list.h"
#include "numerics/rotation.h"

namespace fcl_artic {

/// Highest power of t in a motion's polynomials (a quintic).
constexpr int kMaxDegree = 5;

/// A constant transform, then one moving factor E(t), t in [0, 1], whose parameter is a polynomial of time.
struct MotionElement {
  enum class Kind {
    revolute,   ///< rotation about `axis` by q(t), rad
    prismatic,  ///< translation along `axis` by q(t), m
    slide,      ///< translation by the vector q(t), m
    turn,       ///< rotation exp([q(t)]) by the rotation vector q(t), rad
    bounded,    ///< what its author says (BoundedMotion); the only element of its motion
  };
  Kind kind = Kind::slide;
  RigidTransform before;
  UnitVector axis;
  /// Column k belongs to t^k; revolute and prismatic: row 0 only.
  Eigen::Matrix<double, 3, kMaxDegree + 1> coefficients = Eigen::Matrix<double, 3, kMaxDegree + 1>::Zero();
  const BoundedMotion* bounded = nullptr;  ///< of the caller's

  int degree() const;  ///< largest k with a coefficient that is not 0
};

/// M_0g(t) = before_1 E_1(t) before_2 E_2(t) ... E_m(t) after: from the geometry's frame to the world.
struct BodyMotion {
  ElementList<MotionElement, 2> elements;  ///< from the world on; empty: stands still
  RigidTransform after;

  /// Pose of the geometry's frame in the world at t in [0, 1], in doubles.
  Eigen::Isometry3d pose(double t) const;
  /// The same with its error.
  RigidTransform poseWithError(double t) const;
};

/// The known bounds of all points of a body over [0, 1].
struct PathBounds {
  double speed = 0, acceleration = 0;  ///< D1, D2
  double angular_speed = 0;            ///< of the body, rad per unit of t
  double terms = 0;                    ///< lengths that poses are summed from
  double ulps = 0;                     ///< error of a pose's rotation in 2^-52; of positions in 2^-52 * terms
  double extent = 0;                   ///< no path is much longer across (only for the choice of K)
};
/// @param reach  largest distance of the body's points from the frame that `after` leads from.
PathBounds boundPath(const BodyMotion& motion, double reach);
/// Upper bound of the distance of a box's points from the frame that `after` leads from; infinite if the box is.
/// @param lower, upper  in the geometry's frame.
double reachOf(const BodyMotion& motion, const Eigen::Vector3d& lower, const Eigen::Vector3d& upper);

/// A direction fixed in a body, as its motion has it in the world.
struct Heading {
  Eigen::Vector3d direction;  ///< at t = 0
  double deviation;           ///< bound on |direction at t - direction at 0| for t in [0, 1]
  double author = 0;          ///< what the poses of bounded motions on the way may be off by, as their authors may be
  bool analytic = true;       ///< no bounded motion is on the way: what moves at all does not stand still for a while
};
/// @param own  in the geometry's frame.
Heading headingOf(const BodyMotion& motion, const UnitVector& own);

/// Box in the world that certainly holds a body over all of the motion, rounding included.
/// @param lower, upper  box of the body in its own frame; infinite where it is unbounded.
void enclosePath(const BodyMotion& motion, const Eigen::Vector3d& lower, const Eigen::Vector3d& upper,
                 Eigen::Vector3d& path_lower, Eigen::Vector3d& path_upper);

}  // namespace fcl_artic
