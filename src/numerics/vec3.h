// SPDX-License-Identifier: BSD-3-Clause
//
// Vectors and matrices of three, of doubles and of lanes: a line that uses them reads as its formula.
//
// Sums of three products are always a2 b2 + (a1 b1 + a0 b0). The pads hold for any order (doc/NUMERICS.md, "Pads"); a
// fixed one makes answers repeatable.
#pragma once

#include "numerics/lanes.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

template <class T>
struct Vec3Of {
  T k[3];

  Vec3Of() = default;
  FCL_ARTIC_INLINE Vec3Of(T x, T y, T z) : k{x, y, z} {}
  /// From three numbers in a row.
  FCL_ARTIC_INLINE explicit Vec3Of(const T* p) : k{p[0], p[1], p[2]} {}

  FCL_ARTIC_INLINE T& operator[](int i) { return k[i]; }
  FCL_ARTIC_INLINE const T& operator[](int i) const { return k[i]; }
  /// To three numbers in a row.
  FCL_ARTIC_INLINE void store(T* p) const {
    for (int i = 0; i < 3; ++i) p[i] = k[i];
  }
};

using Vec3 = Vec3Of<double>;
using Vec3Lanes = Vec3Of<Lanes>;

/// The same vector in all lanes.
FCL_ARTIC_INLINE Vec3Lanes spread(const Vec3& a) {
  return {Lanes(a[0]), Lanes(a[1]), Lanes(a[2])};
}
/// One lane's vector.
FCL_ARTIC_INLINE Vec3 laneOf(const Vec3Lanes& a, int lane) {
  return {a[0][lane], a[1][lane], a[2][lane]};
}
FCL_ARTIC_INLINE void setLane(Vec3Lanes& a, int lane, const Vec3& x) {
  for (int i = 0; i < 3; ++i) a[i].set(lane, x[i]);
}

template <class T>
FCL_ARTIC_INLINE Vec3Of<T> operator+(const Vec3Of<T>& a, const Vec3Of<T>& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
template <class T>
FCL_ARTIC_INLINE Vec3Of<T> operator-(const Vec3Of<T>& a, const Vec3Of<T>& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
template <class T>
FCL_ARTIC_INLINE Vec3Of<T> operator-(const Vec3Of<T>& a) {
  return {-a[0], -a[1], -a[2]};
}
FCL_ARTIC_INLINE Vec3 operator*(const Vec3& a, double s) {
  return {a[0] * s, a[1] * s, a[2] * s};
}
FCL_ARTIC_INLINE Vec3 operator/(const Vec3& a, double s) {
  return {a[0] / s, a[1] / s, a[2] / s};
}
FCL_ARTIC_INLINE Vec3Lanes operator*(const Vec3Lanes& a, Lanes s) {
  return {a[0] * s, a[1] * s, a[2] * s};
}
/// a s + c
FCL_ARTIC_INLINE Vec3Lanes mulAdd(const Vec3Lanes& a, Lanes s, const Vec3Lanes& c) {
  return {mulAdd(a[0], s, c[0]), mulAdd(a[1], s, c[1]), mulAdd(a[2], s, c[2])};
}
template <class T>
FCL_ARTIC_INLINE Vec3Of<T> min(const Vec3Of<T>& a, const Vec3Of<T>& b) {
  return {min(a[0], b[0]), min(a[1], b[1]), min(a[2], b[2])};
}
template <class T>
FCL_ARTIC_INLINE Vec3Of<T> max(const Vec3Of<T>& a, const Vec3Of<T>& b) {
  return {max(a[0], b[0]), max(a[1], b[1]), max(a[2], b[2])};
}
template <class T>
FCL_ARTIC_INLINE Vec3Of<T> abs(const Vec3Of<T>& a) {
  return {abs(a[0]), abs(a[1]), abs(a[2])};
}

FCL_ARTIC_INLINE double dot(const Vec3& a, const Vec3& b) {
  return mulAdd(a[2], b[2], mulAdd(a[1], b[1], a[0] * b[0]));
}
FCL_ARTIC_INLINE Lanes dot(const Vec3Lanes& a, const Vec3Lanes& b) {
  return mulAdd(a[2], b[2], mulAdd(a[1], b[1], a[0] * b[0]));
}
FCL_ARTIC_INLINE Lanes dot(const Vec3Lanes& a, const Vec3& b) {
  return mulAdd(a[2], b[2], mulAdd(a[1], b[1], a[0] * Lanes(b[0])));
}
FCL_ARTIC_INLINE Lanes dot(const Vec3& a, const Vec3Lanes& b) {
  return dot(b, a);
}
/// a.b + c, as one sum.
FCL_ARTIC_INLINE Lanes dotPlus(const Vec3Lanes& a, const Vec3& b, Lanes c) {
  return mulAdd(a[2], b[2], mulAdd(a[1], b[1], mulAdd(a[0], b[0], c)));
}
FCL_ARTIC_INLINE Lanes dotPlus(const Vec3Lanes& a, const Vec3Lanes& b, Lanes c) {
  return mulAdd(a[2], b[2], mulAdd(a[1], b[1], mulAdd(a[0], b[0], c)));
}
template <class T>
FCL_ARTIC_INLINE Vec3Of<T> cross(const Vec3Of<T>& a, const Vec3Of<T>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
template <class T>
FCL_ARTIC_INLINE T norm(const Vec3Of<T>& a) {
  return sqrt(dot(a, a));
}

/// The unit vector along a; z where a is 0.
FCL_ARTIC_INLINE Vec3 unitOrZ(const Vec3& a) {
  const double length = norm(a);
  return length > 0 ? a / length : Vec3(0, 0, 1);
}

/// A matrix by its rows.
template <class T>
struct Mat3Of {
  Vec3Of<T> row[3];

  Mat3Of() = default;
  FCL_ARTIC_INLINE Mat3Of(const Vec3Of<T>& x, const Vec3Of<T>& y, const Vec3Of<T>& z) : row{x, y, z} {}
  /// From nine numbers, row by row.
  FCL_ARTIC_INLINE explicit Mat3Of(const T* p) : row{Vec3Of<T>(p), Vec3Of<T>(p + 3), Vec3Of<T>(p + 6)} {}

  /// To nine numbers, row by row.
  FCL_ARTIC_INLINE void store(T* p) const {
    for (int i = 0; i < 3; ++i) row[i].store(p + 3 * i);
  }
  FCL_ARTIC_INLINE Vec3Of<T>& operator[](int i) { return row[i]; }
  FCL_ARTIC_INLINE const Vec3Of<T>& operator[](int i) const { return row[i]; }
  FCL_ARTIC_INLINE Vec3Of<T> column(int j) const { return {row[0][j], row[1][j], row[2][j]}; }
  FCL_ARTIC_INLINE void setColumn(int j, const Vec3Of<T>& x) {
    for (int i = 0; i < 3; ++i) row[i][j] = x[i];
  }
};

using Mat3 = Mat3Of<double>;
using Mat3Lanes = Mat3Of<Lanes>;

template <class T>
FCL_ARTIC_INLINE Mat3Of<T> columns(const Vec3Of<T>& x, const Vec3Of<T>& y, const Vec3Of<T>& z) {
  return {{x[0], y[0], z[0]}, {x[1], y[1], z[1]}, {x[2], y[2], z[2]}};
}
template <class T>
FCL_ARTIC_INLINE Mat3Of<T> transposed(const Mat3Of<T>& a) {
  return columns(a[0], a[1], a[2]);
}
FCL_ARTIC_INLINE Mat3Lanes spread(const Mat3& a) {
  return {spread(a[0]), spread(a[1]), spread(a[2])};
}
FCL_ARTIC_INLINE Mat3 laneOf(const Mat3Lanes& a, int lane) {
  return {laneOf(a[0], lane), laneOf(a[1], lane), laneOf(a[2], lane)};
}
FCL_ARTIC_INLINE void setLane(Mat3Lanes& a, int lane, const Mat3& x) {
  for (int i = 0; i < 3; ++i) setLane(a[i], lane, x[i]);
}
template <class T>
FCL_ARTIC_INLINE Mat3Of<T> operator+(const Mat3Of<T>& a, const Mat3Of<T>& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
template <class T>
FCL_ARTIC_INLINE Mat3Of<T> operator-(const Mat3Of<T>& a, const Mat3Of<T>& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
template <class T>
FCL_ARTIC_INLINE Mat3Of<T> max(const Mat3Of<T>& a, const Mat3Of<T>& b) {
  return {max(a[0], b[0]), max(a[1], b[1]), max(a[2], b[2])};
}
template <class T>
FCL_ARTIC_INLINE Mat3Of<T> abs(const Mat3Of<T>& a) {
  return {abs(a[0]), abs(a[1]), abs(a[2])};
}

FCL_ARTIC_INLINE Mat3 operator*(const Mat3& a, double s) {
  return {a[0] * s, a[1] * s, a[2] * s};
}

/// R v, where either may be lanes.
template <class T, class U>
FCL_ARTIC_INLINE auto operator*(const Mat3Of<T>& R, const Vec3Of<U>& v) {
  return Vec3Of<decltype(dot(R[0], v))>(dot(R[0], v), dot(R[1], v), dot(R[2], v));
}
template <class T, class U>
FCL_ARTIC_INLINE auto operator*(const Mat3Of<T>& a, const Mat3Of<U>& b) {
  return columns(a * b.column(0), a * b.column(1), a * b.column(2));
}
/// R v + c, as one sum each.
FCL_ARTIC_INLINE Vec3Lanes mulAdd(const Mat3Lanes& R, const Vec3Lanes& v, const Vec3Lanes& c) {
  return {dotPlus(R[0], v, c[0]), dotPlus(R[1], v, c[1]), dotPlus(R[2], v, c[2])};
}
/// R^T v
template <class T, class U>
FCL_ARTIC_INLINE auto transposedTimes(const Mat3Of<T>& R, const Vec3Of<U>& v) {
  return transposed(R) * v;
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
