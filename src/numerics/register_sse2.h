// SPDX-License-Identifier: BSD-3-Clause
//
// Two doubles in an SSE2 register, which every x86-64 processor has. The file numerics/lanes.h lists what each
// function does.
#pragma once

#include <emmintrin.h>

#include "numerics/inlined.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

using Register = __m128d;
FCL_ARTIC_INLINE Register regSet(double x) {
  return _mm_set1_pd(x);
}
FCL_ARTIC_INLINE Register regMin(Register a, Register b) {
  return _mm_min_pd(a, b);
}
FCL_ARTIC_INLINE Register regMax(Register a, Register b) {
  return _mm_max_pd(a, b);
}
FCL_ARTIC_INLINE Register regAbs(Register a) {
  return _mm_andnot_pd(_mm_set1_pd(-0.0), a);
}
FCL_ARTIC_INLINE Register regSqrt(Register a) {
  return _mm_sqrt_pd(a);
}
FCL_ARTIC_INLINE Register regMulAdd(Register a, Register b, Register c) {
  return _mm_add_pd(_mm_mul_pd(a, b), c);
}
FCL_ARTIC_INLINE unsigned regGreater(Register a, Register b) {
  return static_cast<unsigned>(_mm_movemask_pd(_mm_cmpgt_pd(a, b)));
}
FCL_ARTIC_INLINE Register regWhereGreater(Register a, Register b, Register x, Register y) {
  const Register which = _mm_cmpgt_pd(a, b);
  return _mm_or_pd(_mm_and_pd(which, x), _mm_andnot_pd(which, y));
}
FCL_ARTIC_INLINE double regMaxLane(Register a) {
  return a[0] > a[1] ? a[0] : a[1];
}

using Integers = __m128i;  // in its lower half
FCL_ARTIC_INLINE Integers regTruncate(Register a) {
  return _mm_cvttpd_epi32(a);
}
FCL_ARTIC_INLINE Integers regPlus(Integers n, int k) {
  return _mm_add_epi32(n, _mm_set1_epi32(k));
}
FCL_ARTIC_INLINE Register regBits(Integers n, int bits) {
  return _mm_cvtepi32_pd(_mm_and_si128(n, _mm_set1_epi32(bits)));
}

using Floats = __m128;
FCL_ARTIC_INLINE Floats regNarrow(const Register* a) {
  return _mm_movelh_ps(_mm_cvtpd_ps(a[0]), _mm_cvtpd_ps(a[1]));
}
FCL_ARTIC_INLINE Floats regSpread(float x) {
  return _mm_set1_ps(x);
}
FCL_ARTIC_INLINE Floats regAbove(Floats a, Floats b) {
  return _mm_cmpgt_ps(a, b);
}
FCL_ARTIC_INLINE Floats regOr(Floats a, Floats b) {
  return _mm_or_ps(a, b);
}
FCL_ARTIC_INLINE unsigned regSigns(Floats a) {
  return static_cast<unsigned>(_mm_movemask_ps(a));
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
