// SPDX-License-Identifier: BSD-3-Clause
//
// Stage 1: pairs whose swept bounds meet; and the query's own stage behind it.
#pragma once

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

/// A mover's line swept sphere over the present batch, and its box in the world (Redon 2004, Section 4). Of a moving
/// obstacle only the box of its whole path is known.
inline void Solver::sweepMover(int mover) {
  const Body& body = problem_->bodies[problem_->movers[mover]];
  const double margin = query_->margins.largest();  // whatever the partner
  SweptBox& box = mover_box_[mover];
  if (isLink(mover)) {
    static const StepBounds kStill = {};
    const FrameLanes* frame = body.step < 0 ? nullptr : &frames(0)[body.step];
    sweepLss(frame, frame ? bounds_[first_step_[0] + body.step] : kStill, problem_->sweeps[0].first_order, body, d_,
             mover_lss_[mover]);
    if (frame) {
      Lanes lo[3], hi[3];
      boundLss(mover_lss_[mover], margin, lo, hi);
      for (int k = 0; k < 3; ++k) {
        box.lo[k] = narrowDown(lo[k]);
        box.hi[k] = narrowUp(hi[k]);
      }
      return;
    }
  }
  for (int k = 0; k < 3; ++k) {
    box.lo[k] = narrowDown(Lanes(body.lo[k] - margin));
    box.hi[k] = narrowUp(Lanes(body.hi[k] + margin));
  }
}

/// Lanes of `mask` in which a link and an obstacle that stands still are not certainly apart by the link's line swept
/// sphere. Where that is deep in a solid contact is expected. Where any will do, a vertex in the solid and a chord of
/// it are tried at once, the chord first where the solid is thin; and the pose is put down for proveAnywhere() where
/// the link's axis is very near. Else later lanes are put off.
/// @param[out] direction  from the obstacle to the link, as in Direction.
inline unsigned Solver::lssMayTouch(int mover, int obstacle_number, unsigned mask, Lanes* direction) {
  const int pair = mover * problem_->num_obstacles + obstacle_number;
  const engine::StillBounds& obstacle = problem_->still_bounds[obstacle_number];
  const SweptLss& lss = mover_lss_[mover];
  Lanes square, nearest[3];
  const double margin = query_->margins.of(pair);
  mask &= ~certainlyApart(lss, obstacle.box, obstacle.inverse, margin, square, nearest, direction);
  const auto nearer = [&](double part) {
    return mask & ~greater(square, Lanes(part * part * lss.radius * lss.radius));
  };
  const unsigned deep = nearer(kDeep);
  if (!deep || !obstacle.solid || query_->every_pair || !watching_) return mask;
  if (!query_->any) {
    claimOverlap(__builtin_ctz(deep));
    return mask;
  }
  // Where the segment is nearest; the middle one of several lanes in which it is as near.
  double least = square[__builtin_ctz(deep)];
  for (int k = 0; k < kLanes; ++k) least = deep >> k & 1 ? min(least, square[k]) : least;
  const int lane = middleLane(deep & ~greater(square, Lanes(least)));
  const double near[3] = {nearest[0][lane], nearest[1][lane], nearest[2][lane]};
  if (proveByBallInSolid(pair, lane)) return mask;
  setupPair(pair);
  const bool thin = widthOfRod(obstacle.tree->pieces[0]) < kThin * lss.radius;
  if (thin && provePierced(pair, lane, near)) return mask;
  if (proveVertexInside(pair, lane)) return mask;
  if (!thin && provePierced(pair, lane, near)) return mask;
  if (const unsigned lanes = nearer(kVeryDeep)) overlapping_.push({pair, 0, 0, lanes});
  return mask;
}

/// Asks for an object's cache lines before they are needed.
template <class T>
FCL_ARTIC_INLINE void prefetch(const T* object) {
  for (unsigned i = 0; i < sizeof(T); i += 64) __builtin_prefetch(reinterpret_cast<const char*>(object) + i);
}

/// Obstacles whose boxes meet a swept box, to met_. Level by level, so that what is looked at next is fetched
/// meanwhile.
inline void Solver::meetObstacles(const SweptBox& box) {
  const Node* nodes = problem_->obstacle_tree;
  met_.resize(problem_->num_obstacles + 1);
  open_nodes_.resize(problem_->num_obstacles + 1);
  Met* met = met_.data();
  std::int32_t *open = open_nodes_.data(), *last = open;
  const auto meet = [&](int index) {
    const Node& node = nodes[index];
    const unsigned mask = kAllLanes & ~apart(box, node);
    if (!mask) return;
    if (node.isLeaf()) {
      *met++ = {node.piece(), mask};
      prefetch(problem_->still_bounds + node.piece());
    } else {
      *last++ = node.child;
      prefetch(nodes + node.child);
    }
  };
  meet(0);
  for (; open < last; ++open) {
    const int left = *open;
    meet(left);
    meet(left + 1);
  }
  met_.truncate(static_cast<int>(met - met_.data()));
}

/// Where any contact is asked for: balls inside links, where these are likely to meet. (Kept out of cull(), which is
/// every query's way.)
[[gnu::noinline, gnu::cold]] inline bool Solver::proveWhereLikely() {
  for (int i = 0; i < query_->num_likely; ++i) {
    const auto [link_pair, part] = query_->likely[i];
    const int pair = problem_->num_scene_pairs + link_pair;
    if (!linkAllowed(link_pair) && proveByBalls(pair, part)) return true;
  }
  return false;
}

/// Stage 1: pairs whose swept bounds meet, with the lanes in which they do, to entries_.
inline void Solver::cull() {
  beginBatch(0, 1);
  mover_box_.resize(problem_->num_movers);
  mover_lss_.resize(problem_->num_scene_movers);
  const bool check_scene = query_->check_scene && problem_->obstacle_tree;
  if (check_scene) statistics_.pairs += static_cast<std::uint64_t>(problem_->num_scene_pairs);
  const bool look = query_->any && !query_->every_pair && watching_;
  if (look && query_->num_likely && proveWhereLikely()) return;
  for (int m = 0; m < problem_->num_movers; ++m) {
    sweepMover(m);
    if (!check_scene || !isLink(m)) continue;
    meetObstacles(mover_box_[m]);
    for (int i = 0; i < met_.size() && !finished(); ++i) {
      const int pair = m * problem_->num_obstacles + met_[i].obstacle;
      if (problem_->scene_allowed && problem_->scene_allowed[pair]) continue;
      Direction direction;
      if (const unsigned left = lssMayTouch(m, met_[i].obstacle, met_[i].mask, direction.l)) {
        entries_.push({pair, 0, 0, left});
        directions_.push(direction);
        prefetch(problem_->still_bounds[met_[i].obstacle].tree);
      }
    }
    if (finished()) return;
  }
  if (query_->check_self && !problem_->num_movers) {  // no stage 1: pairs of free bodies
    statistics_.pairs += static_cast<std::uint64_t>(problem_->num_link_pairs);
    for (int p = 0; p < problem_->num_link_pairs; ++p) {
      if (!linkAllowed(p)) entries_.push({problem_->num_scene_pairs + p, 0, 0, kAllLanes});
    }
  } else if (query_->check_self) {
    statistics_.pairs += static_cast<std::uint64_t>(problem_->num_link_pairs);
    const std::uint8_t* free = query_->link_free ? query_->link_free(query_->link_free_context) : nullptr;
    for (int p = 0; p < problem_->num_link_pairs && !finished(); ++p) {
      const unsigned open = linkAllowed(p) ? 0 : free ? kAllLanes & ~free[p] : kAllLanes;
      if (!open) continue;
      const LinkPair& pair = problem_->link_pairs[p];
      const int mover_a = problem_->bodies[pair.a].mover, mover_b = problem_->bodies[pair.b].mover;
      const SweptBox &a = mover_box_[mover_a], &b = mover_box_[mover_b];
      FloatLanes out = greater(a.lo[0], b.hi[0]) | greater(b.lo[0], a.hi[0]);
      for (int k = 1; k < 3; ++k) out = out | greater(a.lo[k], b.hi[k]) | greater(b.lo[k], a.hi[k]);
      unsigned mask = open & ~lanesOf(out);
      if (mask && isLink(mover_a) && isLink(mover_b)) {
        const double margin = query_->margins.of(problem_->num_scene_pairs + p);
        const SweptLss &lss_a = mover_lss_[mover_a], &lss_b = mover_lss_[mover_b];
        Lanes square;
        mask &= ~certainlyApart(lss_a, lss_b, margin, square);
        if (mask && look) considerPose(problem_->num_scene_pairs + p, square, lss_a.radius + lss_b.radius);
      }
      if (mask) entries_.push({problem_->num_scene_pairs + p, 0, 0, mask});
    }
  }
  statistics_.pairs_after_culling += static_cast<std::uint64_t>(entries_.size());
}

/// A link's line swept sphere in each lane of [0, 1]: both ends' Bernstein points, and its radius.
inline void Solver::sweptSegments(int mover, engine::SweptLink* parts) {
  const SweptLss& s = mover_lss_[mover];
  for (int lane = 0; lane < kLanes; ++lane) {
    for (int end = 0; end < 2; ++end) {
      for (int k = 0; k < 3; ++k) {
        const double c0 = s.end[end][0][k][lane], c1 = s.end[end][1][k][lane], c2 = s.end[end][2][k][lane];
        parts[lane].points[end][k] = c0 - c1 + c2;
        parts[lane].points[2 + end][k] = c0 + c1 + c2;
        parts[lane].points[4 + end][k] = c0 - c2;
      }
    }
    parts[lane].radius = s.radius * (1 + 4 * kUlp);
  }
}

/// Stage 2, where the query brings one: pairs of links and still obstacles that it proves free are left out. (Pairs
/// that are not its business come behind them.)
inline void Solver::refine() {
  candidate_pairs_.clear();
  swept_links_.resize(kLanes * problem_->num_movers);
  int previous = -1;
  for (int i = 0; i < entries_.size() && entries_[i].pair < problem_->num_scene_pairs; ++i) {
    const Entry& e = entries_[i];
    const int mover = e.pair / problem_->num_obstacles;
    if (mover != previous) sweptSegments(previous = mover, swept_links_.data() + kLanes * mover);
    candidate_pairs_.push(
        {e.pair, mover, problem_->obstacles[e.pair % problem_->num_obstacles], e.mask, query_->margins.of(e.pair)});
  }
  const int asked = candidate_pairs_.size();
  if (!asked) return;
  query_->refine(query_->refine_context, *problem_, swept_links_.data(), candidate_pairs_.data(), asked);
  int kept = 0, directions = 0;
  for (int i = 0; i < entries_.size(); ++i) {
    Entry e = entries_[i];
    if (i < asked) {  // a stage may clear parts, nothing else
      FCL_ARTIC_ASSERT(candidate_pairs_[i].pair == e.pair && !(candidate_pairs_[i].lanes & ~(e.mask & kAllLanes)));
      e.mask &= candidate_pairs_[i].lanes;
    }
    if (!e.mask) continue;
    if (i < asked) {
      if (candidate_pairs_[i].free_nodes) partly_free_.push(candidate_pairs_[i]);
      directions_[kept] = directions_[i];
      directions = kept + 1;
    }
    entries_[kept++] = e;
  }
  entries_.truncate(kept);
  directions_.truncate(directions);
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
