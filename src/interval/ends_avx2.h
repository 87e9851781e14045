// SPDX-License-Identifier: BSD-3-Clause
//
// Ends of four intervals in an AVX2 register, rounded as RoundUpward sets it. The file interval/interval_lanes.h lists
// what each function does.
#pragma once

#include <immintrin.h>

#include "interval/rounding.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

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
FCL_ARTIC_INLINE Ends spread(double x) {
  return _mm256_set1_pd(x);
}
FCL_ARTIC_INLINE Ends least(Ends a, Ends b) {
  return _mm256_min_pd(a, b);
}
FCL_ARTIC_INLINE Ends most(Ends a, Ends b) {
  return _mm256_max_pd(a, b);
}
FCL_ARTIC_INLINE Ends negated(Ends a) {
  return _mm256_xor_pd(a, spread(-0.0));
}
}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
