// SPDX-License-Identifier: BSD-3-Clause
//
// Bounds on M_0i(t) down the kinematic tree over a time interval (Redon 2004, Section 3 and 5.2.1), for every step of a
// sweep: arms, free bodies, moving obstacles and pairs of links alike. Derivations: doc/REDON2004.md.
#pragma once

#include <memory>

#include "interval/matrix.h"
#include "model/query.h"

namespace fcl_artic {

/// How a frame's motion over [begin, end] is enclosed, in rising order of tightness.
enum class Enclosure {
  intervalChain,  ///< interval matrix products down the chain: the paper's
  meanValue,      ///< X(tm) + X'(T) (T - tm), cut with the former
  taylor,         ///< quadratic at tm with a constant remainder, cut with the chain's where the motion is large
};

/// Bounds on a frame over a time interval: its pose, and the derivatives of that by time.
struct FrameBounds {
  IntervalTransform pose, rate, second;  ///< rate.R, rate.t: R'(t), o'(t); second: R''(t), o''(t)
};

/// The part of FrameBounds that is asked for; each includes the ones before it.
enum class Derivatives { none, first, second };

/// Bounds of one sweep under one motion. Keeps its memory from query to query; for one thread at a time.
class ChainBounds {
 public:
  ChainBounds();
  ~ChainBounds();
  ChainBounds(ChainBounds&&) noexcept;
  ChainBounds& operator=(ChainBounds&&) noexcept;

  /// @param sweep, query  what they point to must stay while enclose() is called; of the query, coefficients and
  ///                      orientations count.
  void reset(const engine::SweepView& sweep, const engine::Query& query);

  /// Bounds over [begin, end], a part of [0, 1], begin <= end.
  /// @param[out] out  one per step of the sweep: the step's frame in the base frame. The part that isn't asked for is
  ///   not set.
  void enclose(double begin, double end, Enclosure enclosure, Derivatives derivatives, FrameBounds* out);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A constant transform with the error its owner states: holds the model's.
IntervalTransform enclose(const engine::Placement& placement);

}  // namespace fcl_artic
