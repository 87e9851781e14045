// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "model/pair_id.h"
#include "model/tree_view.h"
#include "numerics/buffer.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

using engine::PairId;

/// Entry::nearness where the link is not deep, or nobody asks.
constexpr float kNotDeep = 1e30f;

/// A pair of nodes that is not yet decided in the lanes of `mask`.
struct Entry {
  PairId pair;
  std::int32_t a, b;
  unsigned mask;
  bool put_off = false;         ///< not looked at, as contact was suspected before these lanes
  bool within = false;          ///< the one body is within the bounds of the other, a large mesh: hulls say nothing
  bool deep = false;            ///< a link is deep in this node of a large body: the node's box says nothing
  std::int32_t direction = -1;  ///< of StageOne::direction(); -1: none is known
  /// Where any contact will do: the lane in which a link is deepest in this patch, and is to be tried; -1: none.
  std::int8_t deepest = -1;
  /// The distance, in the lane in which the link is deepest, from the segment of its line swept sphere, as part of the
  /// radius.
  float nearness = kNotDeep;

  bool isWhole() const { return a == 0 && b == 0; }
  /// In a lane of its batch; -1: in any.
  bool isOpenIn(int lane) const { return lane < 0 || (mask >> lane & 1) != 0; }
};

/// The end of the entries of one pair, from number `begin` on: patches of one body follow each other.
inline int endOfPair(const Buffer<Entry>& entries, int begin) {
  int end = begin + 1;
  while (end < entries.size() && entries[end].pair == entries[begin].pair) ++end;
  return end;
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
