// SPDX-License-Identifier: BSD-3-Clause
//
// Intervals without a rounding mode: every result is computed as it comes and both ends moved outward by more than its
// error. Plain C++ for any processor; some 4 ulp wider an operation.
//
// One operation gives the exact result times 1 + theta, |theta| <= 2^-52 in any mode, or what underflows is lost, less
// than 2^-1021 even where subnormals are flushed. Moving an end by 3 * 2^-52 of it and 2^-1000 costs two roundings of
// at most 2^-52 each: still beyond the exact one. So results are no subnormals. Operands that come from outside may be,
// and a processor may take them for 0: they are widened first.
#pragma once

#include "interval/matrix.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

/// Results hold in any mode; this is for numbers that are read as floats, of which subnormal ones could be taken for 0.
using Scope = RoundToNearest;

using Ends = double;
FCL_ARTIC_INLINE Ends load(const float* x) {
  return static_cast<double>(*x);
}
FCL_ARTIC_INLINE Ends spread(double x) {
  return x;
}
FCL_ARTIC_INLINE unsigned above(Ends a, Ends b) {
  return a > b;
}

/// One interval: the batches' code takes it for lanes, of which it has one.
struct Intervals {
  static constexpr int kLanes = 1;
  double lower, upper;

  Intervals() = default;
  FCL_ARTIC_INLINE Intervals(double from, double to) : lower(from), upper(to) {}
  explicit FCL_ARTIC_INLINE Intervals(Interval x)
      : lower(x.lower() - kVanishing * isTiny(x.lower())), upper(x.upper() + kVanishing * isTiny(x.upper())) {}
  explicit FCL_ARTIC_INLINE Intervals(double x)
      : lower(x - kVanishing * isTiny(x)), upper(x + kVanishing * isTiny(x)) {}

  static constexpr double kVanishing = 0x1p-1000;
  static FCL_ARTIC_INLINE bool isTiny(double x) { return __builtin_fabs(x) < kVanishing; }
};

FCL_ARTIC_INLINE Intervals eachNumber(double x) {
  return Intervals(x);
}

/// A number that overflows is infinite in some modes and the largest number in others: ends beyond 2^1022, and NaN,
/// are no bounds.
FCL_ARTIC_INLINE Intervals inflated(double lower, double upper) {
  constexpr double part = 0x1.8p-51, least = Intervals::kVanishing, large = 0x1p1022, infinity = __builtin_inf();
  return {__builtin_fabs(lower) <= large ? lower - (__builtin_fabs(lower) * part + least) : -infinity,
          __builtin_fabs(upper) <= large ? upper + (__builtin_fabs(upper) * part + least) : infinity};
}
FCL_ARTIC_INLINE double smaller(double a, double b) {
  return a < b ? a : b;
}
FCL_ARTIC_INLINE double larger(double a, double b) {
  return a > b ? a : b;
}

FCL_ARTIC_INLINE Intervals operator+(Intervals a, Intervals b) {
  return inflated(a.lower + b.lower, a.upper + b.upper);
}
FCL_ARTIC_INLINE Intervals operator-(Intervals a, Intervals b) {
  return inflated(a.lower - b.upper, a.upper - b.lower);
}
FCL_ARTIC_INLINE Intervals operator*(Intervals a, Intervals b) {
  const double p = a.lower * b.lower, q = a.lower * b.upper, r = a.upper * b.lower, s = a.upper * b.upper;
  const double sum = (p + q) + (r + s);  // NaN or infinite where one of them is
  if (!(__builtin_fabs(sum) <= Interval::kLargest)) return {-__builtin_inf(), __builtin_inf()};
  return inflated(smaller(smaller(p, q), smaller(r, s)), larger(larger(p, q), larger(r, s)));
}
FCL_ARTIC_INLINE Intervals operator*(Intervals a, double b) {
  return a * Intervals(b);
}
FCL_ARTIC_INLINE double magnitude(Intervals a) {
  return larger(-a.lower, a.upper);
}
FCL_ARTIC_INLINE double mignitude(Intervals a) {
  return larger(a.lower, -a.upper);
}
/// Upper bounds.
FCL_ARTIC_INLINE double addUp(double a, double b) {
  return inflated(0, a + b).upper;
}
FCL_ARTIC_INLINE double mulUp(double a, double b) {
  return inflated(0, a * b).upper;
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
