// SPDX-License-Identifier: BSD-3-Clause
//
// Sine and cosine over intervals: those of numerics/sine_cosine.h, for both ends of an interval at once.
#pragma once

#include "interval/interval.h"
#include "numerics/sine_cosine.h"

namespace fcl_artic {

/// Holds sin x and cos x of all x in the interval. Runs under RoundUpward.
FCL_ARTIC_INLINE void encloseSineCosine(Interval x, Interval& sine, Interval& cosine) {
  sine = cosine = Interval(-1, 1);
  if (!(x.magnitude() <= kLargestAngle)) return;
  const Pair ends = pairOf(x.lower(), x.upper());

  // Extrema are at k pi/2: those with k between the ends' quotients by pi/2, which are computed to 1e-9: three
  // roundings of numbers below 6.4e5. One k too many costs no more than 1e-17.
  const Pair scaled = ends * pairOf(0.63661977236758134308);
  const double from = pairLow(scaled) - 1e-9, to = pairHigh(scaled) + 1e-9;
  int first = static_cast<int>(from), last = static_cast<int>(to);
  first += from > first;  // conversion cuts towards 0 in every mode: ceiling and floor of it
  last -= to < last;
  if (last - first >= 3) return;  // a whole turn's extrema

  Pair s, c;
  sineCosine(ends, s, c);
  const auto between = [](Pair y) {  // values at both ends, allowance added, cut to [-1, 1]
    const Pair negative = pairNegate(y);
    const Pair pair = pairMax(pairLows(negative, y), pairHighs(negative, y));
    return pairMin(directed::add(pair, pairOf(kSineError)), pairOf(1));
  };
  s = between(s);
  c = between(c);
  for (int k = first; k <= last; ++k) {
    const Pair peak = (k & 2) ? pairOf(1, -1) : pairOf(-1, 1);  // an end of -1 or 1
    if (k & 1) {
      s = pairMax(s, peak);
    } else {
      c = pairMax(c, peak);
    }
  }
  sine = Interval::raw(s);
  cosine = Interval::raw(c);
}

}  // namespace fcl_artic
