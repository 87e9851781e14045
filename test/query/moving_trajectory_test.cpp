// SPDX-License-Identifier: BSD-3-Clause
//
// Obstacles that move beside trajectories of several pieces.
#include <algorithm>
#include <cmath>

#include <fcl/math/motion/interp_motion.h>
#include <fcl/math/motion/spline_motion.h>
#include <fcl/math/motion/translation_motion.h>

#include "expect_time.h"
#include "fcl_artic/bounded_motion.h"

namespace moving_trajectory_test {

using namespace fcl_artic;
using namespace fcl_artic::test;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

using Moving = fcl::ContinuousCollisionObjectd;

/// From x = 1 along -x, at rest at t = 0: x = 1 - g t^2 / 2; and turning about x, for the inverse's sake.
struct Falling : fcl::MotionBased, BoundedMotion {
  State state(double t) const override {
    State s;
    s.pose.translation().x() = 1 - 0.5 * g * t * t;
    s.pose.linear() = Eigen::AngleAxisd(t, Vector3d::UnitX()).toRotationMatrix();
    s.velocity.x() = -g * t;
    s.acceleration.x() = -g;
    s.angular_velocity.x() = 1;
    return s;
  }
  Bounds bounds(double, double end) const override {
    Bounds b;
    b.speed = g * end * (1 + 1e-12);
    b.acceleration = g;
    b.angular_speed = 1;
    return b;
  }
  bool integrate(double) const override { return true; }
  double computeMotionBound(const fcl::BVMotionBoundVisitor<double>&) const override { return 0; }
  double computeMotionBound(const fcl::TriangleMotionBoundVisitor<double>&) const override { return 0; }
  void getCurrentTransform(fcl::Transform3d& M) const override { M.setIdentity(); }
  void getTaylorModel(fcl::TMatrix3<double>&, fcl::TVector3<double>&) const override {}
  double g = 2;
};

CertifiedResult ask(const ArticulatedCollisionManager& manager, const JointTrajectory& trajectory,
                    const CertifiedRequest& request = {}) {
  CertifiedResult result;
  manager.continuousCollide(trajectory, request, result);
  return result;
}

/// The cart at these places at these times.
JointTrajectory drive(const Cart& cart, const std::vector<double>& times, const std::vector<double>& places) {
  std::vector<VectorXd> waypoints;
  for (const double x : places) waypoints.push_back(VectorXd::Constant(1, x));
  return JointTrajectory::linear(*cart.tree, times, waypoints);
}

}  // namespace

// The ball of 0.2 comes from x = 2 to 0 in 10 s to 20 s: at 2 - (T - 10) / 5. The cart's ball of 0.1 stands at 0 until
// 12 s, drives to 0.5 by 13 s, and on at 0.1 a second. In the third piece: 2 - (T - 10) / 5 - 0.5 - (T - 13) / 10 =
// 0.3.
TEST(MovingTrajectory, PiecesOfDifferentLength) {
  Cart cart;
  const auto motion = std::make_shared<fcl::TranslationMotiond>(pose({2, 0, 0}), pose({0, 0, 0}));
  Moving bowl(std::make_shared<fcl::Sphered>(0.2), motion);
  cart.manager->registerObject(&bowl, "bowl");
  cart.manager->setup();
  const JointTrajectory there = drive(cart, {10, 12, 13, 20}, {0, 0, 0.5, 1.2});
  const CertifiedResult r = ask(*cart.manager, there);
  EXPECT_TRUE(touchesAt(r, 45.0 / 3, 1.1e-6));
  ASSERT_EQ(r.contacts.size(), 1u);
  EXPECT_EQ(r.contacts[0].body2.moving, &bowl);
  EXPECT_NEAR(r.contacts[0].point.x(), 0.5 + 0.2 + 0.1, 1e-5);  // the cart's right end at 15 s
  EXPECT_TRUE(ask(*cart.manager, drive(cart, {10, 12, 13, 20}, {-1, 0, -0.5, -1.2})).isFree());
  CertifiedRequest request;
  request.margin = 0.06;  // 2 - (T - 10) / 5 - 0.5 - (T - 13) / 10 = 0.36
  EXPECT_TRUE(touchesAt(ask(*cart.manager, there, request), 14.8, 1.1e-6));
}

// 1 - s^2 = 0.3, s = T / 4, with a cart that stands still through three pieces.
TEST(MovingTrajectory, MotionOfACallersOwn) {
  Cart cart;
  Moving stone(std::make_shared<fcl::Sphered>(0.2), std::make_shared<Falling>());
  cart.manager->registerObject(&stone, "stone");
  cart.manager->setup();
  const CertifiedResult r = ask(*cart.manager, drive(cart, {0, 1, 3, 4}, {0, 0, 0, 0}));
  EXPECT_TRUE(touchesAt(r, 4 * std::sqrt(0.7), 1.1e-6));
  EXPECT_TRUE(ask(*cart.manager, drive(cart, {0, 1, 3, 4}, {0, 0, -0.2, -0.31})).isFree());
  EXPECT_TRUE(touchesAt(cart.run(0, 0), std::sqrt(0.7)));  // and all of the motion as ever
}

// It begins on the cart's back, lets go, and comes back: x(t) = 4 (0.075 + t (1 - t)) from the cart's place.
TEST(MovingTrajectory, InitialContactMaySeparateAndComesBack) {
  Cart cart;
  const Vector3d none(0, 0, 0);
  // A cubic B-spline with control points c, c + 2 h, c + 2 h, c is c + (5 / 3 + t - t^2) h.
  const double h = 1, c = 0.295 - 5.0 / 3;
  const auto P = [&](double x) { return Vector3d(x, 0, 0); };
  const auto motion =
      std::make_shared<fcl::SplineMotion<double>>(P(c), P(c + 2 * h), P(c + 2 * h), P(c), none, none, none, none);
  Moving fly(std::make_shared<fcl::Sphered>(0.2), motion);
  cart.manager->registerObject(&fly, "fly");
  cart.manager->setup();
  CertifiedRequest request;
  request.ignore_initial_contact = true;
  const CertifiedResult r = ask(*cart.manager, drive(cart, {0, 1, 2, 3, 4}, {0, 0, 0, 0, 0}), request);
  // 0.295 + t (1 - t) = 0.3 again.
  EXPECT_TRUE(touchesAt(r, 4 * (0.5 + std::sqrt(0.25 - 0.005)), 1.1e-6));
  EXPECT_EQ(r.ignored_initial_contacts.size(), 1u);
  EXPECT_EQ(ask(*cart.manager, drive(cart, {0, 1, 2}, {0, 0, 0})).t_lower, 0);
}

// One straight motion, as one piece and cut into many of random length: the brackets have a time in common; and nothing
// touches at samples before them.
TEST(MovingTrajectory, CutIntoPiecesItIsTheSame) {
  std::mt19937_64 random(3);
  const auto uniform = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); };
  const auto vector = [&](double size) {
    return Vector3d(uniform(-size, size), uniform(-size, size), uniform(-size, size));
  };
  int hits = 0, free = 0;
  for (int n = 0; n < 200; ++n) {
    auto tree = std::make_shared<KinematicTree>("arm");
    for (const char* name : {"base", "upper", "lower"}) tree->addLink(name);
    tree->addJoint(makeJoint("shoulder", JointType::revolute, "base", "upper", vector(1)));
    tree->addJoint(makeJoint("elbow", JointType::revolute, "upper", "lower", vector(1), pose({0.7, 0, 0})));
    ArticulatedCollisionManager manager(tree);
    const auto hand = ball(0.25);
    manager.bind("lower", hand.get(), pose({0.5, 0, 0}));
    const Eigen::Isometry3d from = pose(vector(1), uniform(-3, 3), vector(1)),
                            to = pose(vector(1), uniform(-3, 3), vector(1));
    std::shared_ptr<fcl::MotionBased> motion;
    if (n % 3 == 0) {
      motion = std::make_shared<fcl::SplineMotion<double>>(vector(1), vector(1), vector(1), vector(1), vector(2),
                                                           vector(2), vector(2), vector(2));
    } else if (n % 3 == 1) {
      motion = std::make_shared<fcl::InterpMotion<double>>(from.linear(), from.translation(), to.linear(),
                                                           to.translation(), vector(0.5));
    } else {
      motion = std::make_shared<Falling>();
    }
    Moving bowl(std::make_shared<fcl::Sphered>(0.35), motion);
    manager.registerObject(&bowl, "bowl");
    manager.setup();
    const Eigen::Vector2d q0(uniform(-3, 3), uniform(-3, 3)), q1(uniform(-3, 3), uniform(-3, 3));
    const CertifiedResult whole = fcl_artic::test::ask(manager, q0, q1);
    std::vector<double> times = {0, 1};
    const int cuts = 1 + n % 9;
    for (int k = 0; k < cuts; ++k) times.push_back(uniform(0.001, 0.999));
    std::sort(times.begin(), times.end());
    std::vector<VectorXd> waypoints;
    for (const double t : times) waypoints.push_back(q0 + t * (q1 - q0));
    const CertifiedResult cut = ask(manager, JointTrajectory::linear(*tree, times, waypoints));
    SCOPED_TRACE(n);
    ASSERT_EQ(whole.status, cut.status);
    if (whole.isFree()) {
      ++free;
      continue;
    }
    ++hits;
    EXPECT_TRUE(cut.certain);
    EXPECT_LE(cut.t_lower, whole.t_upper + 1e-9);
    EXPECT_GE(cut.t_upper, whole.t_lower - 1e-9);
    EXPECT_LE(cut.t_upper - cut.t_lower, 1.1e-6);
  }
  EXPECT_GT(hits, 50);
  EXPECT_GT(free, 50);
}

// A pair that touches at the begin, which a clearance leaves out, is found along the first piece: a moving obstacle has
// a hundredth of its motion there.
TEST(MovingTrajectory, ClearancesLookAtTheBeginInTheFirstPiecesTime) {
  struct Asked : Falling {
    State state(double t) const override {
      latest = std::max(latest, t);
      return Falling::state(t);
    }
    mutable double latest = 0;
  };
  Cart cart;
  const auto motion = std::make_shared<Asked>();
  Moving bowl(std::make_shared<fcl::Sphered>(0.2), motion);
  cart.manager->registerObject(&bowl, "bowl");
  cart.manager->setup();
  ClearanceRequest request;
  request.ignore_initial_contact = true;
  request.work_budget = 1;  // for no more than this look
  motion->latest = 0;
  const Clearance c = cart.manager->clearance(drive(cart, {0, 1, 100}, {0.9, 0.8, 0.7}), request);
  EXPECT_EQ(c.lower, 0);
  EXPECT_GT(motion->latest, 0);
  EXPECT_LE(motion->latest, 0.01);
}

}  // namespace moving_trajectory_test
