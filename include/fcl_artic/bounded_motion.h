// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

#include "fcl_artic/abi.h"
#include "fcl_artic/export.h"

namespace fcl_artic {

/// Base class for motions of your own: it gives queries what they must know of a motion to decide contact along it with
/// proof. All of fcl_artic's queries take a class that derives from fcl::MotionBase<double> (or `float`) and from this
/// one. They refuse any other unknown motion, as nothing can be certified from poses alone.
///
///     class Swing : public fcl::MotionBase<double>, public fcl_artic::BoundedMotion { ... };
///
/// Queries ask this class only and never call FCL's members: integrate() writes to the object, these members must not.
/// They are called from many threads at once, again and again for the same times, and must then say the same.
///
/// Time t runs from 0 to 1; vectors are in world axes; derivatives are by t. Numbers may be off by rounding, by at most
/// 5e-13: in the entries of a rotation (which must be proper to 1e-12), and in the length of each vector.
class FCL_ARTIC_EXPORT BoundedMotion {
 public:
  /// Pose of the geometry's frame in the world and its derivatives by t, at one time.
  struct State {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();          ///< Pose of the frame in the world, m.
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();              ///< Velocity of its origin, m per unit of t.
    Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();          ///< Acceleration of its origin, m per unit of t^2.
    Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();      ///< Angular velocity, rad per unit of t.
    Eigen::Vector3d angular_acceleration = Eigen::Vector3d::Zero();  ///< Its derivative, rad per unit of t^2.
  };
  /// Upper bounds on lengths of vectors over an interval of time; finite, at least 0.
  struct Bounds {
    /// Bounds on the first three derivatives of the frame's origin: m per unit of t, t^2, t^3.
    double speed = 0, acceleration = 0, jerk = 0;
    /// Bounds on the angular velocity and its first two derivatives: rad per unit of t, t^2, t^3.
    double angular_speed = 0, angular_acceleration = 0, angular_jerk = 0;
  };

  /// Allows destruction through this class.
  virtual ~BoundedMotion() = default;

  /// Returns the state at t in [0, 1].
  virtual State state(double t) const = 0;
  /// Returns bounds that hold for every t in [begin, end], 0 <= begin <= end <= 1. The promise of every answer rests on
  /// them: with a bound that is too small a contact can be missed. One set of bounds that holds for all of [0, 1] is
  /// enough; tighter ones for short intervals make answers faster.
  virtual Bounds bounds(double begin, double end) const = 0;
  /// Whether derivatives are known. If false, only poses and the bounds on speed and angular speed are used; the rest
  /// of state() is not looked at, and the other bounds stay 0. The proof then takes shorter steps. A near miss costs
  /// in proportion to way / gap (two meshes that pass at 1 um, half a second). Contacts may remain undecided at fine
  /// tolerances.
  virtual bool hasDerivatives() const { return true; }
};

}  // namespace fcl_artic
