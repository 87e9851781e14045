// SPDX-License-Identifier: BSD-3-Clause
#include "redon/swept_volumes.h"

#include <algorithm>

#include "redon/parts.h"

namespace fcl_artic {
namespace redon {
namespace {

constexpr int kPartsLevel = 3, kEighths = 8;

double length(const IntervalVec3& v) {
  return sqrt((square(v[0]) + square(v[1])) + square(v[2])).upper();
}

}  // namespace

/// A motion is bounded once per interval for all volumes.
void SweptVolumes::sweep(const engine::Problem& problem, const engine::Query& query, const Options& options,
                         Counts& counts) {
  chains_.begin(problem, query, enclosureOf(options), false, counts);
  for (int k = 0; k < kEighths; ++k) {
    chains_.setInterval(k / 8.0, (k + 1) / 8.0, Derivatives::second);
    for (const Volume& v : volumes_) {
      const FrameBounds& frame = chains_.frame(v.sweep, v.step);
      const auto bendOf = [&](const IntervalVec3& end) {
        const IntervalVec3 bend = frame.second * end;
        return length(v.seen_from ? v.seen_from->R * bend : bend);
      };
      const double bend = std::max(bendOf(v.ends[0]), bendOf(v.ends[1]));
      links_[v.first + static_cast<std::size_t>(k)].radius =
          (Interval(v.radius) + Interval(bend) * Interval(0x1p-11)).upper();  // (1/16)^2 / 8
    }
  }
  for (int k = 0; k <= 2 * kEighths; ++k) {  // begin, middle and end of parts
    chains_.setInterval(k / 16.0, k / 16.0, Derivatives::none);
    for (const Volume& v : volumes_) {
      const FrameBounds& frame = chains_.frame(v.sweep, v.step);
      double places[2][3], error = 0;  // the places' error; the part's radius takes all three
      for (int end = 0; end < 2; ++end) {
        const IntervalVec3 at = frame.pose * v.ends[end], place = v.seen_from ? *v.seen_from * at : at;
        IntervalVec3 off;
        for (int c = 0; c < 3; ++c) {
          places[end][c] = place[c].middle();
          off[c] = place[c] - Interval(places[end][c]);
        }
        error = std::max(error, length(off));
      }
      for (int part = std::max(0, (k - 1) / 2); part <= std::min(k / 2, kEighths - 1); ++part) {
        engine::SweptLink& link = links_[v.first + static_cast<std::size_t>(part)];
        for (int end = 0; end < 2; ++end)
          std::copy(places[end], places[end] + 3, link.points[2 * (k - 2 * part) + end]);
        link.radius = (Interval(link.radius) + Interval(error)).upper();
      }
    }
  }
}

/// The pairs, and the volumes to be swept for them: one for all pairs of a link and still obstacles, one for each of
/// the others.
void SweptVolumes::collect(const engine::Problem& problem, const engine::Query& query,
                           const std::vector<BodyPair>& pairs) {
  static constexpr engine::Placement kWhereItStands = {};
  candidates_.clear();
  volumes_.clear();
  std::int32_t previous = -1;
  for (const BodyPair& pair : pairs) {
    const auto lanes = static_cast<std::uint32_t>(partsAt(kPartsLevel, pair.mask, pair.level));
    const double margin = query.margins.of(pair.index);
    const engine::Body &a = problem.bodies[pair.parts.a], &b = problem.bodies[pair.parts.b];
    const bool of_scene = problem.isScenePair(pair.index);
    if (!of_scene && !b.tree_lss) break;  // free bodies
    if (!of_scene || pair.parts.b != previous) {
      const double* lss = of_scene ? b.lss : b.tree_lss;
      Volume v;
      v.first = kParts * volumes_.size();
      v.sweep = pair.parts.sweep;
      v.step = pair.parts.step_b;
      v.seen_from = of_scene ? nullptr : &pair.inverse_a;
      for (int end = 0; end < 2; ++end) {
        v.ends[end] = IntervalVec3(Interval(lss[3 * end]), Interval(lss[3 * end + 1]), Interval(lss[3 * end + 2]));
        if (!of_scene) v.ends[end] = pair.placement_b * v.ends[end];
      }
      v.radius = lss[6];
      volumes_.push_back(v);
      previous = of_scene ? pair.parts.b : -1;
    }
    candidates_.push_back({pair.index, 0, static_cast<std::int32_t>(volumes_.size()) - 1, pair.parts.a,
                           of_scene ? &a.placement : &kWhereItStands, lanes, margin});
  }
  links_.resize(kParts * volumes_.size());
}

void SweptVolumes::refine(const engine::Problem& problem, const engine::Query& query, const Options& options,
                          std::vector<BodyPair>& pairs, Counts& counts) {
  collect(problem, query, pairs);
  if (candidates_.empty()) return;
  sweep(problem, query, options, counts);
  {
    const RoundToNearest usual;
    for (std::int32_t n = 0; n < query.num_advisors; ++n) {
      const engine::Advisor& advisor = query.advisors[n];
      if (advisor.clear) {
        advisor.clear(advisor.self, problem, links_.data(), candidates_.data(),
                      static_cast<std::int32_t>(candidates_.size()));
      }
    }
  }
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    pairs[i].mask &= partsAt(pairs[i].level, candidates_[i].lanes, kPartsLevel);
  }
  pairs.erase(std::remove_if(pairs.begin(), pairs.end(), [](const BodyPair& pair) { return pair.mask == 0; }),
              pairs.end());
}

}  // namespace redon
}  // namespace fcl_artic
