// SPDX-License-Identifier: BSD-3-Clause
#include "bounded_path.h"

#include <cmath>

#include <fcl/math/motion/bv_motion_bound_visitor.h>
#include <fcl/math/motion/triangle_motion_bound_visitor.h>

#include "fcl_artic/bounded_motion.h"

namespace pair_campaign {
namespace {

using pairs::Real;
using pairs::Vec3;

class WobbleMotion : public fcl::MotionBased, public fcl_artic::BoundedMotion {
 public:
  explicit WobbleMotion(const Wobble& w) : w_(w) {}

  bool integrate(double t) const override {
    t_ = t;
    return true;
  }
  void getCurrentTransform(fcl::Transform3d& tf) const override { tf = state(t_).pose; }
  using fcl::MotionBased::getCurrentTransform;
  double computeMotionBound(const fcl::BVMotionBoundVisitor<double>& visitor) const override {
    return visitor.visit(*this);
  }
  double computeMotionBound(const fcl::TriangleMotionBoundVisitor<double>& visitor) const override {
    return visitor.visit(*this);
  }
  void getTaylorModel(fcl::TMatrix3<double>&, fcl::TVector3<double>&) const override {}

  State state(double t) const override {
    const double f = w_.frequency, s = std::sin(f * t), c = std::cos(f * t);
    State x;
    x.pose.linear() = Eigen::AngleAxisd(w_.turn * t + w_.turn_swing * s, w_.axis).toRotationMatrix() * w_.R1;
    x.pose.translation() = w_.start + t * w_.way + s * w_.swing;
    if (!w_.has_derivatives) return x;
    x.velocity = w_.way + f * c * w_.swing;
    x.acceleration = -f * f * s * w_.swing;
    x.angular_velocity = (w_.turn + f * c * w_.turn_swing) * w_.axis;
    x.angular_acceleration = -f * f * s * w_.turn_swing * w_.axis;
    return x;
  }
  Bounds bounds(double, double) const override {
    const double f = w_.frequency, swing = w_.swing.norm(), turn = std::abs(w_.turn_swing), up = 1 + 1e-14;
    return {up * (w_.way.norm() + f * swing),    up * f * f * swing, up * f * f * f * swing,
            up * (std::abs(w_.turn) + f * turn), up * f * f * turn,  up * f * f * f * turn};
  }
  bool hasDerivatives() const override { return w_.has_derivatives; }

 private:
  Wobble w_;
  mutable double t_ = 0;
};

class BoundedPath : public pairs::Path {
 public:
  explicit BoundedPath(const Wobble& w) : w_(w) {}
  std::string name() const override {
    return w_.has_derivatives ? "bounded motion" : "bounded motion without derivatives";
  }
  pairs::Pose pose(double t) const override {
    const Real s = std::sin(Real(w_.frequency) * Real(t));
    const Real angle = Real(w_.turn) * Real(t) + Real(w_.turn_swing) * s;
    return {pairs::rotationBy(w_.axis.cast<Real>() * angle) * w_.R1.cast<Real>(),
            w_.start.cast<Real>() + Real(t) * w_.way.cast<Real>() + s * w_.swing.cast<Real>()};
  }
  double speed(double radius) const override {
    const auto b = WobbleMotion(w_).bounds(0, 1);
    return b.speed + b.angular_speed * radius;
  }
  double extent() const override { return w_.start.norm() + w_.way.norm() + w_.swing.norm(); }
  std::shared_ptr<fcl::MotionBased> motion() const override { return std::make_shared<WobbleMotion>(w_); }
  pairs::PathPtr shifted(const Vec3& offset) const override {
    Wobble w = w_;
    w.start += offset;
    return boundedPath(w);
  }

 private:
  Wobble w_;
};

}  // namespace

pairs::PathPtr boundedPath(const Wobble& wobble) {
  return std::make_shared<BoundedPath>(wobble);
}

}  // namespace pair_campaign
