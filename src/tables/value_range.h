// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace fcl_artic {

/// Joints may stand at their limits: tables and proofs extend beyond them by this part of the joint's range.
constexpr double kBeyondLimits = 1e-3;
/// Tables and proofs leave out joints with values, or mimic joints with multipliers or offsets, beyond this (rad or m):
/// their pads are derived for smaller ones.
constexpr double kMaxValue = 100;

/// Values of a joint variable, both ends included. Any value is meant where they are infinite.
struct ValueRange {
  double lower = 0, upper = 0;

  double middle() const { return 0.5 * (lower + upper); }
  /// No value in the range is farther from the middle; rounding of a sum and a half included.
  double half() const;
};

}  // namespace fcl_artic
