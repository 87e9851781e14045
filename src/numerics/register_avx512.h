// SPDX-License-Identifier: BSD-3-Clause
//
// Eight doubles in an AVX-512 register. The file numerics/lanes.h lists what each function does.
#pragma once

#include <immintrin.h>

#include "numerics/inlined.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

using Register = __m512d;
FCL_ARTIC_INLINE Register regSet(double x) {
  return _mm512_set1_pd(x);
}
FCL_ARTIC_INLINE Register regMin(Register a, Register b) {
  return _mm512_min_pd(a, b);
}
FCL_ARTIC_INLINE Register regMax(Register a, Register b) {
  return _mm512_max_pd(a, b);
}
FCL_ARTIC_INLINE Register regAbs(Register a) {
  return _mm512_abs_pd(a);
}
FCL_ARTIC_INLINE Register regSqrt(Register a) {
  return _mm512_sqrt_pd(a);
}
FCL_ARTIC_INLINE Register regMulAdd(Register a, Register b, Register c) {
  return _mm512_fmadd_pd(a, b, c);
}
FCL_ARTIC_INLINE unsigned regGreater(Register a, Register b) {
  return _mm512_cmp_pd_mask(a, b, _CMP_GT_OQ);
}
FCL_ARTIC_INLINE Register regWhereGreater(Register a, Register b, Register x, Register y) {
  return _mm512_mask_mov_pd(y, _mm512_cmp_pd_mask(a, b, _CMP_GT_OQ), x);
}
FCL_ARTIC_INLINE double regMaxLane(Register a) {
  const __m256d half = _mm256_max_pd(_mm512_castpd512_pd256(a), _mm512_extractf64x4_pd(a, 1));
  const __m128d m = _mm_max_pd(_mm256_castpd256_pd128(half), _mm256_extractf128_pd(half, 1));
  return m[0] > m[1] ? m[0] : m[1];
}

using Integers = __m256i;
FCL_ARTIC_INLINE Integers regTruncate(Register a) {
  return _mm512_cvttpd_epi32(a);
}
FCL_ARTIC_INLINE Integers regPlus(Integers n, int k) {
  return _mm256_add_epi32(n, _mm256_set1_epi32(k));
}
FCL_ARTIC_INLINE Register regBits(Integers n, int bits) {
  return _mm512_cvtepi32_pd(_mm256_and_si256(n, _mm256_set1_epi32(bits)));
}

using Floats = __m256;
FCL_ARTIC_INLINE Floats regNarrow(const Register* a) {
  return _mm512_cvtpd_ps(a[0]);
}
FCL_ARTIC_INLINE Floats regSpread(float x) {
  return _mm256_set1_ps(x);
}
FCL_ARTIC_INLINE Floats regAbove(Floats a, Floats b) {
  return _mm256_cmp_ps(a, b, _CMP_GT_OQ);
}
FCL_ARTIC_INLINE Floats regOr(Floats a, Floats b) {
  return _mm256_or_ps(a, b);
}
FCL_ARTIC_INLINE unsigned regSigns(Floats a) {
  return static_cast<unsigned>(_mm256_movemask_ps(a));
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
