// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "convex/gjk.h"
#include "model/pair_id.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

using engine::PairId;

/// The last simplices that GJK found between pairs' hulls, to begin with next time: a small direct-mapped cache; what
/// is pushed out is found again. Nothing rests on them.
class HullSimplices {
 public:
  /// A new query: none is known.
  void begin() { ++query_; }
  /// That of a pair in this query, or of a node of its large body; empty at first.
  Simplex& of(PairId pair, std::int32_t node) {
    Kept& kept = kept_[(engine::indexOf(pair) + static_cast<std::size_t>(node)) & (kKept - 1)];
    if (kept.pair != pair || kept.node != node || kept.query != query_) {
      kept.pair = pair;
      kept.node = node;
      kept.query = query_;
      kept.simplex.n = 0;
    }
    return kept.simplex;
  }

 private:
  static constexpr int kKept = 32;
  struct Kept {
    PairId pair;
    std::int32_t node;
    std::uint64_t query;
    Simplex simplex;
  };
  Kept kept_[kKept] = {};
  std::uint64_t query_ = 0;
};

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
