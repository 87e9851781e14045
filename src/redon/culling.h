// SPDX-License-Identifier: BSD-3-Clause
//
// Finds what may touch in a window of time. First it finds links by their swept line swept spheres (Redon 2004,
// Section 4), then triangles by their trees of oriented boxes (Section 5.1). It goes over the sub-intervals that each
// link's refinement level asks for, both times.
#pragma once

#include <functional>
#include <vector>

#include "redon/box_batch.h"
#include "redon/motion.h"
#include "redon/options.h"
#include "redon/overlap.h"

namespace fcl_artic {
namespace redon {

/// A pair of bodies that may touch.
struct BodyPair {
  engine::PairId index = engine::kNoPair;  ///< in the problem
  engine::PairParts parts;
  const ObbTree *a = nullptr, *b = nullptr;
  IntervalTransform inverse_a, placement_b;
  int level = 0;           ///< their line swept spheres' boxes meet in these parts
  std::uint64_t mask = 1;  ///< of the 2^level that the time is in
};

/// Two triangles whose boxes meet in some sub-interval.
struct LeafPair {
  std::int32_t pair;   ///< index into the list of body pairs
  std::int32_t a, b;   ///< triangles
  double from, until;  ///< to be looked at in this time
};

/// Goes through the sub-intervals in the order of time, so that nothing is spent on boxes after the first contact.
/// Bounds are made when they are first asked for: what is far from everything is bounded over the whole motion only.
class Culling {
 public:
  using TreeOf = std::function<const ObbTree*(std::int32_t body)>;

  void begin(const engine::Problem& problem, const engine::Query& query, const Options& options, Counts& counts);
  /// Pairs of bodies that may touch, of those wanted.
  /// @param wanted  asked of each pair of the problem.
  void bodyPairs(const std::function<bool(engine::PairId)>& wanted, const TreeOf& treeOf, std::vector<BodyPair>& out);
  /// To be called next.
  void start(const std::vector<BodyPair>& pairs);
  /// Number of the finest sub-intervals of all pairs, equal parts of [0, 1].
  int numSlots() const { return 1 << finest_; }
  double slotBegin(int slot) const { return timeOf(finest_, slot); }
  /// Pairs of triangles whose boxes meet from the beginning of this slot on. Slots are asked for one after the other.
  /// @param[out] out  appended to.
  /// @return false when the work budget ran out.
  bool leafPairs(const std::vector<BodyPair>& pairs, int slot, std::vector<LeafPair>& out);

 private:
  static constexpr int kFinest = 6;  ///< 2^6 sub-intervals: one bit each
  struct Box {
    double lo[3], hi[3];
    bool certainlyApart(const double* other_lo, const double* other_hi) const {
      for (int k = 0; k < 3; ++k) {
        if (lo[k] > other_hi[k] || hi[k] < other_lo[k]) return true;
      }
      return false;
    }
  };
  /// Boxes in the world that hold a body's line swept sphere over the parts of [0, 1], of each level by itself.
  struct LssBoxes {
    int level = 0;  ///< the paper's r_i
    std::uint64_t made[kFinest + 1] = {};
    std::vector<Box> boxes[kFinest + 1];
  };
  /// B in A over the sub-intervals of a pair.
  struct RelativePoses {
    std::uint64_t mask;
    int level;
    std::uint64_t made;  ///< sub-intervals whose bounds are there
    std::vector<IntervalTransform> relative;
  };
  struct CachedBox {
    std::int32_t node = -1;
    std::int64_t stamp = -1;
    SweptObb box;
  };
  struct NodePair {
    std::int32_t pair, a, b;
    std::uint64_t mask;  ///< of the pair's sub-intervals in which the boxes may meet
  };
  static double timeOf(int level, int k) { return static_cast<double>(k) / (1 << level); }  // exact
  const IntervalTransform& poseOver(int level, int k, int sweep, int step);
  SweepChains& chainsOver(int level, int k);
  int levelOf(int sweep, int step, const double* center, double radius);
  const Box& boxOf(std::int32_t mover, int level, int k);
  std::uint64_t divide(std::int32_t mover, int level, std::uint64_t mask, int finer, const double* lo,
                       const double* hi);
  std::uint64_t meetingParts(std::int32_t mover_a, std::int32_t mover_b, int level);
  bool inWorld(const BodyPair& pair) const;
  const IntervalTransform& relativeOver(const BodyPair& pair, RelativePoses& traversal, int k);
  void wait(const NodePair& e);
  const SweptObb& swept(const BodyPair& pair, const NodePair& e, int k);
  unsigned apart(const BodyPair& pair, const NodePair* entries, int n, int part);

  const engine::Problem* problem_ = nullptr;
  const engine::Query* query_ = nullptr;
  const Options* options_ = nullptr;
  Counts* counts_ = nullptr;
  std::vector<SweepChains> chains_[kFinest + 1];  ///< by level and sub-interval
  std::uint64_t chains_set_[kFinest + 1] = {};
  std::vector<std::vector<int>> levels_;  ///< by sweep and step; -1: not known yet
  std::vector<LssBoxes> movers_;
  std::vector<RelativePoses> relative_poses_;  ///< of the body pairs
  int finest_ = 0;
  std::vector<NodePair> waiting_[1 << kFinest];  ///< by slot
  std::vector<CachedBox> cache_;
  std::int64_t stamp_ = 0;  ///< of the present pair and sub-interval
  std::int32_t stamp_pair_ = -1, stamp_part_ = -1;
};

}  // namespace redon
}  // namespace fcl_artic
