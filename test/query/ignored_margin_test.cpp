// SPDX-License-Identifier: BSD-3-Clause
//
// Initial contacts that are ignored, where there are margins: what is only near its margin may still not touch, and
// what is never checked is counted.
#include <random>
#include <sstream>

#include <fcl/geometry/shape/box.h>
#include <fcl/math/motion/translation_motion.h>

#include "expect_time.h"
#include "fcl_artic/continuous_collision.h"
#include "fcl_artic/trajectory.h"

using namespace fcl_artic;
using namespace fcl_artic::test;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

CertifiedRequest ignoring(double margin, ContactMode mode = ContactMode::first) {
  CertifiedRequest request;
  request.ignore_initial_contact = true;
  request.margin = margin;
  request.mode = mode;
  return request;
}

std::string textOf(const CertifiedResult& r) {
  std::ostringstream text;
  text << r;
  return text.str();
}

/// The cart, whose ball of 0.1 runs along x, and walls: one that begins at x = 2, one that ends at x = -2.
struct Lane : Cart {
  std::shared_ptr<fcl::CollisionObjectd> front = object(std::make_shared<fcl::Boxd>(1, 4, 4), pose({2.5, 0, 0}));
  std::shared_ptr<fcl::CollisionObjectd> back = object(std::make_shared<fcl::Boxd>(1, 4, 4), pose({-2.5, 0, 0}));
  Lane() {
    manager->registerObject(front.get(), "front");
    manager->registerObject(back.get(), "back");
    manager->setup();
  }
};

}  // namespace

// From 1.7, 0.2 from the wall, into it: within the margin from the start on, in contact at x = 1.9.
TEST(IgnoredMargin, WhatIsOnlyWithinItsMarginMayNotTouch) {
  const Lane lane;
  for (const ContactMode mode : {ContactMode::first, ContactMode::firstOfEveryPair}) {
    const CertifiedResult r = lane.run(1.7, 2.5, ignoring(0.3, mode));
    EXPECT_TRUE(touchesAt(r, 0.25));
    ASSERT_EQ(r.contacts.size(), 1u);
    EXPECT_EQ(r.contacts[0].body2.name, "front");
    EXPECT_EQ(r.ignored_initial_contacts.size(), 1u);
  }
  EXPECT_EQ(lane.run(1.7, 2.5, ignoring(0.3, ContactMode::any)).status, Status::contact);
  CertifiedRequest added = ignoring(0.1);
  added.added_margin = 0.2;
  EXPECT_TRUE(touchesAt(lane.run(1.7, 2.5, added), 0.25));
  lane.manager->setMargin("cart", "front", 0.3);
  lane.manager->setup();
  EXPECT_TRUE(touchesAt(lane.run(1.7, 2.5, ignoring(0)), 0.25));
}

TEST(IgnoredMargin, NearButFreeIsFreeAndSaysSo) {
  const Lane lane;
  const CertifiedResult stays = lane.run(1.7, 1.85, ignoring(0.3)), leaves = lane.run(1.7, 0, ignoring(0.3));
  for (const CertifiedResult* r : {&stays, &leaves}) {
    EXPECT_TRUE(r->isFree());
    EXPECT_EQ(r->ignored_initial_contacts.size(), 1u);
    EXPECT_EQ(r->never_apart_pairs, 0u);
    EXPECT_EQ(textOf(*r), "free: proven, but for the initial contact of 1 pair");
  }
  // It leaves, and meets the other wall's margin.
  EXPECT_TRUE(touchesAt(lane.run(1.7, -2.3, ignoring(0.3)), 3.3 / 4));
  EXPECT_TRUE(lane.run(0, 1, ignoring(0.3)).ignored_initial_contacts.empty());
}

TEST(IgnoredMargin, PairsThatNeverPartAreCounted) {
  const Lane lane;
  for (const double margin : {0.0, 0.3}) {
    const CertifiedResult deeper = lane.run(2.2, 2.3, ignoring(margin));
    EXPECT_TRUE(deeper.isFree());
    EXPECT_EQ(deeper.never_apart_pairs, 1u);
    EXPECT_EQ(textOf(deeper), "free: proven, but for 1 pair that touches from the start on");
    EXPECT_EQ(lane.run(2.2, 0, ignoring(margin)).never_apart_pairs, 0u);
  }
  // It touches, parts from the wall but not from its margin, and comes back.
  Eigen::MatrixXd there_and_back(1, 3);
  there_and_back << 2, -1, 1;  // x = 2 - t + t^2, least at t = 1/2: 1.75
  const JointMotion motion = JointMotion::polynomial(*lane.tree, there_and_back);
  CertifiedResult r;
  lane.manager->continuousCollide(motion, ignoring(0.3), r);
  EXPECT_TRUE(touchesAt(r, 0.5 + std::sqrt(0.15)));
}

TEST(IgnoredMargin, AlongATrajectory) {
  const Lane lane;
  const auto through = [&](const std::vector<double>& x) {
    std::vector<VectorXd> waypoints;
    std::vector<double> times;
    for (const double value : x) {
      times.push_back(static_cast<double>(times.size()));
      waypoints.push_back(VectorXd::Constant(1, value));
    }
    return lane.manager->continuousCollide(JointTrajectory::linear(*lane.tree, times, waypoints), ignoring(0.3));
  };
  EXPECT_TRUE(touchesAt(through({1.7, 1.75, 1.8, 2}), 2.5));
  EXPECT_TRUE(through({1.7, 1.75, 1.8}).isFree());
  EXPECT_EQ(through({2.2, 2.25, 2.2}).never_apart_pairs, 1u);
  EXPECT_EQ(through({2.2, 1.8, 1.75}).never_apart_pairs, 0u);
  EXPECT_TRUE(touchesAt(through({2.2, 1.8, 1.85, 1.95}), 2.5));
}

TEST(IgnoredMargin, OfTwoBodies) {
  const auto ball = std::make_shared<fcl::Sphered>(0.1);
  const auto wall = std::make_shared<fcl::Boxd>(1, 4, 4);
  fcl::TranslationMotiond way(pose({1.7, 0, 0}), pose({2.5, 0, 0})), still(pose({2.5, 0, 0}), pose({2.5, 0, 0}));
  const CertifiedPairRequest request = ignoring(0.3);
  CertifiedPairResult r, never;
  continuousCollide(ball.get(), &way, wall.get(), &still, request, r);
  ASSERT_EQ(r.status, Status::contact);
  EXPECT_LE(r.t_lower, 0.25);
  EXPECT_GE(r.t_upper, 0.25 - kRounding);
  EXPECT_TRUE(r.ignored_initial_contact);
  fcl::TranslationMotiond deeper(pose({2.2, 0, 0}), pose({2.3, 0, 0}));
  continuousCollide(ball.get(), &deeper, wall.get(), &still, request, never);
  EXPECT_TRUE(never.isFree());
  EXPECT_TRUE(never.never_apart);
}

TEST(IgnoredMargin, ABudgetThatEndsClaimsNothing) {
  const Lane lane;
  CertifiedRequest request = ignoring(0.3);
  int undecided = 0;
  for (request.work_budget = 1; request.work_budget < 200; ++request.work_budget) {
    const CertifiedResult r = lane.run(1.7, 2.5, request);
    EXPECT_FALSE(r.isFree());
    EXPECT_LE(r.t_lower, 0.25);
    undecided += r.status == Status::undecided;
  }
  EXPECT_GT(undecided, 0);
}

// What is apart at the start never comes into anything before t_lower, whatever the margin: balls among balls, judged
// by their distances.
TEST(IgnoredMargin, NothingThatIsApartAtTheStartTouchesBeforeTheAnswer) {
  std::mt19937 random(20261125);
  const auto uniform = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); };
  int ignored = 0, touching = 0, free = 0;
  for (int world = 0; world < 200; ++world) {
    Cart cart;
    std::vector<std::shared_ptr<fcl::CollisionObjectd>> balls;
    std::vector<std::pair<Vector3d, double>> at;
    for (int k = 0; k < 4; ++k) {
      at.emplace_back(Vector3d(uniform(-2, 2), uniform(-0.6, 0.6), 0), uniform(0.05, 0.3));
      balls.push_back(object(std::make_shared<fcl::Sphered>(at.back().second), pose(at.back().first)));
      cart.manager->registerObject(balls.back().get(), "ball" + std::to_string(k));
    }
    if (world % 3 == 0) cart.manager->setMargin("ball0", uniform(0, 0.3));
    cart.manager->setup();
    for (int k = 0; k < 20; ++k) {
      const double from = uniform(-2, 2), to = uniform(-2, 2);
      const auto mode = static_cast<ContactMode>(k % 3);
      CertifiedRequest request = ignoring(uniform(0, 0.4), mode);
      request.added_margin = k % 2 ? 0 : uniform(0, 0.1);
      const CertifiedResult r = cart.run(from, to, request);
      ASSERT_NE(r.status, Status::undecided);
      ignored += !r.ignored_initial_contacts.empty();
      touching += r.status == Status::contact;
      free += r.isFree();
      const double until = r.isFree() ? 1 : r.t_lower;
      for (const auto& [center, radius] : at) {
        const auto gap = [&](double t) {
          return (Vector3d(from + t * (to - from), 0, 0) - center).norm() - radius - 0.1;
        };
        if (gap(0) <= 1e-6) continue;
        for (int i = 0; i <= 500; ++i) {
          const double t = until * i / 500;
          ASSERT_GT(gap(t), -1e-9) << "world " << world << " from " << from << " to " << to << " at " << t;
        }
      }
    }
  }
  EXPECT_GT(ignored, 500);
  EXPECT_GT(touching, 500);
  EXPECT_GT(free, 500);
  std::printf("%d with ignored pairs, %d in contact, %d free\n", ignored, touching, free);
}
