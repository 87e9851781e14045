// SPDX-License-Identifier: BSD-3-Clause
//
// Boxes of tree nodes swept over eight time intervals: the certificate with the frames' axes as directions.
#pragma once

#include "model/tree_view.h"
#include "motion/lane_motion.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

using engine::Node;

/// Swept bounds of a node in the other body's frame, remainder, pad and margin included.
struct SweptBox {
  FloatLanes lo[3], hi[3];
};

FCL_ARTIC_INLINE void middleOf(const Node& node, double* center) {
  for (int k = 0; k < 3; ++k) center[k] = 0.5 * (static_cast<double>(node.lo[k]) + static_cast<double>(node.hi[k]));
}

/// Bounds of a moving node in the still body's frame, grown by `slack` and the remainder.
FCL_ARTIC_INLINE void sweepNode(const RigidLanes& m, const Node& node, double slack, SweptBox& box) {
  double c[3], h[3], far2 = 0;  // c and h: sums of floats, exact but for far smaller addends
  for (int k = 0; k < 3; ++k) {
    const double lo = node.lo[k], hi = node.hi[k], far = max(-lo, hi);
    c[k] = 0.5 * (lo + hi);
    h[k] = 0.5 * (hi - lo);
    far2 += far * far;
  }
  // |p| over the box; a square, two sums and a root are off by less than 8 ulp.
  const Lanes grow(m.rem_c + m.rem_R * (sqrt(far2) * (1 + 8 * kUlp)) + slack);
  for (int i = 0; i < 3; ++i) {
    const Lanes* S = m.spread + 3 * i;
    const Lanes half = mulAdd(S[0], h[0], mulAdd(S[1], h[1], mulAdd(S[2], h[2], grow)));
    Lanes lo, hi;
    for (int k = 0; k < 3; ++k) {
      const Lanes* R = m.Rb[k] + 3 * i;
      const Lanes center = mulAdd(R[0], c[0], mulAdd(R[1], c[1], mulAdd(R[2], c[2], m.cb[k][i])));
      lo = k ? min(lo, center) : center;
      hi = k ? max(hi, center) : center;
    }
    box.lo[i] = narrowDown(lo - half);
    box.hi[i] = narrowUp(hi + half);
  }
}

/// Lanes in which a swept box and a still one are apart along an axis.
FCL_ARTIC_INLINE unsigned apart(const SweptBox& box, const Node& node) {
  FloatLanes out = greater(box.lo[0], spread(node.hi[0])) | greater(spread(node.lo[0]), box.hi[0]);
  for (int i = 1; i < 3; ++i)
    out = out | greater(box.lo[i], spread(node.hi[i])) | greater(spread(node.lo[i]), box.hi[i]);
  return lanesOf(out);
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
