// SPDX-License-Identifier: BSD-3-Clause
//
// The tube around a motion, as one pair sees it over eight intervals (doc/NUMERICS.md, "Tubes"). Joints, poses and the
// base may be off by their tolerances. So the pair's bodies may be nearer to each other than the motion says.
#pragma once

#include "convex/piece_kinds.h"
#include "motion/rigid_lanes.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

/// A step that strays, in the middles of the lanes, seen from A's tree frame.
struct TubeAxis {
  Vec3Lanes origin, axis;
  double stray;  ///< upper bound, rad; m if it slides
  bool slides;
};

/// Upper bounds, m.
struct Tube {
  Lanes middle{0.0};  ///< in any direction, in the middle of each lane
  double over = 0;    ///< the same over the whole batch
  /// The steps whose share depends on the direction. `rest` is what all others and second order add to it. Entry [0]
  /// counts if points of A are looked at, [1] if points of B are.
  const TubeAxis* axes = nullptr;
  int count = 0;
  double rest_middle[2] = {kUnknown, kUnknown}, rest[2] = {kUnknown, kUnknown};
  static constexpr double kUnknown = 1e300;  ///< no direction says less than `over`
};

/// Two pieces of a pair, of A and of B, with B's motion seen from A.
struct TubePieces {
  const TreeView &tree_a, &tree_b;
  const Piece &a, &b;
  const RigidLanes& b_seen;
};

/// Upper bounds of how much nearer two pieces may be along n in the tube: to first order a turn by d about u moves a
/// point x along n by d (n x u).(x - o). Either piece's points may be looked at; the lesser sum counts.
/// @param n  in A's tree frame.
/// @param length  at least |n|.
/// @param over  over the whole lanes; false: in their middles.
/// @param lanes  those that matter.
inline Lanes tubeAlong(const Tube& tube, const TubePieces& pieces, const Vec3Lanes& n, const Lanes& length, bool over,
                       unsigned lanes) {
  Lanes least = (over ? Lanes(tube.over) : tube.middle) * length;
  for (int s = 0; s < 2; ++s) {
    const TreeView& tree = s ? pieces.tree_b : pieces.tree_a;
    const Piece& piece = s ? pieces.b : pieces.a;
    const double rest = over ? tube.rest[s] : tube.rest_middle[s];
    if (unbounded(piece) || !(rest < tube.over)) continue;
    Lanes sum = Lanes(rest) * length;
    for (int i = 0; i < tube.count; ++i) {
      const TubeAxis& step = tube.axes[i];
      if (step.slides) {
        sum = mulAdd(abs(dot(n, step.axis)), Lanes(step.stray), sum);
        continue;
      }
      const Vec3Lanes w = cross(n, step.axis);
      Lanes at, lower, upper;
      if (s) {
        coreRange(tree, piece, transposedTimes(pieces.b_seen.R[0], w), lanes, lower, upper);
        at = dot(w, pieces.b_seen.c[0] - step.origin);
      } else {
        coreRange(tree, piece, w, lanes, lower, upper);
        at = -dot(w, step.origin);
      }
      const Lanes most = max(at + upper, -(at + lower)) + sqrt(dot(w, w)) * Lanes(piece.radius);
      sum = mulAdd(most, Lanes(step.stray), sum);
    }
    least = min(sum, least);
  }
  return least;
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
