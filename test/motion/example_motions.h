// SPDX-License-Identifier: BSD-3-Clause
//
// Motions of a user's own: one that says what bounds it, one that knows speeds only, one that says nothing.
#pragma once

#include <cmath>

#include <fcl/math/motion/motion_base.h>

#include "fcl_artic/bounded_motion.h"

namespace fcl_artic::test {

/// Members that FCL wants of a motion, for motions that only have a pose.
class PosedMotion : public fcl::MotionBased {
 public:
  using fcl::MotionBased::getCurrentTransform;
  bool integrate(double t) const override {
    t_ = t;
    return true;
  }
  void getCurrentTransform(fcl::Transform3d& M) const override { M = poseAt(t_); }
  double computeMotionBound(const fcl::BVMotionBoundVisitor<double>&) const override { return 0; }
  double computeMotionBound(const fcl::TriangleMotionBoundVisitor<double>&) const override { return 0; }
  void getTaylorModel(fcl::TMatrix3<double>&, fcl::TVector3<double>&) const override {}
  virtual Eigen::Isometry3d poseAt(double t) const = 0;

 private:
  mutable double t_ = 0;
};

/// Nothing is known but poses.
class UnknownMotion : public PosedMotion {
 public:
  Eigen::Isometry3d poseAt(double t) const override { return Eigen::Isometry3d(Eigen::Translation3d(t, 0, 0)); }
};

/// The origin swings along a sine, c(t) = start + sway sin(k t), while the body turns about z by the angle
/// turn sin(m t). All derivatives and their bounds are plain: |sin|, |cos| <= 1.
class SwayingMotion : public PosedMotion, public BoundedMotion {
 public:
  SwayingMotion(const Eigen::Isometry3d& start, const Eigen::Vector3d& sway, double k, double turn, double m)
      : start_(start), sway_(sway), k_(k), turn_(turn), m_(m) {}
  Eigen::Isometry3d poseAt(double t) const override { return state(t).pose; }
  State state(double t) const override {
    State s;
    const double sk = std::sin(k_ * t), ck = std::cos(k_ * t), sm = std::sin(m_ * t), cm = std::cos(m_ * t);
    s.pose = Eigen::Translation3d(start_.translation() + sway_ * sk) *
             Eigen::AngleAxisd(turn_ * sm, Eigen::Vector3d::UnitZ()) * Eigen::Isometry3d(start_.linear());
    s.velocity = k_ * ck * sway_;
    s.acceleration = -k_ * k_ * sk * sway_;
    s.angular_velocity = turn_ * m_ * cm * Eigen::Vector3d::UnitZ();
    s.angular_acceleration = -turn_ * m_ * m_ * sm * Eigen::Vector3d::UnitZ();
    return s;
  }
  Bounds bounds(double, double) const override {
    const double k = std::abs(k_), m = std::abs(m_), turn = std::abs(turn_);
    return {k * sway_.norm(), k * k * sway_.norm(), k * k * k * sway_.norm(), m * turn, m * m * turn, m * m * m * turn};
  }

 private:
  Eigen::Isometry3d start_;
  Eigen::Vector3d sway_;
  double k_, turn_, m_;
};

/// The same, known by its speeds only.
class SpeedBoundedMotion : public SwayingMotion {
 public:
  using SwayingMotion::SwayingMotion;
  State state(double t) const override {
    State s;
    s.pose = SwayingMotion::state(t).pose;
    return s;
  }
  Bounds bounds(double begin, double end) const override {
    const Bounds all = SwayingMotion::bounds(begin, end);
    Bounds known;
    known.speed = all.speed;
    known.angular_speed = all.angular_speed;
    return known;
  }
  bool hasDerivatives() const override { return false; }
};

}  // namespace fcl_artic::test
