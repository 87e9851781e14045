// SPDX-License-Identifier: BSD-3-Clause
//
// Advisors of the solver: tables of two links, grids of where balls meet, culling by visibility, or your own. An
// advisor clears parts of the motion in which it has proven a pair, or a node of a large body, free; it suggests where
// contact is likely. The solver trusts what is cleared. A contact that is suggested counts only if the solver proves
// it. Plain data.
#pragma once

#include <cstdint>

#include "model/pair_id.h"

namespace fcl_artic {
namespace engine {

struct Placement;
struct Problem;

/// A link's line swept sphere over one of the eight parts [k/8, (k+1)/8] of the motion: within the hull of these
/// points, grown by a ball. It is seen from where the other body of the pair stands still. For an obstacle that is the
/// world, for a link or an obstacle that moves the other one's tree frame.
struct SweptLink {
  double points[6][3];
  double radius;
};

/// A pair of a link and another body that stage 1 left, or a node of the other body, if that is a large one.
struct CullCandidate {
  PairId pair;
  std::int32_t node;    ///< of the other body's tree; 0: all of it
  std::int32_t swept;   ///< links[8 * swept + k]: what the link sweeps in part k
  std::int32_t still;   ///< the other body, which stands still in the frame of these
  const Placement* at;  ///< of its tree in that frame
  std::uint32_t lanes;  ///< parts of the motion in which their bounds meet
  double margin;        ///< of the pair
};

/// A pair that is worth a look in the middle of the part [k/8, (k+1)/8] of a motion.
struct LikelyContact {
  std::int32_t link_pair, part;
};

/// Each function may be null.
struct Advisor {
  void* self = nullptr;
  /// One byte per link pair; bit k: the pair is proven free over the part [k/8, (k+1)/8] of this motion. Null: nothing
  /// is known. Called when the solver comes to the link pairs; not called if a contact with an obstacle has ended the
  /// query before. The array must stay valid until the solver returns.
  const std::uint8_t* (*freeParts)(void* self) = nullptr;
  /// The same bits for one link pair, for answers that cost more: called only for pairs that stage 1's own bounds
  /// leave.
  unsigned (*freePartsOf)(void* self, std::int32_t link_pair) = nullptr;
  /// Called between stage 1 and the first batch. May clear bits of `lanes` in which a candidate is proven free.
  /// Candidates with the same `swept` lie together and share a frame; so do those of a pair. Pairs of links and still
  /// obstacles come first, ordered by link, then the others in the order of their numbers.
  void (*clear)(void* self, const Problem& problem, const SweptLink* links, CullCandidate* candidates,
                std::int32_t num_candidates) = nullptr;
  /// Where balls inside links are likely to meet. Called only with Query::any, before stage 1.
  const LikelyContact* (*suggest)(void* self, std::int32_t& count) = nullptr;
};

}  // namespace engine
}  // namespace fcl_artic
