// SPDX-License-Identifier: BSD-3-Clause
//
// Many points and equations under one motion's bounds: intervals side by side in vector registers, compiled once per
// instruction set and picked at run time. All of them but "portable" give the bits that Interval gives; "portable"
// needs no rounding mode and gives intervals that hold those. Callers need no RoundUpward: each call sees to it.
#pragma once

#include "interval/matrix.h"

namespace fcl_artic {

/// Bounds on a frame over a time interval: its pose, and the derivatives of that by time.
struct FrameBounds {
  IntervalTransform pose, rate, second;  ///< rate.R, rate.t: R'(t), o'(t); second: R''(t), o''(t)
};

/// Four points of each equation as columns of constant coordinates: a.x, a.y, a.z, b.x, ... d.z, n numbers each.
using PointColumns = const double* const (&)[12];

struct IntervalBatch {
  const char* name;
  /// out[i] holds M p for point i at every time. With M a frame's rate, its velocity.
  /// @param xyz  n points, packed.
  void (*boundPoints)(const IntervalTransform& M, const double* xyz, int n, IntervalVec3* out);
  /// Redon 2004, eq. (14), of vertex a against face b, c, d: ab . (bc x bd).
  /// @param[out] value  n intervals.
  /// @param[out] rate  of the derivatives by time; null: not wanted.
  void (*vertexFace)(const FrameBounds& of_a, const FrameBounds& of_bcd, PointColumns points, int n, Interval* value,
                     Interval* rate);
  /// Redon 2004, eq. (13), of the edges ab and cd: ac . (ab x cd).
  void (*edgeEdge)(const FrameBounds& of_ab, const FrameBounds& of_cd, PointColumns points, int n, Interval* value,
                   Interval* rate);
};

/// The widest that this processor runs; FCL_ARTIC_ISA=portable|sse2|avx2|avx512 in the environment asks for less.
const IntervalBatch& intervalBatch();
/// The one named "portable", "sse2", "avx2" or "avx512"; null where the processor lacks it.
const IntervalBatch* intervalBatchNamed(const char* name);

extern const IntervalBatch kIntervalBatchPortable, kIntervalBatchSse2, kIntervalBatchAvx2, kIntervalBatchAvx512;

}  // namespace fcl_artic
