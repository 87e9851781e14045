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
/// Most pieces of a pair. If more are left after the 13 directions, they seldom all go, and drawing them costs more
/// than the solver's search. Measured by bench_visibility_map (doc/VISIBILITY.md, "Where it pays").
constexpr std::size_t kMostPiecesOfPair = 64;
/// A window's side is at least this part of its longest one: pixels stay within reason.
constexpr double kFlattest = 1.0 / 64;

/// Sets the window: the part of the link's box that the pieces' boxes leave, a little larger. So a point on its border
/// is well within it, by more than the rounding of its pixel coordinates.
void setWindow(const Bounds& link, const Bounds& pieces, Drawing& drawing) {
  double sides[3];
  for (int k = 0; k < 3; ++k) {
    drawing.lo[k] = std::max(link.lo[k], pieces.lo[k]);
    drawing.hi[k] = std::min(link.hi[k], pieces.hi[k]);
    sides[k] = drawing.hi[k] - drawing.lo[k];
  }
  const double longest = std::max({sides[0], sides[1], sides[2], 0.0});
  for (int k = 0; k < 3; ++k) {
    const double grow = std::max(0.5 * (kFlattest * longest - sides[k]), 0x1p-30 * longest);
    drawing.lo[k] -= grow;
    drawing.hi[k] += grow;
  }
}

/// Whether the middle of what a link sweeps comes into the box around the other one, in whose tree frame it is seen.
/// Only then it takes long to find two links apart: hulls around them do so where each lies on its own side. Without
/// this the stage costs an arm that is checked against itself twice as much (bench_visibility_map, `itself`).
bool comesInto(const engine::Node& box, const Bounds* parts, std::uint32_t lanes) {
  for (; lanes; lanes &= lanes - 1) {
    const Bounds& part = parts[__builtin_ctz(lanes)];
    bool within = true;
    for (int k = 0; k < 3; ++k) {
      const double middle = 0.5 * (part.lo[k] + part.hi[k]);
      within = within && middle >= static_cast<double>(box.lo[k]) && middle <= static_cast<double>(box.hi[k]);
    }
    if (within) return true;
  }
  return false;
}

struct Stage {
  const VisibilityCuller& culler;
  double tolerance_distance;  ///< of the query, m: what is nearer stays; the solver alone may take it for a contact
  Report& report;

  void look(const engine::Problem& problem, const SweptLink* link, CullCandidate* begin, CullCandidate* end);
  void count(const CullCandidate* pair, const CullCandidate* end);
};

/// Draws what a link sweeps and those pieces of its candidates that the 13 directions leave. Clears candidates of which
/// these leave none or of which none may overlap. (Single lanes of a candidate that stays are left as they are: the
/// solver would find the same, by other roundings.)
/// @param begin  those that share the swept volumes; until `end`.
void Stage::look(const engine::Problem& problem, const SweptLink* link, CullCandidate* begin, CullCandidate* end) {
  thread_local Drawing drawing;
  thread_local std::vector<CullCandidate*> pairs, drawn;  // first candidates of those looked at; one for each group
  thread_local std::vector<std::uint8_t> may;
  drawing.clear();
  drawing.resolution = culler.options().resolution;
  pairs.clear();
  drawn.clear();
  SweptParts swept;
  Bounds all, reach;
  std::uint32_t lanes = 0;
  for (const CullCandidate* c = begin; c < end; ++c) lanes |= c->lanes;
  for (int k = 0; k < kParts; ++k) {
    if (!(lanes >> k & 1)) continue;
    swept.parts[k] = boundsOf(link[k].points[0], 6, link[k].radius);
    all.join(swept.parts[k]);
  }
  const double size = std::max({all.hi[0] - all.lo[0], all.hi[1] - all.lo[1], all.hi[2] - all.lo[2]});
  swept.least = size / (4 * drawing.resolution);  // a quarter of a pixel, before the window is known
  lanes = 0;
  std::size_t most = 0;
  for (CullCandidate* c = begin; c < end; ++c) {
    const engine::Body& still = problem.bodies[c->still];
    const bool is_link = still.mover >= 0 && still.mover < problem.num_scene_movers;
    if (is_link && !comesInto(still.tree->nodes[0], swept.parts, c->lanes)) continue;
    if (pairs.empty() || c->pair != pairs.back()->pair) {
      pairs.push_back(c);
      most = drawing.pieces.size() + kMostPiecesOfPair;
    }
    const std::size_t before = drawing.pieces.size();
    std::uint32_t met = c->lanes;
    const double margin = c->margin + tolerance_distance;
    if (!addPieces(*still.tree, c->node, *c->at, margin, swept, most, met, reach, drawing)) continue;
    if (drawing.pieces.size() == before) {
      c->lanes = 0;
      continue;
    }
    lanes |= met;
    drawn.push_back(c);
    ++drawing.num_groups;
  }
  if (pairs.empty()) return;
  setWindow(all, reach, drawing);
  for (int k = 0; k < kParts; ++k) {
    if (lanes >> k & 1) drawing.swept.push_back(drawing.addVolume(link[k].points[0], 6, link[k].radius));
  }
  report.executor = drawBy(culler, drawing, may);
  for (std::size_t group = 0; group < drawn.size(); ++group) {
    if (!may[group]) drawn[group]->lanes = 0;
  }
  report.work.pieces += drawing.pieces.size();
  for (const CullCandidate* pair : pairs) count(pair, end);
}

/// Counts a pair, or the nodes of a large body.
void Stage::count(const CullCandidate* pair, const CullCandidate* end) {
  VisibilityStatistics& work = report.work;
  std::uint64_t free = 0, all = 0;
  for (const CullCandidate* c = pair; c < end && c->pair == pair->pair; ++c, ++all) free += c->lanes == 0;
  ++work.pairs;
  (free == all ? work.culled : work.nodes) += free == all ? 1 : free;
}

/// engine::Advisor::clear.
void clear(void* stage, const engine::Problem& problem, const SweptLink* links, CullCandidate* candidates,
           std::int32_t n) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point begin = Clock::now();
  auto& self = *static_cast<Stage*>(stage);
  CullCandidate* const end = candidates + n;
  for (CullCandidate *from = candidates, *to = from; from < end; from = to) {
    while (to < end && to->swept == from->swept) ++to;
    self.look(problem, links + kParts * from->swept, from, to);
  }
  self.report.work.us += std::chrono::duration<double, std::micro>(Clock::now() - begin).count();
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

}  // namespace

void solve(const VisibilityCuller& culler, const SolveFunction& solver, const engine::Query& query,
           engine::Answer& answer, Report& report) {
  if (query.work_budget) return solver(query, answer);
  Progress progress{query.progress, query.progress_context};
  engine::Query asked = query;
  if (query.progress) {
    asked.progress = &Progress::update;
    asked.progress_context = &progress;
  }
  Stage stage = {culler, query.tolerance_distance, report};
  engine::Advisor advisor;
  advisor.self = &stage;
  advisor.clear = &clear;
  engine::Query advised = asked;
  advised.ask(advisor);
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
