// SPDX-License-Identifier: BSD-3-Clause
//
// Intervals side by side, one per lane of a register: operation by operation what interval.h does, so that every lane
// has the bits of Interval. Compiled once per instruction set: the including file defines FCL_ARTIC_ISA (the namespace)
// and FCL_ARTIC_ISA_BITS (512, 256 or 128) first. AVX-512 names the direction of rounding in each instruction; the
// others take it from RoundUpward, as interval/rounding.h says.
//
// All that depends on the instruction set is in interval/ends_*.h. Such a file defines, lane by lane:
//
//   Ends                 2, 4 or 8 doubles
//   load(const float*)   as many floats
//   addUp(a, b), mulUp(a, b)   rounded upward
//   above(a, b)          an unsigned whose bit i is set where a > b in lane i; not where either is NaN
//   spread(x)            x in every lane
//   least(a, b), most(a, b)    b where either is NaN, and where both are zero
//   negated(a)           the sign bits flipped
#pragma once

#include "interval/matrix.h"

#if FCL_ARTIC_ISA_BITS == 512
#include "interval/ends_avx512.h"
#elif FCL_ARTIC_ISA_BITS == 256
#include "interval/ends_avx2.h"
#else
#include "interval/ends_pair.h"
#endif

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

/// NaN becomes an infinite end.
FCL_ARTIC_INLINE Ends known(Ends a) {
  return least(a, spread(__builtin_inf()));
}

/// The settings that batches need while they compute: AVX-512 needs only that subnormals are kept.
using Scope = RoundUpward;

/// As many intervals as a register has lanes: negative lower ends n, upper ends h.
struct Intervals {
  static constexpr int kLanes = sizeof(Ends) / sizeof(double);
  Ends n, h;

  Intervals() = default;
  FCL_ARTIC_INLINE Intervals(Ends negative_lower, Ends upper) : n(negative_lower), h(upper) {}
  /// The same in every lane.
  explicit FCL_ARTIC_INLINE Intervals(Interval x) : n(spread(-x.lower())), h(spread(x.upper())) {}
};
/// One number per lane.
FCL_ARTIC_INLINE Intervals eachNumber(Ends x) {
  return {negated(x), x};
}

FCL_ARTIC_INLINE Intervals operator+(Intervals a, Intervals b) {
  return {addUp(a.n, b.n), addUp(a.h, b.h)};
}
FCL_ARTIC_INLINE Intervals operator-(Intervals a, Intervals b) {
  return {addUp(a.n, b.h), addUp(a.h, b.n)};
}
FCL_ARTIC_INLINE Intervals operator*(Intervals a, Intervals b) {
  const Ends lower = negated(a.n), below = negated(a.h);
  return {known(most(mulUp(a.n, b.h), most(mulUp(lower, b.n), most(mulUp(below, b.h), mulUp(a.h, b.n))))),
          known(most(mulUp(a.n, b.n), most(mulUp(lower, b.h), most(mulUp(below, b.n), mulUp(a.h, b.h)))))};
}
/// Times one number per lane.
FCL_ARTIC_INLINE Intervals operator*(Intervals a, Ends b) {
  const Ends c = negated(b);
  return {known(most(mulUp(a.h, c), mulUp(a.n, b))), known(most(mulUp(a.n, c), mulUp(a.h, b)))};
}
/// Largest |x|.
FCL_ARTIC_INLINE Ends magnitude(Intervals a) {
  return most(a.n, a.h);
}
/// Smallest |x|, or less than 0 where 0 is inside.
FCL_ARTIC_INLINE Ends mignitude(Intervals a) {
  return negated(least(a.n, a.h));
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
