// SPDX-License-Identifier: BSD-3-Clause
//
// Intervals of every kind that arithmetic may meet.
#pragma once

#include <algorithm>
#include <cmath>

#include "interval/interval.h"
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
  switch (shape) {
    case Shape::tiny:  // subnormals and what their products underflow to
      return sign(random) * (random.chance(0.5) ? random.below(1000) * 0x1p-1074 : random.size(1e-200, 1e-140));
    case Shape::huge:
    case Shape::unbounded:
      return sign(random) * (random.chance(0.3) ? Interval::kLargest : random.size(1e140, 1e308));
    case Shape::zero:
      return random.chance(0.5) ? 0.0 : random.in(-2, 2);
    default:
      return random.chance(0.2) ? random.below(9) - 4 : sign(random) * random.size(1e-3, 1e3);
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

/// True if the value, off by no more than `error`, is in the interval.
inline bool holds(const Interval& x, const Real& value, double error = 0) {
  return Real(x.lower()) <= value + Real(error) && value - Real(error) <= Real(x.upper());
}

}  // namespace numerics_test
}  // namespace fcl_artic
