// SPDX-License-Identifier: BSD-3-Clause
//
// Calls for people: answers returned, text, ownership, names that are checked, queries that their caller ends, and what
// a contact tells of its bodies.
#include <sstream>
#include <type_traits>

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/math/motion/translation_motion.h>
#include <gtest/gtest.h>

#include "arms.h"
#include "fcl_artic/continuous_collision.h"
#include "fcl_artic/manager.h"
#include "meshes.h"

namespace calls_test {

using namespace fcl_artic;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

Isometry3d at(double x, double y, double z) {
  return Isometry3d(Eigen::Translation3d(x, y, z));
}
std::shared_ptr<fcl::CollisionObjectd> ball(double radius, const Isometry3d& pose = Isometry3d::Identity()) {
  return std::make_shared<fcl::CollisionObjectd>(std::make_shared<fcl::Sphered>(radius), pose);
}
std::shared_ptr<fcl::CollisionObjectd> box(double side, const Isometry3d& pose = Isometry3d::Identity()) {
  return std::make_shared<fcl::CollisionObjectd>(std::make_shared<fcl::Boxd>(side, side, side), pose);
}
template <class... Values>
VectorXd values(Values... x) {
  VectorXd q(sizeof...(x));
  int i = 0;
  ((q[i++] = x), ...);
  return q;
}

/// A ball of radius 0.1 on a rail along x, and a wall with its face at x = 1: they touch at q = 0.9.
struct Rail {
  std::shared_ptr<KinematicTree> tree = std::make_shared<KinematicTree>("rail");
  ArticulatedCollisionManager manager;
  static std::shared_ptr<KinematicTree> makeTree() {
    auto tree = std::make_shared<KinematicTree>("rail");
    tree->addLink("base");
    tree->addLink("cart");
    tree->addJoint(Joint::prismatic("slide", "base", "cart", Vector3d::UnitX()));
    return tree;
  }
  Rail() : tree(makeTree()), manager(tree) {
    manager.bind("cart", ball(0.1));
    manager.registerObject(box(1, at(1.5, 0, 0)), "wall");
    manager.setup();
  }
};

TEST(Calls, AnswersAreReturned) {
  const Rail rail;
  const CertifiedResult hit = rail.manager.continuousCollide(values(0), values(1));
  EXPECT_EQ(hit.status, Status::contact);
  EXPECT_TRUE(hit.certain);
  EXPECT_NEAR(hit.t_lower, 0.9, 1e-6);
  EXPECT_TRUE(rail.manager.continuousCollide(values(0), values(0.89)).isFree());
  EXPECT_TRUE(rail.manager.isFree(values(0), values(0.89)));
  EXPECT_FALSE(rail.manager.isFree(values(0), values(0.91)));
  EXPECT_EQ(rail.manager.collide(values(0.95)).status, Status::contact);
  EXPECT_TRUE(rail.manager.collide(values(0.85)).isFree());
  CertifiedRequest wide;
  wide.margin = 0.2;
  EXPECT_FALSE(rail.manager.isFree(values(0), values(0.89), wide));
  const JointTrajectory there = JointTrajectory::linear(*rail.tree, {10, 20}, {values(0), values(1)});
  EXPECT_NEAR(rail.manager.continuousCollide(there).t_lower, 19, 1e-5);
  EXPECT_THROW((void)rail.manager.isFree(values(0, 0), values(1, 1)), std::invalid_argument);
}

TEST(Calls, FirstIsNullWithoutContacts) {
  const Rail rail;
  const CertifiedResult free = rail.manager.continuousCollide(values(0), values(0.5));
  EXPECT_EQ(free.first(), nullptr);
  const CertifiedResult hit = rail.manager.continuousCollide(values(0), values(1));
  ASSERT_NE(hit.first(), nullptr);
  EXPECT_EQ(hit.first(), &hit.contacts[0]);
  EXPECT_EQ(hit.first()->body2.name, "wall");
}

TEST(Calls, AnswersAsText) {
  const Rail rail;
  const auto text = [](const auto& x) {
    std::ostringstream out;
    out << x;
    return out.str();
  };
  EXPECT_EQ(text(Status::undecided), "undecided");
  EXPECT_STREQ(toString(FeatureKind::vertexFace), "vertex-face");
  EXPECT_EQ(text(rail.manager.continuousCollide(values(0), values(0.5))), "free: proven");
  const CertifiedResult hit = rail.manager.continuousCollide(values(0), values(1));
  EXPECT_EQ(text(hit).rfind("contact within [0.89", 0), 0u) << text(hit);
  EXPECT_NE(text(hit).find("], proven"), std::string::npos);
  const std::string contact = text(*hit.first());
  EXPECT_EQ(contact.rfind("cart and wall (volume) within [0.89", 0), 0u) << contact;
}

TEST(Calls, SharedObjectsLiveAsLongAsTheyAreRegistered) {
  Rail rail;
  std::weak_ptr<const fcl::CollisionObjectd> seen;
  {
    const std::shared_ptr<const fcl::CollisionObjectd> post = box(0.2, at(0.5, 0, 0));
    seen = post;
    rail.manager.registerObject(post, "post");
  }
  rail.manager.setup();
  EXPECT_FALSE(seen.expired());
  EXPECT_FALSE(rail.manager.isFree(values(0), values(0.6)));
  rail.manager.attach("cart", seen.lock().get(), at(0, 1, 0));
  rail.manager.setup();
  EXPECT_TRUE(rail.manager.isFree(values(0), values(0.6)));
  EXPECT_FALSE(seen.expired());
  rail.manager.unregisterObject(seen.lock().get());
  EXPECT_TRUE(seen.expired());
}

TEST(Calls, SharedObstaclesThatMoveLiveAsLongAsTheyAreRegistered) {
  Rail rail;
  std::weak_ptr<const fcl::ContinuousCollisionObjectd> seen;
  {
    // It crosses the rail at x = 0.5, halfway.
    const auto across = std::make_shared<fcl::TranslationMotiond>(at(0.5, -1, 0), at(0.5, 1, 0));
    const std::shared_ptr<const fcl::ContinuousCollisionObjectd> mover =
        std::make_shared<fcl::ContinuousCollisionObjectd>(std::make_shared<fcl::Sphered>(0.1), across);
    seen = mover;
    rail.manager.registerObject(mover, "mover");
  }
  rail.manager.setup();
  ASSERT_FALSE(seen.expired());
  EXPECT_FALSE(rail.manager.isFree(values(0.2), values(0.8)));
  EXPECT_TRUE(rail.manager.isFree(values(0), values(0.2)));
  rail.manager.update(seen.lock());
  EXPECT_FALSE(rail.manager.isFree(values(0.2), values(0.8)));
  rail.manager.unregisterObject(seen.lock());
  EXPECT_TRUE(seen.expired());
  rail.manager.setup();
  EXPECT_TRUE(rail.manager.isFree(values(0.2), values(0.8)));
}

TEST(Calls, NamesOfAllowedPairsAreChecked) {
  Rail rail;
  AllowedCollisionMatrix typo;
  typo.allow("cart", "wal");
  try {
    rail.manager.setAllowedCollisions(typo);
    FAIL() << "a typo in a name";
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find("'wal'"), std::string::npos) << e.what();
  }
  EXPECT_TRUE(rail.manager.allowedCollisions().pairs().empty());
  EXPECT_THROW(rail.manager.allow("cart", "wal"), std::invalid_argument);
  EXPECT_THROW(rail.manager.disallow("card", "wall"), std::invalid_argument);
  EXPECT_FALSE(rail.manager.isFree(values(0), values(1)));  // nothing was changed
  rail.manager.allow("wall", "cart");
  rail.manager.setup();
  EXPECT_TRUE(rail.manager.isFree(values(0), values(1)));
  rail.manager.disallow("cart", "wall");
  rail.manager.setup();
  EXPECT_FALSE(rail.manager.isFree(values(0), values(1)));
}

/// A crank that grazes a dozen posts for long: enough work for progress to be told.
struct Graze {
  std::shared_ptr<KinematicTree> tree = std::make_shared<KinematicTree>("crank");
  std::unique_ptr<ArticulatedCollisionManager> manager;
  Graze() {
    tree->addLink("base");
    tree->addLink("crank");
    tree->addJoint(Joint::continuous("turn", "base", "crank", Vector3d::UnitZ()));
    manager = std::make_unique<ArticulatedCollisionManager>(tree);
    manager->bind("crank", test::object(test::cubeMesh(0.5)));
    for (int i = 0; i < 12; ++i) {
      const double angle = 3.14159265358979323846 * i / 6;
      manager->registerObject(
          test::object(test::cubeMesh(0.1), at(0.808 * std::cos(angle), 0.808 * std::sin(angle), 0.6001)));
    }
    manager->setup();
  }
};

TEST(Calls, ProgressEndsAQuery) {
  const Graze graze;
  const VectorXd q0 = values(0), q1 = values(300);
  int ended_queries = 0;
  for (const Method method : {Method::standard, Method::redon2004}) {
    for (const ContactMode mode : {ContactMode::first, ContactMode::any, ContactMode::firstOfEveryPair}) {
      CertifiedRequest request;
      request.method = method;
      request.mode = mode;
      int told = 0;
      request.progress = [&](double) { return ++told > 0; };
      const CertifiedResult whole = graze.manager->continuousCollide(q0, q1, request);
      EXPECT_TRUE(whole.isFree());
      if (told < 3) continue;  // little work: nothing to end
      ++ended_queries;
      int calls = 0;
      double last = 0;
      request.progress = [&](double t) {
        last = t;
        return ++calls < 2;
      };
      const CertifiedResult ended = graze.manager->continuousCollide(q0, q1, request);
      EXPECT_EQ(ended.status, Status::undecided);
      EXPECT_FALSE(ended.certain);
      EXPECT_EQ(calls, 2) << "asked again after it had said no";
      EXPECT_GE(ended.t_lower, mode == ContactMode::first ? last : 0);
      EXPECT_LT(ended.t_lower, 1);
      const JointTrajectory twice = JointTrajectory::linear(*graze.tree, {0, 1, 2}, {q0, q1, q0});
      calls = 0;
      EXPECT_EQ(graze.manager->continuousCollide(twice, request).status, Status::undecided);
    }
  }
  EXPECT_GE(ended_queries, 4) << "the scene is too easy";
}

// ---- witness points and speed ----

TEST(Witness, BallAgainstAWall) {
  const Rail rail;
  const CertifiedResult r = rail.manager.continuousCollide(values(0), values(2));
  ASSERT_NE(r.first(), nullptr);
  const CertifiedContact& c = *r.first();
  EXPECT_NEAR(c.approach_speed, 2, 1e-9);  // m per unit of t
  EXPECT_NEAR((c.nearest1 - Vector3d(1, 0, 0)).norm(), 0, 1e-5);
  EXPECT_NEAR((c.nearest2 - Vector3d(1, 0, 0)).norm(), 0, 1e-5);
  EXPECT_LE(c.nearest1.x(), c.nearest2.x() + 1e-12);
  const JointTrajectory slow = JointTrajectory::linear(*rail.tree, {0, 10}, {values(0), values(2)});
  const CertifiedResult slowly = rail.manager.continuousCollide(slow);
  EXPECT_NEAR(slowly.first()->approach_speed, 0.2, 1e-9);  // m/s
}

TEST(Witness, FollowsTheBodiesOrder) {
  // The wall is body 2 for the manager; for a pair of bodies it is what the caller says.
  for (const bool swap : {false, true}) {
    const auto mover = ball(0.1), wall = box(1, at(1.5, 0, 0));
    const Isometry3d there = at(2, 0, 0), stays = at(1.5, 0, 0);
    CertifiedPairResult r;
    if (swap) {
      continuousCollide(wall.get(), stays, mover.get(), there, fcl::CCDM_LINEAR, CertifiedPairRequest(), r);
    } else {
      continuousCollide(mover.get(), there, wall.get(), stays, fcl::CCDM_LINEAR, CertifiedPairRequest(), r);
    }
    ASSERT_NE(r.first(), nullptr);
    EXPECT_NEAR(r.first()->approach_speed, 2, 1e-9);
    EXPECT_NEAR((r.first()->nearest1 - Vector3d(1, 0, 0)).norm(), 0, 1e-5);
    EXPECT_NEAR((r.first()->nearest2 - Vector3d(1, 0, 0)).norm(), 0, 1e-5);
    EXPECT_NEAR(r.first()->normal.x(), swap ? -1 : 1, 1e-6);
  }
}

/// A ball at 1 m from the hinge meets a ball at 2 rad: the speed along the normal is that of the tip times the cosine
/// between them.
TEST(Witness, BallOnAnArmMeetsABall) {
  auto tree = std::make_shared<KinematicTree>("arm");
  tree->addLink("base");
  tree->addLink("arm");
  tree->addJoint(Joint::revolute("hinge", "base", "arm", Vector3d::UnitZ()));
  ArticulatedCollisionManager manager(tree);
  manager.bind("arm", ball(0.1), at(1, 0, 0));
  manager.registerObject(ball(0.2, at(std::cos(2.0), std::sin(2.0), 0)), "ball");
  manager.setup();
  const CertifiedResult r = manager.continuousCollide(values(0), values(3));
  ASSERT_NE(r.first(), nullptr);
  const CertifiedContact& c = *r.first();
  const double angle = 2 - 2 * std::asin(0.15), expected_time = angle / 3;
  ASSERT_NEAR(c.t_lower, expected_time, 1e-6);
  const Vector3d centre(std::cos(angle), std::sin(angle), 0), other(std::cos(2.0), std::sin(2.0), 0);
  const Vector3d normal = (other - centre).normalized();
  const Vector3d contact = centre + 0.1 * normal;
  const Vector3d velocity = 3 * Vector3d::UnitZ().cross(contact);
  EXPECT_NEAR(c.approach_speed, velocity.dot(normal), 1e-5);
  EXPECT_NEAR((c.nearest1 - contact).norm(), 0, 1e-5);
  EXPECT_NEAR((c.nearest2 - contact).norm(), 0, 1e-5);
}

TEST(Witness, InitialContactAndAnyHaveThePointItself) {
  const Rail rail;
  const CertifiedResult inside = rail.manager.continuousCollide(values(1.2), values(2));
  ASSERT_NE(inside.first(), nullptr);
  EXPECT_EQ(inside.first()->nearest1, inside.first()->point);
  EXPECT_EQ(inside.first()->nearest2, inside.first()->point);
  CertifiedRequest any;
  any.mode = ContactMode::any;
  const CertifiedResult some = rail.manager.continuousCollide(values(0), values(2), any);
  ASSERT_NE(some.first(), nullptr);
  EXPECT_EQ(some.first()->nearest1, some.first()->point);
  EXPECT_EQ(some.first()->approach_speed, 0);
}

// A call that would leave a dangling reference does not compile.
template <class T, class = void>
struct FirstOfTemporary : std::false_type {};
template <class T>
struct FirstOfTemporary<T, std::void_t<decltype(std::declval<T>().first())>> : std::true_type {};
static_assert(!FirstOfTemporary<CertifiedResult>::value && FirstOfTemporary<const CertifiedResult&>::value);

}  // namespace

}  // namespace calls_test
