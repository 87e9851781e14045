// SPDX-License-Identifier: BSD-3-Clause
//
// Arc tangent with a proven error, and the angles that tangents of half an angle stand for. No library function is
// trusted: none promises its error in every rounding mode.
#pragma once

#include "numerics/inlined.h"

namespace fcl_artic {

/// Bounds the error of arcTangent() (doc/NUMERICS.md, Lemma 11).
constexpr double kArcTangentError = 0x1p-50;

/// atan(x) = x - x (c_0 z + c_1 z^2 + ...), z = x^2: the minimax polynomial that fdlibm publishes for |x| <= 7/16.
constexpr int kArcTangentTerms = 11;
constexpr double kArcTangent[kArcTangentTerms] = {
    3.33333333333329318027e-01, -1.99999999998764832476e-01, 1.42857142725034663711e-01, -1.11111104054623557880e-01,
    9.09088713343650656196e-02, -7.69187620504482999495e-02, 6.66107313738753120669e-02, -5.83357013379057348645e-02,
    4.97687799461593236017e-02, -3.65315727442169155270e-02, 1.62858201153657823623e-02};
/// Up to the first one x is the tangent itself, up to the second (s - 1) / (s + 1), an eighth of a turn away, beyond
/// -1 / s, a quarter of a turn away.
constexpr double kFlatTangent = 0.4375, kSteepTangent = 2.4375;
constexpr double kEighthTurn = 7.85398163397448278999e-01, kQuarterTurn = 1.57079632679489655800e+00;

/// atan(s), |s| <= 1e100, off by at most kArcTangentError in any rounding mode.
FCL_ARTIC_INLINE double arcTangent(double s) {
  const double a = s < 0 ? -s : s;
  double x = a, base = 0;
  if (a > kSteepTangent) {
    x = -1 / a;
    base = kQuarterTurn;
  } else if (a > kFlatTangent) {
    x = (a - 1) / (a + 1);
    base = kEighthTurn;
  }
  const double z = x * x;
  double p = kArcTangent[kArcTangentTerms - 1];
  for (int k = kArcTangentTerms - 1; k-- > 0;) p = z * p + kArcTangent[k];
  const double y = base + (x - x * z * p);
  return s < 0 ? -y : y;
}

/// From a range of tangents of half an angle to a range that holds the angles, reference + 2 atan(s).
FCL_ARTIC_INLINE void turnIntoAngles(double reference, double& lower, double& upper) {
  const double size = reference < 0 ? 4 - reference : 4 + reference;
  const double slack = 2 * kArcTangentError + 4 * 0x1p-52 * size;  // the error of 2 atan, and two roundings
  lower = reference + 2 * arcTangent(lower) - slack;
  upper = reference + 2 * arcTangent(upper) + slack;
}

}  // namespace fcl_artic
