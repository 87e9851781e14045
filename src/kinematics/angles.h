// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

namespace fcl_artic {

/// A whole turn in radians; off by less than 2^-52 of itself.
constexpr double kTwoPi = 6.283185307179586;

/// The integer next to x, the even one of two: in any rounding mode, as std::nearbyint() is not. (The remainder is
/// exact, and so is the difference.)
inline double nearestInteger(double x) {
  return x - std::remainder(x, 1.0);
}

}  // namespace fcl_artic
