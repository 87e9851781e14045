// SPDX-License-Identifier: BSD-3-Clause
//
// Angles that go by the tangent s of their half, q = q* + 2 atan(s(t)): the arc tangent, the bounds of the angle's
// derivatives, and whole motions, against exact arithmetic.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "cases.h"
#include "numerics/arc_tangent.h"

namespace fcl_artic {
namespace numerics_test {
namespace half_angle_test {
namespace {

double tangent(Random& random) {
  const double sign = random.chance(0.5) ? 1 : -1;
  switch (random.below(4)) {
    case 0:
      return sign * random.size(1e-300, 1e100);
    case 1:
      return sign * random.in(0, 4);
    case 2:
      return sign * kFlatTangent * (1 + (random.below(9) - 4) * 0x1p-52);
    default:
      return sign * kSteepTangent * (1 + (random.below(9) - 4) * 0x1p-52);
  }
}

TEST(ArcTangent, WithinFourUlpOfMpfrInAnyRoundingMode) {
  Random random(seedOf("ArcTangent"));
  double worst = 0;
  for (int batch = 0; batch < scaled(100000) / 8; ++batch) {
    double s[8], angle[8];
    Real truth[8];
    for (int i = 0; i < 8; ++i) truth[i] = atan(Real(s[i] = tangent(random)));
    const auto check = [&](const char* name, int mode) {
      for (int i = 0; i < 8; ++i) {
        const double error = abs(Real(angle[i]) - truth[i]).toDouble();
        worst = std::max(worst, error);
        ASSERT_LE(error, kArcTangentError) << name << " mode " << mode << " s " << s[i];
      }
    };
    for (const int mode : kRoundingModes) {
      for (const Subject* subject : subjects()) {
        {
          const ScopedRounding scope(mode);
          subject->arcTangent(s, angle);
        }
        check(subject->name, mode);
      }
      {
        const ScopedRounding scope(mode);
        for (int i = 0; i < 8; ++i) angle[i] = arcTangent(s[i]);
      }
      check("scalar", mode);
    }
  }
  std::printf("largest error %.3f of 2^-52 (promised: 4)\n", worst * 0x1p52);
  EXPECT_GT(worst, 0.5 * 0x1p-52) << "the hardest values were not met";
}

TEST(HalfAngle, RangesOfTangentsHoldTheirAngles) {
  Random random(seedOf("AngleRanges"));
  for (int i = 0; i < scaled(20000); ++i) {
    double lower = tangent(random), upper = tangent(random);
    if (lower > upper) std::swap(lower, upper);
    const double reference = random.chance(0.1) ? random.in(-1e5, 1e5) : random.in(-4, 4);
    const Real a = Real(reference) + Real(2.0) * atan(Real(lower)), b = Real(reference) + Real(2.0) * atan(Real(upper));
    const int mode = kRoundingModes[random.below(4)];
    {
      const ScopedRounding scope(mode);
      turnIntoAngles(reference, lower, upper);
    }
    ASSERT_TRUE(Real(lower) <= a && b <= Real(upper)) << "case " << i << " mode " << mode;
    ASSERT_LE((a - Real(lower)).toDouble(), 1e-13 + 2e-15 * std::abs(reference));
  }
}

/// One variable with its law, as a query has it.
struct Law {
  engine::SweepStep step;
  engine::Query query;
  std::vector<double> s;
  std::uint8_t is = 1;
  double reference = 0;

  Law(Random& random, double t) : s(randomTangent(random, random.chance(0.5) ? 2 : 3 + random.below(3), t)) {
    if (random.chance(0.5)) std::fill(s.begin() + 2, s.end(), 0.0);  // straight, as planners go
    reference = random.in(-3, 3);
    step.variable = 0;
    if (random.chance(0.3)) {
      step.multiplier = random.in(-3, 3);
      step.offset = random.in(-2, 2);
    }
    query.coefficients = s.data();
    query.num_variables = 1;
    query.degree = static_cast<std::int32_t>(s.size()) - 1;
    query.half_angles = {&is, &reference, 1};
  }
  Law(const Law&) = delete;
  Law& operator=(const Law&) = delete;

  /// The variable and its first three derivatives, in long double, for q = m (q* + 2 phi) + o, tan(phi) = s. With w =
  /// cos(phi)^2 they are 2 m times phi' = w s', phi'' = w s'' - 2 s phi'^2 and phi''' = w s''' - 2 s phi' w s'' - 2 s'
  /// phi'^2 - 4 s phi' phi''. (These are the derivatives of tan(phi) = s, solved one after the other.)
  void at(long double t, long double* q) const {
    long double d[4] = {0, 0, 0, 0};
    for (std::size_t k = s.size(); k-- > 0;) {
      long double factor = 1;
      for (std::size_t n = 0; n < 4 && n <= k; ++n) {
        long double p = factor * s[k];
        for (std::size_t j = 0; j + n < k; ++j) p *= t;
        d[n] += p;
        factor *= static_cast<long double>(k - n);
      }
    }
    const long double phi = std::atan(d[0]), w = std::cos(phi) * std::cos(phi), w1 = w * d[1];
    const long double w2 = w * d[2] - 2 * d[0] * w1 * w1;
    const long double w3 = w * d[3] - 2 * d[0] * w1 * (w * d[2]) - 2 * d[1] * w1 * w1 - 4 * d[0] * w1 * w2;
    const long double m = step.multiplier;
    q[0] = m * (reference + 2 * phi) + step.offset;
    q[1] = 2 * m * w1;
    q[2] = 2 * m * w2;
    q[3] = 2 * m * w3;
  }
};

/// Dense samples of the derivatives against their bounds, over intervals of any length. A bound's room, and how often a
/// weaker bound would break, show that the samples come near it.
TEST(HalfAngle, NoSampledDerivativeIsAboveItsBound) {
  Random random(seedOf("HalfAngleBounds"));
  const std::vector<const Subject*> tested = subjects();
  int broken[4] = {}, weaker[4] = {}, checks = 0;
  double most[4] = {};
  for (int i = 0; i < scaled(20000); ++i) {
    const int level = random.below(20);
    const double width = std::ldexp(1.0, -level), begin = std::floor(random.unit() * std::ldexp(1.0, level)) * width;
    const Law law(random, random.chance(0.5) ? begin : begin + random.unit() * width);
    const Subject& subject = *tested[static_cast<std::size_t>(random.below(static_cast<int>(tested.size())))];
    double m[4];
    {
      const ScopedRounding scope(kRoundingModes[random.below(4)]);
      subject.boundVariable(law.step, law.query, begin, begin + width, m);
    }
    double sampled[4] = {};
    for (int k = 0; k <= 64; ++k) {
      const double t = k == 64 ? begin + width : k < 33 ? begin + k * width / 32 : begin + random.unit() * width;
      long double q[4];
      law.at(t, q);
      for (int n = 0; n < 4; ++n) sampled[n] = std::max(sampled[n], std::abs(static_cast<double>(q[n])));
    }
    ++checks;
    for (int n = 0; n < 4; ++n) {
      const double room = 1 + 1e-13;  // of the samples' own rounding
      broken[n] += sampled[n] > m[n] * room;
      weaker[n] += sampled[n] > 0.999 * m[n] * room;
      if (m[n] > 1e-9) most[n] = std::max(most[n], sampled[n] / m[n]);
      ASSERT_LE(sampled[n], m[n] * room + 1e-30) << "case " << i << " derivative " << n << " " << subject.name;
    }
  }
  std::printf("%d intervals; attained of the bounds: %.6f %.6f %.6f %.6f; 0.999 of them broken %d %d %d %d times\n",
              checks, most[0], most[1], most[2], most[3], weaker[0], weaker[1], weaker[2], weaker[3]);
  for (int n = 1; n < 4; ++n) EXPECT_GT(weaker[n], 100) << "derivative " << n << ": the samples are far from the bound";
}

/// The largest values of the bounds' factors between the ends of an interval: g_1 at s^2 = 1/3, g_2 at s^2 = 1.
TEST(HalfAngle, BoundsHoldWhereTheirLargestValueLiesWithinTheInterval) {
  for (const double peak : {0.57735026918962576, 1.0, 0.0}) {
    for (const double sign : {1.0, -1.0}) {
      for (const double half : {1e-4, 0.1, 0.3, 2.0}) {
        Random random(1);
        Law law(random, 0.5);
        law.s = {sign * peak - half, 2 * half, 0};
        law.step.multiplier = 1;
        law.step.offset = 0;
        law.query.coefficients = law.s.data();
        law.query.degree = 2;
        double sampled[4] = {}, m[4];
        for (int k = 0; k <= 1000; ++k) {
          long double q[4];
          law.at(k / 1000.0L, q);
          for (int n = 0; n < 4; ++n) sampled[n] = std::max(sampled[n], std::abs(static_cast<double>(q[n])));
        }
        for (const Subject* subject : subjects()) {
          subject->boundVariable(law.step, law.query, 0, 1, m);
          for (int n = 0; n < 4; ++n) EXPECT_LE(sampled[n], m[n] * (1 + 1e-13)) << subject->name << " " << n;
          // If s is straight, each derivative is one product: nothing is given away where the peak is within.
          if (peak > 0 && peak < 1) {
            EXPECT_GT(sampled[2], 0.999 * m[2]) << half;
          }
          if (peak == 0) {
            EXPECT_GT(sampled[1], 0.999 * m[1]) << half;
          }
          if (peak == 0) {
            EXPECT_GT(sampled[3], 0.999 * m[3]) << half;
          }
        }
      }
    }
  }
}

/// As Motion.ExactPointsLieInTheQuadratic, of robots whose angles go by such laws.
TEST(HalfAngle, ExactPointsLieInTheQuadratic) {
  Random random(seedOf("HalfAngleMotion"));
  const std::vector<const Subject*> tested = subjects();
  int checks = 0, no_remainder = 0, half_remainder = 0, small_pad = 0, moved = 0;
  double attained = 0, of_pad = 0;
  for (int i = 0; i < scaled(60000) / 16; ++i) {
    const int mode = kRoundingModes[random.below(4)];
    PairCase c(random, mode);
    c.goByHalfAngles(random);
    moved += std::count(c.half_angles.begin(), c.half_angles.end(), 1) > 0;
    const Subject& subject = *tested[static_cast<std::size_t>(random.below(static_cast<int>(tested.size())))];
    PairOutput m;
    {
      const ScopedRounding scope(mode);
      subject.relate(c.in, m);
    }
    for (int lane = 0; lane < 8; ++lane) {
      const int kind = random.below(8);
      const double tau = kind == 0 ? -1 : kind == 1 ? 1 : kind == 2 ? 0 : random.in(-1, 1);
      const RealRigid M_ab = c.relative(Real(c.in.tm[lane]) + Real(tau) * Real(c.in.d)), M_ba = M_ab.inverse();
      for (int side = 0; side < kSides; ++side) {
        const Eigen::Vector3d p = pointWithin(random, side ? c.extent_a : c.extent_b);
        const Real3 x = (side ? M_ba : M_ab) * exactly(p);
        const double error = norm(quadraticAt(m, side, lane, p, tau) - x).toDouble();
        const double rem = m.rem_c[side] + m.rem_R[side] * p.norm();
        ++checks;
        no_remainder += !(error <= m.pad);
        half_remainder += !(error <= 0.5 * rem + m.pad);
        small_pad += !(error <= rem + 1e-4 * m.pad);
        if (rem > 1e3 * m.pad) attained = std::max(attained, error / rem);
        if (rem < 1e-3 * m.pad) of_pad = std::max(of_pad, error / m.pad);
        ASSERT_LE(error, rem + m.pad) << "case " << i << " lane " << lane << " side " << side << " " << subject.name
                                      << " mode " << mode << " rem " << rem << " pad " << m.pad << " tau " << tau;
      }
    }
  }
  std::printf("%d checks, %d motions with such laws; most of the remainder attained %.4f, of the pad %.4f\n", checks,
              moved, attained, of_pad);
  std::printf("mutants: without remainder %d broken, half of it %d, pad / 1e4 %d\n", no_remainder, half_remainder,
              small_pad);
  EXPECT_GT(no_remainder, 0);
  EXPECT_GT(half_remainder, 0) << "no motion comes near its bound: the test tells little";
  EXPECT_GT(small_pad, 0);
}

}  // namespace
}  // namespace half_angle_test
}  // namespace numerics_test
}  // namespace fcl_artic
