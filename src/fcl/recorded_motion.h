// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <fcl/math/motion/motion_base.h>

#include "motion/body_motion.h"

namespace fcl_artic {

/// A motion that is given as what others are read into: for this library's queries only.
class RecordedMotion : public fcl::MotionBased {
 public:
  /// @param motion  without a BoundedMotion.
  explicit RecordedMotion(BodyMotion motion) : motion_(std::move(motion)) {}

  const BodyMotion& motion() const { return motion_; }

  bool integrate(double t) const override {
    pose_ = motion_.pose(std::clamp(t, 0.0, 1.0));
    return true;
  }
  using fcl::MotionBased::getCurrentTransform;
  void getCurrentTransform(fcl::Transform3d& M) const override { M = pose_; }
  double computeMotionBound(const fcl::BVMotionBoundVisitor<double>&) const override { refuse(); }
  double computeMotionBound(const fcl::TriangleMotionBoundVisitor<double>&) const override { refuse(); }
  void getTaylorModel(fcl::TMatrix3<double>&, fcl::TVector3<double>&) const override { refuse(); }

 private:
  [[noreturn]] static void refuse() {
    throw std::logic_error("a motion that was read from a query is for fcl_artic's queries, not for FCL's");
  }

  BodyMotion motion_;
  mutable fcl::Transform3d pose_ = fcl::Transform3d::Identity();
};

}  // namespace fcl_artic
