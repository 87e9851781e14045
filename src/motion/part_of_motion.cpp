// SPDX-License-Identifier: BSD-3-Clause
#include "motion/part_of_motion.h"

#include <algorithm>

#include "motion/variables.h"

namespace fcl_artic {

void takePart(const TimePart& part, Eigen::MatrixXd& coefficients) {
  const Eigen::Index degree = coefficients.cols() - 1;
  for (Eigen::Index i = 0; i < degree; ++i) {  // Taylor's shift by repeated division
    for (Eigen::Index k = degree - 1; k >= i; --k) coefficients.col(k) += part.begin * coefficients.col(k + 1);
  }
  double power = 1;
  for (Eigen::Index k = 1; k <= degree; ++k) coefficients.col(k) *= power *= part.width();
}

Eigen::MatrixXd partOf(const Eigen::MatrixXd& coefficients, const TimePart& part) {
  Eigen::MatrixXd out = coefficients;
  takePart(part, out);
  return out;
}

PartError partError(const MotionElement& element) {
  using Kind = MotionElement::Kind;
  if (element.kind == Kind::bounded) {  // asked at a time that is off by 2^-52
    const BoundedMotion::Bounds bounds = element.bounded->bounds(0, 1);
    return {2 * bounds.angular_speed, 2 * bounds.speed};
  }
  // A coefficient of the part is off by 4 * degree + 2 times the terms it is summed from, at most; those of all of them
  // sum to the whole's, as begin + width <= 1.
  const double error = (4 * kMaxDegree + 4) * element.coefficients.cwiseAbs().sum();
  const bool turns = element.kind == Kind::revolute || element.kind == Kind::turn;
  return {turns ? error : 0, turns ? 0 : error};
}

BoundedMotion::State BoundedPart::state(double t) const {
  State s = whole_.state(part_.at(t));
  const double h = part_.width();
  s.velocity *= h;
  s.acceleration *= h * h;
  s.angular_velocity *= h;
  s.angular_acceleration *= h * h;
  return s;
}

BoundedMotion::Bounds BoundedPart::bounds(double begin, double end) const {
  constexpr double kTimeError = 0x1p-51;  // of the interval's ends
  const double from = std::max(0.0, part_.at(begin) - kTimeError), to = std::min(1.0, part_.at(end) + kTimeError);
  Bounds b = whole_.bounds(from, to);
  const double h = part_.width() * (1 + 0x1p-49);  // a few products, rounded
  b.speed *= h;
  b.acceleration *= h * h;
  b.jerk *= h * h * h;
  b.angular_speed *= h;
  b.angular_acceleration *= h * h;
  b.angular_jerk *= h * h * h;
  return b;
}

BoundedParts::BoundedParts(const TimePart& part, engine::Problem& problem) {
  if (part.whole()) return;
  std::size_t bounded = 0;
  for (std::int32_t i = 0; i < problem.num_sweeps; ++i) {
    const engine::SweepView& sweep = problem.sweeps[i];
    for (std::int32_t k = 0; k < sweep.num_steps; ++k) bounded += sweep.steps[k].source != nullptr;
  }
  if (bounded == 0) return;
  motions_.reserve(bounded);  // sources and steps point to their elements
  sources_.reserve(bounded);
  sweeps_.assign(problem.sweeps, problem.sweeps + problem.num_sweeps);
  for (engine::SweepView& sweep : sweeps_) {
    steps_.emplace_back(sweep.steps, sweep.steps + sweep.num_steps);
    sweep.steps = steps_.back().data();
    for (engine::SweepStep& step : steps_.back()) {
      if (!step.source) continue;
      motions_.emplace_back(*static_cast<const BoundedMotion*>(step.source->self), part);
      sources_.push_back(boundedSource(motions_.back()));
      step.source = &sources_.back();
    }
  }
  problem.sweeps = sweeps_.data();
}

}  // namespace fcl_artic
