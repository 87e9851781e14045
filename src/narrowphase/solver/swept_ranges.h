// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "narrowphase/solver/relative_motion.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

/// Directions that kept a body's hull apart from patches of a large body, over one batch, each with the hull's range
/// along it. One plane mostly keeps a link apart from many patches: each takes a single look at its few vertices then.
class SweptRanges {
 public:
  /// A new query: none is known. (Epochs may begin anew with it.)
  void forget() {
    epoch_ = -1;
    count_ = next_ = 0;
  }
  /// Lanes of `mask` in which one of the directions certainly keeps B's hull apart from a piece of A. Starts anew for
  /// another pair or batch.
  unsigned separate(Seen seen, const Piece& still, unsigned mask, std::uint64_t& certificates) {
    begin(seen);
    unsigned apart = 0;
    for (int i = 0; i < count_ && (mask & ~apart); ++i) {
      ++certificates;
      apart |= certainlySeparated(seen->side(0), still, *seen->b().outer, ranges_[i]);
    }
    return mask & apart;
  }
  /// Adds a direction, in A's frame.
  /// @return lanes in which it certainly keeps B's hull apart from a piece of A.
  unsigned add(Seen seen, const Piece& still, const Vec3& n, unsigned lanes) {
    begin(seen);
    SweptRange& range = ranges_[next_];
    next_ = (next_ + 1) % kKept;
    count_ = count_ < kKept ? count_ + 1 : kKept;
    sweepRange(seen->side(0), *seen->b().outer, n, lanes, range);
    return certainlySeparated(seen->side(0), still, *seen->b().outer, range);
  }

 private:
  void begin(Seen seen) {
    if (epoch_ == seen->epoch()) return;
    epoch_ = seen->epoch();
    count_ = next_ = 0;
  }

  static constexpr int kKept = 8;
  SweptRange ranges_[kKept];
  int count_ = 0, next_ = 0;
  std::int32_t epoch_ = -1;
};

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
