// SPDX-License-Identifier: BSD-3-Clause
//
// Whoever may advise the solver: tables of two links, grids of where balls meet, culling by visibility, yours. An
// advisor may clear parts of the motion in which it has proven a pair free, and may suggest where contact is likely;
// nothing else. What it clears is trusted, what it suggests is not. Plain data.
#pragma once

#include <cstdint>

#include "model/pair_id.h"

namespace fcl_artic {
namespace engine {

struct Placement;
struct Problem;

/// A link's line swept sphere over one of the eight parts [k/8, (k+1)/8] of the motion: within the hull of these
/// points, grown by a ball. Seen from where the other body of the pair stands still: in the world of an obstacle, in
/// the other one's tree frame of a link or an obstacle that moves.
struct SweptLink {
  double points[6][3];
  double radius;
};

/// A pair of a link and another body that stage 1 left.
struct CullCandidate {
  PairId pair;
  std::int32_t swept;   ///< links[8 * swept + k]: what the link sweeps in part k
  std::int32_t still;   ///< the other body, which stands still in the frame of these
  const Placement* at;  ///< of its tree in that frame
  std::uint32_t lanes;  ///< parts of the motion in which their bounds meet
  double margin;        ///< of the pair
  /// Nodes of the other body's tree, a bit each, that are proven free of the link over the whole motion; null: none.
  /// There until the solver returns.
  const std::uint64_t* free_nodes = nullptr;
};

/// A pair that is worth a look in the middle of the part [k/8, (k+1)/8] of a motion.
struct LikelyContact {
  std::int32_t link_pair, part;
};

/// Each function may be null.
struct Advisor {
  void* self = nullptr;
  /// Per link pair, bit k: it is proven free over the part [k/8, (k+1)/8] of this motion. Asked when the pairs are come
  /// to, which contact with an obstacle may spare. Null: nothing is known. There until the solver returns.
  const std::uint8_t* (*freeParts)(void* self) = nullptr;
  /// The same of one link pair, for what costs more to look up: asked of those that stage 1's own bounds leave.
  unsigned (*freePartsOf)(void* self, std::int32_t link_pair) = nullptr;
  /// Asked between stage 1 and the first batch. May clear bits of `lanes` in which a pair is proven free, and set
  /// `free_nodes`. The pairs with the same `swept` lie together and share a frame. Pairs come in the order of their
  /// numbers but for those of links and still obstacles, which come first, by link.
  void (*clear)(void* self, const Problem& problem, const SweptLink* links, CullCandidate* pairs,
                std::int32_t num_pairs) = nullptr;
  /// With Query::any: where balls inside links are likely to meet. Asked before all else.
  const LikelyContact* (*suggest)(void* self, std::int32_t& count) = nullptr;
};

}  // namespace engine
}  // namespace fcl_artic
