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
/// Size of clusters, as a part of the longest side of what is swept.
constexpr double kCluster = 0.5;
constexpr std::size_t kNone = ~std::size_t{0};

/// Of a bit for each node.
std::size_t wordsOf(const engine::TreeView& tree) {
  return static_cast<std::size_t>(tree.num_nodes + 63) / 64;
}

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

/// One window per link, its swept parts, and per pair those pieces of the obstacle whose bounds meet a part's, in
/// groups by cluster.
void Stage::run(const engine::Problem& problem, const SweptLink* links, CullCandidate* candidates, std::int32_t n,
                ExecutorLoan& loan) {
  Batch& batch = loan->batch;
  batch.clear();
  batch.resolution = culler_.options().resolution;
  batch.rule = culler_.options().rule;
  batch.groups_only = true;
  batch.growth = Growth();
  Collection collection{batch, {}, {}};
  std::vector<Cluster>& clusters = collection.clusters;
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
      const std::size_t objects = batch.objects.size(), groups = clusters.size();
      std::uint32_t met = c.lanes;
      if (!BodyPieces(problem.bodies[c.obstacle], c.margin + tolerance_distance_)
               .add(parts, met, least, kCluster * size, kMostObjects, window, i, collection, reach)) {
        batch.objects.resize(objects);
        batch.objects.push_back({Volume(), window, static_cast<std::int32_t>(groups)});  // without a point: unusable
        clusters.resize(groups);
        clusters.push_back({i, 0});
      }
      lanes |= met;
    }
    if (batch.objects.size() == first_object) continue;
    batch.windows.push_back(windowOf(link, reach));
    for (int lane = 0; lane < kParts; ++lane) {
      if (lanes >> lane & 1) batch.swept.push_back({addVolume(links[kParts * mover + lane], batch), window});
    }
  }
  batch.num_groups = static_cast<std::int32_t>(clusters.size());
  pieces += batch.objects.size();
  executor = loan->name;
  loan->executor->run(batch, loan->may);
  std::vector<std::uint8_t> stays(clusters.size(), 0);
  for (std::size_t i = 0; i < batch.objects.size(); ++i) {
    if (loan->may[i]) stays[static_cast<std::size_t>(batch.objects[i].group)] = 1;
  }
  std::vector<std::size_t> first_word(static_cast<std::size_t>(n), kNone);
  std::size_t words = 0;
  for (std::size_t group = 0; group < clusters.size(); ++group) {
    const std::int32_t pair = clusters[group].pair;
    std::size_t& first = first_word[static_cast<std::size_t>(pair)];
    if (!stays[group]) {
      collection.free.push_back(clusters[group]);
    } else if (first == kNone) {
      first = words;
      words += wordsOf(*problem.bodies[candidates[pair].obstacle].tree);
    }
  }
  free_nodes_.assign(words, 0);
  // From here on nothing fails.
  for (const Cluster& c : collection.free) {
    const std::size_t first = first_word[static_cast<std::size_t>(c.pair)];
    if (first == kNone) continue;
    const auto node = static_cast<std::size_t>(c.node);
    free_nodes_[first + node / 64] |= std::uint64_t{1} << node % 64;
    candidates[c.pair].free_nodes = free_nodes_.data() + first;
    ++nodes;
  }
  for (std::int32_t pair = 0; pair < n; ++pair) {
    if (first_word[static_cast<std::size_t>(pair)] != kNone) continue;
    candidates[pair].lanes =
        0;  // Single lanes are left as they are: the solver would find the same, by other roundings.
    ++culled;
  }
}

void Stage::clear(void* context, const engine::Problem& problem, const SweptLink* links, CullCandidate* pairs,
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
