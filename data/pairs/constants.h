// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>

namespace pairs {

constexpr double kPi = 3.14159265358979323846;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace pairs
