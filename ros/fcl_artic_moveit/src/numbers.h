// SPDX-License-Identifier: BSD-3-Clause
//
// Parameters are refused where they are set, by their names. The library would refuse some of them too, but by its own
// names and when the first trajectory comes.
#pragma once

#include <cmath>
#include <stdexcept>
#include <string>

namespace fcl_artic_moveit {

/// @throws std::invalid_argument naming `what`, for a number that is negative or not finite.
inline void requireAtLeast0(const std::string& what, double value, const char* unit = "") {
  if (std::isfinite(value) && value >= 0) return;
  throw std::invalid_argument(what + " is " + std::to_string(value) + unit + "; it has to be 0 or more");
}

}  // namespace fcl_artic_moveit
