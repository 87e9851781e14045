// SPDX-License-Identifier: BSD-3-Clause
//
// Sine and cosine over intervals: those of numerics/sine_cosine.h, for both ends of an interval at once.
#pragma once

#include "interval/interval.h"
#include "numerics/sine_cosine.h"

namespace fcl_artic {

/// Holds sin x and cos x of all x in the interval. Runs under RoundUpward.
inline __attribute__((always_inline)) void encloseSineCosine(Interval x, Interval& sine, Interval& cosine) {
  sine = cosine = Interval(-1, 1);
  if (!(x.magnitude() <= kLargestAngle)) return;
  const __m128d ends = _mm_set_pd(x.upper(), x.lower());

  // Extrema are at k pi/2: those with k between the ends' quotients by pi/2, which are computed to 1e-9: three
  // roundings of numbers below 6.4e5. One k too many costs no more than 1e-17.
  const __m128d scaled = _mm_mul_pd(ends, _mm_set1_pd(0.63661977236758134308));
  const double from = _mm_cvtsd_f64(scaled) - 1e-9, to = _mm_cvtsd_f64(_mm_unpackhi_pd(scaled, scaled)) + 1e-9;
  int first = static_cast<int>(from), last = static_cast<int>(to);
  first += from > first;  // conversion cuts towards 0 in every mode: ceiling and floor of it
  last -= to < last;
  if (last - first >= 3) return;  // a whole turn's extrema

  __m128d s, c;
  sineCosine(ends, s, c);
  const auto between = [](__m128d y) {  // values at both ends, allowance added, cut to [-1, 1]
    const __m128d negative = _mm_xor_pd(y, _mm_set1_pd(-0.0));
    const __m128d pair = _mm_max_pd(_mm_unpacklo_pd(negative, y), _mm_unpackhi_pd(negative, y));
    return _mm_min_pd(directed::add(pair, _mm_set1_pd(kSineError)), _mm_set1_pd(1));
  };
  s = between(s);
  c = between(c);
  for (int k = first; k <= last; ++k) {
    const __m128d peak = (k & 2) ? _mm_set_pd(-1, 1) : _mm_set_pd(1, -1);  // an end of -1 or 1
    if (k & 1) {
      s = _mm_max_pd(s, peak);
    } else {
      c = _mm_max_pd(c, peak);
    }
  }
  sine = Interval::raw(s);
  cosine = Interval::raw(c);
}

}  // namespace fcl_artic
