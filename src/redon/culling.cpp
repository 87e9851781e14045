// SPDX-License-Identifier: BSD-3-Clause
#include "redon/culling.h"

#include <algorithm>
#include <cmath>

namespace fcl_artic {
namespace redon {
namespace {

/// A link is split in time until it moves by no more than this part of its size in a sub-interval. Measured
/// (doc/REDON2004.md).
constexpr double kMotionPerSize = 0.125;
constexpr int kCached = 1024;

using engine::Body;
using engine::Node;

}  // namespace

void Culling::begin(const engine::Problem& problem, const engine::Query& query, const Options& options, Counts& counts) {
  problem_ = &problem;
  query_ = &query;
  options_ = &options;
  counts_ = &counts;
  cache_.resize(kCached << kFinest);
  for (Swept& s : cache_) s.stamp = -1;
  stamp_ = 0;
}

/// Neighbours share the same computed number: no time is left out.
double Culling::timeOf(int level, int k) const {
  return k == 1 << level ? end_ : begin_ + (end_ - begin_) * (static_cast<double>(k) / (1 << level));
}

/// Bounds of a link over the window, on 2^r equal parts; r from how far the ball (center, radius) in the step's frame moves.
Culling::Motion& Culling::motionOf(int sweep, int step, const double* center, double radius) {
  Motion& motion = motions_[static_cast<std::size_t>(sweep)][static_cast<std::size_t>(step)];
  if (motion.level >= 0) return motion;
  const auto chain = [&](int level, int k) -> SweepChains& {
    chains_[level].resize(std::size_t{1} << level);
    chains_set_[level].resize(std::size_t{1} << level, false);
    SweepChains& chain = chains_[level][static_cast<std::size_t>(k)];
    if (!chains_set_[level][static_cast<std::size_t>(k)]) {
      chain.begin(*problem_, *query_, enclosureOf(*options_), false, *counts_);
      chain.setInterval(timeOf(level, k), timeOf(level, k + 1), level ? Derivatives::none : Derivatives::first);
      chains_set_[level][static_cast<std::size_t>(k)] = true;
    }
    return chain;
  };
  int level = options_->refinement_level;
  if (level < 0) {
    const FrameBounds& whole = chain(0, 0).frame(sweep, step);
    const IntervalVec3 v = whole.rate * center;
    double speed = 0, turn = 0;
    for (int k = 0; k < 3; ++k) speed += v[k].magnitude() * v[k].magnitude();
    for (const Interval& x : whole.rate.R.m) turn += x.magnitude() * x.magnitude();
    const double moved = (end_ - begin_) * (std::sqrt(speed) + std::sqrt(turn) * radius);
    level = 0;
    while (level < kFinest && moved > kMotionPerSize * radius * (1 << level)) ++level;
  }
  level = std::min(level, kFinest);
  motion.level = level;
  motion.frames.clear();
  for (int k = 0; k < 1 << level; ++k) motion.frames.push_back(chain(level, k).frame(sweep, step));
  return motion;
}

/// Boxes in the world that hold a link's line swept sphere over each of its sub-intervals.
void Culling::moverBoxes() {
  const std::size_t n = static_cast<std::size_t>(problem_->num_movers);
  mover_boxes_.resize(n);
  mover_levels_.assign(n, 0);
  for (std::size_t m = 0; m < n; ++m) {
    const Body& body = problem_->bodies[problem_->movers[m]];
    std::vector<Box>& boxes = mover_boxes_[m];
    boxes.clear();
    if (body.step < 0) {
      Box box;
      for (int k = 0; k < 3; ++k) box.lo[k] = body.lo[k], box.hi[k] = body.hi[k];
      boxes.push_back(box);
      continue;
    }
    double center[3], axis = 0;
    for (int k = 0; k < 3; ++k) {
      center[k] = 0.5 * (body.lss[k] + body.lss[3 + k]);
      axis += (body.lss[3 + k] - body.lss[k]) * (body.lss[3 + k] - body.lss[k]);
    }
    const Motion& motion = motionOf(0, body.step, center, body.lss[6] + 0.5 * std::sqrt(axis));
    mover_levels_[m] = motion.level;
    for (const FrameBounds& frame : motion.frames) {
      const IntervalVec3 ends = hull(frame.pose * body.lss, frame.pose * (body.lss + 3));
      Box box;
      for (int k = 0; k < 3; ++k) {
        const Interval side = ends[k] + Interval(-body.lss[6], body.lss[6]);
        box.lo[k] = side.lower();
        box.hi[k] = side.upper();
      }
      boxes.push_back(box);
    }
  }
}

void Culling::bodyPairs(double begin, double end, const std::function<bool(std::int32_t)>& wanted, const TreeOf& treeOf,
                        std::vector<BodyPair>& out) {
  begin_ = begin;
  end_ = end;
  motions_.resize(static_cast<std::size_t>(problem_->num_sweeps));
  for (int i = 0; i < problem_->num_sweeps; ++i) {
    auto& steps = motions_[static_cast<std::size_t>(i)];
    steps.resize(static_cast<std::size_t>(problem_->sweeps[i].num_steps));
    for (Motion& m : steps) m.level = -1;
  }
  for (std::vector<bool>& set : chains_set_) std::fill(set.begin(), set.end(), false);
  out.clear();
  masks_.clear();
  moverBoxes();
  const auto add = [&](std::int32_t index, std::uint64_t mask) {
    BodyPair pair;
    pair.index = index;
    pair.parts = partsOf(*problem_, index);
    pair.a = treeOf(pair.parts.a);
    pair.b = treeOf(pair.parts.b);
    pair.inverse_a = enclose(*pair.parts.inverse_a);
    pair.placement_b = enclose(*pair.parts.placement_b);
    out.push_back(pair);
    masks_.push_back(mask);
  };
  if (query_->check_scene && problem_->obstacle_tree) {
    std::vector<std::pair<std::int32_t, std::uint64_t>> stack;
    for (int m = 0; m < problem_->num_scene_movers; ++m) {
      const std::vector<Box>& boxes = mover_boxes_[static_cast<std::size_t>(m)];
      const std::uint64_t all = boxes.size() == 64 ? ~0ull : (1ull << boxes.size()) - 1;
      stack.assign(1, {0, all});
      while (!stack.empty()) {
        const auto [index, parents] = stack.back();
        stack.pop_back();
        const Node& node = problem_->obstacle_tree[index];
        std::uint64_t mask = 0;
        for (std::uint64_t left = parents; left; left &= left - 1) {
          const Box& box = boxes[static_cast<std::size_t>(__builtin_ctzll(left))];
          bool apart = false;
          for (int k = 0; k < 3; ++k) apart = apart || box.lo[k] > node.hi[k] || box.hi[k] < node.lo[k];
          if (!apart) mask |= left & (~left + 1);
        }
        if (!mask) continue;
        if (!node.isLeaf()) {
          stack.push_back({node.right(), mask});
          stack.push_back({node.left(), mask});
          continue;
        }
        const std::int32_t pair = m * problem_->num_obstacles + node.piece();
        if (problem_->scene_allowed && problem_->scene_allowed[pair]) continue;
        if (wanted(pair)) add(pair, mask);
      }
    }
  }
  if (!query_->check_self) return;
  for (int p = 0; p < problem_->num_link_pairs; ++p) {
    const std::int32_t index = problem_->num_scene_pairs + p;
    if (!wanted(index)) continue;
    if (problem_->num_movers) {
      const engine::LinkPair& pair = problem_->link_pairs[p];
      const std::size_t a = static_cast<std::size_t>(problem_->bodies[pair.a].mover);
      const std::size_t b = static_cast<std::size_t>(problem_->bodies[pair.b].mover);
      const int level = std::max(mover_levels_[a], mover_levels_[b]);
      bool meet = false;
      for (int k = 0; k < 1 << level && !meet; ++k) {
        const Box& x = mover_boxes_[a][static_cast<std::size_t>(k >> (level - mover_levels_[a]))];
        const Box& y = mover_boxes_[b][static_cast<std::size_t>(k >> (level - mover_levels_[b]))];
        bool apart = false;
        for (int i = 0; i < 3; ++i) apart = apart || x.lo[i] > y.hi[i] || x.hi[i] < y.lo[i];
        meet = !apart;
      }
      if (!meet) continue;
    }
    add(index, ~0ull);
  }
}

bool Culling::leafPairs(const std::vector<BodyPair>& pairs, std::vector<LeafPair>& out) {
  out.clear();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (!traverse(static_cast<std::int32_t>(i), pairs[i], masks_[i], out)) return false;
  }
  counts_->leaf_pairs += out.size();
  return true;
}

const SweptObb& Culling::swept(const std::vector<ObbNode>& nodes, int node, int k) {
  Swept& s = cache_[(static_cast<std::size_t>(node & (kCached - 1)) << kFinest) | static_cast<std::size_t>(k)];
  if (s.node != node || s.stamp != stamp_) {
    s.node = node;
    s.stamp = stamp_;
    sweep(relative_[static_cast<std::size_t>(k)], nodes[static_cast<std::size_t>(node)], s.box);
  }
  return s.box;
}

/// Both trees down at once, the larger box first. A sub-interval in which two boxes are apart is done with for all below
/// them; the first in which they are not ends the walk.
bool Culling::traverse(std::int32_t number, const BodyPair& pair, std::uint64_t mask, std::vector<LeafPair>& out) {
  const std::vector<ObbNode> &A = pair.a->nodes(), &B = pair.b->nodes();
  ++stamp_;
  relative_.clear();
  int level = 0;
  if (pair.parts.step_b < 0) {
    relative_.push_back(pair.inverse_a * pair.placement_b);
  } else {
    double center[3] = {0, 0, 0}, radius = 0;
    const engine::Placement& p = *pair.parts.placement_b;
    for (int i = 0; i < 3; ++i) {
      center[i] = p.t[i];
      for (int k = 0; k < 3; ++k) center[i] += p.R[3 * i + k] * B[0].center[k];
      radius += static_cast<double>(B[0].half[i]) * B[0].half[i];
    }
    const Motion& motion = motionOf(pair.parts.sweep, pair.parts.step_b, center, std::sqrt(radius));
    level = motion.level;
    for (const FrameBounds& frame : motion.frames) relative_.push_back(relate(pair.inverse_a, frame.pose, pair.placement_b));
  }
  if (level < kFinest) mask &= (1ull << (1 << level)) - 1;

  struct Entry {
    std::int32_t a, b;
    std::uint64_t mask;
  };
  std::vector<Entry> stack{{0, 0, mask}};
  while (!stack.empty()) {
    Entry e = stack.back();
    stack.pop_back();
    const ObbNode &x = A[static_cast<std::size_t>(e.a)], &y = B[static_cast<std::size_t>(e.b)];
    while (e.mask) {
      ++counts_->box_tests;
      if (!certainlyDisjoint(x, swept(B, e.b, __builtin_ctzll(e.mask)), y.half)) {
        break;
      }
      e.mask &= e.mask - 1;
    }
    if (!e.mask) continue;
    if (query_->work_budget && workOf(*counts_) > query_->work_budget) return false;
    if (x.isLeaf() && y.isLeaf()) {
      out.push_back({number, x.triangle(), y.triangle(), timeOf(level, __builtin_ctzll(e.mask))});
    } else if (y.isLeaf() || (!x.isLeaf() && x.size() > y.size())) {
      stack.push_back({x.child + 1, e.b, e.mask});
      stack.push_back({x.child, e.b, e.mask});
    } else {
      stack.push_back({e.a, y.child + 1, e.mask});
      stack.push_back({e.a, y.child, e.mask});
    }
  }
    return true;
}

}  // namespace redon
}  // namespace fcl_artic
