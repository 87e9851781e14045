// SPDX-License-Identifier: BSD-3-Clause
//
// Intervals side by side, one per lane of a register: operation by operation what interval.h does, so that every lane
// has the bits of Interval. Compiled once per instruction set: the including file defines FCL_ARTIC_ISA (the namespace)
// and FCL_ARTIC_ISA_BITS (128, 256 or 512) first. AVX-512 names the direction of rounding in each instruction; the
// others take it from RoundUpward, as interval/rounding.h tells.
#pragma once

#include "interval/matrix.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

#if FCL_ARTIC_ISA_BITS == 512
using Ends = __m512d;
FCL_ARTIC_INLINE Ends spread(double x) {
  return _mm512_set1_pd(x);
}
FCL_ARTIC_INLINE Ends load(const double* x) {
  return _mm512_loadu_pd(x);
}
FCL_ARTIC_INLINE Ends everyThird(const double* x) {
  return _mm512_i32gather_pd(_mm256_set_epi32(21, 18, 15, 12, 9, 6, 3, 0), x, 8);
}
FCL_ARTIC_INLINE Ends least(Ends a, Ends b) {
  return _mm512_min_pd(a, b);
}
FCL_ARTIC_INLINE Ends most(Ends a, Ends b) {
  return _mm512_max_pd(a, b);
}
FCL_ARTIC_INLINE Ends negated(Ends a) {
  return _mm512_xor_pd(a, _mm512_set1_pd(-0.0));
}
FCL_ARTIC_INLINE Ends addUp(Ends a, Ends b) {
  return _mm512_add_round_pd(a, b, _MM_FROUND_TO_POS_INF | _MM_FROUND_NO_EXC);
}
FCL_ARTIC_INLINE Ends mulUp(Ends a, Ends b) {
  return _mm512_mul_round_pd(a, b, _MM_FROUND_TO_POS_INF | _MM_FROUND_NO_EXC);
}
FCL_ARTIC_INLINE void writePairs(Ends n, Ends h, Interval* out, int stride) {
  const Ends even = _mm512_unpacklo_pd(n, h), odd = _mm512_unpackhi_pd(n, h);
  out[0] = Interval::raw(_mm512_castpd512_pd128(even));
  out[stride] = Interval::raw(_mm512_castpd512_pd128(odd));
  out[2 * stride] = Interval::raw(_mm512_extractf64x2_pd(even, 1));
  out[3 * stride] = Interval::raw(_mm512_extractf64x2_pd(odd, 1));
  out[4 * stride] = Interval::raw(_mm512_extractf64x2_pd(even, 2));
  out[5 * stride] = Interval::raw(_mm512_extractf64x2_pd(odd, 2));
  out[6 * stride] = Interval::raw(_mm512_extractf64x2_pd(even, 3));
  out[7 * stride] = Interval::raw(_mm512_extractf64x2_pd(odd, 3));
}
#elif FCL_ARTIC_ISA_BITS == 256
using Ends = __m256d;
FCL_ARTIC_INLINE Ends spread(double x) {
  return _mm256_set1_pd(x);
}
FCL_ARTIC_INLINE Ends load(const double* x) {
  return _mm256_loadu_pd(x);
}
FCL_ARTIC_INLINE Ends everyThird(const double* x) {
  return _mm256_set_pd(x[9], x[6], x[3], x[0]);
}
FCL_ARTIC_INLINE Ends least(Ends a, Ends b) {
  return _mm256_min_pd(a, b);
}
FCL_ARTIC_INLINE Ends most(Ends a, Ends b) {
  return _mm256_max_pd(a, b);
}
FCL_ARTIC_INLINE Ends negated(Ends a) {
  return _mm256_xor_pd(a, _mm256_set1_pd(-0.0));
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
FCL_ARTIC_INLINE void writePairs(Ends n, Ends h, Interval* out, int stride) {
  const Ends even = _mm256_unpacklo_pd(n, h), odd = _mm256_unpackhi_pd(n, h);
  out[0] = Interval::raw(_mm256_castpd256_pd128(even));
  out[stride] = Interval::raw(_mm256_castpd256_pd128(odd));
  out[2 * stride] = Interval::raw(_mm256_extractf128_pd(even, 1));
  out[3 * stride] = Interval::raw(_mm256_extractf128_pd(odd, 1));
}
#else
using Ends = __m128d;
FCL_ARTIC_INLINE Ends spread(double x) {
  return _mm_set1_pd(x);
}
FCL_ARTIC_INLINE Ends load(const double* x) {
  return _mm_loadu_pd(x);
}
FCL_ARTIC_INLINE Ends everyThird(const double* x) {
  return _mm_set_pd(x[3], x[0]);
}
FCL_ARTIC_INLINE Ends least(Ends a, Ends b) {
  return _mm_min_pd(a, b);
}
FCL_ARTIC_INLINE Ends most(Ends a, Ends b) {
  return _mm_max_pd(a, b);
}
FCL_ARTIC_INLINE Ends negated(Ends a) {
  return _mm_xor_pd(a, _mm_set1_pd(-0.0));
}
FCL_ARTIC_INLINE Ends addUp(Ends a, Ends b) {
  return directed::add(a, b);
}
FCL_ARTIC_INLINE Ends mulUp(Ends a, Ends b) {
  return directed::mul(a, b);
}
FCL_ARTIC_INLINE void writePairs(Ends n, Ends h, Interval* out, int stride) {
  out[0] = Interval::raw(_mm_unpacklo_pd(n, h));
  out[stride] = Interval::raw(_mm_unpackhi_pd(n, h));
}
#endif

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
  /// Interval k to out[k * stride].
  FCL_ARTIC_INLINE void write(Interval* out, int stride = 1) const { writePairs(n, h, out, stride); }
};

/// NaN becomes an infinite end.
FCL_ARTIC_INLINE Ends known(Ends a) {
  return least(a, spread(__builtin_inf()));
}

FCL_ARTIC_INLINE Intervals operator+(Intervals a, Intervals b) {
  return {addUp(a.n, b.n), addUp(a.h, b.h)};
}
FCL_ARTIC_INLINE Intervals operator-(Intervals a, Intervals b) {
  return {addUp(a.n, b.h), addUp(a.h, b.n)};
}
FCL_ARTIC_INLINE Intervals operator-(Intervals a) {
  return {a.h, a.n};
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

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
