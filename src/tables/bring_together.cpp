// SPDX-License-Identifier: BSD-3-Clause
#include "tables/bring_together.h"

#include <algorithm>
#include <cmath>

#include "kinematics/angles.h"

namespace fcl_artic {
namespace {

using Eigen::Vector3d;
using RowMajor = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;

/// Least gain of a further sweep that is worth its time, as a part of the distance.
constexpr double kLeastGain = 0.01;

/// A point after the step, as seen from before its motion.
Vector3d moved(const engine::SweepStep& step, double variable, const Vector3d& x) {
  const double value = step.multiplier * variable + step.offset;
  if (step.kind == engine::StepKind::prismatic) return x + Vector3d(0, 0, value);
  const double cosine = std::cos(value), sine = std::sin(value);
  return {cosine * x[0] - sine * x[1], sine * x[0] + cosine * x[1], x[2]};
}

/// A point before the step's motion, as seen from after it.
Vector3d movedBack(const engine::SweepStep& step, double variable, const Vector3d& x) {
  engine::SweepStep back;
  back.kind = step.kind;
  back.multiplier = -step.multiplier;
  back.offset = -step.offset;
  return moved(back, variable, x);
}

/// The value in the range at which a step brings b (after the step) nearest to a (before it).
double best(const engine::SweepStep& step, const ValueRange& within, const Vector3d& a, const Vector3d& b,
            double otherwise) {
  if (step.multiplier == 0) return otherwise;
  if (step.kind == engine::StepKind::prismatic) {
    return std::clamp((a[2] - b[2] - step.offset) / step.multiplier, within.lower, within.upper);
  }
  const double along = a[0] * b[0] + a[1] * b[1], across = a[1] * b[0] - a[0] * b[1];
  if (along == 0 && across == 0) return otherwise;
  const double turn = kTwoPi / std::abs(step.multiplier);
  double value = (std::atan2(across, along) - step.offset) / step.multiplier;
  value -= std::floor((value - within.lower) / turn) * turn;  // the first one not below the range
  if (value <= within.upper) return value;
  return value - within.upper < within.lower - (value - turn) ? within.upper : within.lower;
}

}  // namespace

double bringTogether(const std::vector<engine::SweepStep>& path, const std::vector<ValueRange>& within,
                     const Vector3d& a, const Vector3d& b, int sweeps, std::vector<double>& values) {
  std::vector<int> steps(within.size(), 0);
  for (const engine::SweepStep& step : path) ++steps[static_cast<std::size_t>(step.variable)];
  std::vector<Vector3d> before(path.size());  // a, as seen from before each step's motion
  const auto distance = [&] {
    Vector3d x = b;
    for (std::size_t i = path.size(); i-- > 0;) {
      x = moved(path[i], values[static_cast<std::size_t>(path[i].variable)], x);
      x = RowMajor(path[i].C) * x + Vector3d::Map(path[i].p);
    }
    return (x - a).norm();
  };
  double last = distance();
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    Vector3d x = a;
    for (std::size_t i = 0; i < path.size(); ++i) {
      before[i] = RowMajor(path[i].C).transpose() * (x - Vector3d::Map(path[i].p));
      x = movedBack(path[i], values[static_cast<std::size_t>(path[i].variable)], before[i]);
    }
    x = b;
    for (std::size_t i = path.size(); i-- > 0;) {
      const auto v = static_cast<std::size_t>(path[i].variable);
      // For a variable of several steps no closed form is known.
      if (steps[v] == 1) values[v] = best(path[i], within[v], before[i], x, values[v]);
      x = RowMajor(path[i].C) * moved(path[i], values[v], x) + Vector3d::Map(path[i].p);
    }
    double here = (x - a).norm();
    for (std::size_t v = 0; v < within.size(); ++v) {
      if (steps[v] == 1) continue;
      double way = 0.5 * (within[v].upper - within[v].lower);
      for (int k = 0; k < 5; ++k, way *= -0.5) {
        const double stay = values[v];
        values[v] = std::clamp(stay + way, within[v].lower, within[v].upper);
        const double there = distance();
        if (there < here) {
          here = there;
        } else {
          values[v] = stay;
        }
      }
    }
    if (here > last * (1 - kLeastGain)) return here;
    last = here;
  }
  return last;
}

}  // namespace fcl_artic
