// SPDX-License-Identifier: BSD-3-Clause
#include "redon/culling.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "redon/parts.h"

namespace fcl_artic {
namespace redon {
namespace {

/// A link is split in time until it moves by no more than this part of its size in a sub-interval. Measured
/// (doc/REDON2004.md).
constexpr double kMotionPerSize = 0.125;
constexpr int kCached = 2048;
/// A level between the whole motion and a link's own. If a link meets no obstacle in an eighth of the motion, that
/// eighth is not divided further.
constexpr int kCoarse = 3;

using engine::Body;

}  // namespace

void Culling::begin(const engine::Problem& problem, const engine::Query& query, const Options& options,
                    Counts& counts) {
  problem_ = &problem;
  query_ = &query;
  options_ = &options;
  counts_ = &counts;
  cache_.resize(kCached);
  stamp_pair_ = -1;
  levels_.resize(static_cast<std::size_t>(problem_->num_sweeps));
  for (int i = 0; i < problem_->num_sweeps; ++i) {
    levels_[static_cast<std::size_t>(i)].assign(static_cast<std::size_t>(problem_->sweeps[i].num_steps), -1);
  }
  std::fill(std::begin(chains_set_), std::end(chains_set_), 0);
  movers_.resize(static_cast<std::size_t>(problem_->num_movers));
  for (std::size_t m = 0; m < movers_.size(); ++m) {
    LssBoxes& mover = movers_[m];
    std::fill(std::begin(mover.made), std::end(mover.made), 0);
    const Body& body = problem_->bodies[problem_->movers[m]];
    mover.level = 0;
    if (body.step < 0) continue;
    double center[3], axis = 0;
    for (int k = 0; k < 3; ++k) {
      center[k] = 0.5 * (body.lss[k] + body.lss[3 + k]);
      axis += (body.lss[3 + k] - body.lss[k]) * (body.lss[3 + k] - body.lss[k]);
    }
    mover.level = levelOf(0, body.step, center, body.lss[6] + 0.5 * std::sqrt(axis));
  }
}

/// All sweeps over part k of 2^level.
SweepChains& Culling::chainsOver(int level, int k) {
  chains_[level].resize(std::size_t{1} << level);
  SweepChains& chains = chains_[level][static_cast<std::size_t>(k)];
  if (!(chains_set_[level] >> k & 1)) {
    chains.begin(*problem_, *query_, enclosureOf(*options_), false, *counts_);
    chains.setInterval(timeOf(level, k), timeOf(level, k + 1), level ? Derivatives::none : Derivatives::first);
    chains_set_[level] |= 1ull << k;
  }
  return chains;
}

const IntervalTransform& Culling::poseOver(int level, int k, int sweep, int step) {
  return chainsOver(level, k).frame(sweep, step).pose;
}

/// A link's r_i, from how far the ball (center, radius) in its step's frame moves.
int Culling::levelOf(int sweep, int step, const double* center, double radius) {
  int& level = levels_[static_cast<std::size_t>(sweep)][static_cast<std::size_t>(step)];
  if (level >= 0) return level;
  level = options_->refinement_level;
  if (level < 0) {
    const FrameBounds& whole = chainsOver(0, 0).frame(sweep, step);
    const IntervalVec3 v = whole.rate * center;
    double speed = 0, turn = 0;
    for (int k = 0; k < 3; ++k) speed += v[k].magnitude() * v[k].magnitude();
    for (const Interval& x : whole.rate.R.m) turn += x.magnitude() * x.magnitude();
    const double moved = std::sqrt(speed) + std::sqrt(turn) * radius;
    level = 0;
    while (level < kFinest && moved > kMotionPerSize * radius * (1 << level)) ++level;
  }
  return level;
}

/// Box in the world that holds a mover's line swept sphere over part k of 2^level.
const Culling::Box& Culling::boxOf(std::int32_t number, int level, int k) {
  LssBoxes& mover = movers_[static_cast<std::size_t>(number)];
  const Body& body = problem_->bodies[problem_->movers[number]];
  if (body.step < 0) level = k = 0;
  mover.boxes[level].resize(std::size_t{1} << level);
  Box& box = mover.boxes[level][static_cast<std::size_t>(k)];
  if (mover.made[level] >> k & 1) return box;
  mover.made[level] |= 1ull << k;
  if (body.step < 0) {
    for (int i = 0; i < 3; ++i) box.lo[i] = body.lo[i], box.hi[i] = body.hi[i];
    return box;
  }
  const IntervalTransform& pose = poseOver(level, k, 0, body.step);
  const IntervalVec3 ends = hull(pose * body.lss, pose * (body.lss + 3));
  for (int i = 0; i < 3; ++i) {
    const Interval side = ends[i] + Interval(-body.lss[6], body.lss[6]);
    box.lo[i] = side.lower();
    box.hi[i] = side.upper();
  }
  return box;
}

/// Divides the parts of `mask`, of 2^level, into parts of 2^finer. @return the parts in which the mover's box meets
/// this one.
std::uint64_t Culling::divide(std::int32_t mover, int level, std::uint64_t mask, int finer, const double* lo,
                              const double* hi) {
  std::uint64_t out = 0;
  for (std::uint64_t left = partsAt(finer, mask, level); left; left &= left - 1) {
    if (!boxOf(mover, finer, __builtin_ctzll(left)).certainlyApart(lo, hi)) out |= left & (~left + 1);
  }
  return out;
}

/// The parts in which two movers' boxes meet, of 2^level parts: `level` is no lower than either mover's own.
std::uint64_t Culling::meetingParts(std::int32_t a, std::int32_t b, int level) {
  const int own_a = movers_[static_cast<std::size_t>(a)].level, own_b = movers_[static_cast<std::size_t>(b)].level;
  std::uint64_t mask = 1;
  int at = 0;
  for (const int finer : {0, std::min(kCoarse, level), level}) {
    std::uint64_t met = 0;
    for (std::uint64_t left = partsAt(finer, mask, at); left; left &= left - 1) {
      const int k = __builtin_ctzll(left), level_a = std::min(finer, own_a), level_b = std::min(finer, own_b);
      const Box& box = boxOf(b, level_b, partHolding(level_b, k, finer));
      if (!boxOf(a, level_a, partHolding(level_a, k, finer)).certainlyApart(box.lo, box.hi)) met |= 1ull << k;
    }
    mask = met;
    at = finer;
    if (!mask) return 0;
  }
  return mask;
}

void Culling::bodyPairs(const std::function<bool(engine::PairId)>& wanted, const TreeOf& treeOf,
                        std::vector<BodyPair>& out) {
  out.clear();
  const auto add = [&](engine::PairId index, int level, std::uint64_t mask) {
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
    std::vector<std::int32_t> stack;
    for (std::int32_t m = 0; m < problem_->num_scene_movers; ++m) {
      const int level = movers_[static_cast<std::size_t>(m)].level;
      stack.assign(1, 0);
      while (!stack.empty()) {
        const engine::WideNode& node = problem_->obstacle_tree[stack.back()];
        stack.pop_back();
        for (std::int32_t i = 0; i < node.num_children; ++i) {
          const engine::EightBoxes& boxes = node.boxes;
          const double lo[3] = {boxes.lo[0][i], boxes.lo[1][i], boxes.lo[2][i]};
          const double hi[3] = {boxes.hi[0][i], boxes.hi[1][i], boxes.hi[2][i]};
          if (boxOf(m, 0, 0).certainlyApart(lo, hi)) continue;
          if (node.child[i] >= 0) {
            stack.push_back(node.child[i]);
            continue;
          }
          const engine::PairId pair = problem_->scenePair(m, problem_->still_bounds[~node.child[i]].obstacle);
          if (!wanted(pair)) continue;
          const int coarse = std::min(kCoarse, level);
          std::uint64_t mask = divide(m, 0, 1, coarse, lo, hi);
          if (mask && coarse < level) mask = divide(m, coarse, mask, level, lo, hi);
          if (mask) add(pair, level, mask);
        }
      }
    }
  }
  if (!query_->check_self) return;
  for (int p = 0; p < problem_->num_link_pairs; ++p) {
    const engine::PairId index = problem_->linkPair(p);
    if (!wanted(index)) continue;
    if (!problem_->num_movers) {
      add(index, 0, 1);
      continue;
    }
    const engine::LinkPair& pair = problem_->link_pairs[p];
    const std::int32_t a = problem_->bodies[pair.a].mover, b = problem_->bodies[pair.b].mover;
    const int level = std::max(movers_[static_cast<std::size_t>(a)].level, movers_[static_cast<std::size_t>(b)].level);
    const std::uint64_t mask = meetingParts(a, b, level);
    if (mask) add(index, level, mask);
  }
}

/// Two links that are both bounded in the world (Section 5.1.1).
bool Culling::inWorld(const BodyPair& pair) const {
  const auto isLink = [&](std::int32_t body) {
    const std::int32_t mover = problem_->bodies[body].mover;
    return mover >= 0 && mover < problem_->num_scene_movers;
  };
  return options_->links_in_world && !problem_->isScenePair(pair.index) && isLink(pair.parts.a) && isLink(pair.parts.b);
}

void Culling::start(const std::vector<BodyPair>& pairs) {
  stamp_pair_ = -1;  // boxes of an earlier list of pairs are others
  for (std::vector<NodePair>& entries : waiting_) entries.clear();
  relative_poses_.resize(pairs.size());
  finest_ = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const BodyPair& pair = pairs[i];
    RelativePoses& t = relative_poses_[i];
    t.made = 0;
    if (inWorld(pair)) {
      const auto own = [&](std::int32_t body) {
        return movers_[static_cast<std::size_t>(problem_->bodies[body].mover)].level;
      };
      t.level = std::max(own(pair.parts.a), own(pair.parts.b));
    } else if (pair.parts.step_b < 0) {
      t.level = 0;
    } else {
      const ObbNode& root = pair.b->nodes()[0];
      const engine::Placement& p = *pair.parts.placement_b;
      double center[3], radius = 0;
      for (int k = 0; k < 3; ++k) {
        center[k] = p.t[k];
        for (int j = 0; j < 3; ++j) center[k] += p.R[3 * k + j] * root.center[j];
        radius += static_cast<double>(root.half[k]) * root.half[k];
      }
      t.level = levelOf(pair.parts.sweep, pair.parts.step_b, center, std::sqrt(radius));
    }
    t.relative.resize(std::size_t{1} << t.level);
    t.mask = partsAt(t.level, pair.mask, pair.level);
    finest_ = std::max(finest_, t.level);
  }
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (relative_poses_[i].mask) wait({static_cast<std::int32_t>(i), 0, 0, relative_poses_[i].mask});
  }
}

/// B's tree frame in A's over sub-interval k of the pair.
const IntervalTransform& Culling::relativeOver(const BodyPair& pair, RelativePoses& t, int k) {
  IntervalTransform& relative = t.relative[static_cast<std::size_t>(k)];
  if (t.made >> k & 1) return relative;
  t.made |= 1ull << k;
  if (inWorld(pair)) {
    const auto placed = [&](std::int32_t number) {
      const Body& body = problem_->bodies[number];
      const int level = movers_[static_cast<std::size_t>(body.mover)].level;
      return poseOver(level, partHolding(level, k, t.level), 0, body.step) * enclose(body.placement);
    };
    relative = inverse(placed(pair.parts.a)) * placed(pair.parts.b);
  } else {
    relative = relate(pair.inverse_a, poseOver(t.level, k, pair.parts.sweep, pair.parts.step_b), pair.placement_b);
  }
  return relative;
}

/// Puts a pair of boxes where its first sub-interval begins.
void Culling::wait(const NodePair& e) {
  const int level = relative_poses_[static_cast<std::size_t>(e.pair)].level;
  waiting_[__builtin_ctzll(e.mask) << (finest_ - level)].push_back(e);
}

const SweptObb& Culling::swept(const BodyPair& pair, const NodePair& e, int k) {
  if (e.pair != stamp_pair_ || k != stamp_part_) {
    stamp_pair_ = e.pair;
    stamp_part_ = k;
    ++stamp_;
  }
  CachedBox& s = cache_[static_cast<std::size_t>(e.b & (kCached - 1))];
  if (s.node != e.b || s.stamp != stamp_) {
    s.node = e.b;
    s.stamp = stamp_;
    sweep(relativeOver(pair, relative_poses_[static_cast<std::size_t>(e.pair)], k),
          pair.b->nodes()[static_cast<std::size_t>(e.b)], s.box);
  }
  return s.box;
}

/// A bit for each pair of boxes that is apart in the pair's sub-interval. If there are enough of them, they are tested
/// in lanes.
unsigned Culling::apart(const BodyPair& pair, const NodePair* entries, int n, int part) {
  const ObbNode *a[BoxBatch::kPairs], *b[BoxBatch::kPairs];
  for (int i = 0; i < n; ++i) {
    a[i] = &pair.a->nodes()[static_cast<std::size_t>(entries[i].a)];
    b[i] = &pair.b->nodes()[static_cast<std::size_t>(entries[i].b)];
  }
  const BoxBatch& lanes = boxBatch();
  if (n >= lanes.fewest) {
    return lanes.apart(relativeOver(pair, relative_poses_[static_cast<std::size_t>(entries[0].pair)], part), a, b, n);
  }
  unsigned out = 0;
  for (int i = 0; i < n; ++i) {
    if (certainlyDisjoint(*a[i], swept(pair, entries[i], part), b[i]->half)) out |= 1u << i;
  }
  return out;
}

/// Both trees down at once, the larger box first. Boxes that are apart in a sub-interval hold only boxes that are apart
/// in it: these wait for the next sub-interval.
bool Culling::leafPairs(const std::vector<BodyPair>& pairs, int slot, std::vector<LeafPair>& out) {
  std::vector<NodePair>& stack = waiting_[slot];
  while (!stack.empty()) {
    NodePair batch[BoxBatch::kPairs];
    const std::int32_t number = stack.back().pair;
    const int k = __builtin_ctzll(stack.back().mask);
    int n = 0;
    while (n < BoxBatch::kPairs && !stack.empty() && stack.back().pair == number &&
           __builtin_ctzll(stack.back().mask) == k) {
      batch[n++] = stack.back();
      stack.pop_back();
    }
    const BodyPair& pair = pairs[static_cast<std::size_t>(number)];
    const int level = relative_poses_[static_cast<std::size_t>(number)].level;
    const unsigned apart = this->apart(pair, batch, n, k);
    counts_->box_tests += static_cast<std::uint64_t>(n);
    for (int i = 0; i < n; ++i) {
      NodePair& e = batch[i];
      if (apart >> i & 1) {
        e.mask &= e.mask - 1;
        if (e.mask) wait(e);
        continue;
      }
      if (query_->work_budget && workOf(*counts_) > query_->work_budget) return false;
      const ObbNode &x = pair.a->nodes()[static_cast<std::size_t>(e.a)],
                    &y = pair.b->nodes()[static_cast<std::size_t>(e.b)];
      const auto push = [&](std::int32_t a, std::int32_t b) { stack.push_back({number, a, b, e.mask}); };
      if (x.isLeaf() && y.isLeaf()) {
        ++counts_->leaf_pairs;
        out.push_back(
            {number, x.triangle(), y.triangle(), timeOf(level, k), options_->in_time_order ? timeOf(level, k + 1) : 1});
        e.mask &= e.mask - 1;
        if (e.mask && options_->in_time_order) wait(e);
      } else if (y.isLeaf() || (!x.isLeaf() && x.size() > y.size())) {
        push(x.child + 1, e.b);
        push(x.child, e.b);
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
