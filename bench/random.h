// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace fcl_artic::bench {

/// SplitMix64 (Steele, Lea, Flood 2014): the same numbers on every platform, unlike the standard distributions.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t bits() {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  /// Uniform in [lower, upper), on a grid of 2^-53 of the width.
  double uniform(double lower = 0, double upper = 1) {
    return lower + (upper - lower) * (static_cast<double>(bits() >> 11) * 0x1p-53);
  }
  /// Uniform in 0 .. count - 1; the bias is below count / 2^53.
  int index(int count) { return static_cast<int>(uniform() * count); }
  bool coin(double probability = 0.5) { return uniform() < probability; }
  double sign() { return coin() ? 1 : -1; }

 private:
  std::uint64_t state_;
};

}  // namespace fcl_artic::bench
