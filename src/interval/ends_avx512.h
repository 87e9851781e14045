// SPDX-License-Identifier: BSD-3-Clause
//
// Ends of eight intervals in an AVX-512 register. The file interval/interval_lanes.h lists what each function does;
// each instruction names the direction of rounding itself.
#pragma once

#include <immintrin.h>

#include "numerics/inlined.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

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
FCL_ARTIC_INLINE Ends spread(double x) {
  return _mm512_set1_pd(x);
}
FCL_ARTIC_INLINE Ends least(Ends a, Ends b) {
  return _mm512_min_pd(a, b);
}
FCL_ARTIC_INLINE Ends most(Ends a, Ends b) {
  return _mm512_max_pd(a, b);
}
FCL_ARTIC_INLINE Ends negated(Ends a) {
  return _mm512_xor_pd(a, spread(-0.0));
}
}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
