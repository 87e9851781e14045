// SPDX-License-Identifier: BSD-3-Clause
// The judge against closed forms, FCL's motions and exact predicates.
#include <cmath>

#include <fcl/geometry/shape/box.h>
#include <gtest/gtest.h>

#include "bounded_path.h"
#include "exact_look.h"
#include "pair_campaign.h"

namespace pair_campaign {
namespace judge_test {
namespace {

using namespace pairs;

BodyPtr box(double half) {
  auto b = std::make_shared<Body>();
  b->kind = Kind::box;
  b->half = Vec3::Constant(half);
  b->geometry = std::make_shared<fcl::Boxd>(2 * half, 2 * half, 2 * half);
  b->reach = b->half.norm();
  return b;
}
BodyPtr ball(double radius) {
  auto b = std::make_shared<Body>();
  b->kind = Kind::sphere;
  b->radius = b->reach = radius;
  return b;
}
PathPtr straight(const Vec3& from, const Vec3& to) {
  Ends ends;
  ends.T1 = from, ends.T2 = to;
  return translationPath(ends);
}

TEST(PairJudge, HeadOnBoxesMeetWhenTheirFacesDo) {
  // From 3 to 0 along x: faces meet at distance 1, t = 2/3. Aligned, so that no corner of anything is inside.
  const PairQuery q{"", 0, box(0.5), box(0.5), straight({3, 0, 0}, {0, 0, 0}), straight({0, 0, 0}, {0, 0, 0})};
  const Truth truth = Judge(q).firstContact();
  ASSERT_TRUE(truth.hit);
  EXPECT_GE(truth.time, 2.0 / 3);
  EXPECT_LE(truth.time, 2.0 / 3 + 4 * kClear);
}

TEST(PairJudge, ABallThatGrazesABoxByAHairIsToldFromOneThatDoesNot) {
  // Passes above the box: the ball's lowest point at height 0.5 + gap.
  for (const double gap : {1e-6, 1e-9, 3e-12, -3e-12, -1e-9, -1e-6}) {
    const double height = 0.5 + 0.25 + gap;
    const PairQuery q{
        "", 0, box(0.5), ball(0.25), straight({0, 0, 0}, {0, 0, 0}), straight({-2, 0, height}, {2, 0.3, height})};
    const Truth truth = Judge(q).firstContact();
    EXPECT_EQ(truth.hit, gap < 0) << gap;
    if (!truth.hit) {
      EXPECT_NEAR(truth.gap, gap, 1e-12 + 1e-2 * gap);
    }
    const Truth least = Judge(q).leastGap();
    if (gap > 0) {
      EXPECT_NEAR(least.gap, gap, 1e-11 + 2e-3 * gap);
    }
  }
}

TEST(PairJudge, ABoxThatTurnsMeetsTheBallWhenItsEdgeReachesIt) {
  // A square of half side 0.5 turns about z; its edge, at distance r = sqrt(1/2) and 45 degrees ahead of the face's
  // normal, comes to the ball at distance 0.5 + 0.1 + 0.05 on the x axis: the face's plane meets the ball first. The
  // ball's centre lies 0.05 above the face at angle 0; the distance from the face at angle a is 0.65 cos a - 0.5, until
  // the foot on the face, 0.65 sin a, passes its end. 0.65 cos a = 0.6 at a = 0.3948.
  Ends turn;
  turn.R2 = Eigen::AngleAxisd(1.0, Vec3::UnitZ()).toRotationMatrix();
  const PairQuery q{"", 0, box(0.5), ball(0.1), interpPath(turn, Vec3::Zero()), straight({0.65, 0, 0}, {0.65, 0, 0})};
  const Truth truth = Judge(q).firstContact();
  ASSERT_TRUE(truth.hit);
  EXPECT_NEAR(truth.time, std::acos(0.6 / 0.65), 1e-11);
}

TEST(PairJudge, EverySampleOfARandomQueryAgreesWithItsTruth) {
  // Plainly, at 500 even times: nothing clear before the first contact, and nothing much nearer than the least gap.
  for (const Family& family : families()) {
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
      const PairQuery q = makeQuery(family, Random::mix(77, seed));
      const Judge judge(q);
      const Truth truth = judge.firstContact(), least = judge.leastGap();
      EXPECT_EQ(truth.hit, least.hit) << describe(q);
      for (int i = 0; i <= 500; ++i) {
        const double t = i / 500.0;
        const Nearness p = judge.at(t, 1e-3);
        if (p.clear) {
          EXPECT_TRUE(truth.hit && truth.time <= t) << describe(q) << " at " << t;
        }
        if (!truth.hit) {
          EXPECT_GE(p.upper, 0.69 * least.gap) << describe(q) << " at " << t;
        }
      }
    }
  }
}

TEST(PairJudge, AgreesWithExactPredicatesOnMeshes) {
  int hits = 0;
  for (std::uint64_t i = 0; i < 60; ++i) {
    const PairQuery q = makeQuery(families()[0], Random::mix(78, i));
    const Truth own = Judge(q).firstContact(), exact = Judge(q, exactLook(q)).firstContact();
    ASSERT_EQ(own.hit, exact.hit) << describe(q);
    hits += own.hit;
    EXPECT_NEAR(own.time, exact.time, 1e-7) << describe(q);
    for (int k = 0; k <= 8; ++k) {
      const Nearness p = Judge(q).at(k / 8.0, 1e-4), e = Judge(q, exactLook(q)).at(k / 8.0, 1e-4);
      EXPECT_EQ(p.clear, e.clear) << describe(q) << " at " << k / 8.0;
      if (!p.clear) {
        EXPECT_NEAR(p.upper, e.upper, 1e-9 + 2e-4 * e.upper) << describe(q) << " at " << k / 8.0;
      }
    }
  }
  EXPECT_GE(hits, 15);
}

TEST(PairJudge, PathsAreFclsMotions) {
  for (const Family& family : families()) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      const PairQuery q = makeQuery(family, Random::mix(79, seed));
      for (const PathPtr& path : {q.path1, q.path2}) {
        const auto motion = path->motion();
        for (const double t : {0.0, 0.3, 0.77, 1.0}) {
          motion->integrate(t);
          fcl::Transform3d tf;
          motion->getCurrentTransform(tf);
          const auto M = path->pose(t).cast<double>();
          EXPECT_LE((M.rotation - tf.linear()).norm() + (M.position - tf.translation()).norm(), 1e-12) << path->name();
        }
      }
    }
  }
}

TEST(PairJudge, NothingMovesFasterThanThePathSays) {
  for (const Family& family : families()) {
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
      const PathPtr path = makeQuery(family, Random::mix(80, seed)).path1;
      const Vec<Real> x = Vec<Real>(0.3, -0.5, 0.4);
      const double speed = path->speed(static_cast<double>(x.norm()));
      Vec<Real> before = path->pose(0) * x;
      for (int i = 1; i <= 400; ++i) {
        const Vec<Real> now = path->pose(i / 400.0) * x;
        EXPECT_LE(static_cast<double>((now - before).norm()) * 400, speed * (1 + 1e-9) + 1e-12) << path->name();
        before = now;
      }
    }
  }
}

TEST(PairJudge, ASpeedOfATurningBoundIsNotGenerous) {
  // The bound is reached: a point at distance 1 from the axis of a rotation by 2 rad.
  Ends turn;
  turn.R2 = Eigen::AngleAxisd(2.0, Vec3::UnitZ()).toRotationMatrix();
  EXPECT_NEAR(interpPath(turn, Vec3::Zero())->speed(1), 2, 1e-9);
}

}  // namespace
}  // namespace judge_test
}  // namespace pair_campaign
