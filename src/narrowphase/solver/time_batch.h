// SPDX-License-Identifier: BSD-3-Clause
//
// Eight intervals of time, one a lane: a value. Motions are bounded over all of them at once.
#pragma once

#include "motion/remainder.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

/// Lanes are certified a little wider than they are, so that rounding of their ends and middles, numbers up to 1, loses
/// nothing (doc/NUMERICS.md, "Time").
constexpr double kLaneSlack = 8 * kUlp;

/// Lane k is the interval [at[k] - d, at[k] + d], which holds [start[k], end[k]].
struct TimeBatch {
  Lanes tm;              ///< the middles
  double at[kLanes], d;  ///< the same, and half of each interval's width; 0: they are poses
  Lanes start, end;
  double width;  ///< of [start, end]

  /// Eight equal parts of [begin, begin + width].
  static TimeBatch partsOf(double begin, double width) {
    TimeBatch batch;
    const double w = width / kLanes;
    batch.width = w;
    batch.d = 0.5 * w + kLaneSlack;
    for (int k = 0; k < kLanes; ++k) {
      batch.start.set(k, begin + k * w);
      batch.end.set(k, begin + (k + 1) * w);
      batch.setMiddle(k, begin + (k + 0.5) * w);
    }
    return batch;
  }
  /// The middles of the eight parts of [0, 1], as poses.
  static TimeBatch middles() {
    TimeBatch batch;
    batch.d = batch.width = 0;
    for (int k = 0; k < kLanes; ++k) batch.setPose(k, 0.125 * k + 0.0625);
    return batch;
  }
  /// One time in all lanes, as a pose, or as an interval of half a width d.
  static TimeBatch around(double t, double d = 0) {
    TimeBatch batch;
    batch.d = d;
    batch.width = 0;
    for (int k = 0; k < kLanes; ++k) batch.setPose(k, t);
    return batch;
  }

  void setMiddle(int lane, double t) {
    at[lane] = t;
    tm.set(lane, t);
  }
  void setPose(int lane, double t) {
    start.set(lane, t);
    end.set(lane, t);
    setMiddle(lane, t);
  }

  /// The same intervals.
  bool operator==(const TimeBatch& other) const {
    return d == other.d && !(greater(tm, other.tm) | greater(other.tm, tm));
  }

  /// The ends of an interval that holds all lanes, as far as something is claimed of them: claims are about [0, 1].
  /// kUlp: rounding of the ends.
  double begin() const { return max(0.0, minLane(tm) - d - kUlp); }
  double finish() const { return min(1.0, maxLane(tm) + d + kUlp); }
};

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
