// SPDX-License-Identifier: BSD-3-Clause
//
// From a piece's own time, [0, 1], to that of its trajectory, rounded outward (doc/PROMISE.md, 3).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "model/bracket.h"
#include "numerics/assertion.h"

namespace fcl_artic {

/// The time [begin, end] of one piece of a trajectory.
class PieceTime {
 public:
  PieceTime(double begin, double end) : begin_(begin), end_(end) { FCL_ARTIC_ASSERT(begin < end); }

  double begin() const { return begin_; }
  double duration() const { return end_ - begin_; }
  /// No later than the trajectory's time at s, but within the piece.
  double lower(double s) const {
    const double t = below(begin_ + below(below(end_ - begin_) * s));
    return s <= 0 ? begin_ : s >= 1 ? end_ : std::min(end_, std::max(begin_, t));
  }
  /// No earlier than that.
  double upper(double s) const {
    const double t = above(begin_ + above(above(end_ - begin_) * s));
    return s <= 0 ? begin_ : s >= 1 ? end_ : std::min(end_, std::max(begin_, t));
  }

 private:
  /// The next double below x, from its bits, so that no rounding mode matters. A sum, difference or product of doubles
  /// that is computed as x, in any mode, is no less. (Below 2^-1000, where products underflow, times count as 0.)
  static double below(double x) {
    if (std::abs(x) < 0x1p-1000) return -0x1p-1000;
    std::int64_t bits;
    std::memcpy(&bits, &x, sizeof bits);
    bits += x > 0 ? -1 : 1;
    std::memcpy(&x, &bits, sizeof bits);
    return x;
  }
  static double above(double x) { return -below(-x); }

  double begin_, end_;
};

}  // namespace fcl_artic
