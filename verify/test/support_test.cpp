// SPDX-License-Identifier: BSD-3-Clause
// How far discs reach along directions that turn.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "worlds.h"

namespace verify::test {
namespace support_test {

// A direction comes to be a disc's axis at an end of the interval, or passes by it within. The bound is above every
// point all the way. Where the direction is the axis nothing is lost, however little the disc's rim is farther out
// before.
TEST(VerifySupport, NothingIsLostWhereADirectionComesToBeADiscsAxis) {
  Rng rng(13);
  double most_lost = 0;
  for (int n = 0; n < 2000; ++n) {
    const std::string shape = n % 2 ? "cylinder " : "cone ";
    const World world = readWorld(kHead + ("geometry " + shape) + hex(uniform(rng, 0.05, 1)) + " " +
                                  hex(uniform(rng, 0.05, 1)) + "\nbody link a 0 0 " + hex(M{}) + "\n");
    const Geometry& g = world.geometries[0];
    const double size = std::ldexp(1, -static_cast<int>(rng() % 50)), end = n % 3 - 1.0;  // where it is the axis
    const double x = uniform(rng, -1, 1) * size, y = n % 5 ? uniform(rng, -1, 1) * size : 0;
    Vec v{Tm{encloseDown(-x * end), encloseDown(x), {}, {}}, Tm{encloseDown(-y * end), encloseDown(y), {}, {}},
          constant(integer(n % 7 ? -1 : 1))};
    const bool exact = n % 4 != 0;  // else it bends, and is not quite known
    const double part[2] = {rng() % 2 ? 1.0 : -1.0, rng() % 2 ? 1.0 : -1.0};
    for (std::size_t k = 0; k < 2 && !exact; ++k) {
      v[k].c2 = encloseDown(uniform(rng, -1, 1) * size);
      v[k].r = encloseUp(uniform(rng, 0, 1) * size);
    }
    Budget budget{1000000000};
    const std::array<Fix, 3> reach = g.reach(0, 1, v, Tm{}, integer(2), budget);
    for (const double s : {-1.0, 1.0, 0.0, uniform(rng, -1, 1)}) {
      V at{x * (s - end), y * (s - end), toDouble(v[2].c0)};
      for (std::size_t k = 0; k < 2; ++k) at[k] += toDouble(v[k].c2) * s * s + part[k] * toDouble(v[k].r);
      const double most = dot(at, farthest(g, 0, 1, at));
      const double bound = (toDouble(reach[0]) * (1 - s) * (1 - s) + 2 * toDouble(reach[1]) * (1 - s) * (1 + s) +
                            toDouble(reach[2]) * (1 + s) * (1 + s)) /
                           4;
      ASSERT_LE(most, bound + 1e-15) << "case " << n << " s " << s;
      if (exact && s != 0 && s == end) most_lost = std::max(most_lost, bound - most);
    }
  }
  EXPECT_LT(most_lost, 1e-15);
}

}  // namespace support_test
}  // namespace verify::test
