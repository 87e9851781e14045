// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>

#include <Eigen/Geometry>

namespace pairs {

/// SplitMix64 (Steele, Lea, Flood 2014): the same numbers on every platform, unlike the standard distributions.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  /// A seed of its own for each index.
  static std::uint64_t mix(std::uint64_t seed, std::uint64_t index) {
    Random random(seed ^ (index * 0xd1342543de82ef95u));
    random.bits();
    return random.bits();
  }

  std::uint64_t bits() {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  /// In [0, 1).
  double unit() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  double uniform(double lower, double upper) { return lower + (upper - lower) * unit(); }
  double logUniform(double lower, double upper) { return lower * std::pow(upper / lower, unit()); }
  int below(int count) { return static_cast<int>(bits() % static_cast<std::uint64_t>(count)); }
  bool chance(double p) { return unit() < p; }

  Eigen::Vector3d direction() {
    for (;;) {
      const double x = uniform(-1, 1), y = uniform(-1, 1), z = uniform(-1, 1);
      const Eigen::Vector3d v(x, y, z);
      const double square = v.squaredNorm();
      if (square > 1e-4 && square <= 1) return v / std::sqrt(square);
    }
  }
  /// A vector of a length between the two, in any direction. (One draw after the other: operands have no order.)
  Eigen::Vector3d vector(double least, double most) {
    const double length = uniform(least, most);
    return length * direction();
  }
  Eigen::Matrix3d rotation(double most = 3.14159265358979323846) {
    const Eigen::Vector3d axis = direction();
    return Eigen::AngleAxisd(uniform(0, most), axis).toRotationMatrix();
  }

 private:
  std::uint64_t state_;
};

}  // namespace pairs
