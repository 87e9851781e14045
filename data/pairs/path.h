// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <memory>
#include <string>

#include <fcl/math/motion/motion_base.h>

#include "pairs/body.h"

namespace pairs {

using Real = long double;
template <class R>
using Vec = Eigen::Matrix<R, 3, 1>;
template <class R>
using Mat = Eigen::Matrix<R, 3, 3>;

/// Pose of a body's frame in the world.
template <class R>
struct PoseOf {
  Mat<R> rotation = Mat<R>::Identity();
  Vec<R> position = Vec<R>::Zero();

  Vec<R> operator*(const Vec<R>& x) const { return rotation * x + position; }
  template <class To>
  PoseOf<To> cast() const {
    return {rotation.template cast<To>(), position.template cast<To>()};
  }
};
using Pose = PoseOf<Real>;

/// Rotation by the vector's length about its direction.
Mat<Real> rotationBy(const Vec<Real>& vector);

/// A body's motion over t in [0, 1], with more digits than FCL's and formulas of its own.
class Path {
 public:
  virtual ~Path() = default;
  virtual std::string name() const = 0;
  virtual Pose pose(double t) const = 0;
  /// No point within `radius` of the frame's origin moves faster, per unit of t.
  virtual double speed(double radius) const = 0;
  /// The frame's origin stays within this of the world's.
  virtual double extent() const = 0;
  /// The same motion for FCL, at t = 0.
  virtual std::shared_ptr<fcl::MotionBased> motion() const = 0;
  /// The motion moved by `offset`, in world axes.
  virtual std::shared_ptr<const Path> shifted(const Vec3& offset) const = 0;
};
using PathPtr = std::shared_ptr<const Path>;

struct Ends {
  Eigen::Matrix3d R1 = Eigen::Matrix3d::Identity(), R2 = Eigen::Matrix3d::Identity();
  Vec3 T1 = Vec3::Zero(), T2 = Vec3::Zero();
};
/// fcl::TranslationMotion: the rotation stays that of the start.
PathPtr translationPath(const Ends& ends);
/// fcl::InterpMotion by its constructor with a reference point, the only sound one.
PathPtr interpPath(const Ends& ends, const Vec3& reference);
/// fcl::ScrewMotion. The rotation must not be smaller than 1e-6 rad.
PathPtr screwPath(const Ends& ends);
/// fcl::SplineMotion by control points of position and rotation vector.
PathPtr splinePath(const std::array<Vec3, 4>& positions, const std::array<Vec3, 4>& rotations);

}  // namespace pairs
