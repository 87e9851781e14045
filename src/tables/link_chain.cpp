// SPDX-License-Identifier: BSD-3-Clause
#include "tables/link_chain.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "geometry/shape_tree.h"
#include "kinematics/angles.h"
#include "numerics/assertion.h"
#include "numerics/constants.h"

namespace fcl_artic {
namespace {

using RowMajor = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;

}  // namespace

double ValueRange::half() const {
  return std::max(upper - middle(), middle() - lower) * (1 + 4 * kUlp);
}

ValueRange wholeRange(const KinematicTree& tree, int variable) {
  constexpr double kAll = std::numeric_limits<double>::infinity();
  const Joint& joint = tree.joint(tree.variableJoint(variable));
  if (KinematicTree::numVariables(joint.type) != 1) return {kAll, -kAll};
  if (hasLimits(joint)) {
    const double beyond = kBeyondLimits * (joint.upper - joint.lower);
    return {joint.lower - beyond, joint.upper + beyond};
  }
  if (!tree.isAngle(variable)) return {kAll, -kAll};
  return {-kAll, kAll};
}

/// Gives the steps' variables, which are the tree's, numbers in the order in which they appear in the path.
/// @param rangeOf  the range of one of the tree's variables.
template <class RangeOf>
void LinkChain::numberVariables(const RangeOf& rangeOf) {
  variables_.clear();
  ranges_.clear();
  num_steps_.clear();
  for (std::size_t i = 0; i < path_.size(); ++i) {
    engine::SweepStep& step = path_[i];
    step.parent = static_cast<std::int32_t>(i) - 1;
    const auto known = std::find(variables_.begin(), variables_.end(), step.variable);
    const auto number = static_cast<std::size_t>(known - variables_.begin());
    if (known == variables_.end()) {
      variables_.push_back(step.variable);
      ranges_.push_back(rangeOf(step.variable));
      num_steps_.push_back(0);
    }
    ++num_steps_[number];
    step.variable = static_cast<std::int32_t>(number);
  }
}

LinkChain::LinkChain(const KinematicTree& tree, const engine::Problem& problem, const engine::LinkPair& pair,
                     const Cut& cut)
    : pair_(pair), outline_a_(outlineOf(problem.bodies[pair.a])), outline_b_(outlineOf(problem.bodies[pair.b])) {
  const engine::SweepView& sweep = problem.sweeps[pair.sweep];
  for (int s = pair.step_b; s >= 0; s = sweep.steps[s].parent) path_.push_back(sweep.steps[s]);
  std::reverse(path_.begin(), path_.end());
  const engine::Body &a = problem.bodies[pair.a], &b = problem.bodies[pair.b];
  double length = pair.inverse_a.length + pair.placement_b.length + 4 * (a.tree->extent + b.tree->extent);
  double ulps = pair.inverse_a.ulps + pair.placement_b.ulps + 128;
  for (const engine::SweepStep& step : path_) {
    bounded_ = bounded_ && (step.kind == engine::StepKind::revolute || step.kind == engine::StepKind::prismatic);
  }
  if (!bounded_) return;
  numberVariables([&](int variable) { return wholeRange(tree, variable); });
  for (const engine::SweepStep& step : path_) {
    ValueRange& range = ranges_[static_cast<std::size_t>(step.variable)];
    // Poses have the period 2 pi in a variable that drives nothing but turns by whole multiples: one turn is all.
    const bool whole_turns = step.kind == engine::StepKind::revolute && step.multiplier == std::round(step.multiplier);
    if (std::isinf(range.lower) && !whole_turns) range = {1, -1};
  }
  for (ValueRange& range : ranges_) {
    if (std::isinf(range.lower) && range.lower < 0) range = {-0.5 * kTwoPi - 1e-9, 0.5 * kTwoPi + 1e-9};
    bounded_ =
        bounded_ && range.lower <= range.upper && std::max(std::abs(range.lower), std::abs(range.upper)) <= kMaxValue;
  }
  if (!bounded_) return;
  for (const engine::SweepStep& step : path_) {
    const double most = maxStepValue(step);
    bounded_ = bounded_ && most <= kMaxValue;
    length += step.length + (step.kind == engine::StepKind::prismatic ? most : 0);
    ulps += step.ulps + 64 + 4 * most;
  }
  // Every product of the path is off by less than 64 ulp of the lengths so far, an angle by 4 ulp of its terms.
  pad_ = kUlp * ulps * length;

  pair_.sweep = 0;
  problem_.bodies = problem.bodies;
  problem_.num_bodies = problem.num_bodies;
  problem_.sweeps = &sweep_;
  problem_.num_sweeps = 1;
  problem_.link_pairs = &pair_;
  problem_.num_link_pairs = 1;
  problem_.contained = problem.contained;
  outline_a_.points =
      RowMajor(pair_.inverse_a.R).transpose() * (outline_a_.points.colwise() - Eigen::Vector3d::Map(pair_.inverse_a.t));
  outline_b_.points =
      (RowMajor(pair_.placement_b.R) * outline_b_.points).colwise() + Eigen::Vector3d::Map(pair_.placement_b.t);
  if (cut.steps_at_a + cut.steps_at_b > 0) replaceByBalls(cut);
  sweep_.steps = path_.data();
  sweep_.num_steps = static_cast<std::int32_t>(path_.size());
  pair_.step_b = sweep_.num_steps - 1;
}

/// The value of a step's own motion is at most this, over the whole range; up to rounding.
double LinkChain::maxStepValue(const engine::SweepStep& step) const {
  const ValueRange& range = ranges_[static_cast<std::size_t>(step.variable)];
  return std::abs(step.multiplier) * std::max(std::abs(range.lower), std::abs(range.upper)) + std::abs(step.offset);
}

std::vector<LinkChain::Cut> LinkChain::cuts() const {
  std::vector<Cut> cuts;
  // (A body within the ball may lie in what a solid encloses, and the ball's middle outside.)
  if (!bounded_ || problem_.bodies[pair_.a].space || problem_.bodies[pair_.b].space) return cuts;
  const std::size_t n = path_.size();
  // Turns about axes that meet have the same ball: all of them are cut off, or none.
  const auto sameBall = [&](std::size_t step, std::size_t turn) {
    return Eigen::Vector3d::Map(path_[step].p).isZero(0) && path_[turn].kind == engine::StepKind::revolute;
  };
  std::vector<std::pair<std::size_t, Cut>> found;
  for (std::size_t steps_at_a = 0; steps_at_a <= n; ++steps_at_a) {
    if (steps_at_a > 0 && steps_at_a < n && sameBall(steps_at_a, steps_at_a)) continue;
    for (std::size_t steps_at_b = 0; steps_at_a + steps_at_b <= n; ++steps_at_b) {
      if (steps_at_b > 0 && steps_at_a + steps_at_b < n && sameBall(n - steps_at_b, n - steps_at_b - 1)) continue;
      std::vector<int> left;
      for (std::size_t i = steps_at_a; i < n - steps_at_b; ++i) left.push_back(path_[i].variable);
      std::sort(left.begin(), left.end());
      left.erase(std::unique(left.begin(), left.end()), left.end());
      if (left.size() < variables_.size()) found.push_back({left.size(), {steps_at_a, steps_at_b}});
    }
  }
  std::stable_sort(found.begin(), found.end(), [](const auto& x, const auto& y) { return x.first < y.first; });
  for (const auto& [variables, cut] : found) cuts.push_back(cut);
  return cuts;
}

/// Lemma 10: the bodies become points, the balls' middles, and the margin pays for the radii.
void LinkChain::replaceByBalls(const Cut& cut) {
  static const std::shared_ptr<const ShapeTree> kPoint = ShapeTree::fromHull({Eigen::Vector3d::Zero()});
  const std::size_t n = path_.size();
  FCL_ARTIC_ASSERT(cut.steps_at_a + cut.steps_at_b <= n);
  FCL_ARTIC_ASSERT(!problem_.bodies[pair_.a].space && !problem_.bodies[pair_.b].space);
  const auto slide = [&](std::size_t i) {
    return path_[i].kind == engine::StepKind::prismatic ? maxStepValue(path_[i]) : 0;
  };
  const auto offset = [&](std::size_t i) { return Eigen::Vector3d::Map(path_[i].p).norm(); };
  bodies_[0] = problem_.bodies[pair_.a];
  bodies_[1] = problem_.bodies[pair_.b];
  pair_.a = 0;
  pair_.b = 1;
  problem_.bodies = bodies_;
  problem_.num_bodies = 2;
  double radii = 0;
  if (cut.steps_at_a > 0) {
    // From the first step on: how far A reaches from each step's origin, seen from after its motion.
    Outline a = outline_a_;
    a.points = RowMajor(path_[0].C).transpose() * (a.points.colwise() - Eigen::Vector3d::Map(path_[0].p));
    double reach = a.farthestFromOrigin() + slide(0);
    for (std::size_t i = 1; i < cut.steps_at_a; ++i) reach += offset(i) + slide(i);
    radii += reach + pad_;
    bodies_[0] = engine::Body();
    bodies_[0].tree = &kPoint->view();
    pair_.inverse_a = engine::Placement();
    outline_a_.points.setZero();
    outline_a_.radius = 0;
  }
  if (cut.steps_at_b > 0) {
    // From the last step on: how far B reaches from each step's origin, seen from before its motion.
    const std::size_t first = n - cut.steps_at_b;
    double reach = outline_b_.farthestFromOrigin() + slide(n - 1);
    for (std::size_t i = n - 1; i > first; --i) reach += offset(i) + slide(i - 1);
    radii += reach + pad_;
    bodies_[1] = engine::Body();
    bodies_[1].tree = &kPoint->view();
    engine::Placement& middle = bodies_[1].placement;
    middle.length = path_[first].length;
    middle.ulps = path_[first].ulps;
    middle.identity = false;
    std::copy_n(path_[first].p, 3, middle.t);
    std::copy_n(path_[first].p, 3, bodies_[1].lss);
    std::copy_n(path_[first].p, 3, bodies_[1].lss + 3);
    pair_.placement_b = middle;
    outline_b_.points.colwise() = Eigen::Vector3d::Map(middle.t);
    outline_b_.radius = 0;
  }
  ball_radii_ = radii * (1 + 1e-9);
  path_.erase(path_.end() - static_cast<std::ptrdiff_t>(cut.steps_at_b), path_.end());
  path_.erase(path_.begin(), path_.begin() + static_cast<std::ptrdiff_t>(cut.steps_at_a));
  // The variables that are left.
  const std::vector<int> old_variables = variables_;
  const std::vector<ValueRange> old_ranges = ranges_;
  for (engine::SweepStep& step : path_) step.variable = old_variables[static_cast<std::size_t>(step.variable)];
  numberVariables([&](int variable) {
    const auto at = std::find(old_variables.begin(), old_variables.end(), variable);
    return old_ranges[static_cast<std::size_t>(at - old_variables.begin())];
  });
}

LinkChain::Outline LinkChain::outlineOf(const engine::Body& body) {
  Outline outline;
  const engine::Node& root = body.tree->nodes[0];
  for (int corner = 0; corner < 8; ++corner) {
    for (int k = 0; k < 3; ++k) {
      outline.points(k, corner) = static_cast<double>(corner >> k & 1 ? root.hi[k] : root.lo[k]);
    }
  }
  // The line swept sphere is in the frame of the body's step in the world.
  const RowMajor R(body.placement.R, 3, 3);
  for (int end = 0; end < 2; ++end) {
    outline.points.col(8 + end) =
        R.transpose() * (Eigen::Vector3d::Map(body.lss + 3 * end) - Eigen::Vector3d::Map(body.placement.t));
  }
  outline.radius = body.lss[6] + kUlp * (body.placement.ulps + 64) * (body.placement.length + 4 * body.tree->extent);
  return outline;
}

double LinkChain::Outline::farthestFromAxis() const {
  const auto squared = points.topRows<2>().colwise().squaredNorm().eval();
  return std::min(std::sqrt(squared.head<8>().maxCoeff()), std::sqrt(squared.tail<2>().maxCoeff()) + radius);
}

double LinkChain::Outline::farthestFromOrigin() const {
  const auto squared = points.colwise().squaredNorm().eval();
  return std::min(std::sqrt(squared.head<8>().maxCoeff()), std::sqrt(squared.tail<2>().maxCoeff()) + radius);
}

}  // namespace fcl_artic
