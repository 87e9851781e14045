// SPDX-License-Identifier: BSD-3-Clause
#include "visibility/stage.h"

#include <algorithm>
#include <chrono>

#include "model/add_fields.h"
#include "visibility/volumes.h"

namespace fcl_artic {
namespace visibility {
namespace {

using engine::CullCandidate;
using engine::SweptLink;

constexpr int kParts = 8;
/// Most objects of a query: some tens of milliseconds of work.
constexpr std::size_t kMostObjects = 20000;
/// Most objects of a pair. If more are left after the 13 directions, they seldom all go, and drawing them costs more
/// than the solver's search. Measured by bench_visibility_map (doc/VISIBILITY.md, "Where it pays").
constexpr std::size_t kMostObjectsOfPair = 64;
/// A window's side is at least this part of its longest one: pixels stay within reason.
constexpr double kFlattest = 1.0 / 64;

/// The part of the link's box that the pieces' boxes leave, a little larger. So a point on its border is well within
/// it, by more than the rounding of its pixel coordinates.
Window windowOf(const Bounds& link, const Bounds& pieces) {
  Window window;
  double longest = 0;
  for (int k = 0; k < 3; ++k) {
    window.lo[k] = std::max(link.lo[k], pieces.lo[k]);
    window.hi[k] = std::min(link.hi[k], pieces.hi[k]);
    longest = std::max(longest, window.hi[k] - window.lo[k]);
  }
  for (int k = 0; k < 3; ++k) {
    const double grow = std::max(0.5 * (kFlattest * longest - (window.hi[k] - window.lo[k])), 0x1p-30 * longest);
    window.lo[k] -= grow;
    window.hi[k] += grow;
  }
  return window;
}

/// Whether the candidate's other body is a link.
bool isLink(const engine::Problem& problem, std::int32_t body) {
  const std::int32_t mover = problem.bodies[body].mover;
  return mover >= 0 && mover < problem.num_scene_movers;
}

/// Whether the middle of what a link sweeps comes into the box around the other one, in whose tree frame it is seen.
/// Only then it takes long to find two links apart: hulls around them do so where each lies on its own side. Without
/// this the stage costs an arm that is checked against itself twice as much (bench_visibility_map, `itself`).
bool comesInto(const engine::Node& box, const Bounds* parts, std::uint32_t lanes) {
  for (int lane = 0; lane < kParts; ++lane) {
    bool within = lanes >> lane & 1;
    for (int k = 0; k < 3 && within; ++k) {
      const double middle = 0.5 * (parts[lane].lo[k] + parts[lane].hi[k]);
      within = middle >= static_cast<double>(box.lo[k]) && middle <= static_cast<double>(box.hi[k]);
    }
    if (within) return true;
  }
  return false;
}

/// The volumes of a query, and the executor's answer.
struct Drawing {
  Batch batch;
  std::vector<CullCandidate*> looked_at, drawn;  ///< of each group one is drawn
  std::vector<std::uint8_t> may;                 ///< of each group

  void addWindow(const engine::Problem& problem, const SweptLink* link, CullCandidate* candidates, std::int32_t n,
                 double tolerance_distance);
};

/// Adds a window with what a link sweeps and those pieces of its candidates that the 13 directions leave. A candidate
/// of which they leave none is cleared.
/// @param candidates  the `n` with the same swept volumes.
/// @param tolerance_distance  of the query, m.
void Drawing::addWindow(const engine::Problem& problem, const SweptLink* link, CullCandidate* candidates,
                        std::int32_t n, double tolerance_distance) {
  std::uint32_t lanes = 0;
  for (std::int32_t i = 0; i < n; ++i) lanes |= candidates[i].lanes;
  SweptParts swept;
  Bounds all = Bounds::none(), reach = Bounds::none();
  for (int lane = 0; lane < kParts; ++lane) {
    if (!(lanes >> lane & 1)) continue;
    swept.parts[lane] = boundsOf(link[lane]);
    all.join(swept.parts[lane]);
  }
  const double size = std::max({all.hi[0] - all.lo[0], all.hi[1] - all.lo[1], all.hi[2] - all.lo[2]});
  swept.least = size / (4 * batch.resolution);  // a quarter of a pixel, before the window is known
  swept.window = static_cast<std::int32_t>(batch.windows.size());
  const std::size_t first_object = batch.objects.size();
  std::size_t most = 0;
  lanes = 0;
  for (CullCandidate* c = candidates; c < candidates + n; ++c) {
    const engine::TreeView& tree = *problem.bodies[c->still].tree;
    if (isLink(problem, c->still) && !comesInto(tree.nodes[0], swept.parts, c->lanes)) continue;
    looked_at.push_back(c);
    const std::size_t objects = batch.objects.size();
    if (c == candidates || c->pair != c[-1].pair) most = std::min(objects + kMostObjectsOfPair, kMostObjects);
    std::uint32_t met = c->lanes;
    const BodyPieces pieces(tree, *c->at, c->margin + tolerance_distance);
    if (!pieces.add(c->node, swept, most, met, reach, batch)) continue;
    if (batch.objects.size() == objects) {
      c->lanes = 0;
      continue;
    }
    lanes |= met;
    drawn.push_back(c);
    ++batch.num_groups;
  }
  if (batch.objects.size() == first_object) return;
  batch.windows.push_back(windowOf(all, reach));
  for (int lane = 0; lane < kParts; ++lane) {
    if (lanes >> lane & 1) batch.swept.push_back({addVolume(link[lane], batch), swept.window});
  }
}

/// Passes progress on. A second solve begins at 0 again; what is proven stays proven. Who has said no is asked no more.
struct Progress {
  bool (*tell)(void* context, double t_lower);
  void* context;
  double proven = 0;
  bool ended = false;
  static bool update(void* self, double t_lower) {
    auto& progress = *static_cast<Progress*>(self);
    progress.proven = std::max(progress.proven, t_lower);
    progress.ended = !progress.tell(progress.context, progress.proven);
    return !progress.ended;
  }
};

/// Counts pairs, and nodes of large bodies.
void count(const engine::Problem& problem, const std::vector<CullCandidate*>& looked_at, VisibilityStatistics& work) {
  std::size_t end = 0;
  for (std::size_t begin = 0; begin < looked_at.size(); begin = end) {
    const CullCandidate& first = *looked_at[begin];
    std::uint64_t free = 0;
    for (end = begin; end < looked_at.size() && looked_at[end]->pair == first.pair; ++end)
      free += looked_at[end]->lanes == 0;
    const std::uint64_t culled = free == end - begin;
    ++work.pairs;
    work.culled += culled;
    if (!culled) work.nodes += free;
    if (problem.bodies[first.still].mover < 0) continue;
    const bool link = isLink(problem, first.still);
    ++(link ? work.link_pairs : work.moving_pairs);
    (link ? work.link_culled : work.moving_culled) += culled;
  }
}

}  // namespace

/// Single lanes of a candidate that stays are left as they are: the solver would find the same, by other roundings.
void Stage::clear(void* context, const engine::Problem& problem, const SweptLink* links, CullCandidate* candidates,
                  std::int32_t n) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point begin = Clock::now();
  thread_local Drawing drawing;
  Stage& stage = *static_cast<Stage*>(context);
  VisibilityStatistics& work = stage.report_.work;
  drawing.batch.clear();
  drawing.batch.resolution = stage.culler_.options().resolution;
  drawing.looked_at.clear();
  drawing.drawn.clear();
  CullCandidate* const all_end = candidates + n;
  for (CullCandidate *from = candidates, *to = from; from < all_end; from = to) {
    while (to < all_end && to->swept == from->swept) ++to;
    drawing.addWindow(problem, links + kParts * from->swept, from, static_cast<std::int32_t>(to - from),
                      stage.tolerance_distance_);
  }
  if (!drawing.looked_at.empty()) {
    stage.report_.executor = runBy(stage.culler_, drawing.batch, drawing.may);
    for (std::size_t group = 0; group < drawing.drawn.size(); ++group) {
      if (!drawing.may[group]) drawing.drawn[group]->lanes = 0;
    }
    count(problem, drawing.looked_at, work);
    work.pieces += drawing.batch.objects.size();
  }
  work.us += std::chrono::duration<double, std::micro>(Clock::now() - begin).count();
}

void solve(const VisibilityCuller& culler, const SolveFunction& solver, const engine::Problem& problem,
           const engine::Query& query, engine::Answer& answer, Report& report) {
  const bool scene = query.check_scene && problem.num_obstacles > 0,
             moving = query.check_self && problem.num_link_pairs > 0;
  if (!(scene || moving) || query.work_budget) return solver(query, answer);
  Progress progress{query.progress, query.progress_context};
  engine::Query asked = query;
  if (query.progress) {
    asked.progress = &Progress::update;
    asked.progress_context = &progress;
  }
  Stage stage(culler, query.tolerance_distance, report);
  engine::Query advised = asked;
  advised.ask(stage.advisor());
  solver(advised, answer);
  report.fallback = culler.fallbackReason();
  const bool plainly_free = answer.isFree() && answer.num_ignored == 0;
  if (plainly_free || progress.ended || report.work.culled + report.work.nodes == 0) return;
  const engine::Statistics first = answer.statistics;
  solver(asked, answer);
  engine::addFields<StandardStatistics>(first, answer.statistics);
  report.work.repeated = 1;
}

}  // namespace visibility
}  // namespace fcl_artic
