// SPDX-License-Identifier: BSD-3-Clause
//
// The robot's part of the set-up: links as bodies that the world's sweep carries, and pairs of links with the sweep
// along the path between them.
#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "setup/neighbours.h"
#include "setup/setup.h"
#include "threads/parallel.h"

namespace fcl_artic {

void Setup::buildPairs(const Registry& registry, const IsChecked& asked) {
  buildSelfPairs(registry, buildLinks(registry), [&](const ManagedBody& a, const ManagedBody& b) {
    return !a.empty() && !b.empty() && !a.attached && !b.attached && asked(a, b);
  });
  listMovers();
  readSolids(registry);
  sweep_views_.clear();
  for (const FrameSweep& sweep : sweeps_) sweep_views_.push_back(sweep.view());
}

void Setup::buildRobot(const Registry& registry) {
  const std::vector<Carrier> carriers = buildLinks(registry);
  buildSelfPairs(registry, carriers, [&](const ManagedBody& a, const ManagedBody& b) {
    return !a.empty() && !b.empty() && registry.excuseOf(a, b) == Excuse::none;
  });
  tables_ready_ = false;
  tree_ = registry.tree()->content();
  robot_ready_ = true;
}

/// @return where each link is carried.
std::vector<Carrier> Setup::buildLinks(const Registry& registry) {
  const std::vector<ManagedBody>& links = registry.links();
  num_links_ = links.size();
  sweeps_.clear();
  sweeps_.push_back(FrameSweep::fromWorld(*registry.tree()));
  bodies_.assign(links.size(), engine::Body());
  // Shapes compute some of their data when they are first asked. That is most of a set-up, so all cores do it here.
  parallelFor(links.size(), 0, [&](std::size_t i) {
    links[i].shape->viewWithParts();
    links[i].shape->innerBalls();
    links[i].shape->lineSweptSphere();
  });
  const engine::SweepView world = sweeps_[0].view();
  std::vector<int> depth_of_step(static_cast<std::size_t>(world.num_steps)), depth(links.size(), 0);
  for (std::size_t s = 0; s < depth_of_step.size(); ++s) {
    const int parent = world.steps[s].parent;  // comes before it
    depth_of_step[s] = 1 + (parent < 0 ? 0 : depth_of_step[static_cast<std::size_t>(parent)]);
  }
  std::vector<Carrier> carriers(links.size());
  for (std::size_t i = 0; i < links.size(); ++i) {
    const ManagedBody& link = links[i];
    engine::Body& body = bodies_[i];
    const Carrier carrier = carriers[i] = sweeps_[0].carrier(link.link);
    const Eigen::Isometry3d in_step = carrier.offset * link.offset;
    // Stage 1 goes into what is large among objects; links are cut into parts.
    const bool entered = link.attached && link.shape->viewWithUpperNodes().upper;
    body.tree = entered ? &link.shape->viewWithUpperNodes() : &link.shape->viewWithParts();
    body.balls = link.shape->innerBalls();
    body.step = carrier.step;
    body.placement = makePlacement(carrier, link.offset);
    const LineSweptSphere& lss = link.shape->lineSweptSphere();
    body.tree_lss = lss.data();
    const Eigen::Vector3d p0 = in_step * Eigen::Vector3d::Map(&lss[0]), p1 = in_step * Eigen::Vector3d::Map(&lss[3]);
    for (int k = 0; k < 3; ++k) {
      body.lss[k] = p0[k];
      body.lss[3 + k] = p1[k];
    }
    const double reach = Eigen::Vector3d::Map(&lss[0]).norm() + Eigen::Vector3d::Map(&lss[3]).norm();
    body.lss[6] = lss[6] + 0x1p-52 * (body.placement.ulps + 16) * (lss[6] + reach + body.placement.length);
    link.worldBox(in_step, body.placement, body.lo, body.hi);  // right where step < 0, not used elsewhere
    if (carrier.step >= 0) depth[i] = depth_of_step[static_cast<std::size_t>(carrier.step)];
  }
  movers_.resize(links.size());
  for (std::size_t i = 0; i < links.size(); ++i) movers_[i] = static_cast<std::int32_t>(i);
  // Distal links first: they move most and are the likeliest to touch, so that t_upper cuts the others' work.
  std::stable_sort(movers_.begin(), movers_.end(), [&](std::int32_t a, std::int32_t b) {
    return depth[static_cast<std::size_t>(a)] > depth[static_cast<std::size_t>(b)];
  });
  for (std::size_t m = 0; m < movers_.size(); ++m) {
    bodies_[static_cast<std::size_t>(movers_[m])].mover = static_cast<std::int32_t>(m);
  }
  return carriers;
}

/// @param checked  of two geometries on different links: whether they make a pair.
void Setup::buildSelfPairs(const Registry& registry, const std::vector<Carrier>& carriers, const IsChecked& checked) {
  const KinematicTree& tree = *registry.tree();
  const std::vector<ManagedBody>& links = registry.links();
  link_pairs_.clear();
  std::map<LinkId, std::int32_t> sweep_of;  // base link to sweep
  registry.forEachTwoLinks([&](std::size_t i, std::size_t j) {
    if (!checked(links[i], links[j])) return;
    // The shorter path first: an ancestor is the base.
    std::size_t a = i, b = j;
    if (linkAbove(tree, links[j].link, links[i].link)) std::swap(a, b);
    engine::LinkPair pair;
    pair.a = static_cast<std::int32_t>(a);
    pair.b = static_cast<std::int32_t>(b);
    if (bodies_[a].step < 0) {  // stands still: the world's sweep serves
      pair.inverse_a = makeInversePlacement(carriers[a], links[a].offset);
      pair.step_b = bodies_[b].step;
      pair.placement_b = bodies_[b].placement;
    } else {
      const auto next = static_cast<std::int32_t>(sweeps_.size());
      const auto [sweep, is_new] = sweep_of.try_emplace(links[a].link, next);
      if (is_new) sweeps_.push_back(FrameSweep::fromLink(tree, links[a].link));
      pair.sweep = sweep->second;
      const Carrier carrier = sweeps_[static_cast<std::size_t>(pair.sweep)].carrier(links[b].link);
      pair.step_b = carrier.step;
      pair.inverse_a = makePlacement(links[a].offset.inverse());
      pair.placement_b = makePlacement(carrier, links[b].offset);
    }
    link_pairs_.push_back(pair);
  });
  num_link_sweeps_ = sweeps_.size();
  // Large links first: they are the likeliest to touch, which helps queries for any contact.
  const auto size = [&](const engine::LinkPair& pair) {
    const auto radius = [&](std::int32_t body) {
      return bodies_[static_cast<std::size_t>(body)].tree->nodes[0].radius;
    };
    return radius(pair.a) + radius(pair.b);
  };
  std::stable_sort(link_pairs_.begin(), link_pairs_.end(),
                   [&](const engine::LinkPair& p, const engine::LinkPair& q) { return size(p) > size(q); });
  num_self_pairs_ = link_pairs_.size();
}

}  // namespace fcl_artic
