// SPDX-License-Identifier: BSD-3-Clause
//
// Initial contacts that are ignored: what is never checked is counted, and answers say so.
#include <sstream>

#include <fcl/geometry/shape/box.h>
#include <fcl/math/motion/translation_motion.h>

#include "expect_time.h"
#include "fcl_artic/continuous_collision.h"
#include "fcl_artic/trajectory.h"

namespace ignored_margin_test {

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

TEST(IgnoredMargin, APairThatPartsIsNamed) {
  const Lane lane;
  for (const double margin : {0.0, 0.3}) {
    const CertifiedResult r = lane.run(margin > 0 ? 1.7 : 2.2, 0, ignoring(margin));
    EXPECT_TRUE(r.isFree());
    EXPECT_EQ(r.ignored_initial_contacts.size(), 1u);
    EXPECT_EQ(r.never_apart_pairs, 0u);
    EXPECT_EQ(textOf(r), "free: proven, but for the initial contact of 1 pair");
  }
  // It leaves, and meets the other wall's margin.
  EXPECT_TRUE(touchesAt(lane.run(1.7, -2.3, ignoring(0.3)), 3.3 / 4));
  EXPECT_TRUE(lane.run(0, 1, ignoring(0.3)).ignored_initial_contacts.empty());
  EXPECT_EQ(textOf(lane.run(0, 1, ignoring(0.3))), "free: proven");
}

// The third goes from within the margin into the wall: nothing is claimed of it either.
TEST(IgnoredMargin, PairsThatPartNowhereAreCounted) {
  const Lane lane;
  struct Way {
    double from, to, margin;
  };
  for (const Way& way : {Way{2.2, 2.3, 0}, Way{2.2, 2.3, 0.3}, Way{1.7, 2.5, 0.3}, Way{1.7, 1.85, 0.3}}) {
    for (const ContactMode mode : {ContactMode::first, ContactMode::any, ContactMode::firstOfEveryPair}) {
      const CertifiedResult r = lane.run(way.from, way.to, ignoring(way.margin, mode));
      EXPECT_TRUE(r.isFree());
      EXPECT_EQ(r.never_apart_pairs, 1u);
      EXPECT_EQ(textOf(r), "free: proven, but for 1 pair that never comes apart");
    }
  }
  // Without the margin the third is what it is.
  EXPECT_TRUE(touchesAt(lane.run(1.7, 2.5, ignoring(0)), 0.25));
  CertifiedRequest plain;
  EXPECT_EQ(lane.run(0, 1, plain).never_apart_pairs, 0u);
}

TEST(IgnoredMargin, AlongATrajectory) {
  const Lane lane;
  const auto neverApart = [&](const std::vector<double>& x) {
    std::vector<VectorXd> waypoints;
    std::vector<double> times;
    for (const double value : x) {
      times.push_back(static_cast<double>(times.size()));
      waypoints.push_back(VectorXd::Constant(1, value));
    }
    const CertifiedResult r =
        lane.manager->continuousCollide(JointTrajectory::linear(*lane.tree, times, waypoints), ignoring(0.3));
    EXPECT_TRUE(r.isFree());
    return r.never_apart_pairs;
  };
  EXPECT_EQ(neverApart({2.2, 2.25, 2.2}), 1u);
  EXPECT_EQ(neverApart({2.2, 1.8, 1.75}), 1u);
  EXPECT_EQ(neverApart({2.2, 1.8, 1.4}), 0u);
  EXPECT_EQ(neverApart({1.4, 1, 1.2}), 0u);
}

TEST(IgnoredMargin, OfTwoBodies) {
  const auto ball = std::make_shared<fcl::Sphered>(0.1);
  const auto wall = std::make_shared<fcl::Boxd>(1, 4, 4);
  const fcl::TranslationMotiond leaves(pose({2.2, 0, 0}), pose({0, 0, 0})),
      deeper(pose({2.2, 0, 0}), pose({2.3, 0, 0})), still(pose({2.5, 0, 0}), pose({2.5, 0, 0}));
  for (const fcl::TranslationMotiond* way : {&leaves, &deeper}) {
    CertifiedPairResult r;
    continuousCollide(ball.get(), way, wall.get(), &still, ignoring(0.3), r);
    EXPECT_TRUE(r.isFree());
    EXPECT_TRUE(r.ignored_initial_contact);
    EXPECT_EQ(r.never_apart, way == &deeper);
  }
}

// The verdict alone: the same bracket, and nothing else.
TEST(IgnoredMargin, WithoutContactsTheVerdictIsTheSame) {
  const Lane lane;
  for (const ContactMode mode : {ContactMode::first, ContactMode::any, ContactMode::firstOfEveryPair}) {
    CertifiedRequest request = ignoring(0, mode);
    const CertifiedResult with = lane.run(0, 2.5, request);
    request.max_contacts = 0;
    const CertifiedResult without = lane.run(0, 2.5, request);
    EXPECT_EQ(with.contacts.size(), 1u);
    EXPECT_FALSE(with.M_0_at_lower.empty());
    EXPECT_TRUE(without.contacts.empty());
    EXPECT_TRUE(without.M_0_at_lower.empty());
    EXPECT_EQ(without.status, Status::contact);
    EXPECT_EQ(without.t_lower, with.t_lower);
    EXPECT_GE(without.t_upper, with.t_upper);
  }
}

}  // namespace ignored_margin_test
