// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "model/pair_id.h"
#include "model/tree_view.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

using engine::PairId;

/// A pair of nodes that is not yet decided in the lanes of `mask`.
struct Entry {
  PairId pair;
  std::int32_t a, b;
  unsigned mask;
  bool put_off = false;         ///< not looked at, as contact was suspected before these lanes
  bool within = false;          ///< the one body is within the bounds of the other, a large mesh: hulls say nothing
  bool deep = false;            ///< a link is deep in this node of a large body: the node's box says nothing
  std::int32_t direction = -1;  ///< of StageOne::direction(); -1: none is known
  /// The lane in which a link is deepest in this patch; -1: it is not deep, or nobody asks. And the distance there from
  /// the segment of the link's line swept sphere, as part of its radius.
  std::int8_t deepest = -1;
  float nearness = 1e30f;

  bool isWhole() const { return a == 0 && b == 0; }
  /// In a lane of its batch; -1: in any.
  bool isOpenIn(int lane) const { return lane < 0 || (mask >> lane & 1) != 0; }
};

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
