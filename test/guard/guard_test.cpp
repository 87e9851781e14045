// SPDX-License-Identifier: BSD-3-Clause
//
// Answers of a guard that can be written down; what its scenes keep; and ranges of random trajectories, judged by the
// manager at single configurations.
#include <atomic>
#include <cmath>
#include <thread>

#include <gtest/gtest.h>

#include <fcl/geometry/shape/box.h>
#include <fcl/math/motion/translation_motion.h>
#include <fcl/narrowphase/continuous_collision_object.h>

#include "../query/arms.h"
#include "../support/random_placing.h"
#include "fcl_artic/guard.h"

namespace fcl_artic {
namespace guard_test {
namespace {

using namespace fcl_artic::test;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// A cart that runs along x at 1 m/s, its ball of radius 0.1 in front; the drives brake by 2 m/s^2.
struct Track {
  Cart cart;
  JointTrajectory trajectory =
      JointTrajectory::linear(*cart.tree, {10, 15}, {VectorXd::Zero(1), VectorXd::Constant(1, 5)});
  GuardOptions options;
  Track() {
    options.deceleration = VectorXd::Constant(1, 2);
    options.period = 0.05;
    options.tries = 20;
  }
  /// The scene with a ball of radius 0.1.
  std::shared_ptr<const LiveScene::Snapshot> with(const Vector3d& at, const ObjectSpeed& speed = {}) {
    cart.manager->clear();
    cart.manager->bind("cart", cart.body.get());
    cart.manager->registerObject(ball(0.1, at), "ball");
    cart.manager->setObjectSpeed("ball", speed);
    cart.manager->setup();
    return LiveScene(cart.manager->copy()).latest();
  }
  GuardAnswer ask(const LiveScene::Snapshot& scene, double now, double path_time, double path_speed) const {
    Guard guard(cart.tree, options);
    guard.follow(trajectory);
    GuardAnswer answer;
    guard.ask(scene, now, path_time, path_speed, answer);
    return answer;
  }
};

TEST(Guard, StopsBeforeAWall) {
  // At speed f the cart needs P f + f^2 / 4, and the ball is `gap` ahead.
  for (const double gap : {0.4, 0.2, 0.05, 1e-3}) {
    Track track;
    const auto scene = track.with(Vector3d(1 + 0.2 + gap, 0, 0));
    const double P = track.options.period, fastest = 2 * (std::sqrt(P * P + gap) - P);
    const GuardAnswer answer = track.ask(*scene, 0, 11, 0);
    EXPECT_TRUE(answer.certified);
    if (fastest >= 1) {
      EXPECT_EQ(answer.speed, 1);
      EXPECT_EQ(answer.reason, GuardReason::none);
      EXPECT_TRUE(answer.body1.name.empty());
    } else {
      EXPECT_LE(answer.speed, fastest);
      EXPECT_GE(answer.speed, fastest - 1e-5);
      EXPECT_EQ(answer.reason, GuardReason::near);
      EXPECT_EQ(answer.body1.name, "cart");
      EXPECT_EQ(answer.body2.name, "ball");
    }
    EXPECT_NEAR(answer.braking, 2, 1e-9);
    EXPECT_NEAR(answer.stop_time, P + answer.speed / 2, 1e-9);
    EXPECT_NEAR(answer.stop_at, 11 + P * answer.speed + answer.speed * answer.speed / 4, 1e-9);
    EXPECT_EQ(answer.valid_until, P);
  }
}

TEST(Guard, SlowsNoFasterThanItBrakes) {
  // From f0 = 1 the speed falls by 2 x 0.05 = 0.1 within a period. The way is (1 - f^2) / 4 + f^2 / 4 + what is left of
  // the period at f: a stop from full speed takes 0.25 whatever is promised.
  Track track;
  const GuardAnswer slow = track.ask(*track.with(Vector3d(1 + 0.2 + 0.26, 0, 0)), 0, 11, 1);
  EXPECT_TRUE(slow.certified);
  EXPECT_GE(slow.speed, 0.9);
  EXPECT_LT(slow.speed, 1);
  const double f = slow.speed, way = 0.25 + (0.05 - (1 - f) / 2) * f;
  EXPECT_NEAR(way, 0.26, 1e-5);
  const GuardAnswer stop = track.ask(*track.with(Vector3d(1 + 0.2 + 0.24, 0, 0)), 0, 11, 1);
  EXPECT_FALSE(stop.certified) << "no stop from full speed ends before it";
  EXPECT_EQ(stop.speed, 0);
}

TEST(Guard, APersonComesWhileItStops) {
  // Beside the track at y = 0.2 + D. A person reaches it within age + P + f / 2 at v.
  for (const double distance : {0.5, 0.3, 0.1}) {
    Track track;
    const double v = 1.6, age = 0.03, P = track.options.period;
    const auto scene = track.with(Vector3d(1, 0.2 + distance, 0), {v, 0});
    const GuardAnswer answer = track.ask(*scene, age, 11, 0);
    const double most = distance / v - age - P;  // time to stop
    if (most < 0) {
      EXPECT_EQ(answer.speed, 0);
      EXPECT_TRUE(answer.certified) << "it stands: nothing of it moves";
      continue;
    }
    // (It runs away from the nearest place, so a little more is possible.)
    EXPECT_GE(answer.speed, std::min(1.0, 2 * most) - 1e-5);
    EXPECT_LE(answer.speed, std::min(1.0, 2 * most + 0.2));
    EXPECT_NEAR(answer.separation.human_reacting, v * (age + P), 1e-9);
    EXPECT_NEAR(answer.separation.human_stopping, v * answer.speed / 2, 1e-9);
    EXPECT_NEAR(answer.separation.robot_reacting, P * answer.speed, 1e-9);
    EXPECT_NEAR(answer.separation.robot_stopping, answer.speed * answer.speed / 4, 1e-9);
    EXPECT_EQ(answer.separation.robot, 0);
  }
}

TEST(Guard, ACertifiedStopStaysCertified) {
  // A person beside the track lets the cart go at less than the 0.1 that it brakes within a period. At the next
  // question the scene is older by that, and the cart may just stop: it then stands after f / 2, not only after the
  // period.
  for (const double time : {0.055, 0.07, 0.09}) {
    Track track;
    const double P = track.options.period;
    const auto scene = track.with(Vector3d(1, 0.2 + 1.6 * time, 0), {1.6, 0});
    const GuardAnswer first = track.ask(*scene, 0, 11, 0);
    ASSERT_TRUE(first.certified);
    ASSERT_GT(first.speed, 0);
    ASSERT_LT(first.speed, 2 * P);
    const GuardAnswer next = track.ask(*scene, P, 11 + P * first.speed, first.speed);
    EXPECT_TRUE(next.certified);
    EXPECT_NEAR(next.stop_time, first.speed / 2, 1e-9);
    EXPECT_LE(next.stop_at, first.stop_at + 1e-9);
  }
}

TEST(Guard, TolerancesAndMarginsCount) {
  Track track;
  track.cart.manager->setJointTolerances({0, 0.1});
  track.options.margin = 0.1;
  track.options.added_margin = 0.05;
  const auto scene = track.with(Vector3d(1 + 0.2 + 0.25 + 0.1, 0, 0));
  const double P = 0.05, fastest = 2 * (std::sqrt(P * P + 0.1) - P);
  const GuardAnswer answer = track.ask(*scene, 0, 11, 0);
  EXPECT_LE(answer.speed, fastest);
  EXPECT_GE(answer.speed, fastest - 1e-4);
  EXPECT_NEAR(answer.separation.robot, 0.1, 1e-9);
}

TEST(Guard, AnOldSceneLetsNothingMove) {
  Track track;
  const auto scene = track.with(Vector3d(100, 0, 0));
  EXPECT_EQ(track.ask(*scene, 0.1, 11, 1).speed, 1);
  for (const double now : {0.1001, -1e-6}) {
    const GuardAnswer answer = track.ask(*scene, now, 11, 1);
    EXPECT_EQ(answer.speed, 0);
    EXPECT_FALSE(answer.certified);
    EXPECT_EQ(answer.reason, GuardReason::old_scene);
  }
  // Boxes beside the track, and a box on the cart: each pair is a question of its own.
  track.options.work_budget = 3;
  LiveScene live(scene->manager.copy());
  live.renew(0, [](ArticulatedCollisionManager& manager) {
    const auto box = std::make_shared<fcl::Boxd>(0.1, 0.1, 0.1);
    manager.bind("cart", object(std::make_shared<fcl::Boxd>(0.2, 0.2, 0.2)));
    for (int k = 0; k < 20; ++k) manager.registerObject(object(box, pose({1 + 0.01 * k, 0.171, 0}, M_PI / 4)));
  });
  const GuardAnswer spent = track.ask(*live.latest(), 0, 11, 0);
  EXPECT_EQ(spent.speed, 0);
  EXPECT_EQ(spent.reason, GuardReason::budget);
}

TEST(Guard, TheEndOfTheTrajectoryIsAStop) {
  Track track;
  const auto scene = track.with(Vector3d(5.21, 0, 0));
  EXPECT_EQ(track.ask(*scene, 0, 14.9, 1).speed, 1) << "it ends 0.01 before the ball";
  EXPECT_EQ(track.ask(*scene, 0, 15, 0).speed, 1);
  EXPECT_EQ(track.ask(*track.with(Vector3d(5.19, 0, 0)), 0, 14.99, 1).speed, 0);
}

TEST(Guard, StopsAsItHasPromised) {
  // The cart brakes by 2 before x = 3, and by 0.5 after it, where the trajectory is four times as fast.
  Track track;
  track.trajectory = JointTrajectory::linear(*track.cart.tree, {0, 3, 4},
                                             {VectorXd::Zero(1), VectorXd::Constant(1, 3), VectorXd::Constant(1, 7)});
  Guard guard(track.cart.tree, track.options);
  guard.follow(track.trajectory);
  GuardAnswer answer;
  guard.ask(*track.with(Vector3d(9, 0, 0)), 0, 2, 1, answer);
  ASSERT_TRUE(answer.certified);
  EXPECT_NEAR(answer.braking, 2, 1e-9);
  // Somebody stands in the way: the stop that was promised is what is left, though a new one would be a weak one.
  guard.ask(*track.with(Vector3d(3, 0, 0)), 0, 2.9, 1, answer);
  EXPECT_FALSE(answer.certified);
  EXPECT_NEAR(answer.braking, 2, 1e-9);
  guard.follow(track.trajectory);
  guard.ask(*track.with(Vector3d(3, 0, 0)), 0, 2.9, 1, answer);
  EXPECT_FALSE(answer.certified);
  EXPECT_NEAR(answer.braking, 0.5, 1e-9);
}

TEST(Guard, LooksAhead) {
  Track track;
  track.options.reaction = 0.1;
  Guard guard(track.cart.tree, track.options);
  guard.follow(track.trajectory);
  AheadAnswer answer;
  // The cart meets the ball 2 s on. Its stop takes 0.25 m, the reaction 0.1 m.
  guard.lookAhead(*track.with(Vector3d(3.2, 0, 0)), 0, 11, answer);
  EXPECT_FALSE(answer.all_free);
  EXPECT_LE(answer.free_until, 13);
  EXPECT_GE(answer.free_until, 13 - 2e-3);
  EXPECT_LE(answer.run_until, 13 - 0.35);
  EXPECT_GE(answer.run_until, 13 - 0.35 - 2e-3);
  EXPECT_EQ(answer.body2.name, "ball");
  // Nothing ahead.
  guard.lookAhead(*track.with(Vector3d(5.3, 0, 0)), 0, 11, answer);
  EXPECT_TRUE(answer.all_free);
  EXPECT_EQ(answer.run_until, 15);
  // A person beside the place where the cart is 2 s on: at full speed the cart passes it 0.35 s later at most.
  guard.lookAhead(*track.with(Vector3d(3, 0.2 + 2, 0), {1, 0}), 0, 11, answer);
  ASSERT_FALSE(answer.all_free);
  double touch = 16;
  for (double s = 15; s > 11; s -= 1e-5) {
    if (std::hypot(s - 10 - 3, 2.2) <= 0.2 + (s - 11 + 0.35)) touch = s;
  }
  EXPECT_LE(answer.free_until, touch);
  EXPECT_GE(answer.free_until, touch - 5e-3);
}

TEST(Guard, WhatIsRefused) {
  Track track;
  GuardOptions bad = track.options;
  EXPECT_THROW(Guard(nullptr, track.options), std::invalid_argument);
  bad.deceleration = VectorXd::Constant(2, 1);
  EXPECT_THROW(Guard(track.cart.tree, bad), std::invalid_argument);
  bad.deceleration = VectorXd::Zero(1);
  EXPECT_THROW(Guard(track.cart.tree, bad), std::invalid_argument);
  bad = track.options;
  bad.period = 0;
  EXPECT_THROW(Guard(track.cart.tree, bad), std::invalid_argument);
  bad = track.options;
  bad.reaction = std::nan("");
  EXPECT_THROW(Guard(track.cart.tree, bad), std::invalid_argument);
  Guard guard(track.cart.tree, track.options);
  GuardAnswer answer;
  const auto scene = track.with(Vector3d(9, 0, 0));
  EXPECT_THROW(guard.ask(*scene, 0, 11, 0, answer), std::logic_error) << "it follows nothing";
  guard.follow(track.trajectory);
  EXPECT_THROW(guard.ask(*scene, 0, 11, 1.1, answer), std::invalid_argument);
  EXPECT_THROW(guard.ask(*scene, std::nan(""), 11, 1, answer), std::invalid_argument);
  EXPECT_THROW(LiveScene(track.cart.manager->copy(), std::nan("")), std::invalid_argument);
  // The same joint variables on other links.
  auto longer = sliderTree({"rail", "cart"});
  longer->addLink("tool");
  longer->addJoint(makeJoint("mount", JointType::fixed, "cart", "tool", Vector3d::UnitX(), pose({1, 0, 0})));
  const LiveScene other{ArticulatedCollisionManager(longer)};
  EXPECT_THROW(guard.ask(*other.latest(), 0, 11, 1, answer), std::invalid_argument);
  // An obstacle with a motion of its own does not stop for anybody.
  Track moving;
  const auto mover = std::make_shared<fcl::ContinuousCollisionObjectd>(
      std::make_shared<fcl::Sphered>(0.1), std::make_shared<fcl::TranslationMotiond>(pose({5, 0, 0}), pose({4, 0, 0})));
  moving.cart.manager->registerObject(mover);
  EXPECT_THROW(moving.ask(*LiveScene(moving.cart.manager->copy()).latest(), 0, 11, 1), std::invalid_argument);
}

TEST(LiveScene, IsRenewedWholeOrNotAtAll) {
  Track track;
  track.with(Vector3d(1, 0.5, 0), {0.1, 0});
  LiveScene live(track.cart.manager->copy(), 5);
  const auto before = live.latest();
  EXPECT_EQ(before->seen_at, 5);
  EXPECT_THROW(live.renew(6,
                          [](ArticulatedCollisionManager& manager) {
                            manager.replaceObject("ball", ball(0.1, Vector3d(1, 0, 0)));
                            throw std::runtime_error("no frame");
                          }),
               std::runtime_error);
  EXPECT_EQ(live.latest(), before);
  live.renew(6, [](ArticulatedCollisionManager& manager) {
    manager.replaceObject("ball", ball(0.1, Vector3d(1, 0, 0)));
    manager.registerObject(ball(0.1, Vector3d(2, 0, 0)), "other");
  });
  const auto after = live.latest();
  EXPECT_EQ(after->seen_at, 6);
  EXPECT_EQ(after->manager.size(), 2u);
  EXPECT_EQ(before->manager.size(), 1u);
  const VectorXd here = VectorXd::Constant(1, 0.5), there = VectorXd::Constant(1, 0.9);
  EXPECT_TRUE(before->manager.isFree(here, there));
  EXPECT_FALSE(after->manager.isFree(here, there));
  EXPECT_NE(after->manager.describeTolerances().find("'ball' moving"), std::string::npos) << "its speed has stayed";
}

TEST(LiveScene, ManyAskWhileItIsRenewed) {
  Track track;
  track.with(Vector3d(1, 0.5, 0));
  LiveScene live(track.cart.manager->copy(), 0);
  std::atomic<bool> go_on{true};
  std::atomic<int> asked{0}, wrong{0};
  const auto ask = [&] {
    Guard guard(track.cart.tree, track.options);
    guard.follow(track.trajectory);
    GuardAnswer answer;
    while (go_on) {
      const auto scene = live.latest();
      // Frame n has the ball in the way if n is odd.
      const bool odd = std::lround(scene->seen_at) % 2 == 1;
      guard.ask(*scene, scene->seen_at, 11, 0, answer);
      if ((answer.speed == 1) == odd) ++wrong;
      ++asked;
    }
  };
  std::thread one(ask), two(ask);
  for (int frame = 1; frame <= 300; ++frame) {
    live.renew(frame, [&](ArticulatedCollisionManager& manager) {
      manager.replaceObject("ball", ball(0.1, Vector3d(1.25, frame % 2 ? 0 : 0.5, 0)));
    });
    std::this_thread::yield();
  }
  while (asked < 100) std::this_thread::yield();
  go_on = false;
  one.join();
  two.join();
  EXPECT_EQ(wrong, 0);
}

/// An arm of a slide, two turns and a ball joint, with a hand.
std::shared_ptr<KinematicTree> mixedArm() {
  auto tree = std::make_shared<KinematicTree>("mixed");
  for (const char* link : {"base", "slide", "upper", "lower", "hand"}) tree->addLink(link);
  tree->addJoint(makeJoint("j1", JointType::prismatic, "base", "slide", Vector3d::UnitX()));
  tree->addJoint(makeJoint("j2", JointType::revolute, "slide", "upper", Vector3d::UnitZ()));
  tree->addJoint(makeJoint("j3", JointType::revolute, "upper", "lower", Vector3d::UnitY(), pose({0.5, 0, 0})));
  tree->addJoint(makeJoint("j4", JointType::spherical, "lower", "hand", Vector3d::UnitZ(), pose({0.5, 0, 0})));
  return tree;
}

VectorXd configuration(Random& random) {
  VectorXd q(7);
  for (int i = 0; i < 3; ++i) q[i] = random.uniform(-1, 1);
  const Eigen::Quaterniond turn(random.rotation());
  q.tail<4>() = turn.coeffs();
  return q;
}

TEST(Guard, RangesOfTrajectoriesAreTheSampledOnes) {
  int free = 0, refused = 0, touched = 0;
  for (int n = 0; n < 150; ++n) {
    Random random(1000 + static_cast<std::uint64_t>(n));
    const auto tree = mixedArm();
    ArticulatedCollisionManager manager(tree);
    const auto bar = std::make_shared<fcl::Boxd>(0.4, 0.05, 0.05);
    manager.bind("upper", object(bar), pose({0.25, 0, 0}));
    manager.bind("lower", object(bar), pose({0.25, 0, 0}));
    manager.bind("hand", object(bar), pose({0.2, 0, 0}));
    for (int k = 0; k < 12; ++k) {
      Vector3d at = random.box(1.5);
      if (at.norm() < 0.4) at *= 2;
      manager.registerObject(ball(0.2, at));
    }
    std::vector<VectorXd> waypoints;
    std::vector<double> times;
    for (int k = 0; k < 4; ++k) {
      waypoints.push_back(configuration(random));
      times.push_back(3 + k * random.uniform(0.9, 1.1));
    }
    const JointTrajectory trajectory = random.oneIn(2) ? JointTrajectory::linear(*tree, times, waypoints)
                                                       : JointTrajectory::tangentHalfAngle(*tree, times, waypoints);
    GuardOptions options;
    options.deceleration = VectorXd::Constant(7, random.uniform(1, 20));
    options.period = random.uniform(0.01, 0.3);
    options.reaction = random.oneIn(2) ? 0 : 0.1;
    options.work_budget = 0;
    Guard guard(tree, options);
    guard.follow(trajectory);
    const LiveScene live(std::move(manager));
    const auto scene = live.latest();
    const double at = random.uniform(times.front(), times.back());
    const double f0 = random.oneIn(2) ? 1 : random.uniform(0, 1);
    GuardAnswer answer;
    guard.ask(*scene, 0, at, f0, answer);
    // The way, written down anew: the longest of all profiles is f at once, if that is the faster one, else f0 until
    // the answer counts and braking to f, and a stop.
    const double d = answer.braking, P = options.period, r = options.reaction, f = answer.speed;
    ASSERT_TRUE(std::isfinite(d));
    double s = r * std::max(f0, f), v = std::max(f0, f);
    const double step = 1e-4;
    double t = 0;
    for (; t < P; t += step) {
      v = std::max(f, v - d * step);
      s += v * step;
    }
    s += v * v / (2 * d);
    const double end = std::min(times.back(), at + s);
    if (answer.certified) {
      EXPECT_GE(answer.stop_at, end - 2e-4) << n;
      EXPECT_LE(answer.stop_at, end + 2e-3) << n;
      ++free;
      for (int k = 0; k <= 400; ++k) {
        const double time = at + (answer.stop_at - at) * k / 400;
        if (!scene->manager.collide(trajectory.configuration(time)).isFree()) {
          ++touched;
          ADD_FAILURE() << "case " << n << ": touches at " << time;
          break;
        }
      }
    } else {
      // A stop from f0 is not free.
      ++refused;
      bool hit = false;
      const double stop = std::min(times.back(), at + r * f0 + f0 * f0 / (2 * d) + 1e-6);
      for (int k = 0; k <= 4000 && !hit; ++k) {
        hit = scene->manager.collide(trajectory.configuration(at + (stop - at) * k / 4000)).status == Status::contact;
      }
      EXPECT_TRUE(hit) << n;
    }
  }
  EXPECT_EQ(touched, 0);
  EXPECT_GT(free, 60);
  EXPECT_GT(refused, 10);
}

}  // namespace
}  // namespace guard_test
}  // namespace fcl_artic
