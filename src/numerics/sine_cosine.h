// SPDX-License-Identifier: BSD-3-Clause
//
// Sine and cosine of two doubles at once. No library function is trusted: none promises its error, and glibc's switches
// the rounding mode at every call. The reduction and polynomials are those of numerics/lanes.h, whose error is proven
// for every rounding mode (doc/NUMERICS.md, section 7).
#pragma once

#include <emmintrin.h>

namespace fcl_artic {

/// Angles beyond are not reduced: their sine is only known to lie in [-1, 1].
constexpr double kLargestAngle = 1e6;
/// Bounds the error of sineCosine() (doc/NUMERICS.md, Lemma 4).
constexpr double kSineError = 0x1p-50;

/// Sine and cosine of two angles, |x| <= kLargestAngle, each off by at most kSineError, in any rounding mode.
inline __attribute__((always_inline)) void sineCosine(__m128d x, __m128d& sine, __m128d& cosine) {
  const auto set = [](double a) { return _mm_set1_pd(a); };
  const auto mulAdd = [](__m128d a, __m128d b, double c) { return _mm_add_pd(_mm_mul_pd(a, b), _mm_set1_pd(c)); };
  // k = x 2/pi + 1/2 with x's sign, truncated: the same in every rounding mode but for ties.
  const __m128d half = _mm_or_pd(_mm_and_pd(x, set(-0.0)), set(0.5));
  const __m128i k = _mm_cvttpd_epi32(_mm_add_pd(_mm_mul_pd(x, set(0.63661977236758134308)), half));
  const __m128d quotient = _mm_cvtepi32_pd(k);
  const __m128d r = _mm_sub_pd(_mm_sub_pd(_mm_sub_pd(x, _mm_mul_pd(quotient, set(1.57079632673412561417e+00))),
                                          _mm_mul_pd(quotient, set(6.07710050630396597660e-11))),
                               _mm_mul_pd(quotient, set(2.02226624879595063154e-21)));
  const __m128d z = _mm_mul_pd(r, r);
  __m128d p = mulAdd(z, set(1.58969099521155010221e-10), -2.50507602534068634195e-08);
  p = mulAdd(z, p, 2.75573137070700676789e-06);
  p = mulAdd(z, p, -1.98412698298579493134e-04);
  p = mulAdd(z, p, 8.33333333332248946124e-03);
  p = mulAdd(z, p, -1.66666666666666324348e-01);
  const __m128d s = _mm_add_pd(_mm_mul_pd(_mm_mul_pd(r, z), p), r);
  __m128d q = mulAdd(z, set(-1.13596475577881948265e-11), 2.08757232129817482790e-09);
  q = mulAdd(z, q, -2.75573143513906633035e-07);
  q = mulAdd(z, q, 2.48015872894767294178e-05);
  q = mulAdd(z, q, -1.38888888888741095749e-03);
  q = mulAdd(z, q, 4.16666666666666019037e-02);
  const __m128d c = _mm_add_pd(_mm_mul_pd(_mm_mul_pd(z, z), q), _mm_sub_pd(set(1), _mm_mul_pd(set(0.5), z)));
  // Odd quadrants swap the two; bit 1 of k is the sine's sign, bit 1 of k + 1 the cosine's.
  const __m128i wide = _mm_shuffle_epi32(k, 0x50);  // k0 k0 k1 k1
  const __m128i one = _mm_set1_epi32(1), two = _mm_set1_epi32(2);
  const __m128d odd = _mm_castsi128_pd(_mm_cmpeq_epi32(_mm_and_si128(wide, one), one));
  const auto sign = [&](__m128i of) {
    return _mm_castsi128_pd(_mm_slli_epi64(_mm_and_si128(of, two), 62));  // bit 1 to bit 63
  };
  sine = _mm_xor_pd(_mm_or_pd(_mm_and_pd(odd, c), _mm_andnot_pd(odd, s)), sign(wide));
  cosine = _mm_xor_pd(_mm_or_pd(_mm_and_pd(odd, s), _mm_andnot_pd(odd, c)), sign(_mm_add_epi32(wide, one)));
}

}  // namespace fcl_artic
