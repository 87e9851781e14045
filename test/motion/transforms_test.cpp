// SPDX-License-Identifier: BSD-3-Clause
//
// Claims of the types of unit vectors, rotations and rigid transforms, in long doubles.
#include <cfenv>
#include <cmath>

#include <gtest/gtest.h>

#include "numerics/rotation.h"
#include "numerics/unit_vector.h"
#include "random_robot.h"

namespace transforms_test {

using namespace fcl_artic;
using bench::Random;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using test::randomDirection;
using Exact3 = Eigen::Matrix<long double, 3, 1>;
using Exact33 = Eigen::Matrix<long double, 3, 3>;

constexpr int kModes[] = {FE_TONEAREST, FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO};

template <class F>
auto inMode(int mode, const F& f) {
  std::fesetround(mode);
  auto result = f();
  std::fesetround(FE_TONEAREST);
  return result;
}

/// In 2^-52.
double ulps(long double error) {
  return static_cast<double>(error * 0x1p52L);
}

Exact33 proper(const Matrix3d& stored) {
  Exact33 R = stored.cast<long double>();
  for (int k = 0; k < 6; ++k) R += 0.5L * R * (Exact33::Identity() - R.transpose() * R);
  return R;
}

TEST(UnitVectorTest, IsWithinItsUlpsOfTheDirectionInAnyRoundingMode) {
  Random random(1);
  double longest = 0, aside = 0;
  for (int n = 0; n < 40000; ++n) {
    Vector3d v = randomDirection(random);
    if (n % 3 == 0) v[n / 3 % 3] *= std::pow(10, random.uniform(-320, 0));
    if (n % 4) v *= std::pow(10, random.uniform(-323, 308));
    if (v.isZero(0)) continue;
    const auto unit = inMode(kModes[n % 4], [&] { return UnitVector::within3Ulps(v); });
    ASSERT_TRUE(unit) << v.transpose();
    const Exact3 exact = v.cast<long double>().normalized(), is = unit->vector().cast<long double>();
    longest = std::max(longest, ulps(std::fabs(is.norm() - 1)));
    aside = std::max(aside, ulps((is / is.norm() - exact).norm()));
  }
  EXPECT_LE(longest, UnitVector::kUlps);
  EXPECT_LE(aside, 2);
  EXPECT_GT(longest, 0.5);
}

TEST(UnitVectorTest, WhatHasNoDirectionIsNone) {
  const double inf = std::numeric_limits<double>::infinity(), nan = std::nan("");
  for (const Vector3d& v : {Vector3d(0, 0, 0), Vector3d(0, -0.0, 0), Vector3d(1, inf, 0), Vector3d(nan, 1, 0),
                            Vector3d(0, 1, nan), Vector3d(-inf, 0, 0)}) {
    EXPECT_FALSE(UnitVector::within3Ulps(v)) << v.transpose();
  }
}

TEST(UnitVectorTest, WhatWasMadeIsTakenAsItIs) {
  for (const int mode : kModes) {
    Random random(4);
    for (int n = 0; n < 500000; ++n) {
      const Vector3d v = random.uniform(0.1, 10) * randomDirection(random);
      inMode(mode, [&] {
        const Vector3d made = *UnitVector::within3Ulps(v);
        EXPECT_EQ(UnitVector::within3Ulps(made)->vector(), made) << n;
        return 0;
      });
    }
  }
}

TEST(UnitVectorTest, LengthsAlongTheirDirectionsDoNotVanish) {
  for (const double length : {5e-324, 2e-323, 1.6e-162, 2e-162, 1e-150, 1.0}) {
    for (const Vector3d& v : {Vector3d(length, 0, 0), Vector3d(0, -length, 0)}) {
      EXPECT_NEAR(lengthAlong(*UnitVector::within3Ulps(v), v) / length, 1, 1e-15);
    }
  }
}

TEST(RotationTest, IsWithinItsUlpsOfTheProperOneNextToIt) {
  Random random(2);
  double worst = 0;
  for (int n = 0; n < 20000; ++n) {
    Matrix3d R = test::randomPose(random, 0).linear();
    const double noise = n % 5 == 0 ? 0 : std::pow(10, random.uniform(-17, -4.8));
    for (int k = 0; k < 9; ++k) R(k / 3, k % 3) += noise * random.uniform(-1, 1);
    const auto rotation = inMode(kModes[n % 4], [&] { return Rotation::within12Ulps(R, 1e-4); });
    ASSERT_TRUE(rotation);
    worst = std::max(worst, ulps((rotation->matrix().cast<long double>() - proper(R)).norm() - 1e-25L));
    // R itself is compared only if it is orthonormal to rounding: else Newton's iteration goes to the polar factor.
  }
  EXPECT_LE(worst, Rotation::kUlps);
  EXPECT_GT(worst, 1);
}

/// So a rotation or an axis that is handed on as numbers stays what it is.
TEST(RotationTest, WhatWasMadeIsTakenAsItIs) {
  for (const int mode : kModes) {
    Random random(3);
    int rounded = 0, circles = 0;
    for (int n = 0; n < 500000; ++n) {
      const Matrix3d R = test::randomPose(random, 0).linear();
      inMode(mode, [&] {
        const Matrix3d made = *Rotation::within12Ulps(R, 1e-4);
        if (made == R) return 0;
        ++rounded;
        circles += !(orthonormalityDefect(made).cwiseAbs().maxCoeff() <= 4e-16);
        EXPECT_EQ(Rotation::within12Ulps(made, 1e-4)->matrix(), made) << n;
        return 0;
      });
    }
    EXPECT_GT(rounded, 10000);
    EXPECT_GE(circles, mode == FE_TONEAREST);
  }
  // Their circles don't end after 64 rounds where they began: by Eigen without vector instructions, and with SSE2.
  const double circles[][9] = {
      {-0x1.9da379a0e542cp-1, -0x1.2db7eefbd1744p-1, 0x1.cbd16d454325fp-8, 0x1.2a7433aec08cp-1, -0x1.9a00922414a3p-1,
       -0x1.19eacd97ff233p-3, 0x1.6346df26f8706p-4, -0x1.b6c42880232ebp-4, 0x1.fb1cec969ee6fp-1},
      {-0x1.8dbef27cea0dep-5, 0x1.ea08d64ee6f21p-1, -0x1.24857aece3f67p-2, -0x1.2ab6c1c7b0bc1p-1, 0x1.a3c45d4dcb022p-3,
       0x1.925e994a4b7ep-1, 0x1.9f15e82a1ee71p-1, 0x1.a3794fcbed036p-3, 0x1.18cdae1b7828ep-1}};
  for (const double* rows : circles) {
    const Matrix3d R = Matrix3d::Map(rows).transpose();
    const Matrix3d made = *Rotation::within12Ulps(R, 1e-4);
    EXPECT_EQ(Rotation::within12Ulps(made, 1e-4)->matrix(), made);
  }
}

TEST(RotationTest, WhatIsNoneIsRefused) {
  const Matrix3d one = Matrix3d::Identity();
  Matrix3d bad = one;
  bad(1, 1) = -1;
  EXPECT_FALSE(Rotation::within12Ulps(bad, 1e-6)) << "a reflection";
  for (const double error : {1.1e-6, -1.1e-6, std::nan(""), 1e300}) {
    bad = one;
    bad(2, 0) = error;
    EXPECT_FALSE(Rotation::within12Ulps(bad, 1e-6)) << error;
  }
  bad = one * (1 + 0.6e-6);
  EXPECT_FALSE(Rotation::within12Ulps(bad, 1e-6));
  EXPECT_TRUE(Rotation::within12Ulps(one * (1 + 0.4e-6), 1e-6));
  Isometry3d M = Isometry3d::Identity();
  for (const double place : {1.1e9, std::numeric_limits<double>::infinity(), std::nan("")}) {
    M.translation()[1] = place;
    EXPECT_FALSE(RigidTransform::within12Ulps(M, 1e-6)) << place;
  }
  EXPECT_NE(whyNotRigid(M, 1e-6).find("not finite"), std::string::npos);
  M.translation()[1] = 1.1e9;
  EXPECT_NE(whyNotRigid(M, 1e-6).find("1e9 m"), std::string::npos);
  M = Isometry3d::Identity();
  M.linear()(0, 0) = 1.1;
  EXPECT_NE(whyNotRigid(M, 1e-6).find("not orthonormal (defect 0.21"), std::string::npos);
  M.linear()(0, 0) = -1;
  EXPECT_NE(whyNotRigid(M, 1e-6).find("reflection"), std::string::npos);
}

TEST(RotationTest, FramesWithAGivenZAreRotations) {
  Random random(3);
  double worst = 0;
  for (int n = 0; n < 20000; ++n) {
    Vector3d z = randomDirection(random);
    if (n % 2)
      z = Vector3d(z[0] * std::pow(10, random.uniform(-320, 0)), z[1] * std::pow(10, random.uniform(-20, 0)), 1);
    const auto Q = inMode(kModes[n % 4], [&] { return Rotation::withZ(*UnitVector::within3Ulps(z)); });
    worst = std::max(worst, ulps((Q.matrix().cast<long double>() - proper(Q)).norm()));
    EXPECT_LE((Q.matrix().col(2) - z.normalized()).norm(), 1e-15);
    EXPECT_GT(Q.matrix().determinant(), 0);
  }
  EXPECT_LE(worst, Rotation::kUlps);
}

// There and back again may come out as the identity: what it cost is kept.
TEST(RigidTransformTest, AProductThatIsTheIdentityKeepsItsError) {
  const RigidTransform there = *RigidTransform::within12Ulps(Isometry3d(Eigen::Translation3d(1, 0, 0)), 1e-9);
  const RigidTransform and_back = there * there.inverse();
  ASSERT_TRUE(isIdentity(and_back.isometry()));
  EXPECT_EQ(and_back.length(), 2 * there.length());
  for (const RigidTransform& product : {and_back * there, there * and_back}) {
    EXPECT_EQ(product.ulps(), 3 * there.ulps());
    EXPECT_EQ(product.length(), 3 * there.length());
  }
  EXPECT_EQ((RigidTransform() * there).ulps(), there.ulps()) << "a stored one costs nothing";
}

TEST(RigidTransformTest, ProductsAndInversesAreAsNearAsTheySay) {
  Random random(4);
  double rotation = 0, place = 0;
  for (int n = 0; n < 2000; ++n) {
    const int mode = kModes[n % 4];
    RigidTransform product;
    Exact33 R = Exact33::Identity();
    Exact3 t = Exact3::Zero();
    const auto check = [&](const RigidTransform& M, const Exact33& R_exact, const Exact3& t_exact) {
      const double in_R = ulps((Matrix3d(M.linear()).cast<long double>() - R_exact).norm()) / M.ulps();
      const double in_t =
          ulps((Vector3d(M.translation()).cast<long double>() - t_exact).norm()) / (M.ulps() * M.length());
      EXPECT_LE(in_R, 1);
      EXPECT_LE(in_t, 1);
      rotation = std::max(rotation, in_R);
      place = std::max(place, in_t);
    };
    const bool back = n % 3 == 0;  // there and back again: translations cancel, their rounding does not
    const int factors = 1 + random.index(40);
    RigidTransform last;
    for (int i = 0; i < factors; ++i) {
      const Isometry3d M = test::randomPose(random, std::pow(10, random.uniform(-2, 3)));
      inMode(mode, [&] {
        last = back && i % 2 ? last.inverse() : *RigidTransform::within12Ulps(M, 1e-9);
        product = product * last;
        return 0;
      });
      const Exact33 own = proper(last.linear());
      t += R * Vector3d(last.translation()).cast<long double>();
      R = R * own;
      // The inverse's own place is rounded: that is part of what it claims of itself.
      check(product, R, t);
      check(inMode(mode, [&] { return product.inverse(); }), R.transpose(), -(R.transpose() * t));
      EXPECT_GE(product.length() * (1 + 1e-15), Vector3d(product.translation()).norm());
    }
  }
  EXPECT_GT(rotation, 0.01);
  EXPECT_GT(place, 0.001);
}

/// A product as bad as it says it may be: too large by its error, and too far away by it.
TEST(RigidTransformTest, InversesOfTheWorstProductsAreAsNearAsTheySay) {
  constexpr double kUlps = 1e6, kError = kUlps * 0x1p-52;
  Random random(5);
  for (int n = 0; n < 100; ++n) {
    const Isometry3d exact = test::randomPose(random, 10);
    Isometry3d M = exact;
    M.linear() *= 1 + kError / std::sqrt(3);  // of three columns
    M.translation() *= 1 + kError;
    const RigidTransform inverse = RigidTransform::product(M, kUlps, exact.translation().norm()).inverse();
    const double off = (Vector3d(inverse.translation()) - exact.inverse().translation()).norm();
    EXPECT_LE(off, 0x1p-52 * inverse.ulps() * inverse.length() * (1 + 1e-6) + 1e-14);
    EXPECT_LE((Matrix3d(inverse.linear()) - exact.linear().transpose()).norm(), 0x1p-52 * inverse.ulps() * (1 + 1e-6));
  }
}

}  // namespace transforms_test
