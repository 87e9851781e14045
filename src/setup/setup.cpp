// SPDX-License-Identifier: BSD-3-Clause
#include "setup/setup.h"

#include <algorithm>
#include <cmath>

#include "geometry/solid_space.h"
#include "numerics/constants.h"
#include "threads/parallel.h"

namespace fcl_artic {

void Setup::build(const Registry& registry) {
  if (!isOf(*registry.tree())) robotChanged();
  if (!robot_ready_) buildRobot(registry);
  ready_ = false;
  buildScene(registry);
  listMovers();
  setStrays(registry);
  const auto nameOf = [&](std::int32_t body) -> const std::string& { return registry.body(body).name; };
  margins_ = PairMargins::of(registry.margins(), problem(), nameOf);
  margins_of_neighbours_ = PairMargins::of(registry.marginsOfNeighbours(), problem(), nameOf);
  readSolids(registry);
  sweep_views_.clear();
  for (const FrameSweep& sweep : sweeps_) sweep_views_.push_back(sweep.view());
  proven_.buildScene(registry);
  if (!tables_ready_) {
    proven_.buildSelf(registry, problem(), margins_, num_self_pairs_);
    auto tables = std::make_shared<LinkTables>(*tables_);  // what they know already stays of use
    tables->build(registry, problem(), margins_, num_self_pairs_, proven_);
    tables_ = std::move(tables);
  }
  if (obb_trees_) {
    parallelFor(bodies_.size(), 0,
                [&](std::size_t i) { registry.body(static_cast<std::int32_t>(i)).shape->obbTree(); });
  }
  tables_ready_ = ready_ = true;
}

void Setup::listMovers() {
  const auto mover = [&](std::int32_t body) { return bodies_[static_cast<std::size_t>(body)].mover; };
  link_movers_ = {};
  for (const engine::LinkPair& pair : link_pairs_) link_movers_.pairs.push_back({mover(pair.a), mover(pair.b)});
  addMoverRows(link_movers_.pairs, 0, num_self_pairs_, link_movers_.rows);
  link_movers_.num_self_rows = link_movers_.rows.size();
  addMoverRows(link_movers_.pairs, num_self_pairs_, link_pairs_.size(), link_movers_.rows);
}

void Setup::setStrays(const Registry& registry) {
  const NamedTolerances& tolerances = registry.tolerances();
  strays_.of_robot = tolerances.straysOf(*registry.tree());
  for (FrameSweep& sweep : sweeps_) sweep.setStrays(strays_.of_robot.of_joint);
  const PoseTolerance& base = tolerances.base();
  strays_.base = {base.length, base.angle, {base.pivot[0], base.pivot[1], base.pivot[2]}};
  engine::LargestStrays& largest = strays_.largest = {};
  strays_.moves = false;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const ManagedBody& body = registry.body(static_cast<std::int32_t>(i));
    bodies_[i].stray = body.empty() ? 0 : tolerances.strayOf(body.name, *body.shape);
    largest.stray = std::max(largest.stray, bodies_[i].stray);
    bodies_[i].lag = body.moving && !body.empty() ? tolerances.lagOf(body.name, *body.shape, body.motion) : 0;
    largest.lag = std::max(largest.lag, bodies_[i].lag);
    const ObjectSpeed speed = body.empty() ? ObjectSpeed() : tolerances.speedOf(body.name);
    bodies_[i].speed = speed.speed;
    // Beside a robot that is late it has moved for longer.
    const double since = bodies_[i].since =
        tolerances.ofTime() > 0 ? std::nextafter(speed.since - tolerances.ofTime(), -HUGE_VAL) : speed.since;
    if (!(speed.speed > 0)) continue;
    largest.earliest_since = strays_.moves ? std::min(largest.earliest_since, since) : since;
    largest.speed = std::max(largest.speed, speed.speed);
    strays_.moves = true;
  }
  strays_.any = tolerances.any() || largest.lag > 0;
  strays_.lags = largest.lag > 0 || (strays_.moves && tolerances.ofTime() > 0);
  for (engine::LinkPair& pair : link_pairs_) pair.stray = strays_.any ? strayOf(pair) : 0;
}

/// Upper bound of how much nearer two bodies may be by the strays of all steps between them (doc/NUMERICS.md, "Tubes").
/// A point is no farther from an axis than the lengths between them allow.
double Setup::strayOf(const engine::LinkPair& pair) const {
  const engine::SweepView sweep = sweeps_[static_cast<std::size_t>(pair.sweep)].view();
  const engine::Body &a = bodies_[static_cast<std::size_t>(pair.a)], &b = bodies_[static_cast<std::size_t>(pair.b)];
  if (pair.a >= static_cast<std::int32_t>(num_links_))
    return kInfinity;                                // an obstacle that moves: the base strays, too
  if (a.speed > 0 || b.speed > 0) return kInfinity;  // attached objects, farther with time
  struct Step {
    double chord, length;
  };
  std::vector<Step> steps;  // B's first
  for (std::int32_t i = pair.step_b; i >= 0; i = sweep.steps[i].parent) {
    const engine::SweepStep& step = sweep.steps[i];
    if (!engine::turns(step.kind)) return kInfinity;  // a motion may go beyond its limits
    steps.push_back({std::min(step.stray, 2.0), step.length});
  }
  std::vector<double> moves_a(steps.size() + 1, 0);  // entry k: by the steps from k on, if they move A
  double reach_a = pair.inverse_a.length + a.tree->extent;
  for (std::size_t k = steps.size(); k-- > 0;) {
    reach_a += steps[k].length;
    moves_a[k] = moves_a[k + 1] + steps[k].chord * reach_a;
  }
  double reach_b = pair.placement_b.length + b.tree->extent, moves_b = 0, least = moves_a[0];
  for (std::size_t k = 0; k < steps.size(); ++k) {
    moves_b += steps[k].chord * reach_b;
    reach_b += steps[k].length;
    least = std::min(least, moves_b + moves_a[k + 1]);
  }
  return (least + a.stray + b.stray) * (1 + 4 * static_cast<double>(steps.size() + 4) * kUlp);
}

void Setup::readSolids(const Registry& registry) {
  // Insides are asked about only for pairs with a solid mesh. If there is none, queries skip that.
  solids_ = false;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    bodies_[i].space = registry.body(static_cast<std::int32_t>(i)).shape->space();
    solids_ = solids_ || bodies_[i].space;
  }
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    bodies_[i].points = solids_ ? registry.body(static_cast<std::int32_t>(i)).shape->surfacePoints() : nullptr;
  }
}

engine::Problem Setup::problem() const {
  engine::Problem p;
  p.bodies = bodies_.data();
  p.num_bodies = static_cast<std::int32_t>(bodies_.size());
  p.movers = movers_.data();
  p.num_movers = static_cast<std::int32_t>(movers_.size());
  p.num_scene_movers = static_cast<std::int32_t>(num_links_);
  p.sweeps = sweep_views_.data();
  p.num_sweeps = static_cast<std::int32_t>(sweep_views_.size());
  p.link_pairs = link_pairs_.data();
  p.link_movers = link_movers_.pairs.data();
  p.mover_rows = link_movers_.rows.data();
  p.num_mover_rows = static_cast<std::int32_t>(link_movers_.rows.size());
  p.num_link_pairs = static_cast<std::int32_t>(link_pairs_.size());
  p.num_scene_pairs = static_cast<std::int32_t>(num_links_ * still_.bodies.size());
  p.scene_allowed = still_.allowed.empty() ? nullptr : still_.allowed.data();
  p.num_scene_allowed = still_.num_allowed;
  p.obstacles = still_.bodies.data();
  p.num_obstacles = static_cast<std::int32_t>(still_.bodies.size());
  p.obstacle_tree = still_.tree.empty() ? nullptr : still_.tree.data();
  p.still_bounds = still_.bounds.data();
  p.strays = strays_.any;
  p.base = strays_.base;
  p.largest = strays_.largest;
  p.contained = solids_ ? &findContained : nullptr;
  return p;
}

}  // namespace fcl_artic
