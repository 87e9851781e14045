// SPDX-License-Identifier: BSD-3-Clause
#include "redon/swept_volumes.h"

#include <algorithm>

#include "redon/parts.h"

namespace fcl_artic {
namespace redon {
namespace {

constexpr int kPartsLevel = 3;  // eighths

double length(const IntervalVec3& v) {
  return sqrt((square(v[0]) + square(v[1])) + square(v[2])).upper();
}

}  // namespace

/// Volumes of all movers that have candidates. A motion is bounded once per interval for all of them.
void SweptVolumes::sweep(const engine::Problem& problem, const engine::Query& query, const Options& options,
                         Counts& counts) {
  links_.resize(static_cast<std::size_t>(kParts * problem.num_movers));
  chains_.begin(problem, query, enclosureOf(options), false, counts);
  const auto eachMover = [&](const auto& visit) {
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      const std::int32_t mover = candidates_[i].mover;
      if (i && candidates_[i - 1].mover == mover) continue;
      const engine::Body& body = problem.bodies[problem.movers[mover]];
      visit(body, chains_.frame(0, body.step), &links_[static_cast<std::size_t>(kParts * mover)]);
    }
  };
  for (int k = 0; k < kParts; ++k) {
    chains_.setInterval(k / 8.0, (k + 1) / 8.0, Derivatives::second);
    eachMover([k](const engine::Body& body, const FrameBounds& frame, engine::SweptLink* links) {
      const double bend = std::max(length(frame.second * body.lss), length(frame.second * (body.lss + 3)));
      links[k].radius = (Interval(body.lss[6]) + Interval(bend) * Interval(0x1p-11)).upper();  // (1/16)^2 / 8
    });
  }
  for (int k = 0; k <= 2 * kParts; ++k) {  // begin, middle and end of parts
    chains_.setInterval(k / 16.0, k / 16.0, Derivatives::none);
    eachMover([k](const engine::Body& body, const FrameBounds& frame, engine::SweptLink* links) {
      double places[2][3], error = 0;  // what the places are known to: the part's radius takes all three
      for (int end = 0; end < 2; ++end) {
        const IntervalVec3 place = frame.pose * (body.lss + 3 * end);
        IntervalVec3 off;
        for (int c = 0; c < 3; ++c) {
          places[end][c] = place[c].middle();
          off[c] = place[c] - Interval(places[end][c]);
        }
        error = std::max(error, length(off));
      }
      for (int part = std::max(0, (k - 1) / 2); part <= std::min(k / 2, kParts - 1); ++part) {
        engine::SweptLink& link = links[part];
        for (int end = 0; end < 2; ++end)
          std::copy(places[end], places[end] + 3, link.points[2 * (k - 2 * part) + end]);
        link.radius = (Interval(link.radius) + Interval(error)).upper();
      }
    });
  }
}

void SweptVolumes::refine(const engine::Problem& problem, const engine::Query& query, const Options& options,
                          std::vector<BodyPair>& pairs, Counts& counts) {
  candidates_.clear();
  for (const BodyPair& pair : pairs) {
    if (!problem.isScenePair(pair.index)) break;
    candidates_.push_back({pair.index, problem.moverOf(pair.index), pair.parts.a,
                           static_cast<std::uint32_t>(partsAt(kPartsLevel, pair.mask, pair.level)),
                           query.margins.of(pair.index)});
  }
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
  free_nodes_.resize(candidates_.size());
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    BodyPair& pair = pairs[i];
    pair.mask &= partsAt(pair.level, candidates_[i].lanes, kPartsLevel);
    if (!pair.mask || !candidates_[i].free_nodes) continue;
    pair.a->nodesWithin(*problem.bodies[pair.parts.a].tree, candidates_[i].free_nodes, free_nodes_[i]);
    pair.free_nodes = free_nodes_[i].data();
  }
  pairs.erase(std::remove_if(pairs.begin(), pairs.end(), [](const BodyPair& pair) { return pair.mask == 0; }),
              pairs.end());
}

}  // namespace redon
}  // namespace fcl_artic
