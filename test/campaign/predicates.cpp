// SPDX-License-Identifier: BSD-3-Clause
#include "predicates.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gmpxx.h>
#include <Eigen/Geometry>

namespace campaign {
namespace {

constexpr double kUnit = std::numeric_limits<double>::epsilon() / 2;

struct Determinant {
  double value;
  double error;  ///< |value - true determinant of the given doubles| is at most this
};

/// det(a - d, b - d, c - d) in doubles. Each of the six products of three differences carries at most 3 + 2 roundings
/// of its factors and products and 3 of the sums, so 8 u times the permanent bounds the error (u = 2^-53); 16 u leaves
/// room for the permanent's own rounding.
Determinant determinant(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 x = a - d, y = b - d, z = c - d;
  const double m0 = y.y() * z.z(), m1 = y.z() * z.y(), m2 = y.z() * z.x(), m3 = y.x() * z.z(), m4 = y.x() * z.y(),
               m5 = y.y() * z.x();
  const double permanent = std::abs(x.x()) * (std::abs(m0) + std::abs(m1)) +
                           std::abs(x.y()) * (std::abs(m2) + std::abs(m3)) +
                           std::abs(x.z()) * (std::abs(m4) + std::abs(m5));
  return {x.x() * (m0 - m1) + x.y() * (m2 - m3) + x.z() * (m4 - m5), 16 * kUnit * permanent + 1e-300};
}

/// Sign of the z component of (b - a) x (c - a) after dropping axis `drop`, exact.
int orient2d(const Vec3& a, const Vec3& b, const Vec3& c, int drop) {
  const int i = (drop + 1) % 3, j = (drop + 2) % 3;
  const mpq_class ai(a[i]), aj(a[j]);
  return sgn((mpq_class(b[i]) - ai) * (mpq_class(c[j]) - aj) - (mpq_class(b[j]) - aj) * (mpq_class(c[i]) - ai));
}

bool sameSide(int x, int y, int z) {
  return (x >= 0 && y >= 0 && z >= 0) || (x <= 0 && y <= 0 && z <= 0);
}

/// Closed segments ab and cd, all four points in one plane that projects injectively along `drop`.
bool coplanarSegmentsTouch(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, int drop) {
  const int s0 = orient2d(a, b, c, drop), s1 = orient2d(a, b, d, drop);
  const int s2 = orient2d(c, d, a, drop), s3 = orient2d(c, d, b, drop);
  if (s0 * s1 < 0 && s2 * s3 < 0) return true;
  const int i = (drop + 1) % 3, j = (drop + 2) % 3;
  const auto within = [&](const Vec3& p, const Vec3& q, const Vec3& x) {
    return std::min(p[i], q[i]) <= x[i] && x[i] <= std::max(p[i], q[i]) && std::min(p[j], q[j]) <= x[j] &&
           x[j] <= std::max(p[j], q[j]);
  };
  return (s0 == 0 && within(a, b, c)) || (s1 == 0 && within(a, b, d)) || (s2 == 0 && within(c, d, a)) ||
         (s3 == 0 && within(c, d, b));
}

bool coplanarSegmentMeetsTriangle(const Vec3& p, const Vec3& q, const Triangle& t) {
  const Vec3 n = (t[1] - t[0]).cross(t[2] - t[0]);
  int drop;
  n.cwiseAbs().maxCoeff(&drop);
  for (const Vec3* x : {&p, &q})
    if (sameSide(orient2d(t[0], t[1], *x, drop), orient2d(t[1], t[2], *x, drop), orient2d(t[2], t[0], *x, drop)))
      return true;
  for (int k = 0; k < 3; ++k)
    if (coplanarSegmentsTouch(p, q, t[k], t[(k + 1) % 3], drop)) return true;
  return false;
}

/// sp, sq: sides of p and q of the triangle's plane.
bool segmentMeetsTriangle(const Vec3& p, const Vec3& q, int sp, int sq, const Triangle& t) {
  if (sp * sq > 0) return false;
  if (sp == 0 && sq == 0) return coplanarSegmentMeetsTriangle(p, q, t);
  // The segment meets the plane in one point, which is in the triangle when the line passes its sides on one hand.
  return sameSide(orient3d(p, q, t[0], t[1]), orient3d(p, q, t[1], t[2]), orient3d(p, q, t[2], t[0]));
}

bool edgesMeet(const Triangle& s, const std::array<int, 3>& side, const Triangle& t) {
  for (int k = 0; k < 3; ++k)
    if (segmentMeetsTriangle(s[k], s[(k + 1) % 3], side[k], side[(k + 1) % 3], t)) return true;
  return false;
}

std::array<int, 3> sidesOf(const Triangle& s, const Triangle& plane) {
  return {orient3d(plane[0], plane[1], plane[2], s[0]), orient3d(plane[0], plane[1], plane[2], s[1]),
          orient3d(plane[0], plane[1], plane[2], s[2])};
}

bool oneSided(const std::array<int, 3>& s) {
  return s[0] == s[1] && s[1] == s[2] && s[0] != 0;
}

bool edgeClearlyCrosses(const Triangle& s, const Triangle& t, double displacement) {
  // A determinant of three differences no longer than `reach`, each off by 2 displacement, is off by at most
  // 3 (reach + 2 displacement)^2 2 displacement.
  const auto signOf = [&](const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    const double reach = std::sqrt(std::max({(a - d).squaredNorm(), (b - d).squaredNorm(), (c - d).squaredNorm()}));
    const double wide = reach + 2 * displacement;
    const Determinant det = determinant(a, b, c, d);
    if (std::abs(det.value) <= det.error + 6.001 * displacement * wide * wide) return 0;
    return det.value > 0 ? 1 : -1;
  };
  for (int k = 0; k < 3; ++k) {
    const Vec3 &p = s[k], &q = s[(k + 1) % 3];
    if (signOf(t[0], t[1], t[2], p) * signOf(t[0], t[1], t[2], q) >= 0) continue;
    const int e = signOf(p, q, t[0], t[1]);
    if (e != 0 && e == signOf(p, q, t[1], t[2]) && e == signOf(p, q, t[2], t[0])) return true;
  }
  return false;
}

}  // namespace

int orient3dExact(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  mpq_class m[3][3];
  const Vec3* rows[3] = {&a, &b, &c};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) m[i][j] = mpq_class((*rows[i])[j]) - mpq_class(d[j]);
  return sgn(m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) + m[0][1] * (m[1][2] * m[2][0] - m[1][0] * m[2][2]) +
             m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]));
}

int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Determinant det = determinant(a, b, c, d);
  if (det.value > det.error) return 1;
  if (det.value < -det.error) return -1;
  return orient3dExact(a, b, c, d);
}

bool trianglesTouch(const Triangle& s, const Triangle& t) {
  // Two closed triangles meet exactly when an edge of one meets the other.
  const std::array<int, 3> side_s = sidesOf(s, t);
  if (oneSided(side_s)) return false;
  const std::array<int, 3> side_t = sidesOf(t, s);
  if (oneSided(side_t)) return false;
  return edgesMeet(s, side_s, t) || edgesMeet(t, side_t, s);
}

bool trianglesClearlyCross(const Triangle& s, const Triangle& t, double displacement) {
  return edgeClearlyCrosses(s, t, displacement) || edgeClearlyCrosses(t, s, displacement);
}

}  // namespace campaign
