// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>

namespace fcl_artic {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Bounds the relative error of one operation in any rounding mode.
constexpr double kUlp = 0x1p-52;

/// Coordinates and lengths allowed, m: up to here pads stay small enough for precise answers.
constexpr double kFarthest = 1e9;

}  // namespace fcl_artic
