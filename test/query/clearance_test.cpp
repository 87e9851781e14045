// SPDX-License-Identifier: BSD-3-Clause
//
// The smallest distance over a whole motion.
#include <cmath>
#include <limits>

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/math/motion/translation_motion.h>
#include <fcl/narrowphase/distance.h>

#include "expect_time.h"

namespace clearance_test {

using namespace fcl_artic;
using namespace fcl_artic::test;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

JointMotion drive(const Cart& cart, double from, double to) {
  return JointMotion::linear(*cart.tree, VectorXd::Constant(1, from), VectorXd::Constant(1, to));
}

testing::AssertionResult holds(const Clearance& c, double distance, const ClearanceRequest& request = {}) {
  const double tolerance = std::max(request.tolerance_relative * c.upper, request.tolerance_distance);
  if (c.lower <= distance + 1e-12 && c.upper >= distance - 1e-12 && c.upper - c.lower <= tolerance &&
      c.within_tolerance) {
    return testing::AssertionSuccess();
  }
  return testing::AssertionFailure() << "[" << c.lower << ", " << c.upper << "] instead of " << distance;
}

/// The cart's ball of 0.1 runs along x; a ball of 0.1 stands at (1, 0.5).
struct Way : Cart {
  std::shared_ptr<fcl::CollisionObjectd> post = ball(0.1, {1, 0.5, 0});
  Way() {
    manager->registerObject(post.get(), "post");
    manager->setup();
  }
  static double distance(double x) { return std::hypot(x - 1, 0.5) - 0.2; }
};

}  // namespace

TEST(Clearance, BallPassesABall) {
  Way way;
  const Clearance c = way.manager->clearance(drive(way, 0, 2));
  EXPECT_TRUE(holds(c, 0.3));
  EXPECT_EQ(c.body1.name, "cart");
  EXPECT_EQ(c.body2.name, "post");
  EXPECT_LE(way.distance(2 * c.time), c.upper + 1e-12);
  ClearanceRequest fine;
  fine.tolerance_relative = 0;
  fine.tolerance_distance = 1e-9;
  EXPECT_TRUE(holds(way.manager->clearance(drive(way, 0, 2), fine), 0.3, fine));
  // Nearest at an end: as it starts, as it stops.
  EXPECT_TRUE(holds(way.manager->clearance(drive(way, 1.5, 2)), way.distance(1.5)));
  EXPECT_TRUE(holds(way.manager->clearance(drive(way, 0, 0.6)), way.distance(0.6)));
  EXPECT_TRUE(holds(way.manager->clearance(drive(way, 0.25, 0.25)), way.distance(0.25)));
}

TEST(Clearance, OfWhatTouchesIsNothing) {
  Way way;
  way.post->setTransform(pose({1, 0.1, 0}));
  way.manager->update();
  const Clearance c = way.manager->clearance(drive(way, 0, 2));
  EXPECT_EQ(c.lower, 0);
  EXPECT_EQ(c.upper, 0);
  EXPECT_TRUE(c.within_tolerance);
  EXPECT_LE(std::hypot(2 * c.time - 1, 0.1), 0.2);
  EXPECT_EQ(c.body2.name, "post");
}

// Balls that come as near as 1e-7: below the tolerance, and nothing more is promised.
TEST(Clearance, BelowTheTolerance) {
  Way way;
  way.post->setTransform(pose({1, 0.2 + 1e-7, 0}));
  way.manager->update();
  EXPECT_TRUE(holds(way.manager->clearance(drive(way, 0, 2)), 1e-7));
}

TEST(Clearance, BeyondWhatIsOfInterest) {
  Way way;
  ClearanceRequest request;
  request.most = 0.25;
  const Clearance c = way.manager->clearance(drive(way, 0, 2), request);
  EXPECT_EQ(c.lower, 0.25);
  EXPECT_EQ(c.upper, std::numeric_limits<double>::infinity());
  EXPECT_TRUE(c.within_tolerance);
  request.check_scene = false;  // the cart alone
  EXPECT_EQ(way.manager->clearance(drive(way, 0, 2), request).lower, 0.25);
}

TEST(Clearance, LooksAtNoMargins) {
  Way way;
  way.manager->setMargin("post", 0.4);
  way.manager->setMargin("cart", "post", 0.2);
  way.manager->setup();
  EXPECT_TRUE(holds(way.manager->clearance(drive(way, 0, 2)), 0.3));
}

// A base on its floor: the pair is said apart, and the answer is of the others.
TEST(Clearance, LeavesOutWhatTouchesAtTheBegin) {
  Way way;
  const auto floor = object(std::make_shared<fcl::Boxd>(9, 9, 1), pose({0, 0, -0.59}));
  way.manager->registerObject(floor.get(), "floor");
  way.manager->setup();
  ClearanceRequest request;
  EXPECT_EQ(way.manager->clearance(drive(way, 0, 2), request).upper, 0);
  request.ignore_initial_contact = true;
  const auto expectIgnored = [&](const Clearance& c) {
    EXPECT_TRUE(holds(c, 0.3));
    EXPECT_EQ(c.body2.name, "post");
    ASSERT_EQ(c.ignored_initial_contacts.size(), 1u);
    EXPECT_EQ(c.ignored_initial_contacts[0].first.name, "floor");
    EXPECT_EQ(c.ignored_initial_contacts[0].second.name, "cart");
  };
  expectIgnored(way.manager->clearance(drive(way, 0, 2), request));
  const auto trajectory =
      JointTrajectory::linear(*way.tree, {3, 4, 6}, {VectorXd::Zero(1), VectorXd::Ones(1), VectorXd::Constant(1, 2)});
  expectIgnored(way.manager->clearance(trajectory, request));
  // A pair within its margin at the begin is ignored too; a pair farther apart isn't.
  floor->setTransform(pose({0, 0, -0.65}));
  way.manager->update();
  EXPECT_TRUE(holds(way.manager->clearance(drive(way, 0, 2), request), 0.05));
  request.ignored_margin = 0.1;
  expectIgnored(way.manager->clearance(drive(way, 0, 2), request));
  way.manager->setMargin("cart", "floor", 0);
  way.manager->setup();
  EXPECT_TRUE(holds(way.manager->clearance(drive(way, 0, 2), request), 0.05));
  // Nothing is proven where the budget ends before it is known which pairs these are.
  request.work_budget = 1;
  EXPECT_EQ(way.manager->clearance(drive(way, 0, 2), request).lower, 0);
  request.ignored_margin = -1;
  EXPECT_THROW((void)way.manager->clearance(drive(way, 0, 2), request), std::invalid_argument);
}

// Two links of one pair, of which the numbers begin after those of obstacles, with and without these.
TEST(Clearance, LeavesOutLinksThatTouchAtTheBegin) {
  const auto tree = sliderTree({"base", "between", "cart"});
  ArticulatedCollisionManager manager(tree);
  const auto still = ball(0.1), moving = ball(0.1), post = ball(0.1, {1, 0.5, 0});
  manager.bind("base", still.get());
  manager.bind("cart", moving.get(), pose({0.1, 0, 0}));
  manager.registerObject(post.get(), "post");
  manager.setup();
  const JointMotion motion = JointMotion::linear(*tree, Eigen::Vector2d(0, 0), Eigen::Vector2d(2, 0));
  ClearanceRequest request;
  request.ignore_initial_contact = true;
  EXPECT_TRUE(holds(manager.clearance(motion, request), 0.3));
  request.check_scene = false;
  EXPECT_EQ(manager.clearance(motion, request).lower, request.most);
  EXPECT_EQ(manager.clearance(motion, request).ignored_initial_contacts.size(), 1u);
}

// Both move: the ball of 0.2 from x = 2 to 1, the cart from 0 to 0.4.
TEST(Clearance, OfAMovingObstacle) {
  Cart cart;
  const Eigen::Isometry3d from = pose({2, 0, 0}), to = pose({1, 0, 0});
  fcl::ContinuousCollisionObjectd bowl(std::make_shared<fcl::Sphered>(0.2),
                                       std::make_shared<fcl::TranslationMotiond>(from, to));
  cart.manager->registerObject(&bowl, "bowl");
  cart.manager->setup();
  const Clearance c = cart.manager->clearance(drive(cart, 0, 0.4));
  EXPECT_TRUE(holds(c, 0.3));
  EXPECT_EQ(c.body2.moving, &bowl);
}

TEST(Clearance, OfATrajectoryInItsOwnTime) {
  Way way;
  std::vector<VectorXd> waypoints;
  for (const double x : {-1.0, 0.0, 1.5, 3.0}) waypoints.push_back(VectorXd::Constant(1, x));
  const JointTrajectory trajectory = JointTrajectory::linear(*way.tree, {100, 110, 130, 131}, waypoints);
  const Clearance c = way.manager->clearance(trajectory);
  EXPECT_TRUE(holds(c, 0.3));
  EXPECT_GE(c.time, 110);
  EXPECT_LE(c.time, 130);
  EXPECT_LE(way.distance((c.time - 110) / 20 * 1.5), c.upper + 1e-12);
}

TEST(Clearance, OfTwoLinks) {
  auto tree = std::make_shared<KinematicTree>("crane");
  for (const char* name : {"rail", "cart", "mast", "hook"}) tree->addLink(name);
  tree->addJoint(makeJoint("slide", JointType::prismatic, "rail", "cart", Vector3d::UnitX()));
  tree->addJoint(makeJoint("turn", JointType::revolute, "cart", "mast", Vector3d::UnitZ()));
  tree->addJoint(makeJoint("drop", JointType::prismatic, "mast", "hook", -Vector3d::UnitX()));
  ArticulatedCollisionManager manager(tree);
  const auto foot = ball(0.1), weight = ball(0.1);
  manager.bind("cart", foot.get());
  manager.bind("hook", weight.get(), pose({1, 0, 0}));
  manager.setup();
  const JointMotion motion = JointMotion::linear(*tree, Vector3d(0, 0, 0), Vector3d(3, 2, 0.75));
  EXPECT_TRUE(holds(manager.clearance(motion), 0.05));
  ClearanceRequest request;
  request.check_self = false;
  EXPECT_EQ(manager.clearance(motion, request).lower, request.most);
}

TEST(Clearance, BudgetEndsItWithWhatIsProven) {
  Way way;
  ClearanceRequest request;
  request.tolerance_relative = 0;
  request.tolerance_distance = 1e-9;
  const std::uint64_t all = [&] {
    const QueryStatistics s = way.manager->clearance(drive(way, 0, 2), request).statistics;
    return s.node_tests + s.leaf_tests;
  }();
  ASSERT_GT(all, 10u);
  int cut = 0;
  for (std::uint64_t budget = 1; budget < all; budget += 1 + all / 20) {
    request.work_budget = budget;
    const Clearance c = way.manager->clearance(drive(way, 0, 2), request);
    EXPECT_LE(c.lower, 0.3 + 1e-12);
    EXPECT_GE(c.upper, 0.3 - 1e-12);
    cut += !c.within_tolerance;
  }
  EXPECT_GT(cut, 5);
}

// Arms of two joints with a box and a cylinder among boxes: FCL's distance along the way.
TEST(Clearance, RandomArmsAgainstDenseSampling) {
  std::mt19937_64 random(9);
  const auto uniform = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); };
  const auto vector = [&](double size) {
    return Vector3d(uniform(-size, size), uniform(-size, size), uniform(-size, size));
  };
  constexpr int kSamples = 200;
  constexpr double kFclError = 1e-4;  // its search ends early at times; 2e-5 was seen
  int apart = 0, touching = 0;
  for (int n = 0; n < 100; ++n) {
    auto tree = std::make_shared<KinematicTree>("arm");
    for (const char* name : {"base", "upper", "lower"}) tree->addLink(name);
    tree->addJoint(makeJoint("shoulder", JointType::revolute, "base", "upper", vector(1)));
    tree->addJoint(makeJoint("elbow", JointType::revolute, "upper", "lower", vector(1), pose({0.6, 0, 0})));
    ArticulatedCollisionManager manager(tree);
    const auto rod = object(std::make_shared<fcl::Boxd>(0.5, 0.1, 0.1)),
               hand = object(std::make_shared<fcl::Cylinderd>(0.1, 0.3));
    const Eigen::Isometry3d offset = pose({0.3, 0, 0});
    manager.bind("upper", rod.get(), offset);
    manager.bind("lower", hand.get(), offset);
    std::vector<std::shared_ptr<fcl::CollisionObjectd>> obstacles;
    for (int o = 0; o < 3; ++o) {
      const Vector3d side(uniform(0.1, 0.5), uniform(0.1, 0.5), uniform(0.1, 0.5));
      obstacles.push_back(object(std::make_shared<fcl::Boxd>(side), pose(vector(1.4), uniform(-3, 3), vector(1))));
      manager.registerObject(obstacles.back().get());
    }
    manager.allow("upper", "lower");  // neighbours that touch at times
    manager.setup();
    const Eigen::Vector2d q0(uniform(-3, 3), uniform(-3, 3)), q1(uniform(-3, 3), uniform(-3, 3));
    const auto distance = [&](double t) {
      std::vector<Eigen::Isometry3d> M;
      tree->forwardKinematics(q0 + t * (q1 - q0), M);
      double least = 1e9;
      for (const auto& obstacle : obstacles) {
        for (const auto& [link, body] : {std::pair(std::size_t{1}, rod), std::pair(std::size_t{2}, hand)}) {
          fcl::DistanceResultd result;
          const double d =
              fcl::distance(body->collisionGeometry().get(), M[link] * offset, obstacle->collisionGeometry().get(),
                            obstacle->getTransform(), fcl::DistanceRequestd(), result);
          least = std::min(least, std::max(d, 0.0));
        }
      }
      return least;
    };
    const Clearance c = manager.clearance(JointMotion::linear(*tree, q0, q1));
    SCOPED_TRACE(n);
    EXPECT_TRUE(c.within_tolerance);
    double least = 1e9;
    for (int i = 0; i <= kSamples; ++i) least = std::min(least, distance(static_cast<double>(i) / kSamples));
    EXPECT_GE(least, c.lower - kFclError);
    if (c.upper <= 1) EXPECT_LE(distance(c.time), c.upper + kFclError);
    // Between samples no point goes farther than its speed, |q'| times its reach.
    const double step = (q1 - q0).cwiseAbs().sum() * 1.2 / kSamples / 2;
    EXPECT_LE(least - step, c.upper);
    if (c.upper <= 1) EXPECT_LE(c.upper - c.lower, std::max(0.01 * c.upper, 1e-4));
    ++(c.upper > 0 ? apart : touching);
  }
  EXPECT_GT(apart, 20);
  EXPECT_GT(touching, 10);
}

TEST(Clearance, BadInputIsRefused) {
  Way way;
  const JointMotion motion = drive(way, 0, 2);
  const auto refused = [&](auto&& change) {
    ClearanceRequest request;
    change(request);
    try {
      (void)way.manager->clearance(motion, request);
    } catch (const std::invalid_argument& e) {
      return std::string(e.what());
    }
    return std::string("accepted");
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {-1.0, 1.0, nan}) {
    EXPECT_NE(refused([&](auto& r) { r.tolerance_relative = bad; }).find("tolerance_relative"), std::string::npos);
  }
  for (const double bad : {-1.0, 0.0, nan, 1 / 0.0}) {
    EXPECT_NE(refused([&](auto& r) { r.tolerance_distance = bad; }).find("tolerance_distance"), std::string::npos);
    EXPECT_NE(refused([&](auto& r) { r.most = bad; }).find("most"), std::string::npos);
  }
  way.manager->setMargin("post", 0.1);
  EXPECT_THROW(static_cast<void>(way.manager->clearance(motion)), std::logic_error);
}

}  // namespace clearance_test
