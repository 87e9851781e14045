// SPDX-License-Identifier: BSD-3-Clause
//
// Boxes of tree nodes swept over eight time intervals: the certificate with the frames' axes as directions.
#pragma once

#include "model/eight_boxes.h"
#include "model/tree_view.h"
#include "motion/rigid_lanes.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

using engine::Node;

/// Swept bounds of a node in the other body's frame, remainder, pad and margin included.
struct SweptBox {
  FloatLanes lo[3], hi[3];
};

FCL_ARTIC_INLINE Vec3 doublesOf(const float* x) {
  return {x[0], x[1], x[2]};
}
FCL_ARTIC_INLINE Vec3 middleOf(const Node& node) {
  return (doublesOf(node.lo) + doublesOf(node.hi)) * 0.5;
}

/// Bounds of a moving node in the still body's frame, grown by `slack` and the remainder.
FCL_ARTIC_INLINE void sweepNode(const RigidLanes& m, const Node& node, double slack, SweptBox& box) {
  // c and h: sums of floats, exact but for far smaller addends
  const Vec3 lo = doublesOf(node.lo), hi = doublesOf(node.hi), c = (lo + hi) * 0.5, h = (hi - lo) * 0.5;
  // |p| over the box; a square, two sums and a root are off by less than 8 ulp.
  const Lanes grow(m.rem_c + m.rem_R * (norm(max(-lo, hi)) * (1 + 8 * kUlp)) + slack);
  for (int i = 0; i < 3; ++i) {
    const Lanes half = dotPlus(m.largest[i], h, grow);
    Lanes least, most;
    for (int k = 0; k < 3; ++k) {
      const Lanes center = dotPlus(m.Rb[k][i], c, m.cb[k][i]);
      least = k ? min(least, center) : center;
      most = k ? max(most, center) : center;
    }
    box.lo[i] = narrowDown(least - half);
    box.hi[i] = narrowUp(most + half);
  }
}

/// A box that is the same in all lanes.
/// @param stride  of its ends in memory.
FCL_ARTIC_INLINE SweptBox spreadBox(const float* lo, const float* hi, int stride = 1) {
  SweptBox box;
  for (int k = 0; k < 3; ++k) {
    box.lo[k] = spread(lo[stride * k]);
    box.hi[k] = spread(hi[stride * k]);
  }
  return box;
}
/// The i-th of eight boxes, in all lanes.
FCL_ARTIC_INLINE SweptBox spreadBox(const engine::EightBoxes& boxes, int i) {
  return spreadBox(&boxes.lo[0][i], &boxes.hi[0][i], kLanes);
}
/// Eight boxes, one per lane.
FCL_ARTIC_INLINE SweptBox load(const engine::EightBoxes& boxes) {
  static_assert(sizeof(SweptBox) == sizeof(engine::EightBoxes));
  SweptBox box;
  __builtin_memcpy(&box, &boxes, sizeof box);
  return box;
}

/// Lanes in which two boxes are apart along an axis.
FCL_ARTIC_INLINE unsigned apart(const SweptBox& a, const SweptBox& b) {
  FloatLanes out = greater(a.lo[0], b.hi[0]) | greater(b.lo[0], a.hi[0]);
  for (int k = 1; k < 3; ++k) out = out | greater(a.lo[k], b.hi[k]) | greater(b.lo[k], a.hi[k]);
  return lanesOf(out);
}
/// The same with a node's box, which stands still.
FCL_ARTIC_INLINE unsigned apart(const SweptBox& box, const Node& node) {
  return apart(box, spreadBox(node.lo, node.hi));
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
