// SPDX-License-Identifier: BSD-3-Clause
// Nine numbers that are read as a rotation's, against the nearest rotation at 300 bits.
#include <gtest/gtest.h>

#include "big.h"
#include "worlds.h"

namespace verify::test {
namespace rotation_test {

/// The orthogonal matrix nearest to R: Newton's iteration X = (X + X^-T) / 2, which doubles the digits each time.
std::array<Big, 9> nearestOrthogonal(const std::array<double, 9>& R) {
  std::array<Big, 9> X;
  for (std::size_t k = 0; k < 9; ++k) X[k] = Big(R[k]);
  for (int n = 0; n < 8; ++n) {
    std::array<Big, 9> cofactors;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) {
        const std::size_t i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
        cofactors[3 * i + j] = X[3 * i1 + j1] * X[3 * i2 + j2] - X[3 * i1 + j2] * X[3 * i2 + j1];
      }
    const Big det = X[0] * cofactors[0] + X[1] * cofactors[1] + X[2] * cofactors[2];
    for (std::size_t k = 0; k < 9; ++k) X[k] = (X[k] + cofactors[k] / det) / Big(2.0);
  }
  return X;
}

// If nine numbers are read as a rotation, they are within 2^-49 of a rotation's, the nearest one's, so the claim is
// about something. A writer's numbers, off by the rounding of some products, are all read.
TEST(VerifyStatement, WhatIsReadAsARotationIsNearOne) {
  const auto isRead = [](const std::array<double, 9>& R) {
    M m;
    m.R = R;
    try {
      readWorld(kHead + "frame f 0 " + hex(m) + "\n");
      return true;
    } catch (const BadInput&) {
      return false;
    }
  };
  Rng rng(32);
  int read = 0, refused = 0, near = 0;
  for (int n = 0; n < 4000; ++n) {
    const BigPose exact = turned({Big(uniform(rng, -1, 1)), Big(uniform(rng, -1, 1)), Big(uniform(rng, -1, 1))},
                                 Big(n % 4 == 0 ? 0 : uniform(rng, -3, 3)));
    std::array<double, 9> R, rounded;
    for (std::size_t k = 0; k < 9; ++k) R[k] = rounded[k] = exact.R[k].toDouble();
    const double size = std::ldexp(1, -52 + n % 5);
    for (double& x : R) x += size * uniform(rng, -1, 1);
    if (n % 3 == 0) R = rounded, R[rng() % 9] += size * (rng() % 2 ? 1 : -1);  // all in one entry
    const std::array<Big, 9> Q = nearestOrthogonal(R);
    bool is_near = true;
    for (std::size_t k = 0; k < 9; ++k) is_near = is_near && (Q[k] - Big(R[k])).abs() <= Big(std::ldexp(1, -49));
    const bool is_read = isRead(R);
    ASSERT_TRUE(is_near || !is_read) << n;
    ASSERT_TRUE(is_read || size > std::ldexp(1, -52)) << n;
    near += is_near;
    read += is_read;
    refused += !is_near;
  }
  EXPECT_GT(read, 0.7 * near);
  EXPECT_GT(read, 1000);
  EXPECT_GT(refused, 200);
  // To the last digit: I with 1 + d in the corner is off by d; the sheared one by d/2 in two entries; where all of the
  // diagonal is 1 + d the bound is not sharp.
  const double u = std::ldexp(1, -52);
  EXPECT_TRUE(isRead({1 + 7 * u, 0, 0, 0, 1, 0, 0, 0, 1}));
  EXPECT_FALSE(isRead({1 + 8 * u, 0, 0, 0, 1, 0, 0, 0, 1}));
  EXPECT_TRUE(isRead({1, 11 * u, 0, 0, 1, 0, 0, 0, 1}));
  EXPECT_FALSE(isRead({1, 17 * u, 0, 0, 1, 0, 0, 0, 1}));
  EXPECT_FALSE(isRead({1 + 8 * u, 0, 0, 0, 1 + 8 * u, 0, 0, 0, 1 + 8 * u}));
  EXPECT_TRUE(isRead({1, 1e-9, 0, -1e-9, 1, 0, 0, 0, 1}));     // a turn, but for 1e-18
  EXPECT_FALSE(isRead({1, 1e-7, 0, -1e-7, 1, 0, 0, 0, 1}));    // off by 5e-15
  EXPECT_FALSE(isRead({1, 0, 0, 0, 1, 0, 0, 0, -1 - 1e-16}));  // a mirror
  EXPECT_FALSE(isRead({0, 0, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_FALSE(isRead({1e9, 0, 0, 0, 1, 0, 0, 0, 1e-9}));
}

}  // namespace rotation_test
}  // namespace verify::test
