// SPDX-License-Identifier: BSD-3-Clause
#include "tables/contact_grid.h"

#include <algorithm>

#include "kinematics/angles.h"

namespace fcl_artic {
namespace {

/// Cells along each of one, two or three variables. Finer ones find no more contacts.
constexpr int kCells[] = {64, 32, 16};

using Eigen::Isometry3d;
using Eigen::Vector3d;
using engine::InnerBalls;

Isometry3d rigid(const double* R, const double* t) {
  Isometry3d M = Isometry3d::Identity();
  M.linear() = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(R);
  M.translation() = Vector3d::Map(t);
  return M;
}

/// Balls of a link, and one about them all.
struct Balls {
  const InnerBalls& balls;
  Vector3d middle = Vector3d::Zero();
  double reach = 0;

  explicit Balls(const InnerBalls& inner) : balls(inner) {
    for (std::int32_t i = 0; i < balls.count; ++i) middle += center(i) / balls.count;
    for (std::int32_t i = 0; i < balls.count; ++i) {
      reach = std::max(reach, (center(i) - middle).norm() + balls.radius[i]);
    }
  }
  Vector3d center(std::int32_t i) const { return {balls.center[0][i], balls.center[1][i], balls.center[2][i]}; }
};

bool meet(const Vector3d& x, double r, const Vector3d& y, double s) {
  return (x - y).squaredNorm() < (r + s) * (r + s);
}

/// @param M_ab  frame of b in that of a.
bool meet(const Balls& a, const Balls& b, const Isometry3d& M_ab) {
  if (!meet(a.middle, a.reach, M_ab * b.middle, b.reach)) return false;
  for (std::int32_t j = 0; j < b.balls.count; ++j) {
    const Vector3d y = M_ab * b.center(j);
    if (!meet(a.middle, a.reach, y, b.balls.radius[j])) continue;
    for (std::int32_t i = 0; i < a.balls.count; ++i) {
      if (meet(a.center(i), a.balls.radius[i], y, b.balls.radius[j])) return true;
    }
  }
  return false;
}

/// The way from one link to the other.
struct Path {
  struct Step {
    Isometry3d before;  ///< constant, from the step before this one
    bool turns;
    std::size_t variable;  ///< number among the grid's
    double multiplier, offset;
  };
  std::vector<Step> steps;
  Isometry3d begin, end;

  /// @param q  the grid's variables.
  Isometry3d pose(const double* q) const {
    Isometry3d M = begin;
    for (const Step& step : steps) {
      M = M * step.before;
      const double x = step.multiplier * q[step.variable] + step.offset;
      if (step.turns) {
        M.rotate(Eigen::AngleAxisd(x, Vector3d::UnitZ()));
      } else {
        M.translate(x * Vector3d::UnitZ());
      }
    }
    return M * end;
  }
};

}  // namespace

VariableRange::VariableRange(const KinematicTree& tree, int variable) {
  const Joint& joint = tree.joint(tree.variableJoint(variable));
  wraps = tree.isAngle(variable) && !(hasLimits(joint) && joint.upper - joint.lower < kTwoPi);
  if (!wraps && !hasLimits(joint)) return;
  lower = wraps ? -kTwoPi / 2 : joint.lower;
  per_range = 1 / (wraps ? kTwoPi : joint.upper - joint.lower);
}

std::shared_ptr<const ContactGrid> ContactGrid::build(const KinematicTree& tree, const engine::SweepView& sweep,
                                                      const engine::LinkPair& pair, const engine::Body* bodies) {
  const InnerBalls *of_a = bodies[pair.a].balls, *of_b = bodies[pair.b].balls;
  if (!of_a || !of_b) return nullptr;
  std::vector<int> variables;
  Path path{{}, rigid(pair.inverse_a.R, pair.inverse_a.t), rigid(pair.placement_b.R, pair.placement_b.t)};
  for (int s = pair.step_b; s >= 0; s = sweep.steps[s].parent) {
    const engine::SweepStep& step = sweep.steps[s];
    const bool turns = step.kind == engine::StepKind::revolute;
    if (!turns && step.kind != engine::StepKind::prismatic) return nullptr;
    const auto known = std::find(variables.begin(), variables.end(), step.variable);
    path.steps.push_back({rigid(step.C, step.p), turns, static_cast<std::size_t>(known - variables.begin()),
                          step.multiplier, step.offset});
    if (known == variables.end()) variables.push_back(step.variable);
  }
  std::reverse(path.steps.begin(), path.steps.end());
  if (variables.empty() || variables.size() > kMaxVariables) return nullptr;
  const auto grid = std::make_shared<ContactGrid>();
  Axes& axes = grid->axes_;
  axes.count = static_cast<int>(variables.size());
  axes.cells = kCells[axes.count - 1];
  std::copy(variables.begin(), variables.end(), axes.variables);
  VariableRange ranges[kMaxVariables];
  std::size_t count = 1;
  for (int i = 0; i < axes.count; ++i) {
    ranges[i] = VariableRange(tree, axes.variables[i]);
    if (!(ranges[i].per_range > 0)) return nullptr;
    count *= static_cast<std::size_t>(axes.cells);
  }
  grid->touching_.resize(count);
  const Balls a(*of_a), b(*of_b);
  for (std::size_t cell = 0; cell < count; ++cell) {
    double q[kMaxVariables];
    std::size_t rest = cell;
    for (int i = axes.count; i-- > 0; rest /= static_cast<std::size_t>(axes.cells)) {
      const double index = static_cast<double>(rest % static_cast<std::size_t>(axes.cells));
      q[i] = ranges[i].value((index + 0.5) / axes.cells);
    }
    grid->touching_[cell] = meet(a, b, path.pose(q));
  }
  if (std::none_of(grid->touching_.begin(), grid->touching_.end(), [](bool x) { return x; })) return nullptr;
  return grid;
}

}  // namespace fcl_artic
