// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "geometry.h"
#include "pairs/random.h"

namespace campaign {

/// The seeded stream, with what scenes draw besides. Draw one number after the other, never two as operands or
/// arguments: C++ leaves their order to the compiler, and the scenes of one seed would differ from processor to
/// processor.
class Random : public pairs::Random {
 public:
  using pairs::Random::Random;
  int between(int a, int b) { return a + below(b - a + 1); }
  double sign() { return chance(0.5) ? 1 : -1; }
  /// Each coordinate between the two.
  Vec3 inBox(double lower, double upper) {
    const double x = uniform(lower, upper), y = uniform(lower, upper), z = uniform(lower, upper);
    return {x, y, z};
  }
  Mat3 rotation();
  /// A point of the body's surface, in its frame.
  Vec3 pointOf(const Geometry& geometry) {
    const double u = unit(), v = unit(), w = unit();
    return geometry.surfacePoint(u, v, w);
  }
};

}  // namespace campaign
