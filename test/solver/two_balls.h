// SPDX-License-Identifier: BSD-3-Clause
//
// The smallest problem there is: two balls, of which one slides past the other, with times worked out by hand. The
// solver's parts for it, put together as the solver does.
#pragma once

#include "ball.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

/// Ball A, radius 0.5, stands in the origin. Ball B, radius 0.25, slides along z from `from` to `to`, which is 4 m for
/// t in [0, 1]: from -2 it touches at z = -0.75, t = 0.3125, and leaves at z = 0.75, t = 0.6875.
class TwoBalls : public SolverParts {
 public:
  static constexpr engine::PairId kPair{};  ///< their only one, by its number
  static constexpr double kFirst = 0.3125, kLast = 0.6875;

  explicit TwoBalls(double from = -2, double to = 2) {
    const double radius[2] = {0.5, 0.25};
    for (int i = 0; i < 2; ++i) round[i].make(radius[i], bodies[i]);
    step.kind = engine::StepKind::prismatic;
    for (int i = 0; i < 9; ++i) step.C[i] = i % 4 == 0;
    for (double& x : step.p) x = 0;
    step.variable = 0;
    sweep.steps = &step;
    sweep.num_steps = 1;
    coefficients[0] = from;
    coefficients[1] = to - from;
    query.coefficients = coefficients;
    query.num_variables = 1;
    problem.bodies = bodies;
    problem.num_bodies = 2;
    problem.sweeps = &sweep;
    problem.num_sweeps = 1;
  }
  /// As a pair of free bodies: no stage 1.
  TwoBalls& asPair() {
    link_pair.a = 0;
    link_pair.b = 1;
    link_pair.step_b = 0;
    problem.link_pairs = &link_pair;
    problem.num_link_pairs = 1;
    return *this;
  }
  /// B is a link, A an obstacle.
  TwoBalls& asLinkAndObstacle() {
    bodies[1].step = 0;
    bodies[1].mover = 0;
    still.box.radius = 0.5;
    for (int k = 0; k < 3; ++k) still.box.lo[k] = still.box.hi[k] = 0;
    still.tree = &round[0].tree;
    still.solid = true;
    problem.movers = &mover;
    problem.num_movers = problem.num_scene_movers = 1;
    problem.obstacles = &obstacle;
    problem.still_bounds = &still;
    problem.num_obstacles = problem.num_scene_pairs = 1;
    for (int k = 0; k < 3; ++k) {
      obstacle_tree.boxes.lo[k][0] = round[0].node.lo[k];
      obstacle_tree.boxes.hi[k][0] = round[0].node.hi[k];
    }
    obstacle_tree.child[0] = ~0;
    obstacle_tree.num_children = 1;
    problem.obstacle_tree = &obstacle_tree;
    return *this;
  }

  void begin() {
    SolverParts::begin(problem, query);
    horizon.setBatch(task.whole);
  }

  /// Lanes of [0, 1] in which the balls touch at some time.
  static unsigned touching(double first = kFirst, double last = kLast) {
    unsigned lanes = 0;
    for (int k = 0; k < kLanes; ++k) {
      if (0.125 * k <= last && 0.125 * (k + 1) >= first) lanes |= 1u << k;
    }
    return lanes;
  }

  Ball round[2];
  engine::WideNode obstacle_tree = {};
  Body bodies[2];
  engine::SweepStep step;
  engine::SweepView sweep;
  LinkPair link_pair;
  engine::StillBounds still = {};
  std::int32_t mover = 1, obstacle = 0;
  double coefficients[2];
  Problem problem;
  Query query;
};

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
