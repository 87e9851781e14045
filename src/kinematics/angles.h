// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

namespace fcl_artic {

/// Half a turn and a whole turn in radians; off by less than 2^-52 of themselves.
constexpr double kPi = 3.141592653589793, kTwoPi = 2 * kPi;
constexpr double kRadiansPerDegree = kPi / 180;

/// The integer next to x, the even one of two: in any rounding mode, as std::nearbyint() is not. (The remainder is
/// exact, and so is the difference.)
inline double nearestInteger(double x) {
  return x - std::remainder(x, 1.0);
}

}  // namespace fcl_artic
