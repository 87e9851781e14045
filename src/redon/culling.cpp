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
constexpr int kCached = 2048;

using engine::Body;
using engine::Node;

}  // namespace

void Culling::begin(const engine::Problem& problem, const engine::Query& query, const Options& options,
                    Counts& counts) {
  problem_ = &problem;
  query_ = &query;
  options_ = &options;
  counts_ = &counts;
  cache_.resize(kCached);
  stamp_pair_ = -1;
  motions_.resize(static_cast<std::size_t>(problem_->num_sweeps));
  for (int i = 0; i < problem_->num_sweeps; ++i) {
    auto& steps = motions_[static_cast<std::size_t>(i)];
    steps.resize(static_cast<std::size_t>(problem_->sweeps[i].num_steps));
    for (Motion& m : steps) m.level = -1;
  }
  for (std::vector<bool>& set : chains_set_) std::fill(set.begin(), set.end(), false);
  moverBoxes();
}

/// Bounds of a link's motion on 2^r equal parts; r from how far the ball (center, radius) in the step's frame moves.
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
    const double moved = std::sqrt(speed) + std::sqrt(turn) * radius;
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

void Culling::bodyPairs(const std::function<bool(std::int32_t)>& wanted, const TreeOf& treeOf,
                        std::vector<BodyPair>& out) {
  out.clear();
  const auto add = [&](std::int32_t index, int level, std::uint64_t mask) {
    BodyPair pair;
    pair.index = index;
    pair.parts = problem_->parts(index);
    pair.a = treeOf(pair.parts.a);
    pair.b = treeOf(pair.parts.b);
    pair.inverse_a = enclose(*pair.parts.inverse_a);
    pair.placement_b = enclose(*pair.parts.placement_b);
    pair.level = level;
    pair.mask = mask;
    out.push_back(pair);
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
        const std::int32_t pair = problem_->scenePair(m, node.piece());
        if (problem_->isAllowed(pair)) continue;
        if (wanted(pair)) add(pair, mover_levels_[static_cast<std::size_t>(m)], mask);
      }
    }
  }
  if (!query_->check_self) return;
  for (int p = 0; p < problem_->num_link_pairs; ++p) {
    const std::int32_t index = problem_->linkPair(p);
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
    add(index, 0, ~0ull);
  }
}

void Culling::start(const std::vector<BodyPair>& pairs) {
  stamp_pair_ = -1;  // boxes of an earlier list of pairs are others
  for (std::vector<Entry>& entries : waiting_) entries.clear();
  traversals_.resize(pairs.size());
  finest_ = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const BodyPair& pair = pairs[i];
    Traversal& t = traversals_[i];
    t.level = 0;
    t.relative.clear();
    if (pair.parts.step_b < 0) {
      t.relative.push_back(pair.inverse_a * pair.placement_b);
    } else {
      const ObbNode& root = pair.b->nodes()[0];
      const engine::Placement& p = *pair.parts.placement_b;
      double center[3], radius = 0;
      for (int k = 0; k < 3; ++k) {
        center[k] = p.t[k];
        for (int j = 0; j < 3; ++j) center[k] += p.R[3 * k + j] * root.center[j];
        radius += static_cast<double>(root.half[k]) * root.half[k];
      }
      const Motion& motion = motionOf(pair.parts.sweep, pair.parts.step_b, center, std::sqrt(radius));
      t.level = motion.level;
      for (const FrameBounds& f : motion.frames) t.relative.push_back(relate(pair.inverse_a, f.pose, pair.placement_b));
    }
    t.mask = pair.mask;
    if (t.level < kFinest) t.mask &= (1ull << (1 << t.level)) - 1;
    finest_ = std::max(finest_, t.level);
  }
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (traversals_[i].mask) wait({static_cast<std::int32_t>(i), 0, 0, traversals_[i].mask});
  }
}

/// Puts a pair of boxes where its first sub-interval begins.
void Culling::wait(const Entry& e) {
  const int level = traversals_[static_cast<std::size_t>(e.pair)].level;
  waiting_[__builtin_ctzll(e.mask) << (finest_ - level)].push_back(e);
}

const SweptObb& Culling::swept(const BodyPair& pair, const Entry& e, int k) {
  if (e.pair != stamp_pair_ || k != stamp_part_) {
    stamp_pair_ = e.pair;
    stamp_part_ = k;
    ++stamp_;
  }
  Swept& s = cache_[static_cast<std::size_t>(e.b & (kCached - 1))];
  if (s.node != e.b || s.stamp != stamp_) {
    s.node = e.b;
    s.stamp = stamp_;
    sweep(traversals_[static_cast<std::size_t>(e.pair)].relative[static_cast<std::size_t>(k)],
          pair.b->nodes()[static_cast<std::size_t>(e.b)], s.box);
  }
  return s.box;
}

/// A bit for each pair of boxes that is apart in the pair's sub-interval: in lanes where there are enough of them.
unsigned Culling::apart(const BodyPair& pair, const Entry* entries, int n, int part) {
  const ObbNode *a[BoxBatch::kPairs], *b[BoxBatch::kPairs];
  for (int i = 0; i < n; ++i) {
    a[i] = &pair.a->nodes()[static_cast<std::size_t>(entries[i].a)];
    b[i] = &pair.b->nodes()[static_cast<std::size_t>(entries[i].b)];
  }
  const BoxBatch& lanes = boxBatch();
  if (n >= lanes.fewest) {
    const Traversal& t = traversals_[static_cast<std::size_t>(entries[0].pair)];
    return lanes.apart(t.relative[static_cast<std::size_t>(part)], a, b, n);
  }
  unsigned out = 0;
  for (int i = 0; i < n; ++i) {
    if (certainlyDisjoint(*a[i], swept(pair, entries[i], part), b[i]->half)) out |= 1u << i;
  }
  return out;
}

/// Both trees down at once, the larger box first. What is apart in a sub-interval is so for all boxes below: these wait
/// for the next one.
bool Culling::leafPairs(const std::vector<BodyPair>& pairs, int slot, std::vector<LeafPair>& out) {
  std::vector<Entry>& stack = waiting_[slot];
  while (!stack.empty()) {
    Entry batch[BoxBatch::kPairs];
    const std::int32_t number = stack.back().pair;
    const int k = __builtin_ctzll(stack.back().mask);
    int n = 0;
    while (n < BoxBatch::kPairs && !stack.empty() && stack.back().pair == number &&
           __builtin_ctzll(stack.back().mask) == k) {
      batch[n++] = stack.back();
      stack.pop_back();
    }
    const BodyPair& pair = pairs[static_cast<std::size_t>(number)];
    const int level = traversals_[static_cast<std::size_t>(number)].level;
    const unsigned apart = this->apart(pair, batch, n, k);
    counts_->box_tests += static_cast<std::uint64_t>(n);
    for (int i = 0; i < n; ++i) {
      Entry& e = batch[i];
      if (apart >> i & 1) {
        e.mask &= e.mask - 1;
        if (e.mask) wait(e);
        continue;
      }
      if (query_->work_budget && workOf(*counts_) > query_->work_budget) return false;
      const ObbNode &x = pair.a->nodes()[static_cast<std::size_t>(e.a)],
                    &y = pair.b->nodes()[static_cast<std::size_t>(e.b)];
      if (x.isLeaf() && y.isLeaf()) {
        ++counts_->leaf_pairs;
        out.push_back(
            {number, x.triangle(), y.triangle(), timeOf(level, k), options_->in_time_order ? timeOf(level, k + 1) : 1});
        e.mask &= e.mask - 1;
        if (e.mask && options_->in_time_order) wait(e);
      } else if (y.isLeaf() || (!x.isLeaf() && x.size() > y.size())) {
        stack.push_back({number, x.child + 1, e.b, e.mask});
        stack.push_back({number, x.child, e.b, e.mask});
      } else {
        stack.push_back({number, e.a, y.child + 1, e.mask});
        stack.push_back({number, e.a, y.child, e.mask});
      }
    }
  }
  return true;
}

}  // namespace redon
}  // namespace fcl_artic
