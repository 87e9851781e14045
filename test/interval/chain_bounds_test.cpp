// SPDX-License-Identifier: BSD-3-Clause
//
// Exact poses and velocities of random robots and bodies against the bounds over time intervals, and how wide those
// are.
#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "interval/turn_series.h"
#include "numerics/body_cases.h"
#include "operands.h"
#include "redon/chain_bounds.h"

namespace fcl_artic {
namespace numerics_test {
namespace chain_bounds_test {
namespace {

constexpr Enclosure kEnclosures[] = {Enclosure::intervalChain, Enclosure::meanValue, Enclosure::taylor};

/// Entries 0..8: the rotation, by rows; 9..11: the origin.
Real entry(const RealRigid& M, int i) {
  return i < 9 ? M.R[static_cast<std::size_t>(i % 3)][static_cast<std::size_t>(i / 3)]
               : M.t[static_cast<std::size_t>(i - 9)];
}
const Interval& entry(const IntervalTransform& M, int i) {
  return i < 9 ? M.R.m[i] : M.t[i - 9];
}

struct Tally {
  long checks = 0, broken = 0;
};

/// B's frame in A's by interval products, with derivatives: constant transforms move nothing of their own.
FrameBounds relate(const IntervalTransform& front, const FrameBounds& f, const IntervalTransform& behind) {
  const RoundUpward upward;
  const auto derivative = [&](const IntervalTransform& rate) -> IntervalTransform {
    return {front.R * (rate.R * behind.R), front.R * (rate.R * behind.t + rate.t)};
  };
  return {front * f.pose * behind, derivative(f.rate), derivative(f.second)};
}

/// The exact pose and its derivatives by differences, whose error 1e-20 is far above what 256 bits make of it, against
/// all enclosures over one interval.
template <typename Case>
void check(const Case& c, double begin, double end, Random& random, int mode, Tally* tally) {
  std::vector<FrameBounds> frames(static_cast<std::size_t>(c.in.sweep.num_steps));
  const double tau = random.below(4) == 0 ? -1 : random.below(4) == 0 ? 1 : random.in(-1, 1);
  Real t = Real(0.5) * (Real(1 - tau) * Real(begin) + Real(1 + tau) * Real(end));
  const Real h = 1e-24;
  const RealRigid now = c.relative(t), before = c.relative(t - h), after = c.relative(t + h);
  for (const Enclosure enclosure : kEnclosures) {
    FrameBounds bounds;
    {
      const ScopedRounding scope(mode);
      ChainBounds chain;
      chain.reset(c.in.sweep, c.in.query);
      chain.enclose(begin, end, enclosure, Derivatives::second, frames.data());
      const IntervalTransform one = IntervalTransform::identity(),
                              nothing = {timesConstant(one.R, std::array<double, 9>{}.data()), one.t};
      const FrameBounds still = {one, nothing, nothing};
      bounds = relate(enclose(c.in.inverse_a), c.in.step_b < 0 ? still : frames[static_cast<std::size_t>(c.in.step_b)],
                      enclose(c.in.placement_b));
    }
    for (int i = 0; i < 12; ++i) {
      const Real rate = (entry(after, i) - entry(before, i)) / (Real(2.0) * h);
      const Real second = ((entry(after, i) - entry(now, i)) + (entry(before, i) - entry(now, i))) / (h * h);
      const bool good[3] = {holds(entry(bounds.pose, i), entry(now, i)), holds(entry(bounds.rate, i), rate, 1e-20),
                            holds(entry(bounds.second, i), second, 1e-20)};
      for (int order = 0; order < 3; ++order) {
        ++tally[order].checks;
        tally[order].broken += !good[order];
        ASSERT_TRUE(good[order]) << "order " << order << " entry " << i << " enclosure " << static_cast<int>(enclosure)
                                 << " [" << begin << ", " << end << "] mode " << mode;
      }
    }
  }
}

template <typename Case>
void campaign(const char* name, int checks) {
  Random random(seedOf(name));
  Tally tally[3];
  const int cases = scaled(checks) / (8 * 36);
  for (int i = 0; i < cases && !testing::Test::HasFatalFailure(); ++i) {
    const int mode = kRoundingModes[i % 4];
    const Case c(random, mode);
    for (int k = 0; k < 8; ++k) {
      double begin = c.in.tm[k] - c.in.d, end = c.in.tm[k] + c.in.d;
      if (k == 1) end = begin;
      check(c, begin, end, random, mode, tally);
    }
  }
  std::printf("%ld poses', %ld first and %ld second derivatives' entries, %ld broken\n", tally[0].checks,
              tally[1].checks, tally[2].checks, tally[0].broken + tally[1].broken + tally[2].broken);
  EXPECT_GE(tally[0].checks, 36 * 8 * cases / 3);
}

TEST(ChainBounds, HoldExactPosesOfRobots) {
  campaign<PairCase>("ChainBounds robots", 100000);
}
/// Robots whose angles go by the tangents of their halves.
struct HalfAngleCase : PairCase {
  HalfAngleCase(Random& random, int rounding) : PairCase(random, rounding) { goByHalfAngles(random); }
};
TEST(ChainBounds, HoldExactPosesOfRobotsThatGoByHalfAngles) {
  campaign<HalfAngleCase>("ChainBounds half angles", 100000);
}
TEST(ChainBounds, HoldExactPosesOfBodies) {
  campaign<BodyCase>("ChainBounds bodies", 100000);
}

/// Slides only, at single times, every other joint fixed. So intervals are wider than a point by the error of the
/// stored transforms, and by little else that could hide a fault in it.
TEST(ChainBounds, HoldTheModelsOfStoredTransforms) {
  Random random(seedOf("Stored transforms"));
  constexpr int kSlides = 4;
  long checks = 0;
  for (int round = 0; round < scaled(100000) / (12 * kSlides); ++round) {
    KinematicTree tree;
    tree.addLink("link0");
    double coefficients[2 * kSlides];
    for (double& c : coefficients) c = random.in(-1, 1);
    for (int i = 1; i <= 2 * kSlides; ++i) {
      Joint joint;
      joint.name = "joint" + std::to_string(i);
      joint.parent = "link" + std::to_string(i - 1);
      joint.child = "link" + std::to_string(i);
      joint.type = i % 2 ? JointType::fixed : JointType::prismatic;
      joint.axis = Eigen::Vector3d::UnitZ();
      joint.origin.linear() = random.rotation();
      joint.origin.translation() = random.unit() * random.direction();
      tree.addLink(joint.child);
      tree.addJoint(joint);
    }
    const FrameSweep sweep = FrameSweep::fromWorld(tree);
    engine::Query query;
    query.coefficients = coefficients;
    query.num_variables = kSlides;
    const double t = random.unit();
    FrameBounds frames[kSlides];
    ChainBounds chain;
    chain.reset(sweep.view(), query);
    chain.enclose(t, t, kEnclosures[round % 3], Derivatives::none, frames);
    RealRigid exact;
    for (int i = 0; i < 2 * kSlides; ++i) {
      exact = exact * properly(tree.joint(i).origin);
      if (i % 2 == 0) continue;
      const int v = i / 2;
      RealRigid slide;
      slide.t = {0.0, 0.0, Real(coefficients[v]) + Real(coefficients[kSlides + v]) * Real(t)};
      exact = exact * slide;
      for (int e = 0; e < 12; ++e) {
        ASSERT_TRUE(holds(entry(frames[v].pose, e), entry(exact, e))) << "round " << round << " slide " << v;
        ++checks;
      }
    }
  }
  std::printf("%ld entries\n", checks);
}

TEST(ChainBounds, TurnSeriesHoldExactValues) {
  Random random(seedOf("Turn series"));
  const int rounds = scaled(100000) / 5;
  for (int round = 0; round < rounds; ++round) {
    const double middle = random.chance(0.3) ? random.in(0.4, 0.6) : random.size(1e-15, 4e3);
    const double from = random.chance(0.2) ? middle : middle * random.unit();
    const double to = random.chance(0.2) ? middle : middle + random.size(1e-6, 10);
    const Interval g(from, to);
    const Real at = std::max(member(random, g), 1e-15), x = sqrt(at), one = 1.0, two = 2.0;
    const Real a = sin(x) / x, b = (one - cos(x)) / at, c = (one - a) / at;
    const Real b1 = (a - two * b) / (two * at), a1 = (cos(x) - a) / (two * at), c1 = (-a1 - c) / at;
    if (from < 1e-15) continue;
    const ScopedRounding scope(kRoundingModes[round % 4]);
    const RoundUpward upward;
    const TurnSeries f = turnSeries(g);
    constexpr double error = 1e-25;  // what 256 bits lose where the differences cancel
    ASSERT_TRUE(holds(f.a, a, error) && holds(f.b, b, error) && holds(f.c, c, error) && holds(f.b1, b1, error) &&
                holds(f.c1, c1, error))
        << "[" << from << ", " << to << "] at " << at.toDouble();
  }
  const RoundUpward upward;
  const TurnSeries none = turnSeries(Interval(0.0));
  EXPECT_TRUE(none.a.contains(1) && none.b.contains(0.5) && none.c.contains(Interval(1.0 / 6)));
  EXPECT_LT(none.c1.width(), 1e-15);
}

}  // namespace
}  // namespace chain_bounds_test
}  // namespace numerics_test
}  // namespace fcl_artic
