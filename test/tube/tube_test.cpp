// SPDX-License-Identifier: BSD-3-Clause
//
// Tolerances of joints, base and objects where the largest free one can be written down.
#include <cmath>

#include <gtest/gtest.h>

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/halfspace.h>

#include "one_turn.h"

namespace fcl_artic {
namespace tube_test {
namespace {

TEST(Tube, OneTurnBeforeABall) {
  OneTurn arm;
  const double at = 1.2;
  const auto obstacle = ball(kRadius, Vector3d(std::cos(at), std::sin(at), 0));
  arm.manager->registerObject(obstacle.get(), "ball");
  // They touch where the chord of the angle between them is two radii.
  const double touch = at - 2 * std::asin(kRadius), end = touch - 0.05;
  EXPECT_TRUE(arm.turn(0, end).isFree());
  // The bound takes the chord of the tolerance at the ball's farthest point, and the gap along the chord between both.
  const double gap = 2 * std::sin(0.5 * (at - end)) - 2 * kRadius, largest = gap / (1 + kRadius);
  arm.manager->setJointTolerances({0.99 * largest, 0});
  EXPECT_TRUE(arm.turn(0, end).isFree());
  arm.manager->setJointTolerances({1.01 * 0.05, 0});
  const CertifiedResult hit = arm.turn(0, end);
  ASSERT_EQ(hit.status, Status::contact);
  ASSERT_TRUE(hit.certain);
  const VectorXd witness = hit.contacts.at(0).q_witness;
  ASSERT_EQ(witness.size(), 1);
  EXPECT_GE(angleOf(witness), touch - 1e-9);
  EXPECT_LE(angleOf(witness) - hit.t_upper * end, 1.01 * 0.05 * (1 + 1e-12));
  EXPECT_GE(hit.t_upper, (touch - 1.01 * 0.05) / end - 1e-9) << "before, all of the tube is free";
  // A joint's own tolerance counts in place of all joints'; without any the answer is the first one again.
  arm.manager->setJointTolerance("joint", {});
  EXPECT_TRUE(arm.turn(0, end).isFree());
  arm.manager->resetTolerances();
  arm.manager->setJointTolerances({1.01 * 0.05, 0});
  EXPECT_FALSE(arm.turn(0, end).isFree());
  arm.manager->resetTolerances();
  EXPECT_TRUE(arm.turn(0, end).isFree());
}

TEST(Tube, ASlideBeforeAHalfspace) {
  for (const double tolerance : {0.0999, 0.1001}) {
    OneTurn arm(JointType::prismatic);
    const auto wall = object(std::make_shared<fcl::Halfspaced>(-Vector3d::UnitZ(), -1));  // z >= 1
    arm.manager->registerObject(wall.get(), "wall");
    arm.manager->setJointTolerances({0, tolerance});
    const CertifiedResult result = arm.turn(0, 1 - kRadius - 0.1);
    EXPECT_EQ(result.isFree(), tolerance < 0.1) << tolerance;
    if (!result.isFree()) {
      ASSERT_TRUE(result.certain);
      EXPECT_NEAR(result.contacts.at(0).q_witness[0], 1 - kRadius, 2e-4);
    }
  }
}

TEST(Tube, APlanarJointSlidesInAnyDirection) {
  // A cart that may be off by d in the plane across an axis, and a ball at 0.98 d from it, in all directions.
  const Vector3d axis = Vector3d(1, 2, 3).normalized(), across = axis.unitOrthogonal();
  const auto tree = std::make_shared<KinematicTree>("cart");
  tree->addLink("floor");
  tree->addLink("cart");
  tree->addJoint(makeJoint("plane", JointType::planar, "floor", "cart", axis));
  const double d = 0.1, radius = 0.2;
  for (int k = 0; k < 16; ++k) {
    ArticulatedCollisionManager manager(tree);
    manager.bind("cart", ball(radius));
    manager.setJointTolerance("plane", {0, d});
    const Vector3d to = pose(Vector3d::Zero(), M_PI * k / 8, axis).linear() * across;
    manager.registerObject(ball(radius, (2 * radius + 0.98 * d) * to), "ball");
    manager.setup();
    EXPECT_FALSE(manager.collide(VectorXd::Zero(3)).isFree()) << k;
    const CertifiedResult moved = ask(manager, VectorXd::Zero(3), Vector3d(0, 0, 1));
    EXPECT_FALSE(moved.isFree()) << k;
    EXPECT_EQ(moved.t_lower, 0) << k;
    // (Both slides count by themselves: no more than twice d.)
    manager.setJointTolerance("plane", {0, 0.49 * d});
    manager.setup();
    EXPECT_TRUE(manager.collide(VectorXd::Zero(3)).isFree()) << k;
  }
}

TEST(Tube, ABodyOnTheAxisIsNotMoved) {
  OneTurn arm;
  const auto hub = ball(0.1);
  arm.manager->bind("arm", hub, pose(Vector3d(0, 0, 1)));
  const auto obstacle = ball(0.1, Vector3d(0.25, 0, 1));
  arm.manager->registerObject(obstacle.get(), "ball");
  // The hub is 0.05 away, and its farthest point from the axis at 0.1.
  arm.manager->setJointTolerances({0.45, 0});
  EXPECT_TRUE(arm.turn(1.5, 1.6).isFree());
  arm.manager->setJointTolerances({0.51, 0});
  const CertifiedResult near = arm.turn(1.5, 1.6);
  EXPECT_FALSE(near.isFree());
  EXPECT_FALSE(near.certain) << "no angle brings a ball nearer that turns about its own middle";
  EXPECT_EQ(near.t_upper, 1);
}

TEST(Tube, FollowersStrayByTheirMultiplier) {
  for (const double multiplier : {-3.0, 0.5}) {
    auto tree = std::make_shared<KinematicTree>("two");
    for (const char* link : {"base", "one", "two"}) tree->addLink(link);
    tree->addJoint(makeJoint("leader", JointType::prismatic, "base", "one", Vector3d::UnitX()));
    Joint follower = makeJoint("follower", JointType::prismatic, "base", "two", Vector3d::UnitY());
    follower.mimics = true;
    follower.mimic = {"leader", multiplier, 0};
    tree->addJoint(follower);
    ArticulatedCollisionManager manager(tree);
    const auto tip = ball(0.1), obstacle = ball(0.1, Vector3d(0, 0.4, 0));
    manager.bind("two", tip);
    manager.registerObject(obstacle.get(), "ball");
    const double gap = 0.2, largest = gap / std::abs(multiplier);
    for (const double part : {0.999, 1.001}) {
      manager.setJointTolerances({0, part * largest});
      manager.setup();
      const CertifiedResult result = ask(manager, VectorXd::Zero(1), VectorXd::Zero(1));
      EXPECT_EQ(result.isFree(), part < 1) << multiplier;
      EXPECT_EQ(result.certain, part > 1) << multiplier;
    }
    EXPECT_THROW(manager.setJointTolerance("follower", {0, 0.1}), std::invalid_argument);
  }
}

TEST(Tube, JointsBetweenTwoBodiesAloneCount) {
  // Both tips are carried by the first joint; only the second moves them against each other.
  auto tree = std::make_shared<KinematicTree>("two");
  for (const char* link : {"base", "one", "two"}) tree->addLink(link);
  tree->addJoint(makeJoint("shoulder", JointType::revolute, "base", "one", Vector3d::UnitZ()));
  tree->addJoint(makeJoint("wrist", JointType::revolute, "one", "two", Vector3d::UnitZ(), pose(Vector3d(10, 0, 0))));
  ArticulatedCollisionManager manager(tree);
  const auto a = ball(0.1), b = ball(0.1);
  manager.bind("one", a, pose(Vector3d(10, 0.5, 0)));
  manager.bind("two", b, pose(Vector3d(0.5, 0, 0)));
  AllowedCollisionMatrix checked;
  checked.disallow("one", "two");
  manager.setAllowedCollisions(checked);
  const VectorXd still = VectorXd::Zero(2);
  const double gap = std::sqrt(0.5) - 0.2;
  for (const double part : {0.9, 1.8}) {
    manager.setJointTolerances({part * gap / 0.6, 0});
    manager.setup();
    EXPECT_EQ(ask(manager, still, still).isFree(), part < 1);
  }
}

TEST(Tube, TheLeverGrowsWithinALane) {
  // The tip slides out from the axis of a turn by 1 m, an eighth of it in each lane of the first batch. At the end of
  // the last lane the turn's error carries the tip farther than in the lane's middle: beyond the wall.
  auto tree = std::make_shared<KinematicTree>("crane");
  for (const char* link : {"base", "turned", "out"}) tree->addLink(link);
  tree->addJoint(makeJoint("turn", JointType::revolute, "base", "turned", Vector3d::UnitZ()));
  tree->addJoint(makeJoint("slide", JointType::prismatic, "turned", "out", Vector3d::UnitX()));
  const double angle = 0.005, middle = 1.5 - 1.0 / 16;
  // A ball meets the wall by a bound in any direction. A large thin plate needs the share along the wall's normal: its
  // own corners are farther from the axis than the bound in any direction lets them be.
  struct Tip {
    std::shared_ptr<fcl::CollisionGeometryd> geometry;
    double reach, beyond;  ///< towards the wall; from the axis, beyond the tip's middle
  };
  for (const Tip& tip : {Tip{std::make_shared<fcl::Sphered>(kRadius), kRadius, 0},
                         Tip{std::make_shared<fcl::Boxd>(2 * kRadius, 1, 1), 0.5, kRadius}}) {
    for (const double lever : {middle + 0.04, 1.6}) {
      ArticulatedCollisionManager manager(tree);
      const auto body = object(tip.geometry);
      const double gap = (lever + tip.beyond) * angle;
      const auto wall = object(std::make_shared<fcl::Boxd>(10, 1, 10), pose(Vector3d(0, 0.5 + tip.reach + gap, 0)));
      manager.bind("out", body);
      manager.registerObject(wall.get(), "wall");
      manager.setJointTolerance("turn", {angle, 0});
      manager.setup();
      const CertifiedResult result = ask(manager, Eigen::Vector2d(0, 0.5), Eigen::Vector2d(0, 1.5));
      EXPECT_EQ(result.isFree(), lever > 1.5) << lever;
      EXPECT_EQ(result.certain, lever < 1.5) << lever;
    }
  }
}

TEST(Tube, ProofsOfRangesHoldForWhatTheJointMayBe) {
  // Beyond the joint's limit of 1 the tip meets a ball on the base.
  auto tree = std::make_shared<KinematicTree>("arm");
  for (const char* link : {"base", "arm"}) tree->addLink(link);
  tree->addJoint(Joint::revolute("joint", "base", "arm", Vector3d::UnitZ(), Eigen::Isometry3d::Identity(), 0, 1));
  ArticulatedCollisionManager manager(tree);
  const auto tip = ball(kRadius), stop = ball(kRadius);
  manager.bind("arm", tip, pose(Vector3d::UnitX()));
  manager.bind("base", stop, pose(Vector3d(std::cos(1.1), std::sin(1.1), 0)));
  AllowedCollisionMatrix checked;
  checked.disallow("base", "arm");
  manager.setAllowedCollisions(checked);
  manager.setLinkPairProofs(manager.classifyLinkPairs().proofs);
  const VectorXd q0 = VectorXd::Zero(1), q1 = VectorXd::Constant(1, 0.99);
  for (const double tolerance : {0.0, 0.05, 0.15}) {
    manager.setJointTolerances({tolerance, 0});
    manager.setup();
    EXPECT_EQ(ask(manager, q0, q1).isFree(), tolerance < 0.1) << tolerance;
  }
}

TEST(Tube, BaseAndObjects) {
  OneTurn arm;
  const auto obstacle = ball(kRadius, Vector3d(1, 0.1, 0));
  arm.manager->registerObject(obstacle.get(), "ball");
  const double gap = 0.1 - 2 * kRadius;
  const auto expect = [&](bool free) { EXPECT_EQ(arm.turn(0, 0).isFree(), free); };
  for (const double part : {0.99, 1.01}) {
    const bool free = part < 1;
    arm.manager->setBaseTolerance({part * gap, 0, Vector3d::Zero()});
    expect(free);
    arm.manager->setBaseTolerance({0, part * gap / (1 + kRadius), Vector3d::Zero()});
    expect(free);
    arm.manager->setBaseTolerance({0, part * gap / (9 + kRadius), Vector3d(-8, 0, 0)});
    expect(free);
    arm.manager->setBaseTolerance({});
    arm.manager->setObjectTolerance("ball", {part * gap, 0, Vector3d::Zero()});
    expect(free);
    // From the pivot, the farthest corner of the ball's box counts.
    const double far = std::sqrt(std::pow(1 + kRadius, 2) + 2 * std::pow(kRadius, 2));
    arm.manager->setObjectTolerance("ball", {0, (free ? 0.999 : 1.01) * gap / far, Vector3d(1, 0, 0)});
    expect(free);
    arm.manager->setObjectTolerance("ball", {});
  }
  // They add up.
  arm.manager->setBaseTolerance({0.4 * gap, 0, Vector3d::Zero()});
  arm.manager->setObjectTolerance("ball", {0.4 * gap, 0, Vector3d::Zero()});
  expect(true);
  arm.manager->setJointTolerances({0.3 * gap, 0});
  expect(false);
  // An object's tolerance goes with it.
  arm.manager->setJointTolerances({});
  arm.manager->setObjectTolerance("ball", {0.9 * gap, 0, Vector3d::Zero()});
  expect(false);
  arm.manager->unregisterObject(obstacle.get());
  arm.manager->registerObject(obstacle.get(), "ball");
  expect(true);
}

TEST(Tube, WhatDoesNotKnowTolerancesRefusesAndCertificatesStateThem) {
  OneTurn arm;
  const auto obstacle = ball(kRadius, Vector3d(1.1, 0, 0));
  arm.manager->registerObject(obstacle.get(), "ball");
  arm.manager->setJointTolerances({0.01, 0});
  arm.manager->setup();
  const VectorXd q = VectorXd::Zero(1);
  CertifiedRequest redon, certificate;
  redon.method = Method::redon2004;
  certificate.certificate = true;
  EXPECT_THROW(ask(*arm.manager, q, q, redon), std::invalid_argument);
  const CertifiedResult proven = ask(*arm.manager, q, q, certificate);
  ASSERT_TRUE(proven.isFree() && proven.certificate && *proven.certificate);
  EXPECT_NE(proven.certificate->world->find("tolerance variable"), std::string::npos);
}

TEST(Tube, BadTolerancesChangeNothing) {
  OneTurn arm;
  const auto obstacle = ball(kRadius, Vector3d(1, 0.1, 0));
  arm.manager->registerObject(obstacle.get(), "ball");
  arm.manager->setJointTolerance("joint", {0.01, 0});
  ArticulatedCollisionManager& m = *arm.manager;
  for (const double bad : {-1e-3, std::nan(""), HUGE_VAL}) {
    EXPECT_THROW(m.setJointTolerances({bad, 0}), std::invalid_argument);
    EXPECT_THROW(m.setJointTolerances({0, bad}), std::invalid_argument);
    EXPECT_THROW(m.setJointTolerance("joint", {bad, 0}), std::invalid_argument);
    EXPECT_THROW(m.setBaseTolerance({bad, 0, Vector3d::Zero()}), std::invalid_argument);
    EXPECT_THROW(m.setObjectTolerance("ball", {0, bad, Vector3d::Zero()}), std::invalid_argument);
    EXPECT_THROW(m.setObjectTolerance("ball", {0, 0, Vector3d(0, 0, std::nan(""))}), std::invalid_argument);
  }
  EXPECT_THROW(m.setJointTolerance("joint", {0, 0.01}), std::invalid_argument) << "it does not slide";
  EXPECT_THROW(m.setJointTolerance("jiont", {0.01, 0}), std::invalid_argument);
  EXPECT_THROW(m.setObjectTolerance("arm", {0.01, 0, Vector3d::Zero()}), std::invalid_argument) << "a link";
  EXPECT_THROW(m.setObjectTolerance("bell", {0.01, 0, Vector3d::Zero()}), std::invalid_argument);
  EXPECT_TRUE(arm.turn(0, 0).isFree());
  arm.manager->setBaseTolerance({0.075, 0, Vector3d::Zero()});
  EXPECT_FALSE(arm.turn(0, 0).isFree()) << "the joint's 0.01 still counts";
}

/// A cart along x beside a ball that moves by itself.
struct CartAndPerson {
  Cart cart;
  std::shared_ptr<fcl::CollisionObjectd> person;
  explicit CartAndPerson(const Vector3d& at, const ObjectSpeed& speed) : person(ball(0.1, at)) {
    cart.manager->registerObject(person, "person");
    cart.manager->setObjectSpeed("person", speed);
    cart.manager->setup();
  }
};

TEST(Speed, ABallComesTowardsASlide) {
  // The cart's middle is at (t, 0). They may meet where its distance from (0, y) is 0.2 + v max(0, t - s).
  for (const double since : {0.0, 0.25, -0.25, 2.0}) {
    const double v = 0.8, y = 0.9;
    CartAndPerson scene(Vector3d(0, y, 0), {v, since});
    const CertifiedResult result = scene.cart.run(0, 1);
    double touch = 2;
    for (int k = 0; k <= 1000000 && touch > 1; ++k) {
      const double t = 1e-6 * k;
      if (std::hypot(t, y) <= 0.2 + v * std::max(0.0, t - since)) touch = t;
    }
    if (touch > 1) {
      EXPECT_TRUE(result.isFree()) << since;
      continue;
    }
    EXPECT_EQ(result.status, Status::contact);
    // It goes straight for the cart, no faster than it may.
    ASSERT_TRUE(result.certain) << since;
    const CertifiedContact& contact = result.contacts.at(0);
    const Vector3d way = contact.deviation2.translation();
    EXPECT_LE(way.norm(), v * (contact.t_upper - since));
    EXPECT_LE((Vector3d(0, y, 0) + way - Vector3d(contact.q_witness[0], 0, 0)).norm(), 0.2 + kRounding);
    EXPECT_GE(contact.t_upper, touch - 1e-5);
    EXPECT_LE(contact.t_upper, touch + 2e-3);
    EXPECT_LE(result.t_lower, touch);
    EXPECT_GE(result.t_lower, touch - 1e-5);
  }
}

TEST(Speed, ATrajectoryHasItsOwnTime) {
  // A cart that waits for 3 s, from 100 s on: the ball needs (1 - 0.2) / 0.5 = 1.6 s.
  CartAndPerson scene(Vector3d(0, 1, 0), {0.5, 0});
  const VectorXd here = VectorXd::Zero(1), there = VectorXd::Constant(1, 1e-3);
  const JointTrajectory slow = JointTrajectory::linear(*scene.cart.tree, {100, 101, 103}, {here, there, here});
  CertifiedRequest request;
  request.tolerance_time = 1e-4;
  const CertifiedResult result = scene.cart.manager->continuousCollide(slow, request);
  ASSERT_EQ(result.status, Status::contact);
  EXPECT_NEAR(result.t_lower, 101.6, 1e-3);
  scene.cart.manager->setObjectSpeed("person", {0.5, 1.5});
  scene.cart.manager->setup();
  EXPECT_TRUE(scene.cart.manager->continuousCollide(slow, request).isFree());
  const JointTrajectory quick = JointTrajectory::linear(*scene.cart.tree, {100, 100.1, 101.5}, {here, there, here});
  scene.cart.manager->setObjectSpeed("person", {0.5, 0});
  scene.cart.manager->setup();
  EXPECT_TRUE(scene.cart.manager->continuousCollide(quick, request).isFree());
  // The distance over all ways that the person may take, and one of these that comes as near.
  const Clearance clearance = scene.cart.manager->clearance(quick);
  EXPECT_LE(clearance.lower, 1 - 0.2 - 0.5 * 1.5);
  EXPECT_GE(clearance.lower, 1 - 0.2 - 0.5 * 1.5 - 1e-3);
  EXPECT_TRUE(clearance.within_tolerance);
  EXPECT_GE(clearance.upper, 1 - 0.2 - 0.5 * 1.5);
  EXPECT_LE(clearance.upper, 1.06 * (1 - 0.2 - 0.5 * 1.5));
}

TEST(Speed, CertificatesStateItWithTheTrajectorysTime) {
  CartAndPerson scene(Vector3d(0, 1, 0), {0.5, 0.25});
  const VectorXd here = VectorXd::Zero(1), there = VectorXd::Constant(1, 1e-3);
  const JointTrajectory way = JointTrajectory::linear(*scene.cart.tree, {0.1, 0.4, 1.5}, {here, there, here});
  CertifiedRequest request;
  request.certificate = true;
  const CertifiedResult free = scene.cart.manager->continuousCollide(way, request);
  ASSERT_TRUE(free.isFree() && free.certificate && *free.certificate) << free.certificate->missing;
  EXPECT_NE(free.certificate->world->find("\ntolerance speed person 0x1p-1 0x1p-2\n"), std::string::npos);
  // A clock is rounded up: the double that is nearest to 1.5 - 0.1 is 0x1.6666666666666p+0, which is less.
  for (const char* clock :
       {"\nclock 0x0p+0 0x1.3333333333334p-2\n", "\nclock 0x1.3333333333334p-2 0x1.6666666666667p+0\n"})
    EXPECT_NE(free.certificate->motion.find(clock), std::string::npos) << free.certificate->motion;
}

TEST(Speed, WhatIsRefused) {
  CartAndPerson scene(Vector3d(0, 1, 0), {1.5, 0});
  ArticulatedCollisionManager& manager = *scene.cart.manager;
  EXPECT_THROW(manager.setObjectSpeed("cart", {1, 0}), std::invalid_argument);
  EXPECT_THROW(manager.setObjectSpeed("persona", {1, 0}), std::invalid_argument);
  EXPECT_THROW(manager.setObjectSpeed("person", {-1, 0}), std::invalid_argument);
  EXPECT_THROW(manager.setObjectSpeed("person", {1, std::nan("")}), std::invalid_argument);
  EXPECT_NE(manager.describeTolerances().find("person"), std::string::npos);
  CertifiedRequest request;
  request.method = Method::redon2004;
  EXPECT_THROW(scene.cart.run(0, 1, request), std::invalid_argument);
  // Speeds go with their object, and stay with its name where it is replaced.
  const auto other = ball(0.1, Vector3d(0, 0.9, 0));
  manager.replaceObject("person", other);
  manager.setup();
  EXPECT_FALSE(scene.cart.run(0, 1).isFree());
  EXPECT_THROW(manager.replaceObject("nobody", ball(1)), std::invalid_argument);
  manager.unregisterObject(other);
  manager.registerObject(ball(0.1, Vector3d(0, 0.9, 0)), "person");
  manager.setup();
  EXPECT_TRUE(scene.cart.run(0, 0.5).isFree());
}

}  // namespace
}  // namespace tube_test
}  // namespace fcl_artic
