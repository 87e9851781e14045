// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

#include "fcl_artic/export.h"

namespace fcl_artic {

/// What a motion of one's own has to tell of itself, so that contact along it can be decided with proof. A class that
/// derives from fcl::MotionBase<double> and from this one is taken by all of fcl_artic's queries; any other unknown motion is
/// refused, as nothing can be certified from poses alone.
///
/// Time t runs from 0 to 1; vectors are in world axes; derivatives are by t. All members must be const in earnest: they are
/// called from many threads at once. Rotations must be proper to rounding (1e-12).
class FCL_ARTIC_EXPORT BoundedMotion {
 public:
  struct State {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();         ///< of the geometry's frame in the world
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();             ///< of that frame's origin
    Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();
    Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();
    Eigen::Vector3d angular_acceleration = Eigen::Vector3d::Zero();
  };
  /// Upper bounds on lengths over an interval of time: of the derivatives of the frame's origin, and of the angular velocity and
  /// its derivatives.
  struct Bounds {
    double speed = 0, acceleration = 0, jerk = 0;
    double angular_speed = 0, angular_acceleration = 0, angular_jerk = 0;
  };

  virtual ~BoundedMotion() = default;

  /// The state at t in [0, 1].
  virtual State state(double t) const = 0;
  /// Bounds that hold for every t in [begin, end]. The promise of every answer rests on them.
  virtual Bounds bounds(double begin, double end) const = 0;
  /// False: only poses and the bounds on speed and angular speed are known; the proof then takes shorter steps.
  virtual bool hasDerivatives() const { return true; }
};

}  // namespace fcl_artic
