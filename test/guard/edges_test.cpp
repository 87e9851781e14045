// SPDX-License-Identifier: BSD-3-Clause
//
// A guard where numbers end: times of clocks that began in 1970, ways shorter than a time's last bit, budgets that are
// spent between two pieces, other robots, and errors.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include <fcl/geometry/shape/box.h>

#include "../query/arms.h"
#include "../support/random_placing.h"
#include "fcl_artic/guard.h"

namespace fcl_artic {
namespace guard_edges_test {
namespace {

using namespace fcl_artic::test;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kSince1970 = 1.7e9;  // s: doubles are 2.4e-7 apart there

GuardOptions optionsOf(int dof) {
  GuardOptions options;
  options.deceleration = VectorXd::Constant(dof, 2);
  options.period = 0.05;
  return options;
}

/// A cart of radius 0.1 that runs along x, and a ball of that radius.
std::shared_ptr<const LiveScene::Snapshot> sceneOf(const Cart& cart, const Vector3d& ball_at, double seen_at = 0) {
  cart.manager->clear();
  cart.manager->bind("cart", cart.body.get());
  cart.manager->registerObject(ball(0.1, ball_at), "ball");
  cart.manager->setup();
  return LiveScene(cart.manager->copy(), seen_at).latest();
}

TEST(GuardEdges, AWayShorterThanATimesLastBitIsChecked) {
  const Cart cart;
  const double begin = kSince1970;
  const auto trajectory =
      JointTrajectory::linear(*cart.tree, {begin, begin + 5}, {VectorXd::Zero(1), VectorXd::Constant(1, 5)});
  Guard guard(cart.tree, optionsOf(1));
  guard.follow(trajectory);
  GuardAnswer answer;
  for (const double speed : {1e-1, 1e-3, 3e-4, 1e-6, 1e-30, 0x1p-1074}) {
    guard.ask(*sceneOf(cart, Vector3d(1.15, 0, 0), kSince1970), kSince1970, begin + 1, speed, answer);
    EXPECT_FALSE(answer.certified) << "it moves at " << speed << ", 5 cm deep in the ball";
    EXPECT_EQ(answer.speed, 0);
  }
  guard.ask(*sceneOf(cart, Vector3d(1.15, 0, 0), kSince1970), kSince1970, begin + 1, 0, answer);
  EXPECT_TRUE(answer.certified) << "it stands";
}

TEST(GuardEdges, AnAnswerCountsNoLongerThanItIsCertified) {
  const Cart cart;
  const auto scene = sceneOf(cart, Vector3d(9, 0, 0), kSince1970);
  GuardOptions options = optionsOf(1);
  options.most_age = 1e3;
  Random random(1);
  for (int n = 0; n < 200; ++n) {
    options.period = random.uniform(1e-3, 1e-2);
    options.reaction = random.oneIn(2) ? 0 : random.uniform(0, 1e-2);
    Guard guard(cart.tree, options);
    guard.follow(JointTrajectory::linear(*cart.tree, {0, 5}, {VectorXd::Zero(1), VectorXd::Constant(1, 5)}));
    GuardAnswer answer;
    const double now = kSince1970 + random.uniform(0, 100);
    guard.ask(*scene, now, 1, 1, answer);
    ASSERT_TRUE(answer.certified);
    EXPECT_LE(answer.valid_until - now, options.reaction + options.period) << n;
    EXPECT_GE(answer.valid_until - now, options.reaction + options.period - 3e-7) << n;
  }
}

TEST(GuardEdges, AnAnswerMayCountBeforeTheReactionIsOver) {
  // The cart stands, 0.24 m before the ball. If it goes at f at once, it does so for all of 0.1 + 0.05 s.
  const Cart cart;
  GuardOptions options = optionsOf(1);
  options.reaction = 0.1;
  options.tries = 20;
  Guard guard(cart.tree, options);
  guard.follow(JointTrajectory::linear(*cart.tree, {0, 5}, {VectorXd::Zero(1), VectorXd::Constant(1, 5)}));
  GuardAnswer answer;
  guard.ask(*sceneOf(cart, Vector3d(1 + 0.2 + 0.24, 0, 0)), 0, 1, 0, answer);
  const double f = answer.speed;
  EXPECT_TRUE(answer.certified);
  EXPECT_LE(0.15 * f + f * f / 4, 0.24);
  EXPECT_GE(0.15 * f + f * f / 4, 0.24 - 1e-5);
  EXPECT_GE(answer.stop_at, 1 + 0.15 * f + f * f / 4);
}

TEST(GuardEdges, ABudgetThatEndsBetweenTwoPiecesIsNotFree) {
  // The cart meets the ball in the fourth of six pieces, at 3.3.
  const Cart cart;
  std::vector<double> times;
  std::vector<VectorXd> waypoints;
  for (int k = 0; k <= 6; ++k) {
    times.push_back(k);
    waypoints.push_back(VectorXd::Constant(1, k));
  }
  const auto trajectory = JointTrajectory::linear(*cart.tree, times, waypoints);
  cart.manager->clear();
  // Boxes beside the track: each pair is a question of its own.
  const auto box = std::make_shared<fcl::Boxd>(0.1, 0.1, 0.1);
  cart.manager->bind("cart", object(std::make_shared<fcl::Boxd>(0.2, 0.2, 0.2)));
  for (int k = 0; k < 60; ++k) cart.manager->registerObject(object(box, pose({0.1 * k, 0.171, 0}, M_PI / 4)));
  cart.manager->registerObject(ball(0.1, Vector3d(3.5, 0, 0)), "ball");
  cart.manager->setup();
  const auto scene = LiveScene(cart.manager->copy()).latest();
  GuardOptions options = optionsOf(1);
  int spent = 0, between = 0;
  for (std::uint64_t budget = 1; budget <= 400; ++budget) {
    options.work_budget = budget;
    Guard guard(cart.tree, options);
    guard.follow(trajectory);
    AheadAnswer answer;
    guard.lookAhead(*scene, 0, 0.5, answer);
    EXPECT_FALSE(answer.all_free) << budget;
    EXPECT_LE(answer.free_until, 3.3 + 1e-9) << budget;
    EXPECT_LE(answer.run_until, 3.05 + 1e-9) << budget;
    spent += answer.reason == GuardReason::budget;
    between += answer.reason == GuardReason::budget && answer.free_until == std::floor(answer.free_until);
  }
  EXPECT_GT(spent, 10);
  EXPECT_GT(between, 0);

  // A stop from full speed takes 5 m. If the budget ends on the way, what was proven by then is enough for less.
  options.deceleration = VectorXd::Constant(1, 0.1);
  int slower = 0;
  for (std::uint64_t budget = 1; budget <= 400; ++budget) {
    options.work_budget = budget;
    Guard guard(cart.tree, options);
    guard.follow(trajectory);
    GuardAnswer answer;
    guard.ask(*scene, 0, 0.5, 0, answer);
    EXPECT_LT(answer.stop_at, 3.3) << budget;
    slower += answer.reason == GuardReason::budget && answer.certified && answer.speed > 0;
  }
  EXPECT_GT(slower, 10);
}

TEST(GuardEdges, BrakingIsThatOfAllOfTheRange) {
  // The first piece takes two of a time's last bits, and is fast at its begin only: x = 1e-9 (1 - (1 - u)^5).
  const Cart cart;
  const double bit = 0x1p-22;
  for (const int bits : {1, 2, 3, 5, 8, 16, 31}) {
    const double begin = kSince1970, middle = begin + bits * bit;
    ASSERT_EQ(middle - begin, bits * bit);
    const double far = 1e-6, h = middle - begin;
    Eigen::MatrixXd fast(1, 6), slow(1, 2);
    const double binomial[] = {5, -10, 10, -5, 1};
    fast(0, 0) = 0;
    for (int k = 1; k <= 5; ++k) fast(0, k) = far * binomial[k - 1] / std::pow(h, k);
    slow << far, 1e-3;
    const auto trajectory = JointTrajectory::piecewise(*cart.tree, {begin, middle, begin + 5}, {fast, slow});
    Guard guard(cart.tree, optionsOf(1));
    guard.follow(trajectory);
    GuardAnswer answer;
    guard.ask(*sceneOf(cart, Vector3d(9, 0, 0), begin), begin, begin, 1, answer);
    EXPECT_LE(answer.braking, 2 / (5 * far / h)) << bits << ": it begins at 5 far / h";
  }
}

TEST(GuardEdges, BrakingOfABallJointHoldsAboutAnyAxis) {
  // It turns by w(t) = (t, t, t) rad: at sqrt 3 rad/s, later perhaps about one of the axes.
  const auto tree = std::make_shared<KinematicTree>("ball");
  for (const char* link : {"base", "hand"}) tree->addLink(link);
  tree->addJoint(makeJoint("joint", JointType::spherical, "base", "hand", Vector3d::UnitZ()));
  ArticulatedCollisionManager manager(tree);
  manager.bind("hand", ball(0.1), pose({0.5, 0, 0}));
  const LiveScene live(std::move(manager));
  Eigen::MatrixXd turn = Eigen::MatrixXd::Zero(4, 2);
  turn(3, 0) = 1;
  turn.col(1).head<3>().setOnes();
  Guard guard(tree, optionsOf(4));
  guard.follow(JointTrajectory::piecewise(*tree, {0, 1}, {turn}));
  GuardAnswer answer;
  guard.ask(*live.latest(), 0, 0.2, 1, answer);
  EXPECT_LE(answer.braking, 2 / std::sqrt(3));
  EXPECT_GE(answer.braking, 2 / std::sqrt(3) - 1e-9);
}

TEST(GuardEdges, ASceneOfAnotherRobotIsRefused) {
  const Cart cart;
  // The same joint, other links: motions of both are the same.
  const auto other = sliderTree({"rail", "cart"});
  for (int k = 0; k < 50; ++k) {
    other->addLink("tool" + std::to_string(k));
    other->addJoint(makeJoint("mount" + std::to_string(k), JointType::fixed,
                              k ? "tool" + std::to_string(k - 1) : "cart", "tool" + std::to_string(k),
                              Vector3d::UnitX(), pose({0.1, 0, 0})));
  }
  ArticulatedCollisionManager manager(other);
  manager.bind("tool49", ball(0.1));
  const auto scene = LiveScene(std::move(manager)).latest();
  Guard guard(cart.tree, optionsOf(1));
  guard.follow(JointTrajectory::linear(*cart.tree, {0, 5}, {VectorXd::Zero(1), VectorXd::Constant(1, 5)}));
  GuardAnswer answer;
  AheadAnswer ahead;
  EXPECT_THROW(guard.ask(*scene, 0, 1, 1, answer), std::invalid_argument);
  EXPECT_THROW(guard.lookAhead(*scene, 0, 1, ahead), std::invalid_argument);
}

TEST(GuardEdges, AnErrorClaimsNothing) {
  const Cart cart;
  Guard guard(cart.tree, optionsOf(1));
  guard.follow(JointTrajectory::linear(*cart.tree, {0, 5}, {VectorXd::Zero(1), VectorXd::Constant(1, 5)}));
  const auto scene = sceneOf(cart, Vector3d(9, 0, 0));
  GuardAnswer answer;
  AheadAnswer ahead;
  guard.ask(*scene, 0, 1, 1, answer);
  guard.lookAhead(*scene, 0, 1, ahead);
  ASSERT_TRUE(answer.certified && ahead.all_free);
  EXPECT_THROW(guard.ask(*scene, 0, 1, 1.5, answer), std::invalid_argument);
  EXPECT_THROW(guard.lookAhead(*scene, std::nan(""), 1, ahead), std::invalid_argument);
  EXPECT_FALSE(answer.certified);
  EXPECT_EQ(answer.speed, 0);
  EXPECT_FALSE(ahead.all_free);
  EXPECT_LT(ahead.run_until, 0);
}

TEST(GuardEdges, SeparationCountsHowFarASlideStrays) {
  // A turn after a slide before a turn: the slide's tolerance makes the first turn's lever longer.
  auto tree = std::make_shared<KinematicTree>("robot");
  for (const char* link : {"base", "a", "b"}) tree->addLink(link);
  tree->addJoint(makeJoint("turn", JointType::revolute, "base", "a", Vector3d::UnitZ()));
  tree->addJoint(makeJoint("slide", JointType::prismatic, "a", "b", Vector3d::UnitX()));
  ArticulatedCollisionManager manager(tree);
  manager.bind("b", ball(0.1));
  manager.setJointTolerance("turn", {0.1, 0});
  manager.setJointTolerance("slide", {0, 0.5});
  const LiveScene live(std::move(manager));
  Guard guard(tree, optionsOf(2));
  guard.follow(JointTrajectory::linear(*tree, {0, 5}, {VectorXd::Zero(2), VectorXd::Ones(2)}));
  GuardAnswer answer;
  guard.ask(*live.latest(), 0, 1, 1, answer);
  EXPECT_GE(answer.separation.robot, 0.5 + 0.1 * (1 + 0.5 + 0.1));
}

}  // namespace
}  // namespace guard_edges_test
}  // namespace fcl_artic
