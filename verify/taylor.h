// SPDX-License-Identifier: BSD-3-Clause
// Taylor models of degree 2: what a quantity is over an interval of time, t = centre + half s with s in [-1, 1].
#pragma once

#include <array>

#include "fixed.h"

namespace verify {

/// All functions g with |g(s) - (c0 + c1 s + c2 s^2)| <= r for s in [-1, 1].
struct Tm {
  Fix c0, c1, c2, r;
};

inline Tm constant(Fix x, Fix error = Fix{0}) {
  return {x, {}, {}, error};
}
/// A number of the statement.
inline Tm exactly(double x) {
  const Enclosed e = enclose(x);
  return constant(e.x, e.error);
}
inline Fix magnitude(const Tm& a) {
  return abs(a.c0) + abs(a.c1) + abs(a.c2);
}  // of the polynomial
inline Fix bound(const Tm& a) {
  return magnitude(a) + a.r;
}  // of the functions
inline bool isZero(const Tm& a) {
  return (a.c0.v | a.c1.v | a.c2.v | a.r.v) == 0;
}

inline Tm operator+(const Tm& a, const Tm& b) {
  return {a.c0 + b.c0, a.c1 + b.c1, a.c2 + b.c2, a.r + b.r};
}
inline Tm operator-(const Tm& a, const Tm& b) {
  return {a.c0 - b.c0, a.c1 - b.c1, a.c2 - b.c2, a.r + b.r};
}
inline Tm operator-(const Tm& a) {
  return {-a.c0, -a.c1, -a.c2, a.r};
}

/// (p + [-ra, ra])(q + [-rb, rb]) lies in p q + [-R, R], R = |p| rb + |q| ra + ra rb, |p| <= |a0| + |a1| + |a2|.
/// In p q the powers s^3 and s^4 are replaced by Chebyshev's polynomials T3 = 4 s^3 - 3 s, T4 = 8 s^4 - 8 s^2 + 1,
/// which are in [-1, 1]. As s^3 = 3/4 s + T3/4 and s^4 = s^2 - 1/8 + T4/8, a quarter and an eighth of the coefficient
/// is left over. Each product and each shift is off by less than one ulp: at most 9 products and 3 shifts in the
/// polynomial, 12 ulp.
inline Tm operator*(const Tm& a, const Tm& b) {
  if (isZero(a) || isZero(b)) return {};
  const Fix e3 = a.c1 * b.c2 + a.c2 * b.c1, e4 = a.c2 * b.c2;
  const Fix left_over = shifted(abs(e3), 2) + shifted(abs(e4), 3) + ulps(2);
  return {a.c0 * b.c0 - shifted(e4, 3), a.c0 * b.c1 + a.c1 * b.c0 + e3 - shifted(e3, 2),
          a.c0 * b.c2 + a.c1 * b.c1 + a.c2 * b.c0 + e4,
          left_over + mulUp(magnitude(a) + a.r, b.r) + mulUp(magnitude(b), a.r) + ulps(12)};
}
/// A third, a half ...: by an integer n > 0. Each of the three quotients is off by less than one ulp.
inline Tm divided(const Tm& a, int n) {
  return {Fix{a.c0.v / n}, Fix{a.c1.v / n}, Fix{a.c2.v / n}, Fix{a.r.v / n} + ulps(4)};
}

using Vec = std::array<Tm, 3>;
using Mat = std::array<Tm, 9>;  // by rows

inline Tm dot(const Vec& a, const Vec& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline Vec operator+(const Vec& a, const Vec& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
inline Vec operator-(const Vec& a, const Vec& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline Vec operator*(const Mat& R, const Vec& x) {
  Vec y;
  for (int i = 0; i < 3; ++i) y[i] = R[3 * i] * x[0] + R[3 * i + 1] * x[1] + R[3 * i + 2] * x[2];
  return y;
}
/// R^T x
inline Vec transposed(const Mat& R, const Vec& x) {
  Vec y;
  for (int i = 0; i < 3; ++i) y[i] = R[i] * x[0] + R[3 + i] * x[1] + R[6 + i] * x[2];
  return y;
}
inline Mat operator*(const Mat& A, const Mat& B) {
  Mat C;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) C[3 * i + j] = A[3 * i] * B[j] + A[3 * i + 1] * B[3 + j] + A[3 * i + 2] * B[6 + j];
  return C;
}

/// x -> R x + t
struct Pose {
  Mat R;
  Vec t;
};

void sineCosine(const Tm& angle, Tm& sine, Tm& cosine);
/// Rotation about a unit axis. @param kk  its products k_i k_j.
Mat rotation(const Vec& k, const Mat& kk, const Tm& angle);
/// exp([w]) @throws OutOfRange where |w| may be above 10.
Mat rotation(const Vec& w);

}  // namespace verify
