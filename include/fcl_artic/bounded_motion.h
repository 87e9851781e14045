// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

#include "fcl_artic/export.h"

namespace fcl_artic {

/// What a motion of one's own has to tell of itself, so that contact along it can be decided with proof. A class that
/// derives from fcl::MotionBase<double> (or <float>) and from this one is taken by all of fcl_artic's queries; any
/// other unknown motion is refused, as nothing can be certified from poses alone.
///
///     class Swing : public fcl::MotionBase<double>, public fcl_artic::BoundedMotion { ... };
///
/// Queries ask this class only and never call FCL's members: integrate() writes to the object, these members must not.
/// They are called from many threads at once, again and again for the same times, and must then say the same.
///
/// Time t runs from 0 to 1; vectors are in world axes; derivatives are by t. Numbers may be off by rounding, of at most
/// 5e-13: in a rotation's entries (and it must be proper to 1e-12), and of the length of each vector.
class FCL_ARTIC_EXPORT BoundedMotion {
 public:
  struct State {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();          ///< of the geometry's frame in the world
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();              ///< of that frame's origin
    Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();          ///< of that frame's origin
    Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();      ///< rad
    Eigen::Vector3d angular_acceleration = Eigen::Vector3d::Zero();  ///< rad
  };
  /// Upper bounds, finite and not below 0, on lengths over an interval of time: of the first three derivatives of the
  /// frame's origin, and of the angular velocity and its first two derivatives.
  struct Bounds {
    double speed = 0, acceleration = 0, jerk = 0;
    double angular_speed = 0, angular_acceleration = 0, angular_jerk = 0;
  };

  virtual ~BoundedMotion() = default;

  /// The state at t in [0, 1].
  virtual State state(double t) const = 0;
  /// Bounds that hold for every t in [begin, end], 0 <= begin <= end <= 1. The promise of every answer rests on them:
  /// with a bound that is too small a contact can be missed. One set of bounds that holds for all of [0, 1] will do;
  /// tighter ones for short intervals make answers faster, and never need to be the tightest.
  virtual Bounds bounds(double begin, double end) const = 0;
  /// False: only poses and the bounds on speed and angular speed are known. What else state() says is not looked at,
  /// and the other bounds stay 0. The proof then takes shorter steps, and contacts may remain undecided at fine
  /// tolerances.
  virtual bool hasDerivatives() const { return true; }
};

}  // namespace fcl_artic
