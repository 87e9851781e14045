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

/// The part of the link's box that the pieces' boxes leave, a little larger, so that a point on its border is well
/// within by the rounding of its pixel coordinates.
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

}  // namespace

/// One window per link, its swept parts, and per pair a group of those pieces of the obstacle whose bounds meet a
/// part's.
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
    for (end = begin; end < n && candidates[end].mover == mover; ++end) lanes |= candidates[end].lanes;
    Bounds parts[kParts], link = Bounds::none(), reach = Bounds::none();
    for (int lane = 0; lane < kParts; ++lane) {
      if (!(lanes >> lane & 1)) continue;
      parts[lane] = boundsOf(links[kParts * mover + lane]);
      link.join(parts[lane]);
    }
    const double size = std::max({link.hi[0] - link.lo[0], link.hi[1] - link.lo[1], link.hi[2] - link.lo[2]});
    const double least = size / (4 * batch.resolution);  // a quarter of a pixel, before the window is known

    const auto window = static_cast<std::int32_t>(batch.windows.size());
    const std::size_t first_object = batch.objects.size();
    lanes = 0;
    for (std::int32_t i = begin; i < end; ++i) {
      const CullCandidate& c = candidates[i];
      const std::size_t objects = batch.objects.size();
      std::uint32_t met = c.lanes;
      if (!BodyPieces(problem.bodies[c.obstacle], c.margin)
               .add(parts, met, least, kMostObjects, window, i, batch, reach)) {
        batch.objects.resize(objects);
        batch.objects.push_back({Volume(), window, i});  // without a point: unusable, so that the pair stays
      }
      lanes |= met;
    }
    if (batch.objects.size() == first_object) continue;
    batch.windows.push_back(windowOf(link, reach));
    for (int lane = 0; lane < kParts; ++lane) {
      if (lanes >> lane & 1) batch.swept.push_back({addVolume(links[kParts * mover + lane], batch), window});
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
    candidates[group].lanes =
        0;  // Single lanes are left as they are: the solver would find the same, by other roundings.
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
