// SPDX-License-Identifier: BSD-3-Clause
//
// Sine and cosine of two doubles at once. No library function is trusted: none promises its error, and glibc's switches
// the rounding mode at every call. The reduction and polynomials are those of numerics/lanes.h, whose error is proven
// for every rounding mode (doc/NUMERICS.md, section 7).
#pragma once

#include "numerics/pair.h"

namespace fcl_artic {

/// Angles beyond are not reduced: their sine is only known to lie in [-1, 1].
constexpr double kLargestAngle = 1e6;
/// Bounds the error of sineCosine() (doc/NUMERICS.md, Lemma 4).
constexpr double kSineError = 0x1p-50;

/// Sine and cosine of two angles, |x| <= kLargestAngle, each off by at most kSineError, in any rounding mode.
FCL_ARTIC_INLINE void sineCosine(Pair x, Pair& sine, Pair& cosine) {
  const auto mulAdd = [](Pair a, Pair b, double c) { return a * b + pairOf(c); };
  // k = x 2/pi + 1/2 with x's sign, truncated: the same in every rounding mode but for ties.
  const PairIntegers k = pairTruncate(x * pairOf(0.63661977236758134308) + pairWithSignOf(0.5, x));
  const Pair quotient = pairOf(k);
  const Pair r = ((x - quotient * pairOf(1.57079632673412561417e+00)) - quotient * pairOf(6.07710050630396597660e-11)) -
                 quotient * pairOf(2.02226624879595063154e-21);
  const Pair z = r * r;
  Pair p = mulAdd(z, pairOf(1.58969099521155010221e-10), -2.50507602534068634195e-08);
  p = mulAdd(z, p, 2.75573137070700676789e-06);
  p = mulAdd(z, p, -1.98412698298579493134e-04);
  p = mulAdd(z, p, 8.33333333332248946124e-03);
  p = mulAdd(z, p, -1.66666666666666324348e-01);
  const Pair s = (r * z) * p + r;
  Pair q = mulAdd(z, pairOf(-1.13596475577881948265e-11), 2.08757232129817482790e-09);
  q = mulAdd(z, q, -2.75573143513906633035e-07);
  q = mulAdd(z, q, 2.48015872894767294178e-05);
  q = mulAdd(z, q, -1.38888888888741095749e-03);
  q = mulAdd(z, q, 4.16666666666666019037e-02);
  const Pair c = (z * z) * q + (pairOf(1) - pairOf(0.5) * z);
  // Odd quadrants swap the two; bit 1 of k is the sine's sign, bit 1 of k + 1 the cosine's.
  sine = pairFlip(pairWhereOdd(k, c, s), k);
  cosine = pairFlip(pairWhereOdd(k, s, c), pairPlus(k, 1));
}

}  // namespace fcl_artic
