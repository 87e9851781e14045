// SPDX-License-Identifier: BSD-3-Clause
//
// Obstacles with FCL motions of their own, among times worked out by hand and random cases sampled densely.
#include <cmath>
#include <limits>

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/halfspace.h>
#include <fcl/math/motion/interp_motion.h>
#include <fcl/math/motion/spline_motion.h>
#include <fcl/math/motion/translation_motion.h>

#include "expect_time.h"
#include "fcl_artic/bounded_motion.h"

namespace moving_obstacle_test {

using namespace fcl_artic;
using namespace fcl_artic::test;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

using Moving = fcl::ContinuousCollisionObjectd;
using MovingPtr = std::shared_ptr<Moving>;
constexpr double kPi = 3.14159265358979323846;

MovingPtr slides(const std::shared_ptr<fcl::CollisionGeometryd>& geometry, const Isometry3d& from, const Vector3d& to) {
  Isometry3d end = from;
  end.translation() = to;
  return std::make_shared<Moving>(geometry, std::make_shared<fcl::TranslationMotiond>(from, end));
}
MovingPtr slides(double radius, const Vector3d& from, const Vector3d& to) {
  return slides(std::make_shared<fcl::Sphered>(radius), pose(from), to);
}
MovingPtr goes(const std::shared_ptr<fcl::CollisionGeometryd>& geometry, const Isometry3d& from, const Isometry3d& to) {
  return std::make_shared<Moving>(
      geometry, std::make_shared<fcl::InterpMotion<double>>(from.linear(), from.translation(), to.linear(),
                                                            to.translation(), Vector3d(0, 0, 0)));
}

/// Members that FCL asks of a motion and nobody needs here.
struct PlainMotion : fcl::MotionBased {
  bool integrate(double) const override { return true; }
  double computeMotionBound(const fcl::BVMotionBoundVisitor<double>&) const override { return 0; }
  double computeMotionBound(const fcl::TriangleMotionBoundVisitor<double>&) const override { return 0; }
  void getCurrentTransform(fcl::Transform3d& M) const override { M.setIdentity(); }
  void getTaylorModel(fcl::TMatrix3<double>&, fcl::TVector3<double>&) const override {}
};

/// Falls along -x from x = 1, at rest at t = 0: x = 1 - g t^2 / 2.
struct Falling : PlainMotion, BoundedMotion {
  State state(double t) const override {
    State s;
    s.pose.translation().x() = 1 - 0.5 * g * t * t;
    s.velocity.x() = -g * t;
    s.acceleration.x() = -g;
    return s;
  }
  Bounds bounds(double, double end) const override {
    Bounds b;
    b.speed = g * end * (1 + 1e-12);
    b.acceleration = g;
    return b;
  }
  double g = 2;
};

}  // namespace

// The cart's ball of 0.1 at x = 0; a ball of 0.2 comes from x = 2 to 0: they touch at 2 - 2 t = 0.3.
TEST(MovingObstacle, RobotStandsStill) {
  Cart cart;
  const MovingPtr obstacle = slides(0.2, {2, 0, 0}, {0, 0, 0});
  cart.manager->registerObject(obstacle.get(), "bowl");
  cart.manager->setup();
  const CertifiedResult r = cart.run(0, 0);
  EXPECT_TRUE(touchesAt(r, 0.85));
  ASSERT_EQ(r.contacts.size(), 1u);
  const CertifiedContact& c = r.contacts[0];
  EXPECT_EQ(c.body1.name, "cart");
  EXPECT_EQ(c.body2.name, "bowl");
  EXPECT_EQ(c.body2.moving, obstacle.get());
  EXPECT_EQ(c.body2.object, nullptr);
  EXPECT_EQ(c.body1.moving, nullptr);
  EXPECT_EQ(c.o2, obstacle->collisionGeometry().get());
  EXPECT_NEAR((c.point - Vector3d(0.1, 0, 0)).norm(), 0, 1e-5);
  EXPECT_NEAR((c.normal - Vector3d::UnitX()).norm(), 0, 1e-6);
  // It never came so far.
  EXPECT_TRUE(cart.run(-0.31, -0.31).isFree());
}

// Both move: (2 - 2 t) - t = 0.3; and side by side they never meet.
TEST(MovingObstacle, BothMove) {
  Cart cart;
  const MovingPtr obstacle = slides(0.2, {2, 0, 0}, {0, 0, 0});
  cart.manager->registerObject(obstacle.get());
  cart.manager->setup();
  EXPECT_TRUE(touchesAt(cart.run(0, 1), 1.7 / 3));
  EXPECT_TRUE(cart.run(1.6, -0.4).isFree());
  CertifiedRequest request;
  request.margin = 0.1;  // 0.4 from centre to centre is touching then
  EXPECT_EQ(cart.run(1.6, -0.4, request).t_lower, 0);
  EXPECT_TRUE(touchesAt(cart.run(0, 1, request), 1.6 / 3));
  request.margin = 0.099;
  EXPECT_TRUE(cart.run(1.6, -0.4, request).isFree());
}

// A bar (capsule of 0.05, 2 long) that goes along x with the cart while it turns about z by a quarter. Seen from its
// middle, the arm's ball of 0.1 stands at 0.8 in direction 60 degrees: they touch at 0.8 sin(60 - 90 t) = 0.15. Turning
// the arm as well, by -30 degrees: 0.8 sin(60 - 120 t) = 0.15.
TEST(MovingObstacle, SlidesAndTurnsWhileTheRobotSlidesAndTurns) {
  auto tree = std::make_shared<KinematicTree>("arm");
  for (const char* name : {"rail", "cart", "arm"}) tree->addLink(name);
  tree->addJoint(makeJoint("slide", JointType::prismatic, "rail", "cart", Vector3d::UnitX()));
  tree->addJoint(makeJoint("turn", JointType::revolute, "cart", "arm", Vector3d::UnitZ()));
  ArticulatedCollisionManager manager(tree);
  const auto hand = ball(0.1);
  manager.bind("arm", hand.get(), pose({0.8, 0, 0}));
  const auto bar = std::make_shared<fcl::Capsuled>(0.05, 2);
  const Isometry3d lying = pose(Vector3d::Zero(), kPi / 2, Vector3d::UnitY());  // along x
  const MovingPtr obstacle = goes(bar, pose({0.5, 0, 0}) * lying, pose({-1, 0, 0}, kPi / 2) * lying);
  manager.registerObject(obstacle.get(), "bar");
  manager.setup();
  const double angle = std::asin(0.15 / 0.8), start = kPi / 3;
  const auto q = [](double x, double a) { return (VectorXd(2) << x, a).finished(); };
  // Half a turn's pi is rounded where the poses are made: tolerances of the times stay far above.
  EXPECT_TRUE(touchesAt(ask(manager, q(0.5, start), q(-1, start)), (start - angle) / (kPi / 2)));
  EXPECT_TRUE(touchesAt(ask(manager, q(0.5, start), q(-1, start - kPi / 6)), (start - angle) / (2 * kPi / 3)));
  // Turning ahead of it, the arm is never reached.
  EXPECT_TRUE(ask(manager, q(0.5, start), q(-1, start + kPi / 3)).isFree());
}

// Control points of a cubic B-spline at x = 0, 1, 4, 9 times -h: x(t) = a - h ((1 + t)^2 + 1/3).
TEST(MovingObstacle, SplineOfDegreeThreeAndALinearRobot) {
  Cart cart;
  const double h = 0.5, a = 2;
  const auto P = [&](int i) { return Vector3d(a - h * i * i, 0, 0); };
  const Vector3d none(0, 0, 0);
  const auto spline = std::make_shared<fcl::SplineMotion<double>>(P(0), P(1), P(2), P(3), none, none, none, none);
  Moving obstacle(std::make_shared<fcl::Sphered>(0.2), spline);
  cart.manager->registerObject(&obstacle);
  cart.manager->setup();
  EXPECT_TRUE(touchesAt(cart.run(0, 0), std::sqrt((a - 0.3) / h - 1.0 / 3) - 1));
  // With the cart at 0.2 t: a - h (s^2 + 1/3) - 0.2 (s - 1) = 0.3, s = 1 + t.
  const double c = a - h / 3 + 0.2 - 0.3;
  EXPECT_TRUE(touchesAt(cart.run(0, 0.2), (-0.2 + std::sqrt(0.04 + 4 * h * c)) / (2 * h) - 1));
}

// 1 - t^2 = 0.3, and the cart running away at speed 0.5 from 0: 1 - t^2 + t / 2 = 0.3.
TEST(MovingObstacle, MotionOfOnesOwn) {
  Cart cart;
  const auto falling = std::make_shared<Falling>();
  Moving obstacle(std::make_shared<fcl::Sphered>(0.2), falling);
  cart.manager->registerObject(&obstacle);
  cart.manager->setup();
  EXPECT_TRUE(touchesAt(cart.run(0, 0), std::sqrt(0.7)));
  EXPECT_TRUE(cart.run(0, -0.5).status == Status::free);
  EXPECT_TRUE(touchesAt(cart.run(0, -0.25), (0.25 + std::sqrt(0.0625 + 2.8)) / 2));
}

// A wall without end, {x >= 2 - 2 t}.
TEST(MovingObstacle, HalfSpaceComes) {
  Cart cart;
  const MovingPtr wall = slides(std::make_shared<fcl::Halfspaced>(Vector3d(-1, 0, 0), 0), pose({2, 0, 0}), {0, 0, 0});
  cart.manager->registerObject(wall.get());
  cart.manager->setup();
  EXPECT_TRUE(touchesAt(cart.run(0, 1), 1.9 / 3));
  EXPECT_TRUE(cart.run(-0.2, -0.2).isFree());
}

TEST(MovingObstacle, BelongsToTheSceneAndMeetsNoOtherObstacle) {
  Cart cart;
  const MovingPtr obstacle = slides(0.2, {2, 0, 0}, {0, 0, 0}), other = slides(0.2, {0, 2, 0}, {2, 2, 0});
  const auto wall = object(std::make_shared<fcl::Boxd>(0.1, 9, 9), pose({1.5, 0, 0}));
  cart.manager->registerObject(obstacle.get(), "bowl");
  cart.manager->registerObject(other.get(), "plate");
  cart.manager->registerObject(wall.get(), "wall");
  cart.manager->setup();
  EXPECT_TRUE(touchesAt(cart.run(0, 0), 0.85));  // through the wall
  CertifiedRequest request;
  request.check_self = false;
  EXPECT_TRUE(touchesAt(cart.run(0, 0, request), 0.85));
  request.check_scene = false;
  EXPECT_TRUE(cart.run(0, 0, request).isFree());
  request.check_self = true;
  EXPECT_TRUE(cart.run(0, 0, request).isFree());
  AllowedCollisionMatrix allowed;
  allowed.allow("cart", "bowl");
  cart.manager->setAllowedCollisions(allowed);
  cart.manager->setup();
  EXPECT_TRUE(cart.run(0, 0).isFree());
  EXPECT_TRUE(touchesAt(cart.run(0, 2), 1.35 / 2));  // the wall, from x = 1.45
}

TEST(MovingObstacle, ComesChangesAndGoes) {
  Cart cart;
  const MovingPtr obstacle = slides(0.2, {2, 0, 0}, {0, 0, 0});
  const auto wall = object(std::make_shared<fcl::Boxd>(1, 1, 1), pose({-3, 0, 0}));
  cart.manager->registerObject(wall.get(), "wall");
  cart.manager->registerObject(obstacle.get(), "bowl");
  EXPECT_EQ(cart.manager->size(), 2u);
  EXPECT_THROW(cart.run(0, 0), std::logic_error);
  cart.manager->setup();
  EXPECT_TRUE(touchesAt(cart.run(0, 0), 0.85));
  std::vector<const Moving*> all;
  cart.manager->getObjects(all);
  EXPECT_EQ(all, std::vector<const Moving*>{obstacle.get()});

  // A caller's use of FCL's motion between queries has no effect; a new motion has, from update() on.
  obstacle->getMotion()->integrate(0.4);
  EXPECT_TRUE(touchesAt(cart.run(0, 0), 0.85));
  auto* motion = dynamic_cast<fcl::TranslationMotiond*>(obstacle->getMotion());
  ASSERT_NE(motion, nullptr);
  *motion = fcl::TranslationMotiond(pose({1, 0, 0}), pose({-1, 0, 0}));
  EXPECT_TRUE(touchesAt(cart.run(0, 0), 0.85));
  cart.manager->update(obstacle.get());
  EXPECT_TRUE(touchesAt(cart.run(0, 0), 0.35));
  *motion = fcl::TranslationMotiond(pose({2, 0, 0}), pose({0, 0, 0}));
  cart.manager->update();
  EXPECT_TRUE(touchesAt(cart.run(0, 0), 0.85));
  cart.manager->unregisterObject(obstacle.get());
  EXPECT_EQ(cart.manager->size(), 1u);
  cart.manager->setup();
  EXPECT_TRUE(cart.run(0, 0).isFree());
  EXPECT_TRUE(touchesAt(cart.run(0, -4), 2.4 / 4));
  cart.manager->registerObject(obstacle.get(), "bowl");
  cart.manager->setup();
  EXPECT_TRUE(touchesAt(cart.run(0, 0), 0.85));
  cart.manager->clear();
  EXPECT_TRUE(cart.manager->empty());
}

TEST(MovingObstacle, BadInputIsNamedAndChangesNothing) {
  Cart cart;
  const MovingPtr obstacle = slides(0.2, {2, 0, 0}, {0, 0, 0});
  cart.manager->registerObject(obstacle.get(), "bowl");
  cart.manager->setup();
  Moving none(std::make_shared<fcl::Sphered>(0.2));
  Moving unknown(std::make_shared<fcl::Sphered>(0.2), std::make_shared<PlainMotion>());
  const MovingPtr far = slides(0.2, {std::numeric_limits<double>::infinity(), 0, 0}, {0, 0, 0});
  const auto message = [&](Moving* object, const std::string& name) {
    try {
      cart.manager->registerObject(object, name);
    } catch (const std::invalid_argument& e) {
      return std::string(e.what());
    }
    return std::string("accepted");
  };
  for (const auto& [object, part] : {std::pair<Moving*, const char*>{nullptr, "null"},
                                     {&none, "no motion"},
                                     {&unknown, "motion"},
                                     {far.get(), "finite"},
                                     {obstacle.get(), "'bowl'"}}) {
    const std::string said = message(object, "thing");
    EXPECT_NE(said.find("'thing'"), std::string::npos) << said;
    EXPECT_NE(said.find(part), std::string::npos) << said;
  }
  EXPECT_NE(message(&none, "bowl").find("taken"), std::string::npos);
  EXPECT_THROW(cart.manager->unregisterObject(&none), std::invalid_argument);
  EXPECT_THROW(cart.manager->update(&none), std::invalid_argument);
  EXPECT_EQ(cart.manager->size(), 1u);
  EXPECT_TRUE(touchesAt(cart.run(0, 0), 0.85));  // and is still set up
}

// Random arms of three joints with a ball on every link, and random balls that slide and turn about points far from
// them.
TEST(MovingObstacle, RandomMotionsAgainstDenseSampling) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> u(-1, 1);
  const auto vector = [&](double size) { return Vector3d(size * u(random), size * u(random), size * u(random)); };
  int hits = 0, frees = 0;
  for (int i = 0; i < 150; ++i) {
    auto tree = std::make_shared<KinematicTree>("arm");
    tree->addLink("base");
    std::vector<std::shared_ptr<fcl::CollisionObjectd>> balls;
    for (int j = 1; j <= 3; ++j) {
      const std::string name = "link" + std::to_string(j), parent = j == 1 ? "base" : "link" + std::to_string(j - 1);
      tree->addLink(name);
      tree->addJoint(makeJoint("joint" + std::to_string(j),
                               j == 2 && i % 3 == 0 ? JointType::prismatic : JointType::revolute, parent, name,
                               vector(1), pose(vector(0.5), u(random), vector(1))));
    }
    ArticulatedCollisionManager manager(tree);
    std::vector<Vector3d> offsets;
    for (int j = 1; j <= 3; ++j) {
      balls.push_back(ball(0.1));
      offsets.push_back(vector(0.3));
      manager.bind("link" + std::to_string(j), balls.back().get(), pose(offsets.back()));
    }
    std::vector<MovingPtr> moving;
    std::vector<fcl::InterpMotion<double>> copies;  // to be integrated
    const double radius = 0.15;
    for (int k = 0; k < 3; ++k) {
      const Isometry3d from = pose(vector(1.5), 3 * u(random), vector(1)),
                       to = pose(vector(1.5), 3 * u(random), vector(1));
      const Vector3d about = vector(0.5);
      const auto motion = std::make_shared<fcl::InterpMotion<double>>(from.linear(), from.translation(), to.linear(),
                                                                      to.translation(), about);
      copies.push_back(*motion);
      moving.push_back(std::make_shared<Moving>(std::make_shared<fcl::Sphered>(radius), motion));
      manager.registerObject(moving.back().get());
    }
    manager.setup();
    CertifiedRequest request;
    request.check_self = false;
    const VectorXd q0 = vector(2), q1 = vector(2);
    const CertifiedResult r = ask(manager, q0, q1, request);
    const auto gap = [&](double t) {
      std::vector<Isometry3d> M_0;
      tree->forwardKinematics(q0 + t * (q1 - q0), M_0);
      double least = 1e9;
      for (auto& motion : copies) {
        motion.integrate(t);
        fcl::Transform3d M;
        motion.getCurrentTransform(M);
        for (int j = 0; j < 3; ++j) {
          const auto link = static_cast<std::size_t>(j + 1);
          least = std::min(least,
                           (M_0[link] * offsets[static_cast<std::size_t>(j)] - M.translation()).norm() - 0.1 - radius);
        }
      }
      return least;
    };
    ASSERT_NE(r.status, Status::undecided);
    for (int s = 0; s <= 1000; ++s) {
      const double t = s / 1000.0;
      if (t >= r.t_lower && !r.isFree()) break;
      ASSERT_GT(gap(t), 0) << "case " << i << " at t = " << t;
    }
    if (r.isFree()) {
      ++frees;
      continue;
    }
    ++hits;
    EXPECT_TRUE(r.certain) << i;
    EXPECT_NEAR(gap(r.t_upper), 0, r.t_lower == 0 ? 1 : 1e-4) << i;
  }
  EXPECT_GT(hits, 30);
  EXPECT_GT(frees, 30);
}

}  // namespace moving_obstacle_test
