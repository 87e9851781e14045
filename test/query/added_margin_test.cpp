// SPDX-License-Identifier: BSD-3-Clause
//
// The margin that a request adds reaches own margins, tables and culling, in all kinds of queries. Each query is
// compared with the same one of margins that are larger by that much.
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/math/motion/translation_motion.h>

#include "expect_time.h"
#include "fcl_artic/continuous_collision.h"
#include "fcl_artic/continuous_manager.h"

namespace added_margin_test {

using namespace fcl_artic;
using namespace fcl_artic::test;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

CertifiedRequest asking(double margin, double added) {
  CertifiedRequest request;
  request.margin = margin;
  request.added_margin = added;
  return request;
}

/// Three links that turn one after the other (two variables between the outer ones: they have a table), obstacles that
/// stand still, and one that moves. Margins of their own: some of links, of obstacles, of pairs.
struct Arm {
  std::shared_ptr<KinematicTree> tree = std::make_shared<KinematicTree>("arm");
  std::vector<std::shared_ptr<fcl::CollisionObjectd>> objects;
  std::unique_ptr<fcl::ContinuousCollisionObjectd> comet;
  std::unique_ptr<ArticulatedCollisionManager> manager;

  /// @param added  to all margins that are set.
  Arm(std::uint64_t seed, double added) {
    std::mt19937_64 random(seed);
    const auto uniform = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); };
    for (const char* name : {"base", "upper", "lower"}) tree->addLink(name);
    tree->addJoint(makeJoint("shoulder", JointType::revolute, "base", "upper", Vector3d::UnitZ()));
    tree->addJoint(makeJoint("elbow", JointType::revolute, "upper", "lower", Vector3d::UnitZ(), pose({1, 0, 0})));
    manager = std::make_unique<ArticulatedCollisionManager>(tree);
    const auto add = [&](const std::shared_ptr<fcl::CollisionGeometryd>& shape, const Vector3d& at) {
      objects.push_back(object(shape, pose(at)));
      return objects.back().get();
    };
    const auto box = std::make_shared<fcl::Boxd>(0.1, 0.1, 0.3);
    manager->bind("base", add(box, {0, 0, 0}), pose({-0.3, 0.2, 0}));
    manager->bind("upper", add(box, {0, 0, 0}), pose({0.6, 0, 0}));
    manager->bind("lower", add(std::make_shared<fcl::Sphered>(0.1), {0, 0, 0}), pose({0.9, 0, 0}));
    for (int o = 0; o < 4; ++o) {
      const double angle = uniform(-3, 3), reach = uniform(0.3, 2);
      const Vector3d at(reach * std::cos(angle), reach * std::sin(angle), uniform(-0.3, 0.3));
      manager->registerObject(add(box, at), "o" + std::to_string(o));
    }
    const Eigen::Isometry3d from = pose({uniform(-2, 2), 2, 0}), to = pose({uniform(-2, 2), -2, 0});
    comet = std::make_unique<fcl::ContinuousCollisionObjectd>(std::make_shared<fcl::Sphered>(0.05),
                                                              std::make_shared<fcl::TranslationMotiond>(from, to));
    manager->registerObject(comet.get(), "comet");
    const double kMargins[] = {0, 0.01, 0.05, 0.2};
    const auto margin = [&] { return kMargins[static_cast<int>(uniform(0, 4))] + added; };
    const char* const links[] = {"base", "upper", "lower"};
    const char* const others[] = {"o0", "o1", "o2", "o3", "comet", "base"};
    for (const char* name : {"lower", "o1", "comet"}) {
      if (uniform(0, 1) < 0.3) manager->setMargin(name, margin());
    }
    for (const char* link : links) {
      for (const char* other : others) {
        if (uniform(0, 1) < 0.4 && link != std::string(other)) manager->setMargin(link, other, margin());
      }
    }
    // Neighbours are checked for touching, whatever the request's margin.
    AllowedCollisionMatrix neighbours;
    neighbours.allow("base", "upper");
    neighbours.allow("upper", "lower");
    manager->setAllowedCollisions(neighbours);
    manager->setup();
  }
};

}  // namespace

TEST(AddedMargin, IsThatOfLargerMarginsInAllQueriesOfAManager) {
  std::mt19937_64 random(5);
  const auto uniform = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); };
  int contacts = 0, matters = 0, free = 0, ignored = 0;
  for (std::uint64_t n = 0; n < 150; ++n) {
    SCOPED_TRACE(n);
    // Powers of two: sums are exact, whoever makes them.
    const double added = n % 3 == 0 ? 0x1p-10 : n % 3 == 1 ? 0x1p-5 : 0x1p-3, requested = n % 2 ? 0 : 0x1p-6;
    const Arm own(n, 0), larger(n, added);
    const Eigen::Vector2d q0(uniform(-3, 3), uniform(-2.5, 2.5)), q1(uniform(-3, 3), uniform(-2.5, 2.5));
    for (const ContactMode mode : {ContactMode::first, ContactMode::any, ContactMode::firstOfEveryPair}) {
      for (int options = 0; options < 16; ++options) {
        CertifiedRequest request = asking(requested, added);
        request.mode = mode;
        request.max_contacts = 20;
        request.ignore_initial_contact = options & 1;
        request.method = options & 2 ? Method::redon2004 : Method::standard;
        request.visibility = options & 4 ? VisibilityMode::on : VisibilityMode::off;
        request.check_self = !(options & 8);
        const CertifiedResult one = ask(*own.manager, q0, q1, request);
        CertifiedRequest without = request;
        without.added_margin = 0;
        const CertifiedResult less = ask(*own.manager, q0, q1, without);
        // Tables of the larger margins know more. The verdict and what is proven agree all the same.
        without.margin = requested + added;
        const CertifiedResult other = ask(*larger.manager, q0, q1, without);
        ASSERT_EQ(one.status, other.status);
        if (mode != ContactMode::any) {
          EXPECT_NEAR(one.t_lower, other.t_lower, request.tolerance_time);
        }
        EXPECT_EQ(one.ignored_initial_contacts.size(), other.ignored_initial_contacts.size());
        if (one.isFree()) {
          EXPECT_TRUE(less.isFree() || request.ignore_initial_contact);
        }
        contacts += !one.isFree();
        free += one.isFree();
        matters += one.status != less.status || (mode == ContactMode::first && one.t_lower < less.t_lower);
        ignored += !one.ignored_initial_contacts.empty();
      }
    }
    const JointTrajectory trajectory =
        JointTrajectory::linear(*own.tree, {0, 1, 3}, {q0, 0.5 * (q0 + q1) + Eigen::Vector2d(0.1, -0.2), q1});
    CertifiedRequest request = asking(requested, added), sum = asking(requested + added, 0);
    CertifiedResult one, other;
    own.manager->continuousCollide(trajectory, request, one);
    larger.manager->continuousCollide(trajectory, sum, other);
    ASSERT_EQ(one.status, other.status);
    EXPECT_NEAR(one.t_lower, other.t_lower, request.tolerance_time);
    own.manager->collide(q0, request, one);
    larger.manager->collide(q0, sum, other);
    EXPECT_EQ(one.status, other.status);
  }
  EXPECT_GT(contacts, 1000);
  EXPECT_GT(free, 200);
  EXPECT_GT(matters, 1000);
  EXPECT_GT(ignored, 200);
}

// A table of two links holds for the pair's own margin, not for what is added to it: the ball of 0.1 passes the box on
// the base at 0.05.
TEST(AddedMargin, TablesOfTheOwnMarginAreNotAsked) {
  auto tree = std::make_shared<KinematicTree>("arm");
  for (const char* name : {"base", "upper", "lower"}) tree->addLink(name);
  Joint shoulder = makeJoint("shoulder", JointType::revolute, "base", "upper", Vector3d::UnitZ());
  shoulder.lower = -2;
  shoulder.upper = 2;
  Joint elbow = makeJoint("elbow", JointType::revolute, "upper", "lower", Vector3d::UnitZ());
  elbow.lower = -2;
  elbow.upper = 2;
  tree->addJoint(shoulder);
  tree->addJoint(elbow);
  const auto still = ball(0.1), moving = ball(0.1);
  ArticulatedCollisionManager manager(tree);
  manager.bind("base", still.get(), pose({1.25, 0, 0}));
  manager.bind("lower", moving.get(), pose({1, 0, 0}));
  for (const double own : {-1.0, 0.0, 0.01}) {
    manager.resetMargins();
    if (own >= 0) manager.setMargin("base", "lower", own);
    manager.setup();
    const Eigen::Vector2d q0(-1, -0.5), q1(1, 0.5);
    EXPECT_TRUE(ask(manager, q0, q1, asking(0, 0)).isFree());
    EXPECT_TRUE(ask(manager, q0, q1, asking(0, 0.03)).isFree());
    // Balls are 1 and 1.25 from the axis: they meet where 1 + 1.25^2 - 2.5 cos(a) = (0.2 + margin)^2.
    const double reach = 0.2 + std::max(own, 0.0) + 0.08;
    const double angle = std::acos((1 + 1.25 * 1.25 - reach * reach) / 2.5);
    EXPECT_TRUE(touchesAt(ask(manager, q0, q1, asking(0, 0.08)), (1.5 - angle) / 3)) << own;
  }
}

TEST(AddedMargin, OfTwoBodiesAndOfManyIsPartOfTheMargin) {
  const auto box = std::make_shared<fcl::Boxd>(0.2, 0.2, 0.2);
  const auto sphere = std::make_shared<fcl::Sphered>(0.1);
  const Eigen::Isometry3d from = pose({-1, 0.35, 0}), to = pose({1, 0.35, 0}), still = pose({0, 0, 0});
  const auto motion = std::make_shared<fcl::TranslationMotiond>(from, to);
  const auto rest = std::make_shared<fcl::TranslationMotiond>(still, still);
  fcl::ContinuousCollisionObjectd a(sphere, motion), b(box, rest);
  ContinuousCollisionManager manager;
  manager.registerObject(&a);
  manager.registerObject(&b);
  manager.setup();
  const auto both = [&](const CertifiedRequest& request) {
    CertifiedPairResult pair;
    collide(&a, &b, request, pair);
    CertifiedPairsResult pairs;
    manager.continuousCollide(request, pairs);
    EXPECT_EQ(pairs.status, pair.status);
    EXPECT_EQ(pairs.t_lower, pair.t_lower);
    return pair;
  };
  EXPECT_TRUE(both(asking(0, 0)).isFree());  // 0.15 from each other when it passes
  EXPECT_TRUE(both(asking(0.1, 0.04)).isFree());
  for (const auto& [margin, added] : {std::make_pair(0.25, 0.0), {0.0, 0.25}, {0.125, 0.125}}) {
    const CertifiedPairResult pair = both(asking(margin, added));
    // The corner's edge at (-0.1, 0.1): contact where (x + 0.1)^2 + 0.25^2 = 0.35^2.
    const double x = -0.1 - std::sqrt(0.35 * 0.35 - 0.25 * 0.25);
    EXPECT_TRUE(pair.certain);
    EXPECT_LE(pair.t_lower, (x + 1) / 2);
    EXPECT_GE(pair.t_upper, (x + 1) / 2);
  }
}

TEST(AddedMargin, ClearanceIsThatOfTheBodies) {
  const Arm arm(3, 0), larger(3, 0.125);
  const JointMotion motion = JointMotion::linear(*arm.tree, Eigen::Vector2d(-2, 0.5), Eigen::Vector2d(-1.5, 0.6));
  EXPECT_EQ(arm.manager->clearance(motion).lower, larger.manager->clearance(motion).lower);
}

TEST(AddedMargin, BadValuesAreRefused) {
  const Arm arm(1, 0);
  const Eigen::Vector2d q(0, 0);
  constexpr double kInfinity = std::numeric_limits<double>::infinity(), kMost = std::numeric_limits<double>::max();
  for (const double added : {-1e-9, kInfinity, -kInfinity, std::nan("")}) {
    EXPECT_THROW(ask(*arm.manager, q, q, asking(0, added)), std::invalid_argument);
    CertifiedPairsResult pairs;
    EXPECT_THROW(ContinuousCollisionManager().continuousCollide(asking(0, added), pairs), std::invalid_argument);
  }
  EXPECT_THROW(ask(*arm.manager, q, q, asking(kMost, kMost)), std::invalid_argument);
  arm.manager->setMargin("upper", "o1", kMost);
  arm.manager->setup();
  EXPECT_THROW(ask(*arm.manager, q, q, asking(0, kMost)), std::invalid_argument);
}

}  // namespace added_margin_test
