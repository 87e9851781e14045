// SPDX-License-Identifier: BSD-3-Clause
//
// Ends of two intervals in a Pair, rounded as RoundUpward sets it: for SSE2, NEON, and any other processor. The file
// interval/interval_lanes.h lists what each function does.
#pragma once

#include "interval/rounding.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

using Ends = Pair;
FCL_ARTIC_INLINE Ends load(const float* x) {
  return pairOf(static_cast<double>(x[0]), static_cast<double>(x[1]));
}
FCL_ARTIC_INLINE Ends addUp(Ends a, Ends b) {
  return directed::add(a, b);
}
FCL_ARTIC_INLINE Ends mulUp(Ends a, Ends b) {
  return directed::mul(a, b);
}
FCL_ARTIC_INLINE unsigned above(Ends a, Ends b) {
  return pairGreater(a, b);
}
FCL_ARTIC_INLINE Ends spread(double x) {
  return pairOf(x);
}
FCL_ARTIC_INLINE Ends least(Ends a, Ends b) {
  return pairMin(a, b);
}
FCL_ARTIC_INLINE Ends most(Ends a, Ends b) {
  return pairMax(a, b);
}
FCL_ARTIC_INLINE Ends negated(Ends a) {
  return pairNegate(a);
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
