// SPDX-License-Identifier: BSD-3-Clause
//
// What may touch in a window of time: links by their swept line swept spheres (Redon 2004, Section 4), then triangles by
// their trees of oriented boxes (Section 5.1), both over the sub-intervals that each link's refinement level asks for.
#pragma once

#include <functional>
#include <vector>

#include "redon/motion.h"
#include "redon/options.h"
#include "redon/overlap.h"

namespace fcl_artic {
namespace redon {

/// A pair of bodies that may touch.
struct BodyPair {
  std::int32_t index = -1;  ///< in the problem
  PairParts parts;
  const ObbTree *a = nullptr, *b = nullptr;
  IntervalTransform inverse_a, placement_b;
};

/// Two triangles whose boxes meet.
struct LeafPair {
  std::int32_t pair;  ///< index into the list of body pairs
  std::int32_t a, b;  ///< triangles
  double from;        ///< their boxes are proven apart before this time
};

class Culling {
 public:
  using TreeOf = std::function<const ObbTree*(std::int32_t body)>;

  void begin(const engine::Problem& problem, const engine::Query& query, const Options& options, Counts& counts);
  /// Pairs of bodies that may touch in the window, of those wanted.
  /// @param wanted  by index of the pair in the problem.
  void bodyPairs(double begin, double end, const std::function<bool(std::int32_t)>& wanted, const TreeOf& treeOf,
                 std::vector<BodyPair>& out);
  /// Pairs of their triangles. To be called right after bodyPairs(), for the same window.
  /// @return false when the work budget ran out.
  bool leafPairs(const std::vector<BodyPair>& pairs, std::vector<LeafPair>& out);

 private:
  static constexpr int kFinest = 6;  ///< 2^6 sub-intervals: one bit each
  /// One link's motion over the window, on its own sub-intervals.
  struct Motion {
    int level = -1;  ///< the paper's r_i; -1: not bounded yet
    std::vector<FrameBounds> frames;
  };
  struct Swept {
    std::int32_t node = -1, stamp = -1;
    SweptObb box;
  };
  Motion& motionOf(int sweep, int step, const double* center, double radius);
  double timeOf(int level, int k) const;
  void moverBoxes();
  bool traverse(std::int32_t number, const BodyPair& pair, std::uint64_t mask, std::vector<LeafPair>& out);
  const SweptObb& swept(const std::vector<ObbNode>& nodes, int node, int k);

  const engine::Problem* problem_ = nullptr;
  const engine::Query* query_ = nullptr;
  const Options* options_ = nullptr;
  Counts* counts_ = nullptr;
  double begin_ = 0, end_ = 1;
  std::vector<SweepChains> chains_[kFinest + 1];  ///< by level and sub-interval
  std::vector<bool> chains_set_[kFinest + 1];
  std::vector<std::vector<Motion>> motions_;      ///< by sweep and step
  struct Box {
    double lo[3], hi[3];
  };
  std::vector<std::vector<Box>> mover_boxes_;  ///< by mover and sub-interval
  std::vector<int> mover_levels_;
  std::vector<std::uint64_t> masks_;           ///< of the body pairs found
  std::vector<IntervalTransform> relative_;    ///< of the present pair, by sub-interval
  std::vector<Swept> cache_;
  std::int32_t stamp_ = 0;
};

}  // namespace redon
}  // namespace fcl_artic
