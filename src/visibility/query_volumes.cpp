// SPDX-License-Identifier: BSD-3-Clause
#include "visibility/query_volumes.h"

#include <algorithm>

namespace fcl_artic {
namespace visibility {
namespace {

using engine::CullCandidate;
using engine::SweptLink;

constexpr int kParts = 8;
/// Objects of a query: some tens of milliseconds of work. Objects beyond this number stay as they are.
constexpr std::size_t kMaxObjects = 20000;
/// Most objects of a pair. If more are left after the 13 directions, they seldom all go, and drawing them costs more
/// than the solver's search. Measured by bench_visibility_map (doc/VISIBILITY.md, "Where it pays").
constexpr std::size_t kMaxObjectsOfPair = 64;
/// A window's side is at least this part of its longest one: pixels stay within reason.
constexpr double kFlattest = 1.0 / 64;
/// Size of clusters, as a part of the longest side of what is swept.
constexpr double kCluster = 0.5;

/// Number of words that hold a bit for each node.
std::size_t wordsOf(const engine::TreeView& tree) {
  return static_cast<std::size_t>(tree.num_nodes + 63) / 64;
}

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

/// Whether the middle of what a link sweeps comes into the box around the other one, in whose tree frame it is seen.
/// Only then it takes long to find two links apart: hulls around them do so where each lies on its own side.
/// Measured by bench_visibility_map (doc/VISIBILITY.md, "Bodies that move").
bool comesInto(const engine::Node& box, const Bounds* parts, std::uint32_t lanes) {
  for (int lane = 0; lane < kParts; ++lane) {
    if (!(lanes >> lane & 1)) continue;
    bool within = true;
    for (int k = 0; k < 3; ++k) {
      const double middle = 0.5 * (parts[lane].lo[k] + parts[lane].hi[k]);
      within = within && middle >= static_cast<double>(box.lo[k]) && middle <= static_cast<double>(box.hi[k]);
    }
    if (within) return true;
  }
  return false;
}

}  // namespace

QueryVolumes::Kind QueryVolumes::kindOf(const engine::Problem& problem, std::int32_t still) {
  const std::int32_t mover = problem.bodies[still].mover;
  return mover < 0 ? Kind::obstacle : mover < problem.num_scene_movers ? Kind::link : Kind::moving;
}

void QueryVolumes::add(const engine::Problem& problem, const SweptLink* links, const CullCandidate* candidates,
                       std::int32_t n, double tolerance_distance, bool every_link_pair, Batch& batch) {
  first_group_ = batch.num_groups;
  first_object_ = batch.objects.size();
  clusters_.clear();
  free_.clear();
  kinds_.clear();
  num_words_.clear();
  work_ = VisibilityStatistics();
  Collection collection{batch, first_group_, 0, clusters_, free_};
  std::int32_t end = 0;
  for (std::int32_t begin = 0; begin < n; begin = end) {
    const std::int32_t swept = candidates[begin].swept;
    std::uint32_t lanes = 0;
    for (end = begin; end < n && candidates[end].swept == swept; ++end) lanes |= candidates[end].lanes;
    Bounds parts[kParts], link = Bounds::none(), reach = Bounds::none();
    for (int lane = 0; lane < kParts; ++lane) {
      if (!(lanes >> lane & 1)) continue;
      parts[lane] = boundsOf(links[kParts * swept + lane]);
      link.join(parts[lane]);
    }
    const double size = std::max({link.hi[0] - link.lo[0], link.hi[1] - link.lo[1], link.hi[2] - link.lo[2]});
    const double least = size / (4 * batch.resolution);  // a quarter of a pixel, before the window is known

    const auto window = static_cast<std::int32_t>(batch.windows.size());
    const std::size_t first_object = batch.objects.size();
    lanes = 0;
    for (std::int32_t i = begin; i < end; ++i) {
      const CullCandidate& c = candidates[i];
      const engine::TreeView& tree = *problem.bodies[c.still].tree;
      kinds_.push_back(kindOf(problem, c.still));
      num_words_.push_back(wordsOf(tree));
      if (kinds_.back() == Kind::link && !every_link_pair && !comesInto(tree.nodes[0], parts, c.lanes)) {
        kinds_.back() = Kind::none;
        continue;
      }
      ++work_.pairs;
      work_.link_pairs += kinds_.back() == Kind::link;
      work_.moving_pairs += kinds_.back() == Kind::moving;
      const std::size_t objects = batch.objects.size(), points = batch.points.size(), groups = clusters_.size();
      const Bounds reached = reach;
      collection.most = std::min(first_object_ + kMaxObjects, objects + kMaxObjectsOfPair);
      std::uint32_t met = c.lanes;
      if (!BodyPieces(tree, *c.at, c.margin + tolerance_distance)
               .add(parts, met, least, kCluster * size, window, i, collection, reach)) {
        batch.objects.resize(objects);
        batch.points.resize(points);
        clusters_.resize(groups);
        reach = reached;
        batch.objects.push_back({Volume(), window, collection.nextGroup()});  // without a point: unusable
        clusters_.push_back({i, 0});
      }
      lanes |= met;
    }
    if (batch.objects.size() == first_object) continue;
    batch.windows.push_back(windowOf(link, reach));
    for (int lane = 0; lane < kParts; ++lane) {
      if (lanes >> lane & 1) batch.swept.push_back({addVolume(links[kParts * swept + lane], batch), window});
    }
  }
  end_object_ = batch.objects.size();
  batch.num_groups = collection.nextGroup();
  work_.pieces = end_object_ - first_object_;
}

void QueryVolumes::conclude(const Batch& batch, const std::vector<std::uint8_t>& may) {
  stays_.assign(clusters_.size(), 0);
  for (std::size_t i = first_object_; i < end_object_; ++i) {
    if (may[i]) stays_[static_cast<std::size_t>(batch.objects[i].group - first_group_)] = 1;
  }
  first_word_.assign(num_words_.size(), kNone);
  std::size_t words = 0;
  for (std::size_t group = 0; group < clusters_.size(); ++group) {
    const auto pair = static_cast<std::size_t>(clusters_[group].pair);
    if (!stays_[group]) {
      free_.push_back(clusters_[group]);
    } else if (first_word_[pair] == kNone) {
      first_word_[pair] = words;
      words += num_words_[pair];
    }
  }
  free_nodes_.assign(words, 0);
  for (const Cluster& c : free_) {
    const std::size_t first = first_word_[static_cast<std::size_t>(c.pair)];
    if (first == kNone) continue;
    const auto node = static_cast<std::size_t>(c.node);
    free_nodes_[first + node / 64] |= std::uint64_t{1} << node % 64;
    ++work_.nodes;
  }
  for (std::size_t pair = 0; pair < kinds_.size(); ++pair) {
    if (!isFree(pair)) continue;
    ++work_.culled;
    work_.link_culled += kinds_[pair] == Kind::link;
    work_.moving_culled += kinds_[pair] == Kind::moving;
  }
}

void QueryVolumes::apply(CullCandidate* candidates) const {
  for (const Cluster& c : free_) {
    const std::size_t first = first_word_[static_cast<std::size_t>(c.pair)];
    if (first != kNone) candidates[c.pair].free_nodes = free_nodes_.data() + first;
  }
  for (std::size_t pair = 0; pair < first_word_.size(); ++pair) {
    // Single lanes of the other pairs are left as they are: the solver would find the same, by other roundings.
    if (isFree(pair)) candidates[pair].lanes = 0;
  }
}

}  // namespace visibility
}  // namespace fcl_artic
