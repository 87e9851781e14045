// SPDX-License-Identifier: BSD-3-Clause
//
// Bounds on the motion of a pair over a time interval: B's tree frame in A's, along the path that the problem gives
// (the world's sweep for a link and an obstacle; the joints between them for two links). A chain is bounded once per
// sweep and interval, whatever number of pairs and features ask (Redon 2004, eq. 17).
#pragma once

#include <vector>

#include "redon/chain_bounds.h"
#include "redon/options.h"

namespace fcl_artic {
namespace redon {

inline Enclosure enclosureOf(const Options& options) {
  return options.enclosure == MotionEnclosure::taylor      ? Enclosure::taylor
         : options.enclosure == MotionEnclosure::meanValue ? Enclosure::meanValue
                                                           : Enclosure::intervalChain;
}

/// B in A: M = inverse_a * frame * placement_b, and the same of the frame's derivative.
IntervalTransform relate(const IntervalTransform& inverse_a, const IntervalTransform& pose,
                         const IntervalTransform& placement_b);
IntervalTransform relateRate(const IntervalTransform& inverse_a, const IntervalTransform& rate,
                             const IntervalTransform& placement_b);

/// The chains of all sweeps over one time interval after another, each bounded when first asked for.
class SweepChains {
 public:
  /// @param only_paths  each time that a step is asked for, the path to it is bounded anew: what an equation on its own
  ///   pays (Redon 2004, eq. 15).
  void begin(const engine::Problem& problem, const engine::Query& query, Enclosure enclosure, bool only_paths,
             Counts& counts);
  void setInterval(double begin, double end, Derivatives derivatives);
  /// The step's frame; step -1 stands still.
  const FrameBounds& frame(int sweep, int step);

 private:
  const engine::Problem* problem_ = nullptr;
  const engine::Query* query_ = nullptr;
  Counts* counts_ = nullptr;
  Enclosure enclosure_ = Enclosure::intervalChain;
  Derivatives derivatives_ = Derivatives::none;
  double begin_ = 0, end_ = 0;
  bool only_paths_ = false;
  struct Chain {
    bool set = false, ready = false;
    ChainBounds bounds;
    std::vector<FrameBounds> frames;
  };
  std::vector<Chain> sweeps_;              ///< whole sweeps
  std::vector<std::vector<Chain>> paths_;  ///< by sweep and step: the steps up to it
};

}  // namespace redon
}  // namespace fcl_artic
