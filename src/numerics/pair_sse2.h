// SPDX-License-Identifier: BSD-3-Clause
//
// Two doubles in an SSE2 register, which every x86-64 processor has. The file numerics/pair.h lists what each function
// does.
#pragma once

#include <emmintrin.h>

#include "numerics/inlined.h"

namespace fcl_artic {

using Pair = __m128d;
FCL_ARTIC_INLINE Pair pairOf(double x) {
  return _mm_set1_pd(x);
}
FCL_ARTIC_INLINE Pair pairOf(double low, double high) {
  return _mm_set_pd(high, low);
}
FCL_ARTIC_INLINE double pairLow(Pair a) {
  return _mm_cvtsd_f64(a);
}
FCL_ARTIC_INLINE double pairHigh(Pair a) {
  return _mm_cvtsd_f64(_mm_unpackhi_pd(a, a));
}
FCL_ARTIC_INLINE Pair pairLows(Pair a, Pair b) {
  return _mm_unpacklo_pd(a, b);
}
FCL_ARTIC_INLINE Pair pairHighs(Pair a, Pair b) {
  return _mm_unpackhi_pd(a, b);
}
FCL_ARTIC_INLINE Pair pairLows(Pair a) {
  return pairLows(a, a);
}
FCL_ARTIC_INLINE Pair pairHighs(Pair a) {
  return pairHighs(a, a);
}
FCL_ARTIC_INLINE Pair pairSwap(Pair a) {
  return _mm_shuffle_pd(a, a, 1);
}
FCL_ARTIC_INLINE Pair pairMix(Pair a, Pair b) {
  return _mm_move_sd(b, a);
}
FCL_ARTIC_INLINE Pair pairNegate(Pair a) {
  return _mm_xor_pd(a, _mm_set1_pd(-0.0));
}
FCL_ARTIC_INLINE Pair pairNegateLow(Pair a) {
  return _mm_xor_pd(a, _mm_set_pd(0.0, -0.0));
}
FCL_ARTIC_INLINE Pair pairMin(Pair a, Pair b) {
  return _mm_min_pd(a, b);
}
FCL_ARTIC_INLINE Pair pairMax(Pair a, Pair b) {
  return _mm_max_pd(a, b);
}
FCL_ARTIC_INLINE Pair pairWhereAtMost(Pair a, Pair b, Pair x, Pair y) {
  const Pair which = _mm_cmple_pd(a, b);
  return _mm_or_pd(_mm_and_pd(which, x), _mm_andnot_pd(which, y));
}
FCL_ARTIC_INLINE unsigned pairGreater(Pair a, Pair b) {
  return static_cast<unsigned>(_mm_movemask_pd(_mm_cmpgt_pd(a, b)));
}
FCL_ARTIC_INLINE Pair pairWithSignOf(double x, Pair a) {
  return _mm_or_pd(_mm_and_pd(a, _mm_set1_pd(-0.0)), _mm_set1_pd(x));
}

using PairIntegers = __m128i;  // in its lower half
FCL_ARTIC_INLINE PairIntegers pairTruncate(Pair a) {
  return _mm_cvttpd_epi32(a);
}
FCL_ARTIC_INLINE PairIntegers pairPlus(PairIntegers n, int k) {
  return _mm_add_epi32(n, _mm_set1_epi32(k));
}
FCL_ARTIC_INLINE Pair pairOf(PairIntegers n) {
  return _mm_cvtepi32_pd(n);
}
/// Each integer twice: n0 n0 n1 n1.
FCL_ARTIC_INLINE PairIntegers pairTwice(PairIntegers n) {
  return _mm_shuffle_epi32(n, 0x50);
}
FCL_ARTIC_INLINE Pair pairWhereOdd(PairIntegers n, Pair x, Pair y) {
  const __m128i one = _mm_set1_epi32(1);
  const Pair odd = _mm_castsi128_pd(_mm_cmpeq_epi32(_mm_and_si128(pairTwice(n), one), one));
  return _mm_or_pd(_mm_and_pd(odd, x), _mm_andnot_pd(odd, y));
}
FCL_ARTIC_INLINE Pair pairFlip(Pair a, PairIntegers n) {
  const __m128i sign = _mm_slli_epi64(_mm_and_si128(pairTwice(n), _mm_set1_epi32(2)), 62);  // bit 1 to bit 63
  return _mm_xor_pd(a, _mm_castsi128_pd(sign));
}

}  // namespace fcl_artic
