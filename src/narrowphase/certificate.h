// SPDX-License-Identifier: BSD-3-Clause
//
// The proof that anything is free (SHAPES, section 1): a direction n, fixed in one body's frame, keeps two convex pieces
// apart over a whole time interval. Where n comes from needs no trust; this file and lane_motion.h carry all of it.
#pragma once

#include "motion/lane_motion.h"
#include "narrowphase/piece_support.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

/// One body seen from the other. `m` is the motion of `moving` in the frame of `still`.
struct Side {
  RigidLanes m;
  const TreeView* still;
  const TreeView* moving;
};

/// Ends of n.x over the moving piece's core, as Bernstein points of a lower and an upper quadratic; the remainder and pad
/// are left to the caller.
///
/// n.x(t) over the core is n.c + range of the core along R^T n. With R and c in the hull of their Bernstein points
/// (with weights that depend on t only) and h convex, h(R(t)^T n) lies below the quadratic with Bernstein points
/// h(R_k^T n); -h(-u) above the one with -h(-R_k^T n).
FCL_ARTIC_INLINE void movingRange(const Side& side, const Piece& moving, const double* n, Lanes* lower, Lanes* upper) {
  for (int k = 0; k < 3; ++k) {
    Lanes u[3];
    for (int j = 0; j < 3; ++j) {
      u[j] = mulAdd(side.m.Rb[k][j], n[0], mulAdd(side.m.Rb[k][3 + j], n[1], side.m.Rb[k][6 + j] * Lanes(n[2])));
    }
    coreRange(*side.moving, moving, u, lower[k], upper[k]);
    const Lanes g = dot(side.m.cb[k], n);
    lower[k] = lower[k] + g;
    upper[k] = upper[k] + g;
  }
}

/// Lanes in which n or -n (unit to 1e-15) certainly keeps the pieces more than `margin` apart over the whole interval.
/// @param n  in the frame of side.still.
/// @param sign  +1 or -1 where n, or -n, separated some lane (still to moving); else left as it was.
FCL_ARTIC_INLINE unsigned certainlySeparated(const Side& side, const Piece& still, const Piece& moving,
                                             const double* n, double margin, double pad, double& sign) {
  double s_lower, s_upper;
  coreRange(*side.still, still, n, s_lower, s_upper);
  Lanes lower[3], upper[3];
  movingRange(side, moving, n, lower, upper);
  const double slack = margin + still.radius + moving.radius + side.m.rem_c + side.m.rem_R * moving.reach + pad;
  const unsigned above = greater(min(min(lower[0], lower[1]), lower[2]), Lanes(s_upper + slack));
  const unsigned below = greater(Lanes(s_lower - slack), max(max(upper[0], upper[1]), upper[2]));
  if (above) sign = 1;
  if (below) sign = -1;
  return above | below;
}

/// A part [0, z] of [0, 1] on which the quadratic with Bernstein coefficients G is certainly positive; up to its first
/// root, as far as rounding lets that be proven. z is only a guess until de Casteljau's subdivision at z has shown that
/// the coefficients over [0, z], and over [z, 1] where all of [0, 1] is claimed, are not negative.
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
    return right >= 0 && g2 >= 0 ? 1 : z;
  }
  return 0;
}

/// Bernstein coefficients of a lower bound of the gap beyond `margin` along n, over each lane's interval.
/// @param n  in the frame of side.still, from still to moving.
FCL_ARTIC_INLINE void gapBound(const Side& side, const Piece& still, const Piece& moving, const double* n, double margin,
                               double pad, Lanes* G) {
  double s_lower, s_upper;
  coreRange(*side.still, still, n, s_lower, s_upper);
  Lanes upper[3];
  movingRange(side, moving, n, G, upper);
  const Lanes slack(s_upper +
                    (margin + still.radius + moving.radius + side.m.rem_c + side.m.rem_R * moving.reach + pad));
  for (int k = 0; k < 3; ++k) G[k] = G[k] - slack;
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
