// SPDX-License-Identifier: BSD-3-Clause
//
// Interval matrices: 3x3, and 4x4 with the last row (0 0 0 1), kept as rotation and origin. Where they hold a motion
// over a time interval, R holds the rotation and t the origin at every time of it; R is no rotation itself.
#pragma once

#include "interval/vector.h"

namespace fcl_artic {

template <typename T>
struct Mat3 {
  T m[9];  ///< row-major

  Mat3() = default;
  /// One matrix, row-major.
  explicit FCL_ARTIC_INLINE Mat3(const double* a) {
    for (int i = 0; i < 9; ++i) m[i] = T(a[i]);
  }
  static FCL_ARTIC_INLINE Mat3 identity() {
    Mat3 o;
    for (int i = 0; i < 9; ++i) o.m[i] = T(i % 4 == 0 ? 1.0 : 0.0);
    return o;
  }
  FCL_ARTIC_INLINE T& operator()(int i, int j) { return m[3 * i + j]; }
  FCL_ARTIC_INLINE const T& operator()(int i, int j) const { return m[3 * i + j]; }
  FCL_ARTIC_INLINE Vec3<T> row(int i) const { return {m[3 * i], m[3 * i + 1], m[3 * i + 2]}; }
  FCL_ARTIC_INLINE Vec3<T> column(int j) const { return {m[j], m[3 + j], m[6 + j]}; }
};
using IntervalMat3 = Mat3<Interval>;

template <typename T>
FCL_ARTIC_INLINE Mat3<T> operator+(const Mat3<T>& a, const Mat3<T>& b) {
  Mat3<T> o;
  for (int i = 0; i < 9; ++i) o.m[i] = a.m[i] + b.m[i];
  return o;
}
template <typename T>
FCL_ARTIC_INLINE Vec3<T> operator*(const Mat3<T>& a, const Vec3<T>& x) {
  return {dot(a.row(0), x), dot(a.row(1), x), dot(a.row(2), x)};
}
/// Times a point given in doubles.
template <typename T>
FCL_ARTIC_INLINE Vec3<T> operator*(const Mat3<T>& a, const double* x) {
  Vec3<T> o;
  for (int i = 0; i < 3; ++i) o[i] = (a(i, 0) * x[0] + a(i, 1) * x[1]) + a(i, 2) * x[2];
  return o;
}
template <typename T>
FCL_ARTIC_INLINE Mat3<T> operator*(const Mat3<T>& a, const Mat3<T>& b) {
  Mat3<T> o;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) o(i, j) = (a(i, 0) * b(0, j) + a(i, 1) * b(1, j)) + a(i, 2) * b(2, j);
  }
  return o;
}
/// a times a constant in doubles, row-major.
template <typename T>
FCL_ARTIC_INLINE Mat3<T> timesConstant(const Mat3<T>& a, const double* b) {
  Mat3<T> o;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) o(i, j) = (a(i, 0) * b[j] + a(i, 1) * b[3 + j]) + a(i, 2) * b[6 + j];
  }
  return o;
}
template <typename T, typename S>
FCL_ARTIC_INLINE Mat3<T> scaled(const Mat3<T>& a, const S& s) {
  Mat3<T> o;
  for (int i = 0; i < 9; ++i) o.m[i] = a.m[i] * s;
  return o;
}
template <typename T>
FCL_ARTIC_INLINE Mat3<T> transpose(const Mat3<T>& a) {
  Mat3<T> o;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) o(i, j) = a(j, i);
  }
  return o;
}
template <typename T>
FCL_ARTIC_INLINE Mat3<T> hull(const Mat3<T>& a, const Mat3<T>& b) {
  Mat3<T> o;
  for (int i = 0; i < 9; ++i) o.m[i] = hull(a.m[i], b.m[i]);
  return o;
}
template <typename T>
FCL_ARTIC_INLINE Mat3<T> intersection(const Mat3<T>& a, const Mat3<T>& b) {
  Mat3<T> o;
  for (int i = 0; i < 9; ++i) o.m[i] = intersection(a.m[i], b.m[i]);
  return o;
}

/// x -> R x + t: a 4x4 matrix whose last row is (0 0 0 1).
template <typename T>
struct Rigid {
  Mat3<T> R;
  Vec3<T> t;

  static FCL_ARTIC_INLINE Rigid identity() { return {Mat3<T>::identity(), Vec3<T>(T(0.0), T(0.0), T(0.0))}; }
};
/// Bounds on M0i(t) over a time interval: the paper's M~0i.
using IntervalTransform = Rigid<Interval>;

template <typename T>
FCL_ARTIC_INLINE Rigid<T> operator*(const Rigid<T>& a, const Rigid<T>& b) {
  return {a.R * b.R, a.R * b.t + a.t};
}
template <typename T>
FCL_ARTIC_INLINE Vec3<T> operator*(const Rigid<T>& a, const Vec3<T>& x) {
  return a.R * x + a.t;
}
template <typename T>
FCL_ARTIC_INLINE Vec3<T> operator*(const Rigid<T>& a, const double* x) {
  return a.R * x + a.t;
}
/// The inverses of the rigid transforms in a: R^T, -R^T t.
template <typename T>
FCL_ARTIC_INLINE Rigid<T> inverse(const Rigid<T>& a) {
  const Mat3<T> R = transpose(a.R);
  return {R, -(R * a.t)};
}
template <typename T>
FCL_ARTIC_INLINE Rigid<T> hull(const Rigid<T>& a, const Rigid<T>& b) {
  return {hull(a.R, b.R), hull(a.t, b.t)};
}
template <typename T>
FCL_ARTIC_INLINE Rigid<T> intersection(const Rigid<T>& a, const Rigid<T>& b) {
  return {intersection(a.R, b.R), intersection(a.t, b.t)};
}

}  // namespace fcl_artic
