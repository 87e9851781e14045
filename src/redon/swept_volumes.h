// SPDX-License-Identifier: BSD-3-Clause
//
// The volumes that links sweep, for stage 2 (Redon 2004, Section 4: dynamic culling of swept volumes), which the query
// brings. Runs under RoundUpward.
//
// An end p of a link's line swept sphere moves twice differentiably. Over [a, b] it stays within (b - a)^2 / 8 sup
// |p''| of the chord from p(a) to p(b): the error e = p - chord vanishes at both ends, and along e's direction where
// |e| is largest this is the bound on linear interpolation. So over an eighth of the time, halved, both ends' places
// at its begin, middle and end span a solid. Grown by this bound over half of it and by the sphere's radius, it holds
// the link.
#pragma once

#include <vector>

#include "redon/culling.h"

namespace fcl_artic {
namespace redon {

class SweptVolumes {
 public:
  /// Takes pairs out that stage 2 proves free, and sub-intervals in which it does.
  /// @param pairs  those of a link and still obstacles lie together, pairs of two bodies that move after them: as
  /// Culling::bodyPairs() gives them.
  void refine(const engine::Problem& problem, const engine::Query& query, const Options& options,
              std::vector<BodyPair>& pairs, Counts& counts);

 private:
  static constexpr std::size_t kParts = 8;  ///< engine::Advisor's
  /// A line swept sphere that is to be swept.
  struct Volume {
    std::size_t first;                   ///< its parts, in links_
    std::int32_t sweep, step;            ///< that carry it
    const IntervalTransform* seen_from;  ///< the sweep's base as seen from where it is wanted; null: from the base
    IntervalVec3 ends[2];                ///< in the step's frame
    double radius;
  };
  void collect(const engine::Problem& problem, const engine::Query& query, const std::vector<BodyPair>& pairs);
  void sweep(const engine::Problem& problem, const engine::Query& query, const Options& options, Counts& counts);

  SweepChains chains_;
  std::vector<Volume> volumes_;
  std::vector<engine::CullCandidate> candidates_;
  std::vector<engine::SweptLink> links_;
};

}  // namespace redon
}  // namespace fcl_artic
