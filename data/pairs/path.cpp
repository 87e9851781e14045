// SPDX-License-Identifier: BSD-3-Clause
#include "pairs/path.h"

#include <algorithm>
#include <cmath>

#include <fcl/math/motion/interp_motion.h>
#include <fcl/math/motion/screw_motion.h>
#include <fcl/math/motion/spline_motion.h>
#include <fcl/math/motion/translation_motion.h>

namespace pairs {
namespace {

Vec<Real> real(const Vec3& v) {
  return v.cast<Real>();
}

/// c(t) = start + velocity t + D(t) arm and R(t) = D(t) R1 with D(t) = exp(t angle axis): all motions of FCL that turn
/// evenly, each with the numbers that the FCL object holds, its roundings included.
struct Twist {
  Vec<Real> axis = Vec<Real>::UnitX();
  Real angle = 0;
  Vec<Real> start, velocity, arm;
};

class TwistPath : public Path {
 public:
  enum class Type { translation, interp, screw };
  TwistPath(Type type, const Ends& ends, const Vec3& reference) : type_(type), ends_(ends), reference_(reference) {
    switch (type_) {
      case Type::translation:
        twist_ = {Vec<Real>::UnitX(), 0, real(ends.T1), real(ends.T2 - ends.T1), Vec<Real>::Zero()};
        break;
      case Type::interp: {
        const auto m = interp();
        const Vec<Real> arm = ends.R1.cast<Real>() * real(m.getReferencePoint());
        twist_ = {real(m.getAngularAxis()), m.getAngularVelocity(), real(ends.T1) + arm, real(m.getLinearVelocity()),
                  -arm};
        break;
      }
      case Type::screw: {
        const auto m = screw();
        const Vec<Real> origin = real(m.getAxisOrigin()), axis = real(m.getAxis());
        twist_ = {axis, m.getAngularVelocity(), origin, Real(m.getLinearVelocity()) * axis, real(ends.T1) - origin};
        break;
      }
    }
  }

  std::string name() const override {
    return type_ == Type::translation ? "translation" : type_ == Type::interp ? "interp" : "screw";
  }
  Pose pose(double t) const override {
    const Mat<Real> D = rotationBy(twist_.axis * (twist_.angle * Real(t)));
    return {D * ends_.R1.cast<Real>(), twist_.start + twist_.velocity * Real(t) + D * twist_.arm};
  }
  double speed(double radius) const override {
    const Real turning = std::abs(twist_.angle) * (twist_.axis.cross(twist_.arm).norm() + Real(radius));
    return static_cast<double>(twist_.velocity.norm() + turning) * (1 + 1e-12);
  }
  double extent() const override {
    return static_cast<double>(twist_.start.norm() + twist_.velocity.norm() + twist_.arm.norm());
  }
  std::shared_ptr<fcl::MotionBased> motion() const override {
    switch (type_) {
      case Type::interp:
        return std::make_shared<fcl::InterpMotion<double>>(interp());
      case Type::screw:
        return std::make_shared<fcl::ScrewMotion<double>>(screw());
      case Type::translation:
        break;
    }
    return std::make_shared<fcl::TranslationMotion<double>>(ends_.R1, ends_.T1, ends_.T2);
  }
  PathPtr shifted(const Vec3& offset) const override {
    Ends ends = ends_;
    ends.T1 += offset;
    ends.T2 += offset;
    return std::make_shared<TwistPath>(type_, ends, reference_);
  }

 private:
  fcl::InterpMotion<double> interp() const { return {ends_.R1, ends_.T1, ends_.R2, ends_.T2, reference_}; }
  fcl::ScrewMotion<double> screw() const { return {ends_.R1, ends_.T1, ends_.R2, ends_.T2}; }

  Type type_;
  Ends ends_;
  Vec3 reference_;
  Twist twist_;
};

class SplinePath : public Path {
 public:
  SplinePath(const std::array<Vec3, 4>& positions, const std::array<Vec3, 4>& rotations)
      : positions_(positions), rotations_(rotations) {}

  std::string name() const override { return "spline"; }
  Pose pose(double time) const override {
    const Real t = time, s = 1 - t;
    const Real weights[] = {s * s * s / 6, (4 - 6 * t * t + 3 * t * t * t) / 6, (4 - 6 * s * s + 3 * s * s * s) / 6,
                            t * t * t / 6};
    Vec<Real> position = Vec<Real>::Zero(), rotation = Vec<Real>::Zero();
    for (std::size_t k = 0; k < 4; ++k) {
      position += weights[k] * real(positions_[k]);
      rotation += weights[k] * real(rotations_[k]);
    }
    return {rotationBy(rotation), position};
  }
  /// The derivative of a uniform B-spline is one of the differences of its control points; the rate of a rotation is no
  /// greater than that of its vector.
  double speed(double radius) const override {
    const auto rate = [](const std::array<Vec3, 4>& p) {
      return std::max({(p[1] - p[0]).norm(), (p[2] - p[1]).norm(), (p[3] - p[2]).norm()});
    };
    return (rate(positions_) + rate(rotations_) * radius) * (1 + 1e-12);
  }
  double extent() const override {
    double most = 0;
    for (const Vec3& p : positions_) most = std::max(most, p.norm());
    return most;
  }
  std::shared_ptr<fcl::MotionBased> motion() const override {
    const auto& p = positions_;
    const auto& r = rotations_;
    return std::make_shared<fcl::SplineMotion<double>>(p[0], p[1], p[2], p[3], r[0], r[1], r[2], r[3]);
  }
  PathPtr shifted(const Vec3& offset) const override {
    std::array<Vec3, 4> positions = positions_;
    for (Vec3& p : positions) p += offset;
    return std::make_shared<SplinePath>(positions, rotations_);
  }

 private:
  std::array<Vec3, 4> positions_, rotations_;
};

}  // namespace

Mat<Real> rotationBy(const Vec<Real>& vector) {
  // 1 + sin(a)/a W + (1 - cos a)/a^2 W^2; near 0 by the first terms of the series, the next is below 1e-20.
  const Real square = vector.squaredNorm(), a = std::sqrt(square);
  const bool small = a < Real(1e-4);
  const Real f = small ? 1 - square / 6 + square * square / 120 : std::sin(a) / a;
  const Real half = std::sin(a / 2);
  const Real g = small ? Real(0.5) - square / 24 + square * square / 720 : 2 * half * half / square;
  Mat<Real> W;
  W << 0, -vector.z(), vector.y(), vector.z(), 0, -vector.x(), -vector.y(), vector.x(), 0;
  return Mat<Real>::Identity() + f * W + g * (W * W);
}

PathPtr translationPath(const Ends& ends) {
  return std::make_shared<TwistPath>(TwistPath::Type::translation, ends, Vec3::Zero());
}
PathPtr interpPath(const Ends& ends, const Vec3& reference) {
  return std::make_shared<TwistPath>(TwistPath::Type::interp, ends, reference);
}
PathPtr screwPath(const Ends& ends) {
  return std::make_shared<TwistPath>(TwistPath::Type::screw, ends, Vec3::Zero());
}
PathPtr splinePath(const std::array<Vec3, 4>& positions, const std::array<Vec3, 4>& rotations) {
  return std::make_shared<SplinePath>(positions, rotations);
}

}  // namespace pairs
