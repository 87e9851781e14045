// SPDX-License-Identifier: BSD-3-Clause
#include "taylor.h"

namespace verify {

// angle = x0 + d, x0 the number c0, d = c1 s + c2 s^2 + [-r, r], |d| <= D. Taylor with Lagrange's remainder:
//   sin d = d - d^3/6 + [-1, 1] D^5/120,   cos d = 1 - d^2/2 + d^4/24 + [-1, 1] D^6/720,
// for every D. Then sin(x0 + d) and cos(x0 + d) by the sums of angles.
void sineCosine(const Tm& angle, Tm& sine, Tm& cosine) {
  Fix s0, c0;
  sineCosine(angle.c0, s0, c0);
  const Tm s = constant(s0, ulps(2)), c = constant(c0, ulps(2));
  const Tm d{{}, angle.c1, angle.c2, angle.r};
  if (isZero(d)) {
    sine = s;
    cosine = c;
    return;
  }
  const Fix D = bound(d);
  const Fix D2 = mulUp(D, D), D4 = mulUp(D2, D2);
  const Tm d2 = d * d;
  Tm sin_d = d - divided(d2 * d, 6), cos_d = constant(integer(1)) - divided(d2, 2) + divided(d2 * d2, 24);
  sin_d.r += Fix{mulUp(D4, D).v / 120} + ulps(1);
  cos_d.r += Fix{mulUp(D4, D2).v / 720} + ulps(1);
  sine = s * cos_d + c * sin_d;
  cosine = c * cos_d - s * sin_d;
}

/// Adds diagonal I + a [k], where entry (i, i+1) of [k] is -k_(i+2) and entry (i+1, i) is +k_(i+2).
static void finish(Mat& R, const Tm& diagonal, const Tm& a, const Vec& k) {
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, l = (i + 2) % 3;
    const Tm turn = a * k[l];
    R[4 * i] = R[4 * i] + diagonal;
    R[3 * i + j] = R[3 * i + j] - turn;
    R[3 * j + i] = R[3 * j + i] + turn;
  }
}

// Rodrigues: R = cos I + sin [k] + (1 - cos) k k^T.
Mat rotation(const Vec& k, const Mat& kk, const Tm& angle) {
  Tm sine, cosine;
  sineCosine(angle, sine, cosine);
  const Tm rest = constant(integer(1)) - cosine;
  Mat R;
  for (int i = 0; i < 9; ++i) R[i] = rest * kk[i];
  finish(R, cosine, sine, k);
  return R;
}

// exp([w]) = I + A [w] + B [w]^2 with z = |w|^2, [w]^2 = w w^T - z I and
//   A = sin|w|/|w|           = 1 - z/(2*3) (1 - z/(4*5) (1 - z/(6*7) (...
//   B = (1 - cos|w|)/|w|^2   = 1/2 (1 - z/(3*4) (1 - z/(5*6) (1 - ...
// The brackets after step k are 1 - x1 + x1 x2 - ... with x_i = z/(m(m+1)), m >= 2k: where all x_i <= 1/2, they are in
// [-2, 2]. At k = 40 and z <= 100: x_i <= 100/6480. From there back to the front the bracket is divided 40 times.
// Longer vectors: exp([w]) = exp([w/2])^2, again and again; dot() refuses what is out of range. If a rotation's
// enclosure has become useless, only this much is said: its numbers are in [-1, 1].
Mat rotation(const Vec& w) {
  const Tm z = dot(w, w);
  if (bound(z) > integer(100)) {
    const Mat half = rotation(Vec{divided(w[0], 2), divided(w[1], 2), divided(w[2], 2)});
    Mat R = half * half;
    for (Tm& entry : R)
      if (bound(entry) > integer(2)) entry = constant(Fix{0}, integer(1));
    return R;
  }
  constexpr int kTerms = 40;
  const Tm one = constant(integer(1));
  Tm A = constant(Fix{0}, integer(2)), B = A;
  for (int k = kTerms; k >= 1; --k) {
    A = one - divided(z * A, 2 * k * (2 * k + 1));
    B = one - divided(z * B, (2 * k + 1) * (2 * k + 2));
  }
  B = divided(B, 2);
  Mat R;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) R[3 * i + j] = B * (w[i] * w[j]);
  finish(R, one - B * z, A, w);
  return R;
}

}  // namespace verify
