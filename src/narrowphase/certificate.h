// SPDX-License-Identifier: BSD-3-Clause
//
// The proof that anything is free (doc/NUMERICS.md, section 4): a direction n, fixed in one body's frame, keeps two
// convex pieces apart over a whole time interval. Where n comes from needs no trust; this file and
// motion/{chain,factors,remainder,rigid_lanes}.h carry all of it.
#pragma once

#include "convex/piece_kinds.h"
#include "motion/rigid_lanes.h"
#include "narrowphase/tube.h"
#include "numerics/assertion.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

/// One body seen from the other. `m` is the motion of `moving` in the frame of `still`. They are to be more than
/// `margin` apart; `pad` is what rounding may take of that.
struct Side {
  RigidLanes m;
  const TreeView* still;
  const TreeView* moving;
  double margin, pad;          ///< with what the tube adds in any direction
  double own_margin;           ///< without
  const Tube* tube = nullptr;  ///< null: nothing strays
  const Side* direct;          ///< B seen from A: this one, or the other one of the pair
};

/// Ends of n.x over the moving piece's core, as Bernstein points of a lower and an upper quadratic; the remainder and
/// pad are left to the caller.
/// @param lanes  those that matter.
///
/// n.x(t) over the core is n.c + range of the core along R^T n. With R and c in the hull of their Bernstein points
/// (with weights that depend on t only) and h convex, h(R(t)^T n) lies below the quadratic with Bernstein points
/// h(R_k^T n); -h(-u) above the one with -h(-R_k^T n).
FCL_ARTIC_INLINE void movingRange(const Side& side, const Piece& moving, const Vec3& n, unsigned lanes, Lanes* lower,
                                  Lanes* upper) {
  for (int k = 0; k < 3; ++k) {
    const Vec3Lanes u = transposedTimes(side.m.Rb[k], n);
    coreRange(*side.moving, moving, u, lanes, lower[k], upper[k]);
    const Lanes g = dot(side.m.cb[k], n);
    lower[k] = lower[k] + g;
    upper[k] = upper[k] + g;
  }
}

/// The pieces are more than the margin apart if the gap between their cores along a unit direction is larger than
/// this. It covers radii, what the quadratic leaves out, rounding.
FCL_ARTIC_INLINE double slackOf(const Side& side, const Piece& still, const Piece& moving) {
  return side.margin + still.radius + moving.radius + side.m.rem_c + side.m.rem_R * moving.reach + side.pad;
}

/// Upper bounds of what the tube takes of the gap along n, over the lanes. The side has a tube.
/// @param n  in the frame of side.still; `length` is at least |n|.
inline Lanes tubeAlong(const Side& side, const Piece& still, const Piece& moving, const Vec3Lanes& n,
                       const Lanes& length, unsigned lanes) {
  const Side& direct = *side.direct;
  if (&side == &direct) {
    return tubeAlong(*side.tube, {*side.still, *side.moving, still, moving, side.m}, n, length, true, lanes);
  }
  const TubePieces pieces = {*direct.still, *direct.moving, moving, still, direct.m};
  return tubeAlong(*side.tube, pieces, direct.m.R[0] * n, length, true, lanes);
}
/// slackOf() without the tube.
FCL_ARTIC_INLINE double slackWithoutTube(const Side& side, const Piece& still, const Piece& moving) {
  return side.own_margin + still.radius + moving.radius + side.m.rem_c + side.m.rem_R * moving.reach + side.pad;
}

/// The range of n.x over the moving piece's core in each lane, for a direction n that is fixed in the frame of
/// side.still. The same range serves every still piece that it is compared with.
struct SweptRange {
  Vec3 n;          ///< unit to 1e-15
  unsigned lanes;  ///< of which it is known
  Lanes least, most;
};
FCL_ARTIC_INLINE void sweepRange(const Side& side, const Piece& moving, const Vec3& n, unsigned lanes,
                                 SweptRange& range) {
  Lanes lower[3], upper[3];
  movingRange(side, moving, n, lanes, lower, upper);
  range.n = n;
  range.lanes = lanes;
  range.least = min(min(lower[0], lower[1]), lower[2]);
  range.most = max(max(upper[0], upper[1]), upper[2]);
}
/// Lanes, of those that are known, in which range.n or -range.n certainly keeps the pieces more than the margin apart
/// over the whole interval. The gap is compared with slackOf(), then with the slack that the tube leaves along n.
FCL_ARTIC_INLINE unsigned certainlySeparated(const Side& side, const Piece& still, const Piece& moving,
                                             const SweptRange& range) {
  double s_lower, s_upper;
  coreRange(*side.still, still, range.n, s_lower, s_upper);
  const double slack = slackOf(side, still, moving);
  unsigned apart = greater(range.least, Lanes(s_upper + slack)) | greater(Lanes(s_lower - slack), range.most);
  if (side.tube && (range.lanes & ~apart)) {
    const Lanes along = tubeAlong(side, still, moving, spread(range.n), Lanes(1 + 8 * kUlp), range.lanes & ~apart) +
                        Lanes(slackWithoutTube(side, still, moving));
    apart |= greater(range.least, Lanes(s_upper) + along) | greater(Lanes(s_lower) - along, range.most);
  }
  return range.lanes & apart;
}
/// Lanes, of those that matter, in which n or -n (unit to 1e-15) certainly keeps the pieces more than the margin apart
/// over the whole interval.
/// @param n  in the frame of side.still.
FCL_ARTIC_INLINE unsigned certainlySeparated(const Side& side, const Piece& still, const Piece& moving, const Vec3& n,
                                             unsigned lanes) {
  SweptRange range;
  sweepRange(side, moving, n, lanes, range);
  return certainlySeparated(side, still, moving, range);
}

/// A part [0, z] of [0, 1] on which the quadratic with Bernstein coefficients G is certainly positive; up to its first
/// root, as far as rounding lets that be proven. Its end z is only a guess until de Casteljau's subdivision at z has
/// shown that the coefficients are not negative. These are the coefficients over [0, z], and over [z, 1] where all of
/// [0, 1] is claimed.
inline double positivePrefix(const double* G) {
  // The subdivision errs by at most 11 kUlp of the largest coefficient.
  const double reserve = 16 * kUlp * max(max(abs(G[0]), abs(G[1])), abs(G[2]));
  const double g0 = G[0] - reserve, g1 = G[1] - reserve, g2 = G[2] - reserve;
  if (!(g0 > 0)) return 0;
  if (g1 >= 0 && g2 >= 0) return 1;
  const double a = (g0 - g1) + (g2 - g1), b = g1 - g0, discriminant = b * b - a * g0;  // g0 + 2 b z + a z^2
  double guess;
  if (!(discriminant > 0)) {
    guess = -b / a;  // no root: the lowest point
  } else {
    const double root = sqrt(discriminant);
    guess = b <= 0 ? g0 / (root - b) : -(b + root) / a;  // the first root, without cancellation
  }
  static const double kParts[3] = {1 - 1e-12, 1 - 1e-8, 1 - 1e-3};
  for (const double part : kParts) {
    const double z = max(0.0, min(guess, 1.0)) * part;
    const double left = g0 + z * (g1 - g0), right = g1 + z * (g2 - g1), middle = left + z * (right - left);
    if (!(left >= 0 && middle >= 0)) continue;
    FCL_ARTIC_ASSERT(z >= 0 && z <= 1);
    return right >= 0 && g2 >= 0 ? 1 : z;
  }
  return 0;
}

/// Bernstein coefficients of a lower bound of the gap beyond the margin along n, over each lane's interval.
/// @param n  in the frame of side.still, from still to moving.
FCL_ARTIC_INLINE void gapBound(const Side& side, const Piece& still, const Piece& moving, const Vec3& n, Lanes* G) {
  double s_lower, s_upper;
  coreRange(*side.still, still, n, s_lower, s_upper);
  Lanes upper[3];
  movingRange(side, moving, n, kAllLanes, G, upper);
  Lanes slack(s_upper + slackOf(side, still, moving));
  if (side.tube) {
    slack = tubeAlong(side, still, moving, spread(n), Lanes(1 + 8 * kUlp), kAllLanes) +
            Lanes(s_upper + slackWithoutTube(side, still, moving));
  }
  for (int k = 0; k < 3; ++k) G[k] = G[k] - slack;
}

/// A direction that turns: over each lane's interval it goes straight from `begin` to `end`. It need not be unit.
struct TurningDirection {
  Vec3Lanes begin, end;
};

/// The same along a direction that turns, as the gap's own does between edges and curved surfaces, in neither body's
/// frame. The product of a linear n and a quadratic motion is a cubic: Bernstein points (R_0 n_0, (R_0 n_1 + 2 R_1
/// n_0) / 3, (2 R_1 n_1 + R_2 n_0) / 3, R_2 n_1). The still piece's range is convex in n, so it lies below the line
/// between its values at both ends. So does |n|, and all that is taken off is multiplied by the larger of both. The
/// quadratic with the points (g_0, min((3 g_1 - g_0) / 2, (3 g_2 - g_3) / 2), g_3) lies below the cubic: raised to
/// degree 3 none of its points is higher. (The tube's part is convex in n: no direction between has a larger one.)
/// @param side  B seen from A: the pad is derived for the direct motion (doc/NUMERICS.md, "Pads").
FCL_ARTIC_INLINE void gapBound(const Side& side, const Piece& still, const Piece& moving, const TurningDirection& n,
                               Lanes* G) {
  const Lanes third(1.0 / 3);
  Lanes g[4];
  Lanes s_lower[2], s_upper[2];
  coreRange(*side.still, still, n.begin, s_lower[0], s_upper[0]);
  coreRange(*side.still, still, n.end, s_lower[1], s_upper[1]);
  const Lanes longest = sqrt(max(dot(n.begin, n.begin), dot(n.end, n.end)));
  Lanes length = longest * Lanes((1 + 8 * kUlp) * slackOf(side, still, moving));
  if (side.tube) {
    const Lanes unit = longest * Lanes(1 + 8 * kUlp);
    length = unit * Lanes(slackWithoutTube(side, still, moving)) +
             max(tubeAlong(side, still, moving, n.begin, unit, kAllLanes),
                 tubeAlong(side, still, moving, n.end, unit, kAllLanes));
  }
  for (int k = 0; k < 4; ++k) {
    // Point k of the cubic: (k n_1 X_(k-1) + (3 - k) n_0 X_k) / 3.
    Vec3Lanes u = spread(Vec3(0, 0, 0));
    Lanes origin(0.0);
    for (int end = 0; end < 2; ++end) {
      const int point = k - end;
      if (point < 0 || point > 2) continue;
      const Lanes weight = Lanes(end ? k : 3 - k) * third;
      const Vec3Lanes m = (end ? n.end : n.begin) * weight;
      u = mulAdd(transposed(side.m.Rb[point]), m, u);
      origin = origin + dot(side.m.cb[point], m);
    }
    Lanes upper;
    coreRange(*side.moving, moving, u, g[k], upper);
    const Lanes part = Lanes(k / 3.0);
    g[k] = g[k] + origin - (mulAdd(part, s_upper[1] - s_upper[0], s_upper[0]) + length);
  }
  const Lanes half(0.5), more(1.5);
  G[0] = g[0];
  G[1] = min(more * g[1] - half * g[0], more * g[2] - half * g[3]);
  G[2] = g[3];
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
