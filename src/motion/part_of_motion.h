// SPDX-License-Identifier: BSD-3-Clause
//
// A part [begin, end] of a motion's time as a motion over [0, 1] of its own: t stands for begin + t (end - begin).
//
// The numbers of a part are rounded. The way by which that moves a body is known beforehand, for every part. It is
// paid for in the sweep that the body is carried by (FrameSweep::allowError; doc/NUMERICS.md, "Parts of a motion").
#pragma once

#include <vector>

#include <Eigen/Core>

#include "model/problem.h"
#include "motion/body_motion.h"

namespace fcl_artic {

struct TimePart {
  double begin = 0, end = 1;
  double width() const { return end - begin; }
  bool whole() const { return begin == 0 && end == 1; }
  double at(double t) const { return t >= 1 ? end : begin + t * width(); }
};

/// Polynomials (one a row, column k for t^k) over a part of their time, in place of those over the whole.
void takePart(const TimePart& part, Eigen::MatrixXd& coefficients);
/// The same, elsewhere.
Eigen::MatrixXd partOf(const Eigen::MatrixXd& coefficients, const TimePart& part);

/// How far a computed part of an element's motion can be from the true one: an angle (rad) and a length, in 2^-52.
struct PartError {
  double angle, length;
};
PartError partError(const MotionElement& element);

/// A motion that its author bounds, over a part of its time. Keeps the reference.
class BoundedPart : public BoundedMotion {
 public:
  BoundedPart(const BoundedMotion& whole, const TimePart& part) : whole_(whole), part_(part) {}
  State state(double t) const override;
  Bounds bounds(double begin, double end) const override;
  bool hasDerivatives() const override { return whole_.hasDerivatives(); }

 private:
  const BoundedMotion& whole_;
  TimePart part_;
};

/// A problem whose bounded motions are asked for a part of their time: while this object lives, the problem's sweeps
/// are its.
class BoundedParts {
 public:
  BoundedParts(const TimePart& part, engine::Problem& problem);
  BoundedParts(const BoundedParts&) = delete;
  BoundedParts& operator=(const BoundedParts&) = delete;

 private:
  std::vector<BoundedPart> motions_;
  std::vector<engine::BoundedSource> sources_;
  std::vector<std::vector<engine::SweepStep>> steps_;
  std::vector<engine::SweepView> sweeps_;
};

}  // namespace fcl_artic
