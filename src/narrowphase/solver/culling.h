// SPDX-License-Identifier: BSD-3-Clause
//
// Stage 1: pairs whose swept bounds meet; and the query's own stage behind it.
#pragma once

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

/// Swept box of a body's line swept sphere in the world, one per lane (Redon 2004, Section 4).
inline void Solver::sweptLss(int mover, SweptBox& box) {
  const Body& body = problem_->bodies[problem_->movers[mover]];
  const double margin = max(query_->margin, problem_->largest_margin);  // whatever the partner
  if (body.step < 0) {
    for (int k = 0; k < 3; ++k) {
      box.lo[k] = narrowDown(Lanes(body.lo[k] - margin));
      box.hi[k] = narrowUp(Lanes(body.hi[k] + margin));
    }
    return;
  }
  const FrameLanes& f = frames(0)[body.step];
  const StepBounds& b = bounds_[first_step_[0] + body.step];
  const double radius = (body.lss[6] + margin) * (1 + 4 * kUlp);
  const bool first_order = problem_->sweeps[0].first_order;
  Lanes lo[2][3], hi[2][3];
  for (int end = 0; end < 2; ++end) sweepBall(f, b, first_order, body.lss + 3 * end, radius, d_, lo[end], hi[end]);
  for (int k = 0; k < 3; ++k) {
    box.lo[k] = narrowDown(min(lo[0][k], lo[1][k]));
    box.hi[k] = narrowUp(max(hi[0][k], hi[1][k]));
  }
}

/// Stage 1: pairs whose swept bounds meet, with the lanes in which they do, to entries_.
inline void Solver::cull() {
  beginBatch(0, 1);
  mover_box_.resize(problem_->num_movers);
  for (int m = 0; m < problem_->num_movers; ++m) sweptLss(m, mover_box_[m]);
  if (query_->check_scene && problem_->obstacle_tree) {
    statistics_.pairs += static_cast<std::uint64_t>(problem_->num_scene_pairs);
    for (int m = 0; m < problem_->num_scene_movers; ++m) {
      const SweptBox& box = mover_box_[m];
      Buffer<Entry>& stack = stack_[0];
      stack.push({0, 0, 0, 0});
      while (stack.size()) {
        const Node& node = problem_->obstacle_tree[stack[stack.size() - 1].a];
        stack.truncate(stack.size() - 1);
        const unsigned mask = kAllLanes & ~apart(box, node);
        if (!mask) continue;
        if (!node.isLeaf()) {
          stack.push({0, node.right(), 0, 0});
          stack.push({0, node.left(), 0, 0});
          continue;
        }
        const int pair = m * problem_->num_obstacles + node.piece();
        if (!problem_->scene_allowed || !problem_->scene_allowed[pair]) entries_.push({pair, 0, 0, mask});
      }
    }
  }
  if (query_->check_self && !problem_->num_movers) {  // no stage 1: pairs of free bodies
    statistics_.pairs += static_cast<std::uint64_t>(problem_->num_link_pairs);
    for (int p = 0; p < problem_->num_link_pairs; ++p) {
      if (!linkAllowed(p)) entries_.push({problem_->num_scene_pairs + p, 0, 0, kAllLanes});
    }
  } else if (query_->check_self) {
    statistics_.pairs += static_cast<std::uint64_t>(problem_->num_link_pairs);
    for (int p = 0; p < problem_->num_link_pairs; ++p) {
      const unsigned open = linkAllowed(p) ? 0 : problem_->link_free ? kAllLanes & ~problem_->link_free[p] : kAllLanes;
      if (!open) continue;
      const LinkPair& pair = problem_->link_pairs[p];
      const SweptBox& a = mover_box_[problem_->bodies[pair.a].mover];
      const SweptBox& b = mover_box_[problem_->bodies[pair.b].mover];
      FloatLanes out = greater(a.lo[0], b.hi[0]) | greater(b.lo[0], a.hi[0]);
      for (int k = 1; k < 3; ++k) out = out | greater(a.lo[k], b.hi[k]) | greater(b.lo[k], a.hi[k]);
      const unsigned mask = open & ~lanesOf(out);
      if (mask) entries_.push({problem_->num_scene_pairs + p, 0, 0, mask});
    }
  }
  statistics_.pairs_after_culling += static_cast<std::uint64_t>(entries_.size());
}

/// A body's line swept sphere in each lane of [0, 1]: both ends' Bernstein points, and the larger of their radii.
inline void Solver::sweptSegments(int mover, engine::SweptLink* parts) {
  const Body& body = problem_->bodies[problem_->movers[mover]];
  const double radius = body.lss[6];
  double slack = radius;
  for (int end = 0; end < 2; ++end) {
    const double* p = body.lss + 3 * end;
    Lanes c[3][3];
    if (body.step < 0) {
      for (int k = 0; k < 3; ++k) {
        c[0][k] = Lanes(p[k]);
        c[1][k] = c[2][k] = Lanes(0.0);
      }
    } else {
      const StepBounds& b = bounds_[first_step_[0] + body.step];
      slack = max(slack, sweepCenter(frames(0)[body.step], b, problem_->sweeps[0].first_order, p, radius, d_, c));
    }
    for (int lane = 0; lane < kLanes; ++lane) {
      for (int k = 0; k < 3; ++k) {
        const double c0 = c[0][k][lane], c1 = c[1][k][lane], c2 = c[2][k][lane];
        parts[lane].points[end][k] = c0 - c1 + c2;
        parts[lane].points[2 + end][k] = c0 + c1 + c2;
        parts[lane].points[4 + end][k] = c0 - c2;
      }
    }
  }
  for (int lane = 0; lane < kLanes; ++lane) parts[lane].radius = slack * (1 + 4 * kUlp);
}

/// Stage 2, where the query brings one: pairs of links and still obstacles that it proves free are left out. (Pairs that are
/// not its business come behind them.)
inline void Solver::refine() {
  candidate_pairs_.clear();
  swept_links_.resize(kLanes * problem_->num_movers);
  int previous = -1;
  for (int i = 0; i < entries_.size() && entries_[i].pair < problem_->num_scene_pairs; ++i) {
    const Entry& e = entries_[i];
    const int mover = e.pair / problem_->num_obstacles;
    if (mover != previous) sweptSegments(previous = mover, swept_links_.data() + kLanes * mover);
    candidate_pairs_.push({e.pair, mover, problem_->obstacles[e.pair % problem_->num_obstacles], e.mask,
                           engine::marginOf(*problem_, query_->margin, e.pair)});
  }
  const int asked = candidate_pairs_.size();
  if (!asked) return;
  query_->refine(query_->refine_context, *problem_, swept_links_.data(), candidate_pairs_.data(), asked);
  int kept = 0;
  for (int i = 0; i < entries_.size(); ++i) {
    Entry e = entries_[i];
    if (i < asked) e.mask &= candidate_pairs_[i].lanes;
    if (e.mask) entries_[kept++] = e;
  }
  entries_.truncate(kept);
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
