// SPDX-License-Identifier: BSD-3-Clause
//
// Intervals of real numbers, rounded outward. Every operation and function of this file must run under RoundUpward
// (rounding.h); then its result holds all real results for arguments in the operands: a proof, in floating point.
//
// The pair (-lo, hi) is kept instead of (lo, hi). Both are bounds from above, so that one direction of rounding serves
// both, and a sum of intervals is one instruction. Ends lie in [-2^1024, 2^1024) as (-lo, hi) see it: an overflow
// gives an infinite end, which is true, and no operation makes NaN (doc/REDON2004.md).
#pragma once

#include "interval/rounding.h"
#include "numerics/pair.h"

namespace fcl_artic {

class Interval {
 public:
  Interval() = default;  ///< not set
  /// One number. NaN becomes the whole line.
  FCL_ARTIC_INLINE Interval(double x) : Interval(x, x) {}  // NOLINT: exact
  /// [lower, upper], lower <= upper. A NaN is no bound: it becomes an infinite end.
  FCL_ARTIC_INLINE Interval(double lower, double upper) : v_(known(pairOf(-lower, upper))) {}
  static FCL_ARTIC_INLINE Interval entire() { return raw(infinities()); }
  /// From (-lower, upper), not NaN.
  static FCL_ARTIC_INLINE Interval raw(Pair v) {
    Interval o;
    o.v_ = v;
    return o;
  }

  FCL_ARTIC_INLINE double lower() const { return -pairLow(v_); }
  FCL_ARTIC_INLINE double upper() const { return pairHigh(v_); }
  FCL_ARTIC_INLINE Pair raw() const { return v_; }

  /// Upper bound of the width.
  FCL_ARTIC_INLINE double width() const { return pairLow(directed::add(v_, swapped())); }
  /// A number in the interval near its middle; ends finite.
  FCL_ARTIC_INLINE double middle() const {
    const double m = 0.5 * lower() + 0.5 * upper();
    return m < lower() ? lower() : m > upper() ? upper() : m;
  }
  /// Largest |x|.
  FCL_ARTIC_INLINE double magnitude() const { return pairLow(pairMax(v_, swapped())); }
  /// Smallest |x|.
  FCL_ARTIC_INLINE double mignitude() const {
    const double least = -pairLow(pairMin(v_, swapped()));
    return least > 0 ? least : 0;
  }

  FCL_ARTIC_INLINE bool contains(double x) const { return lower() <= x && x <= upper(); }
  FCL_ARTIC_INLINE bool contains(Interval x) const { return lower() <= x.lower() && x.upper() <= upper(); }
  FCL_ARTIC_INLINE bool containsZero() const { return lower() <= 0 && upper() >= 0; }
  FCL_ARTIC_INLINE bool certainlyPositive() const { return lower() > 0; }
  FCL_ARTIC_INLINE bool certainlyNegative() const { return upper() < 0; }
  /// No number; only intersection() makes such.
  FCL_ARTIC_INLINE bool isEmpty() const { return !(lower() <= upper()); }
  FCL_ARTIC_INLINE bool isFinite() const { return magnitude() <= kLargest; }

  /// Highest finite number.
  static constexpr double kLargest = 1.7976931348623157e308;

 private:
  static FCL_ARTIC_INLINE Pair infinities() { return pairOf(__builtin_inf()); }
  /// pairMin() gives its second operand where the first one is NaN.
  static FCL_ARTIC_INLINE Pair known(Pair v) { return pairMin(v, infinities()); }
  FCL_ARTIC_INLINE Pair swapped() const { return pairSwap(v_); }
  static Interval ofCorners(Pair p, Pair q, Pair r, Pair s);
  Pair v_;

  friend Interval operator+(Interval a, Interval b);
  friend Interval operator-(Interval a, Interval b);
  friend Interval operator-(Interval a);
  friend Interval operator*(Interval a, Interval b);
  friend Interval operator*(Interval a, double b);
  friend Interval operator/(Interval a, Interval b);
  friend Interval square(Interval a);
  friend Interval sqrt(Interval a);
  friend Interval abs(Interval a);
  friend Interval max(Interval a, Interval b);
};

FCL_ARTIC_INLINE Interval operator+(Interval a, Interval b) {
  return Interval::raw(directed::add(a.v_, b.v_));
}
FCL_ARTIC_INLINE Interval operator-(Interval a, Interval b) {
  return Interval::raw(directed::add(a.v_, b.swapped()));
}
FCL_ARTIC_INLINE Interval operator-(Interval a) {
  return Interval::raw(a.swapped());
}

/// The ends of a product or quotient are among the four of ends. pairMax() gives its second operand where the first
/// one is NaN. So 0 * inf and inf / inf, which stand for some number that others cover, are dropped; the innermost
/// makes an infinite end.
FCL_ARTIC_INLINE Interval Interval::ofCorners(Pair p, Pair q, Pair r, Pair s) {
  return raw(known(pairMax(p, pairMax(q, pairMax(r, s)))));
}
FCL_ARTIC_INLINE Interval operator*(Interval a, Interval b) {
  const Pair n = pairLows(a.v_), h = pairHighs(a.v_), c = b.swapped();
  return Interval::ofCorners(directed::mul(n, c), directed::mul(pairNegate(n), b.v_), directed::mul(pairNegate(h), c),
                             directed::mul(h, b.v_));
}
FCL_ARTIC_INLINE Interval operator*(Interval a, double b) {
  const Pair k = pairOf(b);
  return Interval::raw(Interval::known(pairMax(directed::mul(a.swapped(), pairNegate(k)), directed::mul(a.v_, k))));
}
FCL_ARTIC_INLINE Interval operator*(double a, Interval b) {
  return b * a;
}

/// The whole line where b contains 0.
FCL_ARTIC_INLINE Interval operator/(Interval a, Interval b) {
  if (b.containsZero()) return Interval::entire();
  const Pair n = pairLows(a.v_), h = pairHighs(a.v_), c = b.swapped();
  return Interval::ofCorners(directed::div(n, c), directed::div(pairNegate(n), b.v_), directed::div(pairNegate(h), c),
                             directed::div(h, b.v_));
}

/// Tighter than a * a where a straddles 0.
FCL_ARTIC_INLINE Interval square(Interval a) {
  const Interval b = abs(a);
  const Pair h = b.v_;
  return Interval::raw(directed::mul(h, pairNegateLow(h)));
}

/// The square root of the part of a that is not negative.
FCL_ARTIC_INLINE Interval sqrt(Interval a) {
  const Pair x = pairMax(pairOf(a.lower(), a.upper()), pairOf(0));
  const Pair root = directed::sqrt(x);
  // From above, so lower end's root is too high by less than one step, unless its square is not above it.
  const Pair squared = directed::mul(root, root);
  const Pair below = directed::add(pairNegate(root), pairOf(0x1p-1022));
  const Pair lower = pairWhereAtMost(squared, x, pairNegate(root), below);
  return Interval::raw(pairMix(lower, root));
}

FCL_ARTIC_INLINE Interval abs(Interval a) {
  // -min|x| = min(0, max(lo's, hi's negative)) = min(0, max(lo, -hi) negated), max|x| = max(-lo, hi)
  const Pair s = a.swapped();
  const Pair least = pairMin(pairMin(a.v_, s), pairOf(0)), most = pairMax(a.v_, s);
  return Interval::raw(pairMix(least, most));
}

/// { max(x, y) }
FCL_ARTIC_INLINE Interval max(Interval a, Interval b) {
  const Pair most = pairMax(a.v_, b.v_), least = pairMin(a.v_, b.v_);
  return Interval::raw(pairMix(least, most));
}
FCL_ARTIC_INLINE Interval min(Interval a, Interval b) {
  return -max(-a, -b);
}

/// [-radius, radius]
FCL_ARTIC_INLINE Interval plusMinus(double radius) {
  return Interval(-radius, radius);
}

/// The smallest interval that holds both.
FCL_ARTIC_INLINE Interval hull(Interval a, Interval b) {
  return Interval::raw(pairMax(a.raw(), b.raw()));
}
/// The numbers that both hold; may be empty. No operation takes an empty interval.
FCL_ARTIC_INLINE Interval intersection(Interval a, Interval b) {
  return Interval::raw(pairMin(a.raw(), b.raw()));
}

FCL_ARTIC_INLINE bool certainlyLess(Interval a, Interval b) {
  return a.upper() < b.lower();
}
FCL_ARTIC_INLINE bool certainlyDisjoint(Interval a, Interval b) {
  return certainlyLess(a, b) || certainlyLess(b, a);
}

FCL_ARTIC_INLINE Interval& operator+=(Interval& a, Interval b) {
  return a = a + b;
}
FCL_ARTIC_INLINE Interval& operator-=(Interval& a, Interval b) {
  return a = a - b;
}
FCL_ARTIC_INLINE Interval& operator*=(Interval& a, Interval b) {
  return a = a * b;
}

}  // namespace fcl_artic
