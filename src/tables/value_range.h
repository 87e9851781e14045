// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace fcl_artic {

/// Values of a joint variable, both ends included. Any value is meant where they are infinite.
struct ValueRange {
  double lower = 0, upper = 0;

  double middle() const { return 0.5 * (lower + upper); }
  /// No value in the range is farther from the middle; rounding of a sum and a half included.
  double half() const;
};

}  // namespace fcl_artic
