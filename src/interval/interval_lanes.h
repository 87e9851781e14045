// SPDX-License-Identifier: BSD-3-Clause
//
// Intervals side by side, one per lane of a register: operation by operation what interval.h does, so that every lane
// has the bits of Interval. Compiled once per instruction set: the including file defines FCL_ARTIC_ISA (the namespace)
// and FCL_ARTIC_ISA_BITS (128, 256 or 512) first. AVX-512 names the direction of rounding in each instruction; the
// others take it from RoundUpward, as interval/rounding.h tells.
#pragma once

#include "interval/matrix.h"

#if FCL_ARTIC_ISA_BITS == 512
#define FCL_ARTIC_LANES(name) _mm512_##name
#elif FCL_ARTIC_ISA_BITS == 256
#define FCL_ARTIC_LANES(name) _mm256_##name
#else
#define FCL_ARTIC_LANES(name) _mm_##name
#endif

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

/// What instruction sets do differently: a + b and a * b upward, and, for each lane, a bit where a > b.
#if FCL_ARTIC_ISA_BITS == 512
using Ends = __m512d;
FCL_ARTIC_INLINE Ends load(const float* x) {
  return _mm512_cvtps_pd(_mm256_loadu_ps(x));
}
FCL_ARTIC_INLINE Ends addUp(Ends a, Ends b) {
  return _mm512_add_round_pd(a, b, _MM_FROUND_TO_POS_INF | _MM_FROUND_NO_EXC);
}
FCL_ARTIC_INLINE Ends mulUp(Ends a, Ends b) {
  return _mm512_mul_round_pd(a, b, _MM_FROUND_TO_POS_INF | _MM_FROUND_NO_EXC);
}
FCL_ARTIC_INLINE unsigned above(Ends a, Ends b) {
  return _mm512_cmp_pd_mask(a, b, _CMP_GT_OQ);
}
#elif FCL_ARTIC_ISA_BITS == 256
using Ends = __m256d;
FCL_ARTIC_INLINE Ends load(const float* x) {
  return _mm256_cvtps_pd(_mm_loadu_ps(x));
}
FCL_ARTIC_INLINE Ends addUp(Ends a, Ends b) {
  Ends o;
  asm("vaddpd %2, %1, %0" : "=x"(o) : "x"(a), "x"(b), "m"(rounding_mode));
  return o;
}
FCL_ARTIC_INLINE Ends mulUp(Ends a, Ends b) {
  Ends o;
  asm("vmulpd %2, %1, %0" : "=x"(o) : "x"(a), "x"(b), "m"(rounding_mode));
  return o;
}
FCL_ARTIC_INLINE unsigned above(Ends a, Ends b) {
  return static_cast<unsigned>(_mm256_movemask_pd(_mm256_cmp_pd(a, b, _CMP_GT_OQ)));
}
#else
using Ends = __m128d;
FCL_ARTIC_INLINE Ends load(const float* x) {
  return _mm_set_pd(static_cast<double>(x[1]), static_cast<double>(x[0]));
}
FCL_ARTIC_INLINE Ends addUp(Ends a, Ends b) {
  return directed::add(a, b);
}
FCL_ARTIC_INLINE Ends mulUp(Ends a, Ends b) {
  return directed::mul(a, b);
}
FCL_ARTIC_INLINE unsigned above(Ends a, Ends b) {
  return static_cast<unsigned>(_mm_movemask_pd(_mm_cmpgt_pd(a, b)));
}
#endif

FCL_ARTIC_INLINE Ends spread(double x) {
  return FCL_ARTIC_LANES(set1_pd)(x);
}
FCL_ARTIC_INLINE Ends least(Ends a, Ends b) {
  return FCL_ARTIC_LANES(min_pd)(a, b);
}
FCL_ARTIC_INLINE Ends most(Ends a, Ends b) {
  return FCL_ARTIC_LANES(max_pd)(a, b);
}
FCL_ARTIC_INLINE Ends negated(Ends a) {
  return FCL_ARTIC_LANES(xor_pd)(a, spread(-0.0));
}
/// NaN becomes an infinite end.
FCL_ARTIC_INLINE Ends known(Ends a) {
  return least(a, spread(__builtin_inf()));
}

/// What batches need set while they compute: AVX-512 only that subnormals are kept.
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
