// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace fcl_artic {

/// A whole turn in radians; off by less than 2^-52 of itself.
constexpr double kTwoPi = 6.283185307179586;

}  // namespace fcl_artic
