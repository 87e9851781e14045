// SPDX-License-Identifier: BSD-3-Clause
#include "distances.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <stdexcept>

#include "threads/parallel.h"

namespace fcl_artic::app {
namespace {

constexpr int kSteps = 100;
// A curve is for the eye and decides nothing, and a page must not take minutes.
constexpr double kToleranceRelative = 0.05;
constexpr double kTolerancePart = 1e-3;  // of `most`
constexpr std::uint64_t kWorkForStep = 4000000;

/// Coefficients of p(a + (b - a) s), by powers of s, from those of p(t).
Eigen::MatrixXd shifted(const Eigen::MatrixXd& p, double a, double b) {
  Eigen::MatrixXd q = p;
  const Eigen::Index n = q.cols();
  for (Eigen::Index i = 0; i < n; ++i) {  // Horner's scheme, again and again: the coefficients of p(a + u)
    for (Eigen::Index k = n - 2; k >= i; --k) q.col(k) += a * q.col(k + 1);
  }
  double power = 1;
  for (Eigen::Index k = 0; k < n; ++k, power *= b - a) q.col(k) *= power;
  return q;
}

/// A stretch of one piece of the motion, and the step that it is of.
struct Stretch {
  std::size_t step, piece;
  double begin, end;  ///< of the motion's time
};

/// Steps of equal length, cut where pieces of a trajectory end.
std::vector<Stretch> stretchesOf(const std::vector<double>& times) {
  std::vector<Stretch> out;
  const double begin = times.front(), length = times.back() - begin;
  for (std::size_t k = 0; k < kSteps; ++k) {
    double at = k == 0 ? begin : begin + length * static_cast<double>(k) / kSteps;
    const double end = k + 1 == kSteps ? times.back() : begin + length * static_cast<double>(k + 1) / kSteps;
    while (at < end) {
      const auto next = std::upper_bound(times.begin(), times.end() - 1, at);
      const double stop = std::min(end, *next);
      out.push_back({k, static_cast<std::size_t>(next - times.begin()) - 1, at, stop});
      at = stop;
    }
  }
  return out;
}

/// Joins what holds over one stretch with what holds over another.
void join(const Clearance& more, Clearance& all) {
  all.lower = std::min(all.lower, more.lower);
  if (more.upper < all.upper) {
    all.upper = more.upper;
    all.time = more.time;
    all.body1 = more.body1;
    all.body2 = more.body2;
  }
  all.within_tolerance = all.within_tolerance && more.within_tolerance;
}

}  // namespace

std::pair<double, double> timeOf(const RobotMotion& motion) {
  if (const auto* trajectory = std::get_if<JointTrajectory>(&motion)) {
    return {trajectory->beginTime(), trajectory->endTime()};
  }
  return {0, 1};
}

Eigen::VectorXd configurationAt(const RobotMotion& motion, double t) {
  return std::visit([t](const auto& m) { return m.configuration(t); }, motion);
}

JointMotion partOf(const KinematicTree& tree, const JointMotion& motion, double a, double b) {
  const Eigen::MatrixXd whole = motion.coefficients();
  Eigen::MatrixXd part = shifted(whole, a, b);
  const Eigen::VectorXd begin = motion.configuration(a);
  for (JointId joint = 0; joint < tree.numJoints(); ++joint) {
    const int first = tree.quaternionVariable(joint);
    if (first < 0) continue;
    // exp([w(t)]) R0 with w(t) = t w1 is exp([s (b - a) w1]) exp([a w1]) R0.
    if (whole.cols() > 2 && !whole.block(first, 2, 4, whole.cols() - 2).isZero(0)) {
      throw std::invalid_argument("joint '" + tree.joint(joint).name + "' turns about an axis that turns itself");
    }
    part.block(first, 0, 4, part.cols()).setZero();
    part.block(first, 0, 4, 1) = begin.segment(first, 4);
    part.block(first, 1, 4, 1) = (b - a) * whole.block(first, 1, 4, 1);
  }
  return motion.isPolynomial() ? JointMotion::polynomial(tree, part)
                               : JointMotion::tangentHalfAnglePolynomial(tree, part, motion.references());
}

Distances measureDistances(const ArticulatedCollisionManager& manager, const RobotMotion& motion,
                           const DistanceOptions& options) {
  Distances out;
  out.most = options.most;
  std::vector<const fcl::ContinuousCollisionObjectd*> moving;
  manager.getObjects(moving);
  if (!moving.empty() || manager.hasSpeeds()) {  // the parts of the motion are asked about by themselves
    out.missing = "obstacles move by themselves";
    return out;
  }
  const auto* trajectory = std::get_if<JointTrajectory>(&motion);
  const std::vector<double> times = trajectory ? trajectory->times() : std::vector<double>{0, 1};
  const std::vector<Stretch> stretches = stretchesOf(times);
  std::vector<JointMotion> parts;
  try {
    for (const Stretch& s : stretches) {
      const double begin = times[s.piece], length = times[s.piece + 1] - begin;
      parts.push_back(partOf(manager.tree(), trajectory ? trajectory->piece(s.piece) : std::get<JointMotion>(motion),
                             (s.begin - begin) / length, (s.end - begin) / length));
    }
  } catch (const std::invalid_argument& error) {
    out.missing = error.what();
    return out;
  }
  std::vector<DistanceStep> found(stretches.size());
  std::atomic<std::size_t> done{0};
  std::atomic<bool> stopped{false};
  const auto goOn = [&](double, double) {
    if (options.progress && !options.progress(static_cast<double>(done) / static_cast<double>(stretches.size()))) {
      stopped = true;
    }
    return !stopped;
  };
  parallelFor(stretches.size(), 0, [&](std::size_t i) {
    const Stretch& s = stretches[i];
    found[i].begin = s.begin;
    found[i].end = s.end;
    const auto measure = [&](bool scene, Clearance& clearance) {
      if (stopped) return;
      ClearanceRequest request;
      request.most = options.most;
      request.tolerance_relative = kToleranceRelative;
      request.tolerance_distance = kTolerancePart * options.most;
      request.check_scene = scene;
      request.check_self = !scene;
      request.work_budget = kWorkForStep;
      request.progress = goOn;
      clearance = manager.clearance(parts[i], request);
      clearance.time = s.begin + clearance.time * (s.end - s.begin);
    };
    if (options.obstacles) measure(true, found[i].obstacles);
    if (options.links) measure(false, found[i].links);
    ++done;
    goOn(0, 0);
  });
  if (stopped) {
    out.missing = "their measuring was stopped";
    return out;
  }
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (i > 0 && stretches[i].step == stretches[i - 1].step) {
      DistanceStep& step = out.steps.back();
      step.end = found[i].end;
      join(found[i].obstacles, step.obstacles);
      join(found[i].links, step.links);
    } else {
      out.steps.push_back(found[i]);
    }
  }
  return out;
}

}  // namespace fcl_artic::app
