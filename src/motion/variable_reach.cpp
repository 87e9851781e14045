// SPDX-License-Identifier: BSD-3-Clause
#include "motion/variable_reach.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Core>

namespace fcl_artic {
namespace {

using RowMajor = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;

/// The largest value over the corners of the body's box; f is convex.
template <class F>
double mostOver(const engine::TreeView& body, const F& f) {
  const engine::Node& root = body.nodes[0];
  double most = 0;
  for (int corner = 0; corner < 8; ++corner) {
    Eigen::Vector3d x;
    for (int k = 0; k < 3; ++k) x[k] = static_cast<double>(corner >> k & 1 ? root.hi[k] : root.lo[k]);
    most = std::max(most, f(x));
  }
  return most;
}

}  // namespace

double reachPerUnit(const engine::SweepView& sweep, int step, const engine::Placement& placement,
                    const engine::TreeView& body, int variable, const std::function<double(int)>& size) {
  using engine::StepKind;
  std::vector<const engine::SweepStep*> path;  // from the body back to the base
  for (int s = step; s >= 0; s = sweep.steps[s].parent) path.push_back(&sweep.steps[s]);
  double rate = 0, rate_before = 0, reach = 0;  // of the last frame: turn, turn without its own step, way of its origin
  for (auto it = path.rbegin(); it != path.rend(); ++it) {
    const engine::SweepStep& s = **it;
    const bool moves = s.variable == variable;
    const double multiplier = std::abs(s.multiplier);
    reach += rate * s.perp + rate_before * s.axial;
    rate_before = rate;
    if (s.kind == StepKind::revolute) {
      rate += moves ? multiplier : 0;
    } else {
      reach += rate * (multiplier * size(s.variable) + std::abs(s.offset)) + (moves ? multiplier : 0);
    }
  }
  // A point p of the body, in the last frame, adds rate |p|, or less as Lemma 2 splits it. Both bounds are convex in p,
  // so they are largest at a corner of a box around the body.
  const bool turns = !path.empty() && path.front()->kind == StepKind::revolute;
  const RowMajor R(placement.R, 3, 3);
  const double most = mostOver(body, [&](const Eigen::Vector3d& x) {
    const Eigen::Vector3d p = R * x + Eigen::Vector3d::Map(placement.t);
    return turns ? rate * p.head<2>().norm() + rate_before * std::abs(p[2]) : rate * p.norm();
  });
  // The placement's own error; all sums and products of a path of any length are within 1e-9 of themselves.
  const double error = 0x1p-52 * (placement.ulps + 64) * (placement.length + 4 * body.extent) * rate;
  return (reach + most + error) * (1 + 1e-9);
}

double reachOfBase(const engine::SweepStep& first, const engine::Placement& inverse, const engine::TreeView& body) {
  const double multiplier = std::abs(first.multiplier);
  if (first.kind == engine::StepKind::prismatic) return multiplier;
  const RowMajor R(inverse.R, 3, 3), C(first.C, 3, 3);
  const double most = mostOver(body, [&](const Eigen::Vector3d& x) {
    const Eigen::Vector3d p =
        C.transpose() * (R.transpose() * (x - Eigen::Vector3d::Map(inverse.t)) - Eigen::Vector3d::Map(first.p));
    return p.head<2>().norm();
  });
  const double error = 0x1p-52 * (inverse.ulps + first.ulps + 64) * (inverse.length + first.length + 4 * body.extent);
  return multiplier * (most + error) * (1 + 1e-9);
}

}  // namespace fcl_artic
