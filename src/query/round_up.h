// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace fcl_artic {

/// Sums and products of a few positive numbers, rounded, times this are no less than the true ones.
constexpr double kUp = 1 + 0x1p-48;

}  // namespace fcl_artic
