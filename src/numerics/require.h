// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <stdexcept>
#include <string>
#include <string_view>

#include "numerics/shown.h"

namespace fcl_artic {

// Queries call these: they allocate nothing for a good number.

/// @throws std::invalid_argument, "WHAT is X, not a number >= 0", for a number that is negative or not finite.
inline void requireNotNegative(double x, std::string_view what) {
  if (std::isfinite(x) && x >= 0) return;
  throw std::invalid_argument(std::string(what) + " is " + shown(x) + ", not a number >= 0");
}

/// @throws std::invalid_argument, "WHAT is X, not a positive number", for a number that is not above 0 or not finite.
inline void requirePositive(double x, std::string_view what) {
  if (std::isfinite(x) && x > 0) return;
  throw std::invalid_argument(std::string(what) + " is " + shown(x) + ", not a positive number");
}

/// @throws std::invalid_argument, "WHAT is X, not a finite number", for an infinite number or NaN.
inline void requireFinite(double x, std::string_view what) {
  if (std::isfinite(x)) return;
  throw std::invalid_argument(std::string(what) + " is " + shown(x) + ", not a finite number");
}

}  // namespace fcl_artic
