// SPDX-License-Identifier: BSD-3-Clause
//
// Stage 1 finds the pairs whose swept bounds meet, over the eight parts of [0, 1]. Stage 2 takes the pairs, parts and
// nodes out of these that advisors prove free.
#pragma once

#include "narrowphase/solver/patches.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

/// An obstacle, by its place in Problem::still_bounds, and the lanes in which its box meets that of a mover.
struct BoxHit {
  std::int32_t place;
  unsigned mask;
};

class StageOne : PartOfSolver {
 public:
  StageOne(SearchState& state, AnyContact& any)
      : PartOfSolver(state.task),
        frames_(state.frames),
        strays_(state.task, state.frames),
        motions_(state.motions),
        horizon_(state.horizon),
        contacts_(state.contacts),
        any_(any),
        patches_(state, any, directions_) {}

  /// Stage 1: appends to `open` the pairs whose swept bounds meet, with the lanes in which they meet.
  void cull(Buffer<Entry>& open);
  /// Stage 2: removes the pairs, nodes and lanes from `open` that advisors prove free.
  void refine(Buffer<Entry>& open);
  /// From A to B in A's tree frame, in the middles of the lanes, of any length; null: not known.
  const Vec3Lanes* direction(const Entry& e) const { return e.direction < 0 ? nullptr : &directions_[e.direction]; }

  const Buffer<BoxHit>& meetObstacles(int mover);
  /// Lanes in which the boxes of two movers are certainly apart.
  unsigned boxesApart(int mover_a, int mover_b) const;

 private:
  void sweepMover(int mover);
  void setWholeBox(int mover);
  SweptBox wholeBox(int mover) const;
  void meetLinks();
  void cullObstacles(int mover, Buffer<Entry>& open);
  void cullLinks(Buffer<Entry>& open);
  /// If a link's line swept sphere and an obstacle are farther apart than this, their bodies are more than the pair's
  /// margin apart in all of the tube.
  double apartFromObstacle(PairId pair, int mover, int obstacle) const {
    return query().margins.of(pair) + (mover_stray_[mover] + strays_.ofObstacle(problem().obstacles[obstacle]));
  }
  unsigned lssMayTouch(PairId pair, int mover, const engine::StillBounds& obstacle, unsigned mask,
                       Vec3Lanes& direction);
  void expectContact(PairId pair, int mover, const engine::StillBounds& obstacle, unsigned mask,
                     const NearestToBox& nearest);
  void sweptInWorld(int mover, engine::SweptLink* parts) const;
  void sweepInPartner(PairId pair, Patches::Large partner, const double* lss, SweptLss& s);
  bool enterCarried(PairId pair, unsigned mask, const double* lss_a, Buffer<Entry>& open);
  void sweptInPartner(PairId pair, const double* lss, engine::SweptLink* parts);
  void takeAdvice(const engine::Advisor& advisor, Buffer<Entry>& open);

  SweptFrames& frames_;
  Strays strays_;
  RelativeMotions& motions_;
  Horizon& horizon_;
  const ContactList& contacts_;
  AnyContact& any_;

  Buffer<SweptBox> mover_box_;
  Buffer<engine::EightBoxes> whole_boxes_;  ///< of movers over [0, 1], as MoverRow groups them
  Buffer<std::uint64_t> met_pairs_;         ///< link pairs whose movers' boxes meet, a bit each
  Buffer<SweptLss> mover_lss_;              ///< of links, where the motion has them
  Buffer<double> mover_stray_;              ///< of links, against the world, m
  Buffer<BoxHit> met_;
  Buffer<std::int32_t> open_nodes_;
  Buffer<engine::SweptLink> swept_links_;
  Buffer<engine::CullCandidate> candidates_;
  Buffer<Vec3Lanes> directions_;  ///< of pairs of links and still obstacles (Entry::direction)
  Patches patches_;
};

/// A mover's line swept sphere over [0, 1], and its box in the world (Redon 2004, Section 4). For a moving obstacle
/// only the box of its whole path is known.
inline void StageOne::sweepMover(int mover) {
  const Body& carried = body(problem().movers[mover]);
  const double margin = query().margins.largest() + strays_.largest();  // whatever the partner
  SweptBox& box = mover_box_[mover];
  if (task_.isLink(mover)) {
    const FrameLanes* frame = carried.step < 0 ? nullptr : &frames_.of(0, carried.step);
    sweepLss({frame, frames_.bounds(0, carried.step), problem().sweeps[0].first_order, whole().d}, carried,
             mover_lss_[mover]);
    const double stray = mover_stray_[mover] = strays_.inWorld(carried, mover_lss_[mover]);
    if (frame) {
      boundLss(mover_lss_[mover], margin + stray, box);
      setWholeBox(mover);
      return;
    }
  }
  const double around = margin + (task_.isLink(mover) ? mover_stray_[mover] : 0);  // of obstacles: the largest
  for (int k = 0; k < 3; ++k) {
    box.lo[k] = narrowDown(Lanes(carried.lo[k] - around));
    box.hi[k] = narrowUp(Lanes(carried.hi[k] + around));
  }
  setWholeBox(mover);
}

/// Sets a mover's box over [0, 1].
inline void StageOne::setWholeBox(int mover) {
  float ends[6];
  endsOfWhole(mover_box_[mover], ends);
  engine::EightBoxes& boxes = whole_boxes_[mover / kLanes];
  // (With -fsanitize=undefined g++ 12 writes some numbers of `(c ? lo : hi)[k][lane] = x` elsewhere.)
  for (int i = 0; i < 6; ++i) {
    float* const lanes = i < 3 ? boxes.lo[i] : boxes.hi[i - 3];
    lanes[mover % kLanes] = ends[i];
  }
}

/// A mover's box over [0, 1], in all lanes.
inline SweptBox StageOne::wholeBox(int mover) const {
  return spreadBox(whole_boxes_[mover / kLanes], mover % kLanes);
}

inline unsigned StageOne::boxesApart(int mover_a, int mover_b) const {
  return apart(mover_box_[mover_a], mover_box_[mover_b]);
}

/// Obstacles whose boxes meet that of a mover, and when. At each node the eight children's boxes are compared at once
/// with the mover's box over [0, 1]. The children that are left are compared with its boxes in each part. The tree is
/// traversed level by level, so that the next nodes are fetched meanwhile.
inline const Buffer<BoxHit>& StageOne::meetObstacles(int mover) {
  const SweptBox &parts = mover_box_[mover], whole = wholeBox(mover);
  const engine::WideNode* nodes = problem().obstacle_tree;
  met_.resize(problem().num_obstacles + 1);
  open_nodes_.resize(problem().num_obstacles + 1);
  BoxHit* met = met_.data();
  std::int32_t *open = open_nodes_.data(), *last = open;
  *last++ = 0;
  for (; open < last; ++open) {
    const engine::WideNode& node = nodes[*open];
    const unsigned used = (1u << node.num_children) - 1;
    for (unsigned left = used & ~apart(whole, load(node.boxes)); left; left &= left - 1) {
      const int i = __builtin_ctz(left);
      const unsigned mask = kAllLanes & ~apart(parts, spreadBox(node.boxes, i));
      if (!mask) continue;
      const std::int32_t child = node.child[i];
      if (child < 0) {
        *met++ = {~child, mask};
        prefetch(problem().still_bounds + ~child);
      } else {
        *last++ = child;
        prefetch(nodes + child);
      }
    }
  }
  met_.truncate(static_cast<int>(met - met_.data()));
  return met_;
}

/// Lanes of `mask` in which a link and an obstacle that stands still are not certainly apart by the link's line swept
/// sphere.
/// @param[out] direction  from the obstacle to the link, as in direction().
inline unsigned StageOne::lssMayTouch(PairId pair, int mover, const engine::StillBounds& obstacle, unsigned mask,
                                      Vec3Lanes& direction) {
  NearestToBox nearest;
  const WorldSeen world = {obstacle.inverse};
  mask &= ~certainlyApart(mover_lss_[mover], obstacle.box, world, apartFromObstacle(pair, mover, obstacle.obstacle),
                          nearest);
  direction = nearest.direction;
  if (mask && obstacle.solid) expectContact(pair, mover, obstacle, mask, nearest);
  return mask;
}

/// If a line swept sphere is deep in a solid, contact is suspected there, and later lanes are put off. If any contact
/// will do, it is looked for at once instead; poses are kept as guesses if the sphere's segment is very near the solid.
inline void StageOne::expectContact(PairId pair, int mover, const engine::StillBounds& obstacle, unsigned mask,
                                    const NearestToBox& nearest) {
  const double radius = mover_lss_[mover].radius;
  const Lanes square = nearest.square;
  const auto nearer = [&](double part) { return mask & ~greater(square, Lanes(part * part * radius * radius)); };
  const unsigned deep = nearer(kDeep);
  if (!deep || query().every_pair || !contacts_.watching()) return;
  if (!query().any) return horizon_.suspect(whole().at[__builtin_ctz(deep)]);
  const int lane = nearestLane(square, deep);
  const bool thin = widthOfRod(obstacle.tree->pieces[0]) < kThinSolid * radius;
  if (any_.tryObstacle(pair, lane, laneOf(nearest.point, lane), thin)) return;
  if (const unsigned lanes = nearer(kVeryDeep)) any_.guessOverlap(pair, lanes);
}

/// The line swept sphere of one body of a pair as seen from its partner's tree frame. All that the motion leaves out or
/// rounds is in the radius, and so is all by which both stray.
/// @param lss  in the body's own tree frame.
inline void StageOne::sweepInPartner(PairId pair, Patches::Large partner, const double* lss, SweptLss& s) {
  const Seen seen = motions_.of(pair, whole());
  s.radius = s.ulps = s.rate = 0;
  Lanes sizes(0.0);
  for (int end = 0; end < 2; ++end) {
    const Vec3 p(lss + 3 * end);
    s.radius =
        max(s.radius, lss[6] + seen->stray() + seen->seePoint(partner == Patches::Large::a ? 0 : 1, p, s.end[end]));
    for (const Vec3Lanes& c : s.end[end].c) sizes = sizes + abs(c[0]) + abs(c[1]) + abs(c[2]);
  }
  s.measureSegment();
  s.sizes = maxLane(sizes) + s.radius;
}

/// Goes into the body B of a pair, if A is small against it.
/// @param lss_a  A's line swept sphere, in its tree frame.
inline bool StageOne::enterCarried(PairId pair, unsigned mask, const double* lss_a, Buffer<Entry>& open) {
  const TreeView& tree = *body(problem().parts(pair).b).tree;
  if (!(2 * lss_a[6] < tree.nodes[0].radius)) return false;
  SweptLss seen;
  sweepInPartner(pair, Patches::Large::b, lss_a, seen);
  patches_.cull({pair, 0, 0, mask}, Patches::Large::b, query().margins.of(pair), seen, open);
  return true;
}

inline void StageOne::cullObstacles(int mover, Buffer<Entry>& open) {
  const Buffer<BoxHit>& met = meetObstacles(mover);
  for (int i = 0; i < met.size() && !horizon_.isOver(); ++i) {
    const engine::StillBounds& obstacle = problem().still_bounds[met[i].place];
    const PairId pair = problem().scenePair(mover, obstacle.obstacle);
    if (problem().isAllowed(pair)) continue;
    if (obstacle.entered) {
      SweptLss seen;
      seeFrom(obstacle.inverse, mover_lss_[mover], seen);
      patches_.cull({pair, 0, 0, met[i].mask}, Patches::Large::a, apartFromObstacle(pair, mover, obstacle.obstacle),
                    seen, open);
      continue;
    }
    Vec3Lanes direction;
    if (const unsigned left = lssMayTouch(pair, mover, obstacle, met[i].mask, direction)) {
      if (body(problem().movers[mover]).tree->upper) {
        double lss[7];
        lssOfBox(obstacle.box, lss);
        if (enterCarried(pair, left, lss, open)) continue;
      }
      Entry& entry = open.grow() = {pair, 0, 0, left};
      entry.direction = directions_.size();
      directions_.push(direction);
      prefetch(obstacle.tree);
      prefetch(problem().bodies + problem().obstacles[obstacle.obstacle]);
    }
  }
}

/// Link pairs whose movers' boxes over [0, 1] meet, to met_pairs_: a mover with eight others at once.
inline void StageOne::meetLinks() {
  const int words = (problem().num_link_pairs + 63) / 64;
  met_pairs_.resize(words);
  for (int i = 0; i < words; ++i) met_pairs_[i] = 0;
  int mover = -1;
  SweptBox box;
  for (int r = 0; r < problem().num_mover_rows; ++r) {
    const engine::MoverRow& row = problem().mover_rows[r];
    if (row.mover != mover) box = wholeBox(mover = row.mover);
    for (unsigned left = row.lanes & ~apart(box, load(whole_boxes_[row.group])); left; left &= left - 1) {
      const int pair = row.pair[__builtin_ctz(left)] - problem().first_in_rows;
      met_pairs_[pair / 64] |= std::uint64_t{1} << pair % 64;
    }
  }
}

/// Pairs of movers, also of those that are obstacles. Pairs that advisors have proven free are left out.
inline void StageOne::cullLinks(Buffer<Entry>& open) {
  const bool any = any_.isWanted();
  const std::uint8_t* free[Query::kMaxAdvisors];
  const engine::Advisor* advisors[Query::kMaxAdvisors];  // those that are asked of single pairs
  int num_free = 0, num_advisors = 0;
  for (int n = 0; n < query().num_advisors; ++n) {
    const engine::Advisor& advisor = query().advisors[n];
    const std::uint8_t* parts = advisor.freeParts ? advisor.freeParts(advisor.self) : nullptr;
    if (parts) free[num_free++] = parts;
    if (advisor.freePartsOf) advisors[num_advisors++] = &advisor;
  }
  meetLinks();
  const auto cullPair = [&](int p) {
    const PairId pair = problem().linkPair(p);
    unsigned mask = problem().isAllowed(pair) ? 0 : kAllLanes;
    for (int n = 0; n < num_free; ++n) mask &= ~static_cast<unsigned>(free[n][p]);
    if (!mask) return;
    const auto [mover_a, mover_b] = problem().link_movers[p];
    mask &= ~boxesApart(mover_a, mover_b);
    const bool links = task_.isLink(mover_a) && task_.isLink(mover_b);
    Lanes square;
    if (mask && links) {
      const double stray = strays_.ofLinks(p, mover_stray_[mover_a] + mover_stray_[mover_b]);
      mask &= ~certainlyApart(mover_lss_[mover_a], mover_lss_[mover_b], query().margins.of(pair) + stray, square);
    }
    for (int n = 0; n < num_advisors && mask; ++n) {
      const unsigned parts = advisors[n]->freePartsOf(advisors[n]->self, p);
      FCL_ARTIC_ASSERT(!(parts & ~kAllLanes));  // it may clear parts, nothing else
      mask &= ~parts;
    }
    if (!mask) return;
    if (links && any) any_.considerLinks(pair, square, mover_lss_[mover_a].radius + mover_lss_[mover_b].radius);
    const PairParts bodies = problem().parts(pair);
    const TreeView& tree = *body(bodies.a).tree;
    if (tree.upper && body(bodies.b).tree_lss) {
      SweptLss seen;
      sweepInPartner(pair, Patches::Large::a, body(bodies.b).tree_lss, seen);
      return patches_.cull({pair, 0, 0, mask}, Patches::Large::a, query().margins.of(pair), seen, open);
    }
    if (body(bodies.b).tree->upper && body(bodies.a).tree_lss &&
        enterCarried(pair, mask, body(bodies.a).tree_lss, open)) {
      return;
    }
    open.push({pair, 0, 0, mask});
  };
  for (int i = 0; i < met_pairs_.size(); ++i) {
    for (std::uint64_t left = met_pairs_[i]; left && !horizon_.isOver(); left &= left - 1) {
      cullPair(64 * i + __builtin_ctzll(left));
    }
  }
}

inline void StageOne::cull(Buffer<Entry>& open) {
  directions_.clear();
  frames_.set(whole());
  strays_.begin();
  mover_box_.resize(problem().num_movers);
  whole_boxes_.resize((problem().num_movers + kLanes - 1) / kLanes);
  mover_lss_.resize(problem().num_scene_movers);
  mover_stray_.resize(problem().num_scene_movers);
  const bool check_scene = query().check_scene && problem().obstacle_tree;
  if (check_scene) {
    statistics().pairs += static_cast<std::uint64_t>(problem().num_scene_pairs - problem().num_scene_allowed);
  }
  if (any_.isWanted() && query().num_advisors && any_.tryLikely()) return;
  for (int m = 0; m < problem().num_movers && !horizon_.isOver(); ++m) {
    sweepMover(m);
    if (check_scene && task_.isLink(m)) cullObstacles(m, open);
  }
  if (horizon_.isOver()) return;
  if (query().check_self) {
    statistics().pairs += static_cast<std::uint64_t>(problem().num_link_pairs);
    if (problem().num_movers) {
      cullLinks(open);
    } else {  // no stage 1: pairs of free bodies
      for (int p = 0; p < problem().num_link_pairs; ++p) {
        const PairId pair = problem().linkPair(p);
        if (!problem().isAllowed(pair)) open.push({pair, 0, 0, kAllLanes});
      }
    }
  }
  for (int i = 0; i < open.size(); i = endOfPair(open, i)) ++statistics().pairs_after_culling;
}

/// A line swept sphere that holds a link in all of the tube, in each lane of [0, 1].
inline void StageOne::sweptInWorld(int mover, engine::SweptLink* parts) const {
  const SweptLss& s = mover_lss_[mover];
  for (int lane = 0; lane < kLanes; ++lane) sweptOver(lane, s.end, s.radius + mover_stray_[mover], parts[lane]);
}

/// The same of the link B of a pair of two bodies that move, seen from A's tree frame, where A stands still.
/// @param lss  in B's tree frame.
inline void StageOne::sweptInPartner(PairId pair, const double* lss, engine::SweptLink* parts) {
  SweptLss s;
  sweepInPartner(pair, Patches::Large::a, lss, s);
  for (int lane = 0; lane < kLanes; ++lane) sweptOver(lane, s.end, s.radius, parts[lane]);
}

inline void StageOne::refine(Buffer<Entry>& open) {
  for (int n = 0; n < query().num_advisors && open.size(); ++n) {
    if (query().advisors[n].clear) takeAdvice(query().advisors[n], open);
  }
}

inline void StageOne::takeAdvice(const engine::Advisor& advisor, Buffer<Entry>& open) {
  static constexpr engine::Placement kWhereItStands = {};
  candidates_.clear();
  swept_links_.resize(kLanes * (problem().num_movers + open.size()));
  int previous = -1, num_swept = problem().num_movers;
  PairId last = engine::kNoPair;
  for (int i = 0; i < open.size(); ++i) {
    const Entry& e = open[i];
    const double margin = query().margins.of(e.pair);
    if (problem().isScenePair(e.pair)) {
      const int mover = problem().moverOf(e.pair), obstacle = problem().obstacles[problem().obstacleOf(e.pair)];
      if (mover != previous) sweptInWorld(previous = mover, swept_links_.data() + kLanes * mover);
      const double apart = margin + strays_.ofObstacle(obstacle);
      candidates_.push({e.pair, e.a, mover, obstacle, &body(obstacle).placement, e.mask, apart});
      continue;
    }
    const PairParts parts = problem().parts(e.pair);
    if (!body(parts.b).tree_lss) continue;
    if (e.pair != last) {
      last = e.pair;
      sweptInPartner(e.pair, body(parts.b).tree_lss, swept_links_.data() + kLanes * num_swept++);
    }
    candidates_.push({e.pair, e.a, num_swept - 1, parts.a, &kWhereItStands, e.mask, margin});
  }
  const int asked = candidates_.size();
  if (!asked) return;
  advisor.clear(advisor.self, problem(), swept_links_.data(), candidates_.data(), asked);
  int kept = 0, next = 0;
  for (int i = 0; i < open.size(); ++i) {
    Entry e = open[i];
    if (next < asked && candidates_[next].pair == e.pair && candidates_[next].node == e.a) {
      const unsigned left = candidates_[next++].lanes;
      FCL_ARTIC_ASSERT(!(left & ~e.mask));  // it may clear parts, nothing else
      e.mask = left;
    }
    if (e.mask) open[kept++] = e;
  }
  FCL_ARTIC_ASSERT(next == asked);
  open.truncate(kept);
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
