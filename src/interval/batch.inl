// SPDX-License-Identifier: BSD-3-Clause
//
// The batches of batch.h over a type Intervals, which the including file brings in the namespace FCL_ARTIC_ISA, with
// FCL_ARTIC_ISA_BATCH the table's name.
#include "interval/batch.h"

#define FCL_ARTIC_STRING2(x) #x
#define FCL_ARTIC_STRING(x) FCL_ARTIC_STRING2(x)

namespace fcl_artic {
namespace FCL_ARTIC_ISA {
namespace {

constexpr int kWidth = Intervals::kLanes;

struct Point {
  Ends x[3];
};
/// Each lane's point by each lane's matrix entries, which are the same in all lanes.
struct Transform {
  Intervals R[9], t[3];
  explicit FCL_ARTIC_INLINE Transform(const IntervalTransform& M) {
    for (int i = 0; i < 9; ++i) R[i] = Intervals(M.R.m[i]);
    for (int i = 0; i < 3; ++i) t[i] = Intervals(M.t[i]);
  }
  FCL_ARTIC_INLINE Vec3<Intervals> operator*(const Point& p) const {
    Vec3<Intervals> o;
    for (int i = 0; i < 3; ++i) o[i] = ((R[3 * i] * p.x[0] + R[3 * i + 1] * p.x[1]) + R[3 * i + 2] * p.x[2]) + t[i];
    return o;
  }
};

/// Numbers i.. of a column that ends at n; behind the end the last one again.
FCL_ARTIC_INLINE Ends part(const double* column, int i, int n) {
  if (i + kWidth <= n) return load(column + i);
  alignas(64) double rest[kWidth];
  for (int k = 0; k < kWidth; ++k) rest[k] = column[i + k < n ? i + k : n - 1];
  return load(rest);
}
/// Intervals i.. of n that lie `stride` apart.
FCL_ARTIC_INLINE void write(Intervals a, Interval* out, int stride, int i, int n) {
  if (i + kWidth <= n) {
    a.write(out + i * stride, stride);
    return;
  }
  Interval all[kWidth];
  a.write(all);
  for (int k = 0; i + k < n; ++k) out[(i + k) * stride] = all[k];
}

void boundPoints(const IntervalTransform& M, const double* xyz, int n, IntervalVec3* out) {
  const Scope scope;
  const Transform T(M);
  for (int i = 0; i < n; i += kWidth) {
    const double* p = xyz + 3 * i;
    double rest[3 * kWidth];
    if (i + kWidth > n) {  // behind the end, the last point again
      for (int k = 0; k < 3 * kWidth; ++k) rest[k] = p[k < 3 * (n - i) ? k : 3 * (n - i - 1) + k % 3];
      p = rest;
    }
    const Vec3<Intervals> x = T * Point{{everyThird(p), everyThird(p + 1), everyThird(p + 2)}};
    for (int c = 0; c < 3; ++c) write(x[c], &out[0][c], 3, i, n);
  }
}

/// x . (y x z) and its derivative x' . (y x z) + x . (y' x z + y x z').
template <typename Differences>
FCL_ARTIC_INLINE void tripleProducts(const FrameBounds& first, const FrameBounds& second, const bool (&of_second)[4],
                                     PointColumns points, int n, Interval* value, Interval* rate,
                                     Differences differences) {
  const Scope scope;
  const Transform pose[2] = {Transform(first.pose), Transform(second.pose)};
  const auto place = [&](const Transform* T, int i, Vec3<Intervals>* p) __attribute__((always_inline)) {
    for (int k = 0; k < 4; ++k) {
      p[k] = T[of_second[k]] *
             Point{{part(points[3 * k], i, n), part(points[3 * k + 1], i, n), part(points[3 * k + 2], i, n)}};
    }
  };
  if (!rate) {
    for (int i = 0; i < n; i += kWidth) {
      Vec3<Intervals> p[4], d[3];
      place(pose, i, p);
      differences(p, d);
      write(tripleProduct(d[0], d[1], d[2]), value, 1, i, n);
    }
    return;
  }
  const Transform speed[2] = {Transform(first.rate), Transform(second.rate)};
  for (int i = 0; i < n; i += kWidth) {
    Vec3<Intervals> p[4], d[3], v[4], e[3];
    place(pose, i, p);
    differences(p, d);
    place(speed, i, v);
    differences(v, e);
    const Vec3<Intervals> normal = cross(d[1], d[2]);
    write(dot(d[0], normal), value, 1, i, n);
    write(dot(e[0], normal) + dot(d[0], cross(e[1], d[2]) + cross(d[1], e[2])), rate, 1, i, n);
  }
}

void vertexFace(const FrameBounds& of_a, const FrameBounds& of_bcd, PointColumns points, int n, Interval* value,
                Interval* rate) {
  tripleProducts(
      of_a, of_bcd, {false, true, true, true}, points, n, value, rate,
      [](const Vec3<Intervals>* p, Vec3<Intervals>* d) __attribute__((always_inline)) {
        d[0] = p[1] - p[0];
        d[1] = p[2] - p[1];
        d[2] = p[3] - p[1];
      });
}

void edgeEdge(const FrameBounds& of_ab, const FrameBounds& of_cd, PointColumns points, int n, Interval* value,
              Interval* rate) {
  tripleProducts(
      of_ab, of_cd, {false, false, true, true}, points, n, value, rate,
      [](const Vec3<Intervals>* p, Vec3<Intervals>* d) __attribute__((always_inline)) {
        d[0] = p[2] - p[0];
        d[1] = p[1] - p[0];
        d[2] = p[3] - p[2];
      });
}

}  // namespace
}  // namespace FCL_ARTIC_ISA

const IntervalBatch FCL_ARTIC_ISA_BATCH = {FCL_ARTIC_STRING(FCL_ARTIC_ISA), &FCL_ARTIC_ISA::boundPoints,
                                           &FCL_ARTIC_ISA::vertexFace, &FCL_ARTIC_ISA::edgeEdge};

}  // namespace fcl_artic
