// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace fcl_artic {

/// Beyond this, rad or m, or as the tangent of half an angle, the error pads of a motion's bounds do not hold.
constexpr double kLargestJointValue = 1e5;

}  // namespace fcl_artic
