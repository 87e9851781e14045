// SPDX-License-Identifier: BSD-3-Clause
//
// Functions that make a rotation of a rotation vector (doc/REDON2004.md, "Turns"). Under RoundUpward, as all intervals.
#pragma once

#include "interval/sine_cosine.h"

namespace fcl_artic {

/// a = sin(x)/x, b = (1 - cos x)/x^2, c = (1 - a)/x^2 as functions of g = x^2 >= 0, and the derivatives of b and c by
/// g.
struct TurnSeries {
  Interval a, b, c, b1, c1;
};
/// At one g, by the series for small ones. The rest after ten terms is less than the first one left out, as signs
/// alternate.
inline TurnSeries turnSeriesAt(double point) {
  const Interval g(point);
  if (point >= 0.5) {
    const Interval x = sqrt(g);
    Interval sine, cosine;
    encloseSineCosine(x, sine, cosine);
    TurnSeries f;
    f.a = sine / x;
    f.b = (Interval(1.0) - cosine) / g;
    f.c = (Interval(1.0) - f.a) / g;
    const Interval a1 = (cosine - f.a) / (g * 2.0);
    f.b1 = (f.a - f.b * 2.0) / (g * 2.0);
    f.c1 = (-a1 - f.c) / g;
    return f;
  }
  TurnSeries f = {Interval(0.0), Interval(0.0), Interval(0.0), Interval(0.0), Interval(0.0)};
  Interval term(1.0);  // (-g)^k / (2k + 1)!
  for (int k = 0; k < 10; ++k) {
    const double i = 2 * k;
    const Interval two_more = term / Interval((i + 2) * (i + 3));
    const Interval next = -(two_more * (k + 1.0));
    f.a += term;
    f.b += term / Interval(i + 2);
    f.c += two_more;
    f.b1 += next / Interval(i + 4);
    f.c1 += next / Interval((i + 4) * (i + 5));
    term = -(two_more * g);
  }
  const Interval left_out = plusMinus(1e-20);
  f.a += left_out;
  f.b += left_out;
  f.c += left_out;
  f.b1 += left_out;
  f.c1 += left_out;
  return f;
}
/// Over an interval. Here a is the integral of cos(x s) over s in [0, 1], b that of (1 - s) cos(x s), c that of (1 -
/// s)^2/2 cos(x s). The first two derivatives of cos(x s) by g are at most s^2/2 and s^4/12. So the functions change
/// by at most 1/6, 1/24, 1/120, 1/360, 1/2520 of what g does.
inline TurnSeries turnSeries(Interval g) {
  const double middle = g.middle() > 0 ? g.middle() : 0;
  TurnSeries f = turnSeriesAt(middle);
  const Interval change = plusMinus((g - Interval(middle)).magnitude());
  f.a += change / Interval(6.0);
  f.b += change / Interval(24.0);
  f.c += change / Interval(120.0);
  f.b1 += change / Interval(360.0);
  f.c1 += change / Interval(2520.0);
  return f;
}

}  // namespace fcl_artic
