// SPDX-License-Identifier: BSD-3-Clause
//
// Vectors of three intervals; T is Interval or eight of them side by side (interval_lanes.h).
#pragma once

#include "interval/interval.h"

namespace fcl_artic {

template <typename T>
struct Vec3 {
  T v[3];

  Vec3() = default;
  FCL_ARTIC_INLINE Vec3(T x, T y, T z) : v{x, y, z} {}
  /// One point.
  explicit FCL_ARTIC_INLINE Vec3(const double* p) : v{T(p[0]), T(p[1]), T(p[2])} {}
  FCL_ARTIC_INLINE T& operator[](int i) { return v[i]; }
  FCL_ARTIC_INLINE const T& operator[](int i) const { return v[i]; }
};
using IntervalVec3 = Vec3<Interval>;

template <typename T>
FCL_ARTIC_INLINE Vec3<T> operator+(const Vec3<T>& a, const Vec3<T>& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
template <typename T>
FCL_ARTIC_INLINE Vec3<T> operator-(const Vec3<T>& a, const Vec3<T>& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
template <typename T>
FCL_ARTIC_INLINE Vec3<T> operator-(const Vec3<T>& a) {
  return {-a[0], -a[1], -a[2]};
}
template <typename T, typename S>
FCL_ARTIC_INLINE Vec3<T> operator*(const Vec3<T>& a, const S& s) {
  return {a[0] * s, a[1] * s, a[2] * s};
}
template <typename T>
FCL_ARTIC_INLINE T dot(const Vec3<T>& a, const Vec3<T>& b) {
  return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
}
template <typename T>
FCL_ARTIC_INLINE Vec3<T> cross(const Vec3<T>& a, const Vec3<T>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
/// a . (b x c)
template <typename T>
FCL_ARTIC_INLINE T tripleProduct(const Vec3<T>& a, const Vec3<T>& b, const Vec3<T>& c) {
  return dot(a, cross(b, c));
}
template <typename T>
FCL_ARTIC_INLINE Vec3<T> hull(const Vec3<T>& a, const Vec3<T>& b) {
  return {hull(a[0], b[0]), hull(a[1], b[1]), hull(a[2], b[2])};
}
/// Component by component; both operands hold the same thing, so that no component is empty.
template <typename T>
FCL_ARTIC_INLINE Vec3<T> intersection(const Vec3<T>& a, const Vec3<T>& b) {
  return {intersection(a[0], b[0]), intersection(a[1], b[1]), intersection(a[2], b[2])};
}

}  // namespace fcl_artic
