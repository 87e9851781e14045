// SPDX-License-Identifier: BSD-3-Clause
//
// The continuous overlap test of two oriented boxes (Redon 2004, eq. 12; RKC02): both sides of the fifteen inequalities
// in interval arithmetic over a time interval, ended by the first axis that separates. Runs under RoundUpward.
//
// Box A: axes e_i, center c_a, half sizes a_i, standing still. Box B: axes f_j, center c_b, half sizes b_j, moving by
// M(t). In the coordinates y_i = e_i . (x - c_a) box A is |y_i| <= a_i, exactly so, whatever rounding the stored axes
// have (their slabs hold the triangles). B there is T(t) + sum_j z_j g_j(t), |z_j| <= b_j: T_i = e_i . (M c_b - c_a),
// G_ij = e_i . (R f_j). An axis n separates them if |n . T| > sum_i a_i |n_i| + sum_j b_j |n . g_j|:
//   n = unit i      |T_i|                          > a_i + sum_j b_j |G_ij|
//   n = g_j         |sum_i T_i G_ij|               > sum_i a_i |G_ij| + b_j
//   n = unit i x g_j  |T_k G_lj - T_l G_kj|        > a_k |G_lj| + a_l |G_kj| + b_m |G_in| + b_n |G_im|
// with i, k, l and j, m, n cyclic. The latter two take the g_j for orthonormal, which they are but for the rounding of
// both boxes' axes to single precision: each product g_j . g_k is within 2^-19 of 0 or 1, so sum_j b_j 2^-18 on the
// right side pays for it (a margin of that size along a direction of at most length 2).
#pragma once

#include "geometry/obb_tree.h"
#include "interval/matrix.h"

namespace fcl_artic {
namespace redon {

/// Box B, bounded over a time interval in A's frame.
struct SweptObb {
  IntervalVec3 axis[3], center;
};

FCL_ARTIC_INLINE void sweep(const IntervalTransform& M, const ObbNode& box, SweptObb& out) {
  double p[3];
  for (int j = 0; j < 3; ++j) {
    for (int k = 0; k < 3; ++k) p[k] = box.axis[j][k];
    out.axis[j] = M.R * p;
  }
  for (int k = 0; k < 3; ++k) p[k] = box.center[k];
  out.center = M * p;
}

/// Upward: a * x + b * y, all >= 0.
FCL_ARTIC_INLINE double sumOfProducts(double a, double x, double b, double y) {
  const Pair p = directed::mul(pairOf(a, b), pairOf(x, y));
  return pairLow(directed::add(p, pairHighs(p)));
}
FCL_ARTIC_INLINE double sumUp(double a, double b) {
  return pairLow(directed::add(pairOf(a, 0), pairOf(b, 0)));
}
FCL_ARTIC_INLINE double productUp(double a, double b) {
  return pairLow(directed::mul(pairOf(a, 0), pairOf(b, 0)));
}

/// No point of the one box meets one of the other at any time of the interval.
inline bool certainlyDisjoint(const ObbNode& A, const SweptObb& moved, const float* half_b) {
  const double a[3] = {A.half[0], A.half[1], A.half[2]}, b[3] = {half_b[0], half_b[1], half_b[2]};
  IntervalVec3 d;
  for (int k = 0; k < 3; ++k) d[k] = moved.center[k] - Interval(static_cast<double>(A.center[k]));
  Interval T[3], G[3][3];
  double g[3][3];  // upper bounds of |G_ij|
  const auto along = [&](int i, const IntervalVec3& v) {
    return (v[0] * static_cast<double>(A.axis[i][0]) + v[1] * static_cast<double>(A.axis[i][1])) +
           v[2] * static_cast<double>(A.axis[i][2]);
  };
  for (int i = 0; i < 3; ++i) {
    T[i] = along(i, d);
    for (int j = 0; j < 3; ++j) {
      G[i][j] = along(i, moved.axis[j]);
      g[i][j] = G[i][j].magnitude();
    }
    const double radius = sumUp(sumUp(sumOfProducts(b[0], g[i][0], b[1], g[i][1]), productUp(b[2], g[i][2])), a[i]);
    if (T[i].mignitude() > radius) return true;
  }
  const double slack = productUp(0x1p-18, sumUp(sumUp(b[0], b[1]), b[2]));
  for (int j = 0; j < 3; ++j) {
    const Interval t = (T[0] * G[0][j] + T[1] * G[1][j]) + T[2] * G[2][j];
    const double radius =
        sumUp(sumUp(sumOfProducts(a[0], g[0][j], a[1], g[1][j]), productUp(a[2], g[2][j])), sumUp(b[j], slack));
    if (t.mignitude() > radius) return true;
  }
  for (int i = 0; i < 3; ++i) {
    const int k = (i + 1) % 3, l = (i + 2) % 3;
    for (int j = 0; j < 3; ++j) {
      const int m = (j + 1) % 3, n = (j + 2) % 3;
      const Interval t = T[k] * G[l][j] - T[l] * G[k][j];
      const double radius =
          sumUp(sumUp(sumOfProducts(a[k], g[l][j], a[l], g[k][j]), sumOfProducts(b[m], g[i][n], b[n], g[i][m])), slack);
      if (t.mignitude() > radius) return true;
    }
  }
  return false;
}

}  // namespace redon
}  // namespace fcl_artic
