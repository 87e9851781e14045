// SPDX-License-Identifier: BSD-3-Clause
//
// Poses and swept boxes of body motions.
#include "motion/body_motion.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "example_motions.h"
#include "random_robot.h"

namespace fcl_artic {
namespace body_motion_test {
namespace {

using bench::Random;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Kind = MotionElement::Kind;
using test::randomDirection;
using test::randomPose;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

UnitVector unit(const Vector3d& v) {
  return UnitVector::within3Ulps(v).value();
}
RigidTransform rigid(const Isometry3d& M) {
  return RigidTransform::within12Ulps(M, 1e-12).value();
}

MotionElement element(Kind kind, std::initializer_list<Vector3d> coefficients) {
  MotionElement e;
  e.kind = kind;
  int k = 0;
  for (const Vector3d& c : coefficients) e.coefficients.col(k++) = c;
  return e;
}

TEST(MotionElementTest, Degree) {
  MotionElement e;
  EXPECT_EQ(e.degree(), 0);
  e.coefficients(2, 5) = 1;
  for (const Kind kind : {Kind::slide, Kind::turn}) {
    e.kind = kind;
    EXPECT_EQ(e.degree(), 5);
  }
  e.coefficients(0, 3) = -1;
  for (const Kind kind : {Kind::revolute, Kind::prismatic}) {
    e.kind = kind;
    EXPECT_EQ(e.degree(), 3);
  }
}

TEST(BodyMotionTest, StandsStillWithoutElements) {
  BodyMotion motion;
  motion.after = RigidTransform(Rotation(), {1, 2, 3});
  EXPECT_EQ(motion.pose(0.7).matrix(), motion.after.matrix());
}

/// x(1/2) by hand: a slide (t^2, 0, 1), then a turn by (0, 0, pi t), then a prismatic joint 4 t^3 along x, then (0, 1,
/// 0): the turn by pi/2 takes (1/2, 1, 0) to (-1, 1/2, 0), and the slide is at (1/4, 0, 1).
TEST(BodyMotionTest, WorkedPose) {
  BodyMotion motion;
  MotionElement prismatic = element(Kind::prismatic, {Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero(), {4, 9, 9}});
  prismatic.axis = UnitVector::along(0);
  motion.elements = {element(Kind::slide, {{0, 0, 1}, {0, 0, 0}, {1, 0, 0}}),
                     element(Kind::turn, {{0, 0, 0}, {0, 0, M_PI}}), prismatic};
  motion.after = RigidTransform(Rotation(), {0, 1, 0});
  EXPECT_LE((motion.pose(0.5).translation() - Vector3d(-0.75, 0.5, 1)).norm(), 1e-15);
}

TEST(BodyMotionTest, TurnsAreProperAndRightAtAllAngles) {
  Random random(1);
  for (int n = 0; n < 2000; ++n) {
    const double angle = n == 0 ? 0 : std::pow(10, random.uniform(-320, 2));
    const Vector3d axis = randomDirection(random);
    BodyMotion motion;
    motion.elements = {element(Kind::turn, {angle * axis})};
    const Matrix3d R = motion.pose(0.5).linear();
    EXPECT_LE((R.transpose() * R - Matrix3d::Identity()).norm(), 4e-15);
    // Off by the rounding of the vector, in all some ulp of the angle.
    EXPECT_LE((R - Eigen::AngleAxisd(angle, axis).toRotationMatrix()).norm(), 4e-15 + 1e-15 * angle) << angle;
    const Vector3d vee(R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1));
    if (angle < 1e-3 && angle > 1e-290) {
      // Small angles keep their digits: sin(angle) axis, to the rounding of the entries (which ends at 1e-16 beside b w
      // w^T).
      EXPECT_LE((vee / 2 - std::sin(angle) * axis).norm(), 4e-16 * angle + 1e-16 * angle * angle) << angle;
    }
  }
}

struct Case {
  BodyMotion motion;
  Vector3d lower, upper;
  std::shared_ptr<BoundedMotion> bounded;
};

/// Chains of up to four elements of any kind and degree, or an author's motion.
Case randomCase(Random& random) {
  Case c;
  const double scale = std::pow(10, random.uniform(-2, 2));
  if (random.coin(0.15)) {
    const Isometry3d start = randomPose(random, scale);
    const Vector3d sway = scale * random.uniform() * randomDirection(random);
    const double k = random.uniform(0, 6), turn = random.uniform(0, 3), m = random.uniform(0, 4);
    if (random.coin()) {
      c.bounded = std::make_shared<test::SwayingMotion>(start, sway, k, turn, m);
    } else {
      c.bounded = std::make_shared<test::SpeedBoundedMotion>(start, sway, k, turn, m);
    }
    MotionElement e;
    e.kind = Kind::bounded;
    e.bounded = c.bounded.get();
    c.motion.elements = {e};
  } else {
    for (int n = 1 + random.index(4); n > 0; --n) {
      MotionElement e;
      e.kind = static_cast<Kind>(random.index(4));
      if (random.coin()) e.before = rigid(randomPose(random, scale));
      e.axis = unit(randomDirection(random));
      const double size =
          e.kind == Kind::revolute || e.kind == Kind::turn ? std::pow(10, random.uniform(-4, 0.5)) : scale;
      for (int k = random.index(kMaxDegree + 1); k >= 0; --k) {
        e.coefficients.col(k) = size * random.uniform() * randomDirection(random);
      }
      c.motion.elements.push_back(e);
    }
    if (random.coin()) c.motion.after = rigid(randomPose(random, scale));
  }
  c.lower = scale * random.uniform() * randomDirection(random);
  c.upper = c.lower + scale * std::pow(10, random.uniform(-3, 0)) * randomDirection(random).cwiseAbs();
  if (random.coin(0.1)) c.upper = c.lower;  // a point
  return c;
}

Vector3d corner(const Case& c, int i) {
  return {i & 1 ? c.upper[0] : c.lower[0], i & 2 ? c.upper[1] : c.lower[1], i & 4 ? c.upper[2] : c.lower[2]};
}

TEST(HeadingTest, DirectionsTurnNoFartherThanItsBound) {
  Random random(3);
  int tight = 0, still = 0, about_itself = 0;
  for (int n = 0; n < 3000; ++n) {
    Case c = randomCase(random);
    const UnitVector own = unit(randomDirection(random));
    // A turn about the direction itself, wherever it is in a chain, leaves it as it is.
    if (n % 3 == 0 && !c.bounded) {
      MotionElement e;
      e.kind = random.coin() ? Kind::revolute : Kind::turn;
      e.axis = unit(c.motion.after.linear() * own.vector());
      for (int k = 0; k < 3; ++k) {
        const double q = random.uniform(-2, 2);
        e.coefficients.col(k) = e.kind == Kind::turn ? Vector3d(q * e.axis.vector()) : Vector3d(q, 0, 0);
      }
      BodyMotion alone;
      alone.elements = {e};
      alone.after = c.motion.after;
      EXPECT_LE(headingOf(alone, own).deviation, 1e-14);
      for (const double t : {0.0, 0.3, 1.0}) {
        EXPECT_LE((alone.pose(t).linear() * own.vector() - headingOf(alone, own).direction).norm(), 1e-14);
      }
      ++about_itself;
      c.motion.elements.push_back(e);
    }
    const Heading heading = headingOf(c.motion, own);
    EXPECT_LE((heading.direction - c.motion.pose(0).linear() * own.vector()).norm(), 2e-14);
    double farthest = 0;
    for (int i = 0; i <= 40; ++i) {
      farthest = std::max(farthest, (c.motion.pose(i / 40.0).linear() * own.vector() - heading.direction).norm());
    }
    EXPECT_LE(farthest, heading.deviation + 1e-13) << n;
    tight += farthest > 0.8 * heading.deviation && heading.deviation > 1e-3;
    still += heading.deviation == 0;
  }
  EXPECT_GE(tight, 50);
  EXPECT_GE(still, 200);
  EXPECT_GE(about_itself, 500);
}

/// A turn by a vector that is along the direction only after t = 0 does turn it.
TEST(HeadingTest, ATurnWhoseAxisChangesIsNotTakenForOneAboutTheDirection) {
  BodyMotion motion;
  motion.elements = {element(Kind::turn, {{M_PI / 2, 0, 0}, {0, 0, 1}})};
  EXPECT_GE(headingOf(motion, UnitVector()).deviation, 1);
  EXPECT_GE((motion.pose(1).linear().col(2) - motion.pose(0).linear().col(2)).norm(), 0.1);
}

TEST(EnclosePathTest, HoldsEverySampledPoint) {
  Random random(2);
  int outside = 0, checks = 0;
  double least = kInfinity;
  for (int n = 0; n < 4000; ++n) {
    const Case c = randomCase(random);
    Vector3d lo, hi;
    enclosePath(c.motion, c.lower, c.upper, lo, hi);
    const double width = (hi - lo).norm();
    for (int i = 0; i < 30; ++i) {
      const Isometry3d M = c.motion.pose(i == 0 ? 0 : i == 1 ? 1 : random.uniform());
      for (int k = 0; k < 8; ++k) {
        const Vector3d x = M * corner(c, k);
        const double inside = std::min((x - lo).minCoeff(), (hi - x).minCoeff());
        outside += !(inside >= 0);
        least = std::min(least, inside / width);
        ++checks;
      }
    }
  }
  std::printf("%d points; nearest to a wall: %.2g of the width\n", checks, least);
  EXPECT_EQ(outside, 0);
  EXPECT_LT(least, 1e-9) << "no point comes near a wall: the test tells little";
}

/// Where the path turns, the boxes of its ends alone don't hold it: points on the circle's far side show what is left
/// out.
TEST(EnclosePathTest, HoldsTheTopOfACircle) {
  for (int n = 1; n <= 64; ++n) {
    // Half a turn about z, begun at -90 degrees + offset: the top in x lies anywhere between the times looked at.
    BodyMotion motion;
    const double turn = M_PI * n / 16, offset = 0.37 * turn;
    motion.elements = {element(Kind::revolute, {{-offset, 0, 0}, {turn, 0, 0}})};
    Vector3d lo, hi;
    enclosePath(motion, Vector3d::UnitX(), Vector3d::UnitX(), lo, hi);
    EXPECT_GE(hi[0], 1) << n;
    EXPECT_LE(hi[0], 1.02) << n;
  }
}

struct Ratio {
  double worst = 0, sum = 0;
  int count = 0;
  void add(double ratio) {
    worst = std::max(worst, ratio);
    sum += ratio;
    ++count;
  }
};

/// Diagonal of the box over that of the points at 400 times; 1 for points that stand still.
double tightness(const Case& c) {
  Vector3d lo, hi, low = Vector3d::Constant(kInfinity), high = -low;
  enclosePath(c.motion, c.lower, c.upper, lo, hi);
  for (int i = 0; i <= 400; ++i) {
    const Isometry3d M = c.motion.pose(i / 400.0);
    for (int k = 0; k < 8; ++k) {
      low = low.cwiseMin(M * corner(c, k));
      high = high.cwiseMax(M * corner(c, k));
    }
  }
  return low == high ? 1 : (hi - lo).norm() / (high - low).norm();
}

TEST(EnclosePathTest, IsNotWide) {
  Random random(3);
  Ratio quarter, any, author;
  for (int n = 0; n < 300; ++n) {
    // A body of 0.1 to 1 m that turns by a quarter about an axis within 1 m while it goes up to 2 m.
    Case c;
    MotionElement turn = element(Kind::revolute, {{0, 0, 0}, {M_PI / 2, 0, 0}});
    turn.axis = unit(randomDirection(random));
    c.motion.elements = {
        element(Kind::slide, {randomDirection(random), 2 * random.uniform() * randomDirection(random)}), turn};
    c.motion.after = rigid(randomPose(random, 1));
    c.upper = Vector3d(random.uniform(0.05, 0.5), random.uniform(0.05, 0.5), random.uniform(0.05, 0.5));
    c.lower = -c.upper;
    quarter.add(tightness(c));

    const Case other = randomCase(random);
    (other.bounded ? author : any).add(tightness(other));
  }
  std::printf("width over the path's: quarter turns %.3f (worst %.3f), any chain %.3f (%.3f), authors' %.3f (%.3f)\n",
              quarter.sum / quarter.count, quarter.worst, any.sum / any.count, any.worst, author.sum / author.count,
              author.worst);
  EXPECT_LT(quarter.worst, 1.03);
  EXPECT_LT(any.sum / any.count, 1.1);
  EXPECT_LT(author.worst, 1.2);
}

TEST(EnclosePathTest, StraightPathsAreExactToRounding) {
  BodyMotion motion;
  motion.elements = {element(Kind::slide, {{1, 2, 3}, {10, 0, -1}})};
  Vector3d lo, hi;
  enclosePath(motion, Vector3d(-1, -1, -1), Vector3d(1, 1, 1), lo, hi);
  EXPECT_LE((lo - Vector3d(0, 1, 1)).norm(), 4e-12);
  EXPECT_LE((hi - Vector3d(12, 3, 4)).norm(), 4e-12);
}

TEST(EnclosePathTest, UnboundedBodiesAndWildMotionsGiveUnboundedBoxes) {
  const Vector3d all = Vector3d::Constant(kInfinity), one = Vector3d::Ones();
  const auto expectUnbounded = [&](const BodyMotion& motion, const Vector3d& lower, const Vector3d& upper) {
    Vector3d lo, hi;
    enclosePath(motion, lower, upper, lo, hi);
    EXPECT_EQ(lo, -all);
    EXPECT_EQ(hi, all);
  };
  BodyMotion motion;
  motion.elements = {element(Kind::turn, {{0, 0, 0}, {1, 0, 0}})};
  expectUnbounded(motion, -all, one);
  expectUnbounded(motion, -one, Vector3d(1, kInfinity, 1));
  expectUnbounded(motion, -one, Vector3d(1, std::nan(""), 1));
  motion.elements[0].coefficients(1, 1) = std::nan("");
  expectUnbounded(motion, -one, one);
  motion.elements[0].coefficients(1, 1) = 1e200;  // squares overflow
  expectUnbounded(motion, -one, one);
}

}  // namespace
}  // namespace body_motion_test
}  // namespace fcl_artic
