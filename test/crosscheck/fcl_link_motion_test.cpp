// SPDX-License-Identifier: BSD-3-Clause
#include "fcl_artic/fcl_link_motion.h"

#include <array>
#include <cmath>
#include <limits>

#include <fcl/math/motion/tbv_motion_bound_visitor.h>
#include <fcl/math/motion/triangle_motion_bound_visitor.h>
#include <fcl/narrowphase/continuous_collision_object.h>
#include <gtest/gtest.h>

#include "random_robot.h"
#include "rivals.h"

namespace fcl_artic {
namespace fcl_link_motion_test {
namespace {

using bench::Random;
using Eigen::Isometry3d;
using Eigen::Vector3d;

struct Case {
  std::shared_ptr<const KinematicTree> tree;
  JointMotion motion;
  LinkId link;
  Isometry3d offset;
};

Case randomCase(Random& random) {
  auto tree = test::randomTree(random, 1 + random.index(9), 0.5);
  const double angle = std::pow(10, random.uniform(-2.5, 0.8));
  JointMotion motion = test::randomMotion(*tree, random, angle);
  const LinkId link = random.coin(0.7) ? tree->numLinks() - 1 : random.index(tree->numLinks());
  return {tree, std::move(motion), link, test::randomPose(random, 0.2)};
}

TEST(FclLinkMotionTest, PosesAreThoseOfForwardKinematics) {
  Random random(1);
  std::vector<Isometry3d> M_0;
  for (int n = 0; n < 500; ++n) {
    const Case c = randomCase(random);
    const FclLinkMotion motion(*c.tree, c.motion, c.link, c.offset);
    for (double t : {0.0, random.uniform(), 1.0}) {
      c.tree->forwardKinematics(c.motion.configuration(t), M_0);
      const Isometry3d expected = M_0[static_cast<std::size_t>(c.link)] * c.offset;
      // A dozen products of rotations: some ulps of lengths of a few metres.
      EXPECT_TRUE(motion.pose(t).isApprox(expected, 1e-13)) << "case " << n << " t " << t;
      EXPECT_TRUE(motion.integrate(t));
      fcl::Transform3d current;
      motion.getCurrentTransform(current);
      EXPECT_EQ(current.matrix(), motion.pose(t).matrix());
      fcl::Matrix3d R;
      fcl::Vector3d T;
      motion.getCurrentTransform(R, T);  // overload of the base class
      EXPECT_EQ(R, current.linear());
      EXPECT_EQ(T, current.translation());
    }
  }
}

TEST(FclLinkMotionTest, TimesOutsideTheMotionAreClamped) {
  Random random(2);
  const Case c = randomCase(random);
  const FclLinkMotion motion(*c.tree, c.motion, c.link, c.offset);
  fcl::Transform3d current;
  motion.integrate(1.5);
  motion.getCurrentTransform(current);
  EXPECT_EQ(current.matrix(), motion.pose(1).matrix());
  motion.integrate(-0.5);
  motion.getCurrentTransform(current);
  EXPECT_EQ(current.matrix(), motion.pose(0).matrix());
}

// Largest advance along n per unit of t that is seen from time t on.
double sampledAdvance(const FclLinkMotion& motion, double t, const Vector3d& x_g, const Vector3d& n) {
  constexpr int kSamples = 24;
  const Vector3d x = motion.pose(t) * x_g;
  double most = -std::numeric_limits<double>::infinity();
  for (int i = 1; i <= kSamples; ++i) {
    const double s = (1 - t) * i / kSamples;
    most = std::max(most, n.dot(motion.pose(t + s) * x_g - x) / s);
  }
  return most;
}

TEST(FclLinkMotionTest, BoundsHoldForTheRestOfTheStep) {
  Random random(3);
  constexpr double kRounding = 1e-11;  // differences of positions of a few metres over s >= 1/240
  int tight = 0, tight_undirected = 0;
  constexpr int kCases = 1500;
  for (int n = 0; n < kCases; ++n) {
    const Case c = randomCase(random);
    const FclLinkMotion motion(*c.tree, c.motion, c.link, c.offset);
    const double t = random.uniform(0, 0.9);
    const Vector3d direction = test::randomDirection(random);
    motion.integrate(t);

    std::array<Vector3d, 3> corner;
    for (Vector3d& x : corner) x = 0.3 * random.uniform() * test::randomDirection(random);
    const fcl::TriangleMotionBoundVisitor<double> triangle(corner[0], corner[1], corner[2], direction);
    const double bound = motion.computeMotionBound(triangle);
    double sampled = -std::numeric_limits<double>::infinity();
    for (const Vector3d& x : corner) sampled = std::max(sampled, sampledAdvance(motion, t, x, direction));
    const Vector3d inside = (corner[0] + corner[1] + corner[2]) / 3;
    EXPECT_LE(sampledAdvance(motion, t, inside, direction), bound + kRounding) << "case " << n;
    EXPECT_LE(sampled, bound + kRounding) << "case " << n;
    tight += sampled > 0.5 * bound;
    double reach = 0;
    for (const Vector3d& x : corner) reach = std::max(reach, x.norm());
    tight_undirected += sampled > 0.5 * motion.speedBound(reach);

    fcl::RSSd rss;
    rss.axis = test::randomPose(random, 0).linear();
    rss.To = corner[0];
    rss.l[0] = random.uniform(0, 0.3);
    rss.l[1] = random.uniform(0, 0.3);
    rss.r = random.uniform(0, 0.1);
    const double rss_bound = motion.computeMotionBound(fcl::TBVMotionBoundVisitor<fcl::RSSd>(rss, direction));
    for (int i = 0; i < 6; ++i) {
      const Vector3d x = rss.To + rss.axis.col(0) * rss.l[0] * random.uniform() +
                         rss.axis.col(1) * rss.l[1] * random.uniform() + rss.r * test::randomDirection(random);
      EXPECT_LE(sampledAdvance(motion, t, x, direction), rss_bound + kRounding) << "case " << n;
    }
    fcl::OBBRSSd both;
    both.rss = rss;
    EXPECT_EQ(motion.computeMotionBound(fcl::TBVMotionBoundVisitor<fcl::OBBRSSd>(both, direction)), rss_bound);
  }
  // Safe is not enough, an infinite bound is that too: the direction must pay.
  RecordProperty("tight", tight);
  RecordProperty("tight_undirected", tight_undirected);
  EXPECT_GT(tight, kCases / 8);
  EXPECT_GT(tight, 2 * tight_undirected);
}

TEST(FclLinkMotionTest, SpeedAndAccelerationBoundsHold) {
  Random random(4);
  for (int n = 0; n < 500; ++n) {
    const Case c = randomCase(random);
    const FclLinkMotion motion(*c.tree, c.motion, c.link, c.offset);
    const double radius = random.uniform(0, 0.4);
    const Vector3d x_g = radius * test::randomDirection(random);
    const double speed = motion.speedBound(radius), acceleration = motion.accelerationBound(radius);
    constexpr double h = 1e-3;
    for (int i = 0; i < 10; ++i) {
      const double t = random.uniform(h, 1 - h);
      const Vector3d before = motion.pose(t - h) * x_g, now = motion.pose(t) * x_g, after = motion.pose(t + h) * x_g;
      // Mean values over the difference interval are bounded by what bounds the derivatives.
      EXPECT_LE((after - before).norm() / (2 * h), speed * (1 + 1e-12) + 1e-11) << "case " << n;
      EXPECT_LE((after - 2 * now + before).norm() / (h * h), acceleration * (1 + 1e-12) + 1e-8) << "case " << n;
    }
  }
}

/// A link "bar" that turns about z.
KinematicTree hinge() {
  KinematicTree tree;
  tree.addLink("base");
  tree.addLink("bar");
  Joint joint;
  joint.name = "hinge";
  joint.type = JointType::revolute;
  joint.parent = "base";
  joint.child = "bar";
  joint.axis = Vector3d::UnitZ();
  tree.addJoint(joint);
  return tree;
}

TEST(FclLinkMotionTest, BoundsAreAttainedByOneJoint) {
  const KinematicTree tree = hinge();
  const JointMotion turn = JointMotion::linear(tree, Eigen::VectorXd::Zero(1), Eigen::VectorXd::Constant(1, 0.5));
  const FclLinkMotion motion(tree, turn, tree.linkId("bar"));
  EXPECT_DOUBLE_EQ(motion.speedBound(2), 1);           // 0.5 rad at 2 m
  EXPECT_DOUBLE_EQ(motion.accelerationBound(2), 0.5);  // 0.5^2 * 2
}

TEST(FclLinkMotionTest, BoxOfAContinuousObjectContainsTheMotion) {
  Random random(5);
  for (int n = 0; n < 300; ++n) {
    const Case c = randomCase(random);
    const auto motion = std::make_shared<FclLinkMotion>(*c.tree, c.motion, c.link, c.offset);
    const auto box = std::make_shared<fcl::Boxd>(0.1, 0.2, 0.3);
    box->computeLocalAABB();
    fcl::ContinuousCollisionObjectd object(box, motion);
    object.computeAABB();
    for (int i = 0; i <= 20; ++i) {
      const Isometry3d M = motion->pose(i / 20.0);
      for (int corner = 0; corner < 8; ++corner) {
        const Vector3d x(corner & 1 ? 0.05 : -0.05, corner & 2 ? 0.1 : -0.1, corner & 4 ? 0.15 : -0.15);
        EXPECT_TRUE(object.getAABB().contain(M * x)) << "case " << n << " t " << i / 20.0;
      }
    }
  }
}

TEST(FclLinkMotionTest, BadInputIsNamed) {
  Random random(6);
  const auto tree = test::randomTree(random, 3, 0.3), other = test::randomTree(random, 4, 0.3);
  const JointMotion motion = test::randomMotion(*tree, random, 1);
  EXPECT_THROW(FclLinkMotion(*tree, motion, tree->numLinks()), std::out_of_range);
  EXPECT_THROW(FclLinkMotion(*tree, motion, -1), std::out_of_range);
  EXPECT_THROW(FclLinkMotion(*other, motion, 1), std::invalid_argument);
  Isometry3d sheared = Isometry3d::Identity();
  sheared.linear()(0, 1) = 0.5;
  EXPECT_THROW(FclLinkMotion(*tree, motion, 1, sheared), std::invalid_argument);
  sheared.linear()(0, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(FclLinkMotion(*tree, motion, 1, sheared), std::invalid_argument);
}

TEST(FclLinkMotionTest, VolumesWithoutABoundAreRefusedNotTakenAsStill) {
  Random random(7);
  const Case c = randomCase(random);
  const FclLinkMotion motion(*c.tree, c.motion, c.link, c.offset);
  const fcl::TBVMotionBoundVisitor<fcl::OBBd> visitor(fcl::OBBd(), Vector3d::UnitX());
  EXPECT_THROW(motion.computeMotionBound(visitor), std::invalid_argument);
}

// A flat bar along x turns by a quarter about z. A wall through the z axis, 1.1 rad on, is met by the whole leading
// edge at once, at t* = 1.1 / (pi / 2).
//
//        wall
//       /
//      /  ^ turns
//     o=======
//
TEST(FclLinkMotionTest, OrientedAdvancementFindsAKnownContactEveryTime) {
  const KinematicTree tree = hinge();
  const JointMotion turn =
      JointMotion::linear(tree, Eigen::VectorXd::Zero(1), Eigen::VectorXd::Constant(1, bench::kPi / 2));
  const FclLinkMotion motion(tree, turn, tree.linkId("bar"));

  bench::TriangleMesh bar, wall;
  bar.vertices = {{0.3, 0, 0}, {1, 0, 0}, {1, -0.1, 0}, {0.3, -0.1, 0}};
  bar.triangles = {{0, 1, 2}, {0, 2, 3}};
  const double c = std::cos(1.1), s = std::sin(1.1);
  wall.vertices = {
      {0.5 * c, 0.5 * s, -0.3}, {0.8 * c, 0.8 * s, -0.3}, {0.8 * c, 0.8 * s, 0.3}, {0.5 * c, 0.5 * s, 0.3}};
  wall.triangles = {{0, 1, 2}, {0, 2, 3}};
  const auto bar_bvh = bench::toBvh<fcl::RSSd>(bar), wall_bvh = bench::toBvh<fcl::RSSd>(wall);
  const double expected = 1.1 / (bench::kPi / 2);
  for (int i = 0; i < 3; ++i) {
    const double toc = bench::orientedAdvancement(*bar_bvh, motion, *wall_bvh, bench::still());
    EXPECT_LE(toc, expected + 1e-12);
    EXPECT_GE(toc, expected - 2e-4);
  }
  // The other way round the wall is body 1, and the direction of the bar's bound is reversed.
  const double toc = bench::orientedAdvancement(*wall_bvh, bench::still(), *bar_bvh, motion);
  EXPECT_LE(toc, expected + 1e-12);
  EXPECT_GE(toc, expected - 2e-4);
}

}  // namespace
}  // namespace fcl_link_motion_test
}  // namespace fcl_artic
