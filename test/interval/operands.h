// SPDX-License-Identifier: BSD-3-Clause
//
// Intervals of every kind that arithmetic may meet.
#pragma once

#include <algorithm>
#include <cmath>

#include "interval/matrix.h"
#include "numerics/cases.h"

namespace fcl_artic {
namespace numerics_test {

enum class Shape { thin, ulps, wide, straddling, zero, tiny, huge, unbounded };
constexpr Shape kShapes[] = {Shape::thin, Shape::ulps, Shape::wide, Shape::straddling,
                             Shape::zero, Shape::tiny, Shape::huge, Shape::unbounded};
constexpr int kNumShapes = 8;
constexpr Shape kModerateShapes[] = {Shape::thin, Shape::ulps, Shape::wide, Shape::straddling};
constexpr int kNumModerateShapes = 4;

inline double sign(Random& random) {
  return random.chance(0.5) ? 1 : -1;
}

/// A finite number of the size that goes with the shape.
inline double number(Random& random, Shape shape) {
  const double s = sign(random);  // one draw after the other: the same numbers from every compiler
  switch (shape) {
    case Shape::tiny:  // subnormals and what their products underflow to
      if (random.chance(0.5)) return s * random.below(1000) * 0x1p-1074;
      return s * random.size(1e-200, 1e-140);
    case Shape::huge:
    case Shape::unbounded:
      return s * (random.chance(0.3) ? Interval::kLargest : random.size(1e140, 1e308));
    case Shape::zero:
      return random.chance(0.5) ? 0.0 : random.in(-2, 2);
    default:
      return random.chance(0.2) ? random.below(9) - 4 : s * random.size(1e-3, 1e3);
  }
}

/// An interval of that shape; of unbounded ones some ends are infinite.
inline Interval operand(Random& random, Shape shape) {
  const double x = number(random, shape);
  const double infinity = HUGE_VAL;
  switch (shape) {
    case Shape::thin:
      return Interval(x);
    case Shape::ulps:
      return Interval(std::nextafter(x, -infinity), random.chance(0.5) ? x : std::nextafter(x, infinity));
    case Shape::wide:
      return Interval(x, x + std::abs(x) * random.unit());
    case Shape::straddling:
      return Interval(-std::abs(x) * random.unit(), std::abs(x));
    case Shape::zero:
      return random.chance(0.3)   ? Interval(0.0)
             : random.chance(0.5) ? Interval(0, std::abs(x))
                                  : Interval(-std::abs(x), 0);
    case Shape::tiny:
    case Shape::huge: {
      const double y = number(random, shape);
      return random.chance(0.4) ? Interval(x) : Interval(std::min(x, y), std::max(x, y));
    }
    case Shape::unbounded:
      break;
  }
  const double y = number(random, random.chance(0.5) ? Shape::zero : Shape::wide);
  const int kind = random.below(4);
  return kind == 0   ? Interval::entire()
         : kind == 1 ? Interval(-infinity, y)
         : kind == 2 ? Interval(y, infinity)
                     : Interval(y);
}

/// A number of the interval, an end now and then; infinite ends stand for large numbers.
inline double member(Random& random, const Interval& x) {
  const double lower = std::max(x.lower(), -Interval::kLargest), upper = std::min(x.upper(), Interval::kLargest);
  const int kind = random.below(4);
  if (kind == 0) return lower;
  if (kind == 1) return upper;
  const double s = kind == 2 ? random.unit() : random.size(1e-300, 1), y = (1 - s) * lower + s * upper;
  return std::min(std::max(y, lower), upper);
}

inline IntervalTransform randomTransform(Random& random, Shape shape) {
  IntervalTransform M;
  for (Interval& x : M.R.m) x = operand(random, shape);
  for (Interval& x : M.t.v) x = operand(random, shape);
  return M;
}

/// One of the matrices in an interval matrix, exactly.
struct RealFrame {
  Real R[3][3];
  Real3 t;
  Real3 operator*(const Real3& p) const {
    Real3 x = t;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) x[i] += R[i][j] * p[j];
    }
    return x;
  }
};
inline RealFrame memberOf(Random& random, const IntervalTransform& M) {
  RealFrame o;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) o.R[i][j] = member(random, M.R(i, j));
    o.t[static_cast<std::size_t>(i)] = member(random, M.t[i]);
  }
  return o;
}

/// True if the value, off by no more than `error`, is in the interval.
inline bool holds(const Interval& x, const Real& value, double error = 0) {
  return Real(x.lower()) <= value + Real(error) && value - Real(error) <= Real(x.upper());
}

}  // namespace numerics_test
}  // namespace fcl_artic
