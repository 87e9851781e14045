// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>

#include "convex.h"

namespace campaign {

/// SplitMix64: the same numbers on every platform, and a good hash of seed and index.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  static std::uint64_t mix(std::uint64_t seed, std::uint64_t index) {
    Random r(seed ^ (index * 0xd1342543de82ef95ULL));
    r.next();
    return r.next();
  }

  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ULL);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
  }
  /// In [0, 1).
  double unit() { return static_cast<double>(next() >> 11) * 0x1p-53; }
  double uniform(double a, double b) { return a + (b - a) * unit(); }
  double logUniform(double a, double b) { return a * std::pow(b / a, unit()); }
  int below(int n) { return static_cast<int>(next() % static_cast<std::uint64_t>(n)); }
  int between(int a, int b) { return a + below(b - a + 1); }
  bool chance(double p) { return unit() < p; }
  double sign() { return chance(0.5) ? 1 : -1; }

  Vec3 direction() {
    for (;;) {
      const Vec3 v{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
      const double n = v.squaredNorm();
      if (n > 1e-4 && n <= 1) return v / std::sqrt(n);
    }
  }
  Mat3 rotation();

 private:
  std::uint64_t state_;
};

}  // namespace campaign
