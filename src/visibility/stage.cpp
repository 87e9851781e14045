// SPDX-License-Identifier: BSD-3-Clause
#include "visibility/stage.h"

#include <algorithm>
#include <chrono>
#include <exception>

#include "visibility/volumes.h"

namespace fcl_artic {
namespace visibility {
namespace {

using engine::CullCandidate;
using engine::SweptLink;

constexpr int kParts = 8;
/// Objects of a batch: some tens of milliseconds of work. What does not go in stays as it is.
constexpr std::size_t kMostObjects = 20000;
/// A window's side is at least this part of its longest one: pixels stay within reason.
constexpr double kFlattest = 1.0 / 64;

/// The part of the link's box that all its obstacles' boxes leave, a little larger, so that a point on its border is well
/// within by the rounding of its pixel coordinates.
Window windowOf(const Box& link, const Box& obstacles) {
  Window window;
  double longest = 0;
  for (int k = 0; k < 3; ++k) {
    window.lo[k] = std::max(link.lo[k], obstacles.lo[k]);
    window.hi[k] = std::min(link.hi[k], obstacles.hi[k]);
    longest = std::max(longest, window.hi[k] - window.lo[k]);
  }
  for (int k = 0; k < 3; ++k) {
    const double grow = std::max(0.5 * (kFlattest * longest - (window.hi[k] - window.lo[k])), 0x1p-30 * longest);
    window.lo[k] -= grow;
    window.hi[k] += grow;
  }
  return window;
}

}  // namespace

/// One window per link, its swept parts, and per pair a group of the obstacle's pieces.
void Stage::run(const engine::Problem& problem, const SweptLink* links, CullCandidate* candidates, std::int32_t n,
                ExecutorLoan& loan) {
  Batch& batch = loan->batch;
  batch.clear();
  batch.resolution = culler_.options().resolution;
  batch.rule = culler_.options().rule;
  batch.groups_only = true;
  batch.growth = Growth();
  batch.num_groups = n;
  std::int32_t end = 0;
  for (std::int32_t begin = 0; begin < n; begin = end) {
    const std::int32_t mover = candidates[begin].mover;
    std::uint32_t lanes = 0;
    Box obstacles = {}, link = {};
    for (end = begin; end < n && candidates[end].mover == mover; ++end) {
      const engine::Body& body = problem.bodies[candidates[end].obstacle];
      Box box;
      const double margin = candidates[end].margin * (1 + 0x1p-50);
      for (int k = 0; k < 3; ++k) {
        box.lo[k] = body.lo[k] - margin;
        box.hi[k] = body.hi[k] + margin;
      }
      if (end == begin) obstacles = box;
      obstacles.join(box);
      lanes |= candidates[end].lanes;
    }
    Box part_of[kParts];
    bool first = true;
    const auto window = static_cast<std::int32_t>(batch.windows.size());
    for (int lane = 0; lane < kParts; ++lane) {
      if (!(lanes >> lane & 1)) continue;
      const SweptLink& swept = links[kParts * mover + lane];
      part_of[lane] = boxOf(swept);
      if (first) link = part_of[lane];
      first = false;
      link.join(part_of[lane]);
      batch.swept.push_back({addVolume(swept, batch), window});
    }
    batch.windows.push_back(windowOf(link, obstacles));
    const Window& w = batch.windows.back();
    double pixel = w.hi[0] - w.lo[0];
    for (int k = 1; k < 3; ++k) pixel = std::min(pixel, w.hi[k] - w.lo[k]);
    pixel /= batch.resolution;
    for (std::int32_t i = begin; i < end; ++i) {
      Box parts[kParts];
      int num_parts = 0;
      for (int lane = 0; lane < kParts; ++lane) {
        if (candidates[i].lanes >> lane & 1) parts[num_parts++] = part_of[lane];
      }
      const std::size_t objects = batch.objects.size();
      if (!BodyPieces(problem.bodies[candidates[i].obstacle], candidates[i].margin)
               .add(parts, num_parts, 0.25 * pixel, kMostObjects, window, i, batch)) {
        batch.objects.resize(objects);
        batch.objects.push_back({Volume(), window, i});  // without a point: unusable, so that the pair stays
      }
    }
  }
  pieces += batch.objects.size();
  executor = loan->name;
  loan->executor->run(batch, loan->may);
  std::vector<std::uint8_t>& may = loan->may;
  std::size_t i = 0;
  for (std::int32_t group = 0; group < n; ++group) {
    bool touching = false;
    for (; i < batch.objects.size() && batch.objects[i].group == group; ++i) touching = touching || may[i];
    if (touching) continue;
    candidates[group].lanes = 0;
    ++culled;
  }
}

void Stage::refine(void* context, const engine::Problem& problem, const SweptLink* links, CullCandidate* pairs,
                   std::int32_t num_pairs) {
  using Clock = std::chrono::steady_clock;
  Stage& stage = *static_cast<Stage*>(context);
  const Clock::time_point begin = Clock::now();
  stage.pairs += static_cast<std::uint64_t>(num_pairs);
  ExecutorLoan loan(stage.culler_);
  try {
    stage.run(problem, links, pairs, num_pairs, loan);
  } catch (const std::exception& e) {  // nothing was taken out yet
    stage.failure = e.what();
    loan.giveUp(e.what());
  }
  stage.elapsed_us += std::chrono::duration<double, std::micro>(Clock::now() - begin).count();
}

}  // namespace visibility
}  // namespace fcl_artic
