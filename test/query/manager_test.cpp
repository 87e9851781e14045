// SPDX-License-Identifier: BSD-3-Clause
//
// The manager on cases worked out by hand, its modes, and what it does with bad input.
#include "fcl_artic/manager.h"

#include <cmath>
#include <limits>
#include <sstream>
#include <thread>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/octree/octree.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/math/bv/OBBRSS.h>
#include <gtest/gtest.h>

#include "expect_time.h"
#include "meshes.h"

namespace manager_test {

using namespace fcl_artic;
using namespace fcl_artic::test;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

constexpr double kPi = 3.14159265358979323846;
template <class Exception, class F>
std::string messageOf(F&& f) {
  try {
    f();
  } catch (const Exception& e) {
    return e.what();
  }
  return "";
}

}  // namespace

// Sphere of radius 0.1 slides from 0 to 1 towards a box face at x = 0.5: centre at 0.4 touches, t* = 0.4.
TEST(Manager, SphereMeetsBoxFaceAtTheTimeWorkedOut) {
  Cart cart;
  auto wall = object(std::make_shared<fcl::Boxd>(1, 1, 1), pose({1, 0, 0}));
  cart.manager->registerObject(wall.get(), "wall");
  cart.manager->setup();
  const CertifiedResult r = cart.run(0, 1);
  ASSERT_TRUE(touchesAt(r, 0.4));
  ASSERT_EQ(r.contacts.size(), 1u);
  const CertifiedContact& c = r.contacts[0];
  EXPECT_EQ(c.body1.name, "cart");
  EXPECT_EQ(c.body2.name, "wall");
  EXPECT_EQ(c.b1, -1);
  EXPECT_NEAR((c.point - Vector3d(0.5, 0, 0)).norm(), 0, 1e-5);
  EXPECT_NEAR((c.normal - Vector3d::UnitX()).norm(), 0, 1e-6);
  EXPECT_NEAR(r.M_0_at_lower[1].translation().x(), r.t_lower, 1e-15);
}

TEST(Manager, FreeMotionIsProvenFree) {
  Cart cart;
  auto wall = object(std::make_shared<fcl::Boxd>(1, 1, 1), pose({1, 0, 0}));
  cart.manager->registerObject(wall.get());
  cart.manager->setup();
  const CertifiedResult r = cart.run(0, 0.3999);
  EXPECT_EQ(r.status, Status::free);
  EXPECT_EQ(r.t_lower, 1);
  EXPECT_TRUE(r.contacts.empty());
}

// With a margin of 0.15 the same sphere counts as touching from x = 0.25.
TEST(Manager, MarginMovesTheContactForward) {
  Cart cart;
  auto wall = object(cubeMesh(0.5), pose({1, 0, 0}));
  cart.manager->registerObject(wall.get());
  cart.manager->setup();
  CertifiedRequest request;
  request.margin = 0.15;
  const CertifiedResult r = cart.run(0, 1, request);
  ASSERT_TRUE(touchesAt(r, 0.25));
}

TEST(Manager, ContactExactlyAtTheEndCounts) {
  Cart cart(cubeMesh(0.25));
  auto wall = object(cubeMesh(0.5), pose({1, 0, 0}));
  cart.manager->registerObject(wall.get());
  cart.manager->setup();
  const CertifiedResult r = cart.run(0, 0.25);
  EXPECT_EQ(r.status, Status::contact);
  EXPECT_LE(r.t_lower, 1);
  EXPECT_GE(r.t_lower, 1 - 1e-5);
}

TEST(Manager, TouchingAtTheStartGivesZero) {
  Cart cart(std::make_shared<fcl::Boxd>(0.5, 0.5, 0.5));
  auto wall = object(std::make_shared<fcl::Boxd>(1, 1, 1), pose({0.5, 0.1, 0.05}));
  cart.manager->registerObject(wall.get());
  cart.manager->setup();
  const CertifiedResult r = cart.run(0, -1);
  ASSERT_EQ(r.status, Status::contact);
  EXPECT_TRUE(r.certain);
  EXPECT_EQ(r.t_lower, 0);
  EXPECT_EQ(r.t_upper, 0);
}

// The cart starts inside one wall, leaves it and meets another whose face is at x = -2: centre at -1.75, t* = 1.75 / 3.
TEST(Manager, IgnoredInitialContactIsWatchedOnceItHasSeparated) {
  Cart cart(std::make_shared<fcl::Boxd>(0.5, 0.5, 0.5));
  auto near = object(std::make_shared<fcl::Boxd>(1, 1, 1), pose({0.5, 0.1, 0.05}));
  auto far = object(std::make_shared<fcl::Boxd>(1, 1, 1), pose({-2.5, 0, 0}));
  cart.manager->registerObject(near.get(), "near");
  cart.manager->registerObject(far.get(), "far");
  cart.manager->setup();
  CertifiedRequest request;
  request.ignore_initial_contact = true;
  const CertifiedResult r = cart.run(0, -3, request);
  ASSERT_TRUE(touchesAt(r, 1.75 / 3));
  EXPECT_EQ(r.contacts.at(0).body2.name, "far");
  ASSERT_EQ(r.ignored_initial_contacts.size(), 1u);
  // Deeper into the first wall it never separates: ignored, and the motion is free.
  EXPECT_EQ(cart.run(0, 0.2, request).status, Status::free);
}

// A crank that starts in contact, leaves and comes back after a turn of 350 degrees.
TEST(Manager, SecondContactWithTheSameBodyAfterSeparationCounts) {
  auto tree = std::make_shared<KinematicTree>("crank");
  tree->addLink("base");
  tree->addLink("arm");
  tree->addJoint(makeJoint("turn", JointType::continuous, "base", "arm", Vector3d::UnitZ()));
  auto arm = object(std::make_shared<fcl::Boxd>(1, 0.1, 0.1));
  auto post = object(std::make_shared<fcl::Cylinderd>(0.05, 1), pose({1, 0, 0}));
  ArticulatedCollisionManager manager(tree);
  Isometry3d offset = Isometry3d::Identity();
  offset.translation().x() = 0.6;
  manager.bind("arm", arm.get(), offset);
  manager.registerObject(post.get(), "post");
  manager.setup();
  CertifiedRequest request;
  request.ignore_initial_contact = true;
  CertifiedResult r;
  const auto motion = JointMotion::linear(*tree, VectorXd::Constant(1, 0), VectorXd::Constant(1, 355 * kPi / 180));
  manager.continuousCollide(motion, request, r);
  ASSERT_EQ(r.status, Status::contact);
  EXPECT_TRUE(r.certain);
  // The box's side y = 0.05 and the post of radius 0.05 at distance 1: sin(angle) = 0.1 before a full turn.
  const double expected = (2 * kPi - std::asin(0.1)) / (355 * kPi / 180);
  EXPECT_LE(r.t_lower, expected + kRounding);
  EXPECT_GE(r.t_upper, expected - kRounding);
}

TEST(Manager, EveryPairReportsEachPairsFirstContact) {
  Cart cart;
  auto first = object(std::make_shared<fcl::Sphered>(0.1), pose({0.5, 0.1, 0}));
  auto second = object(std::make_shared<fcl::Sphered>(0.1), pose({0.8, 0, 0.1}));
  auto third = object(std::make_shared<fcl::Sphered>(0.1), pose({0.5, 5, 0}));
  cart.manager->registerObject(first.get(), "first");
  cart.manager->registerObject(second.get(), "second");
  cart.manager->registerObject(third.get(), "third");
  cart.manager->setup();
  CertifiedRequest request;
  request.mode = ContactMode::firstOfEveryPair;
  request.max_contacts = 10;
  const CertifiedResult r = cart.run(0, 1, request);
  ASSERT_EQ(r.status, Status::contact);
  ASSERT_EQ(r.contacts.size(), 2u);
  const double half_chord = std::sqrt(0.04 - 0.01);
  for (const CertifiedContact& c : r.contacts) {
    const double expected = (c.body2.name == "first" ? 0.5 : 0.8) - half_chord;
    EXPECT_LE(c.t_lower, expected + kRounding) << c.body2.name;
    EXPECT_GE(c.t_upper, expected - kRounding) << c.body2.name;
  }
  EXPECT_LE(r.t_lower, 0.5 - half_chord + kRounding);
}

// Free without a pair to check is as proven as any, and yet not what was meant: it is said.
TEST(Manager, NothingCheckedIsSaid) {
  const auto said = [](const CertifiedResult& r) {
    std::ostringstream out;
    out << r;
    return out.str();
  };
  const std::string nothing = "nothing was checked, there is no pair of bodies";
  CertifiedRequest request;
  for (const ContactMode mode : {ContactMode::first, ContactMode::any, ContactMode::firstOfEveryPair}) {
    for (const Method method : {Method::standard, Method::redon2004}) {
      request.mode = mode;
      request.method = method;
      Cart cart;
      cart.manager->setup();
      EXPECT_TRUE(cart.run(0, 1, request).nothingChecked()) << "no obstacle, no other link with geometry";
      EXPECT_EQ(said(cart.run(0, 1, request)), nothing);
      const auto far = ball(0.1, {0, 5, 0});
      cart.manager->registerObject(far.get(), "far");
      cart.manager->setup();
      EXPECT_FALSE(cart.run(0, 1, request).nothingChecked());
      EXPECT_EQ(said(cart.run(0, 1, request)), "free: proven");
      request.check_scene = false;
      EXPECT_TRUE(cart.run(0, 1, request).nothingChecked());
      request.check_scene = true;
      cart.manager->allow("cart", "far");
      cart.manager->setup();
      EXPECT_TRUE(cart.run(0, 1, request).nothingChecked()) << "all pairs are allowed";
    }
  }
  EXPECT_FALSE(CertifiedResult().nothingChecked()) << "undecided";
}

#if FCL_HAVE_OCTOMAP
TEST(Manager, NothingTouchesAnEmptyOcTree) {
  Cart cart;
  const auto none = object(std::make_shared<fcl::OcTreed>(0.1));
  cart.manager->registerObject(none.get());
  cart.manager->setup();
  CertifiedRequest request;
  request.margin = 1;
  EXPECT_EQ(cart.run(0, 1, request).status, Status::free);
}
#endif

TEST(Manager, BudgetThatRunsOutSaysUndecidedAndKeepsItsLowerBound) {
  Cart cart(cubeMesh(0.2));
  auto wall = object(cubeMesh(0.5), pose({1, 0, 0}));
  cart.manager->registerObject(wall.get());
  cart.manager->setup();
  CertifiedRequest request;
  request.work_budget = 3;
  const CertifiedResult r = cart.run(0, 1, request);
  EXPECT_EQ(r.status, Status::undecided);
  EXPECT_FALSE(r.certain);
  EXPECT_LE(r.t_lower, 0.3);
}

// Two links of a planar elbow that folds onto its base link: self collision, and none once it is allowed.
TEST(Manager, SelfCollisionIsFoundUnlessAllowed) {
  auto tree = std::make_shared<KinematicTree>("elbow");
  for (const char* link : {"a", "b", "c"}) tree->addLink(link);
  tree->addJoint(makeJoint("j1", JointType::revolute, "a", "b", Vector3d::UnitZ(), pose({1, 0, 0})));
  tree->addJoint(makeJoint("j2", JointType::revolute, "b", "c", Vector3d::UnitZ(), pose({0.3, 0, 0})));
  auto a = object(std::make_shared<fcl::Boxd>(1, 0.1, 0.1)), b = object(std::make_shared<fcl::Boxd>(0.2, 0.1, 0.1)),
       c = object(std::make_shared<fcl::Sphered>(0.1));
  ArticulatedCollisionManager manager(tree);
  Isometry3d offset = Isometry3d::Identity();
  offset.translation().x() = 0.4;
  manager.bind("a", a.get(), offset);
  offset.translation().x() = 0.15;
  manager.bind("b", b.get(), offset);
  offset.translation().x() = 0.6;
  manager.bind("c", c.get(), offset);
  manager.setup();
  VectorXd q0(2), q1(2);
  q0 << 0, 0;
  q1 << 0, kPi;
  const auto motion = JointMotion::linear(*tree, q0, q1);
  CertifiedResult r;
  manager.continuousCollide(motion, {}, r);
  ASSERT_EQ(r.status, Status::contact);
  EXPECT_TRUE(r.certain);
  EXPECT_EQ(r.contacts.at(0).body1.name, "a");
  EXPECT_EQ(r.contacts.at(0).body2.name, "c");
  // Sphere's centre at (1.3 + 0.6 cos q, 0.6 sin q); the box's corner nearest is (0.9, 0.05).
  const double t = r.t_upper * kPi;
  const double gap = std::hypot(std::max(0.0, 1.3 + 0.6 * std::cos(t) - 0.9), 0.6 * std::sin(t) - 0.05) - 0.1;
  EXPECT_NEAR(gap, 0, 1e-5);
  CertifiedRequest no_self;
  no_self.check_self = false;
  manager.continuousCollide(motion, no_self, r);
  EXPECT_EQ(r.status, Status::free);
  AllowedCollisionMatrix allowed;
  allowed.allow("c", "a");
  manager.setAllowedCollisions(allowed);
  manager.setup();
  manager.continuousCollide(motion, {}, r);
  EXPECT_EQ(r.status, Status::free);
}

// Aligned boxes meet head on, face to face: both certificate and proof must cope with faces that coincide (Lemma 2).
TEST(Manager, ParallelFacesHeadOnAreProven) {
  for (const double offset : {0.0, 0.1, 0.25}) {
    Cart cart(std::make_shared<fcl::Boxd>(0.5, 0.5, 0.5));
    auto wall = object(std::make_shared<fcl::Boxd>(1, 1, 1), pose({1, offset, 0}));
    cart.manager->registerObject(wall.get());
    cart.manager->setup();
    const CertifiedResult r = cart.run(0, 1);
    ASSERT_EQ(r.status, Status::contact);
    EXPECT_TRUE(r.certain) << offset;
    EXPECT_LE(r.t_lower, 0.25 + kRounding);
    EXPECT_GE(r.t_lower, 0.25 - 1e-9);
    EXPECT_LE(r.t_upper, 0.25 + 1e-6);
  }
}

// c is fixed to b, which is fixed to a: no motion moves any of them against the others, and who asks for a pair gets
// it.
TEST(Manager, RigidlyAttachedLinksAreCheckedWhereSomebodyAsks) {
  auto tree = std::make_shared<KinematicTree>("stack");
  for (const char* link : {"a", "b", "c"}) tree->addLink(link);
  tree->addJoint(makeJoint("ab", JointType::fixed, "a", "b", Vector3d::UnitX(), pose({0.1, 0, 0})));
  tree->addJoint(makeJoint("bc", JointType::fixed, "b", "c", Vector3d::UnitX(), pose({0.1, 0, 0})));
  auto a = object(cubeMesh(0.15)), b = object(cubeMesh(0.15)), c = object(cubeMesh(0.15));
  ArticulatedCollisionManager manager(tree);
  manager.bind("a", a.get());
  manager.bind("b", b.get());
  manager.bind("c", c.get());
  manager.setup();
  CertifiedResult r;
  manager.collide(VectorXd(), {}, r);
  EXPECT_TRUE(r.nothingChecked());
  manager.disallow("a", "c");
  manager.setup();
  manager.collide(VectorXd(), {}, r);
  ASSERT_EQ(r.status, Status::contact);
  EXPECT_EQ(r.contacts.at(0).body1.name, "a");
  EXPECT_EQ(r.contacts.at(0).body2.name, "c");
  AllowedCollisionMatrix allowed;
  allowed.allow("a", "c");
  manager.setAllowedCollisions(allowed);
  manager.setup();
  manager.collide(VectorXd(), {}, r);
  EXPECT_EQ(r.status, Status::free);
}

// A body that a planar joint moves about on the ground can run into it: balls of 0.1, from 1 apart to 0.
TEST(Manager, GroundIsNoNeighbourOfWhatAPlanarJointMoves) {
  auto tree = std::make_shared<KinematicTree>("rover");
  for (const char* link : {"ground", "rover"}) tree->addLink(link);
  tree->addJoint(makeJoint("drive", JointType::planar, "ground", "rover", Vector3d::UnitZ()));
  const auto bump = ball(0.1), rover = ball(0.1);
  ArticulatedCollisionManager manager(tree);
  manager.bind("ground", bump.get());
  manager.bind("rover", rover.get());
  manager.setup();
  EXPECT_TRUE(touchesAt(ask(manager, Vector3d(1, 0, 0), Vector3d(0, 0, 0)), 0.8));
}

// Two robots in one forest, each a slider along its own axis; they meet in the middle.
TEST(Manager, TwoRootsMeet) {
  auto tree = std::make_shared<KinematicTree>("pair");
  for (const char* link : {"base1", "cart1", "base2", "cart2"}) tree->addLink(link);
  tree->addJoint(makeJoint("s1", JointType::prismatic, "base1", "cart1", Vector3d::UnitX()));
  tree->addJoint(makeJoint("s2", JointType::prismatic, "base2", "cart2", -Vector3d::UnitX(), pose({2, 0, 0})));
  auto one = object(cubeMesh(0.1)), two = object(std::make_shared<fcl::Boxd>(0.2, 0.2, 0.2));
  ArticulatedCollisionManager manager(tree);
  manager.bind("cart1", one.get());
  manager.bind("cart2", two.get());
  manager.setup();
  CertifiedResult r;
  manager.continuousCollide(JointMotion::linear(*tree, VectorXd::Zero(2), VectorXd::Constant(2, 1.5)), {}, r);
  ASSERT_TRUE(touchesAt(r, 0.6));  // 2 - 3 t = 0.2
}

// Gripper whose second finger mimics the first with multiplier -1: the fingers close on each other at q = 0.05.
TEST(Manager, MimicJointMovesWithItsMaster) {
  auto tree = std::make_shared<KinematicTree>("gripper");
  for (const char* link : {"palm", "left", "right"}) tree->addLink(link);
  tree->addJoint(makeJoint("close", JointType::prismatic, "palm", "left", Vector3d::UnitY(), pose({0, -0.1, 0})));
  Joint follower = makeJoint("follow", JointType::prismatic, "palm", "right", Vector3d::UnitY(), pose({0, 0.1, 0}));
  follower.mimics = true;
  follower.mimic = {"close", -1, 0};
  tree->addJoint(follower);
  auto left = object(std::make_shared<fcl::Boxd>(0.1, 0.1, 0.1)), right = object(cubeMesh(0.05));
  ArticulatedCollisionManager manager(tree);
  manager.bind("left", left.get());
  manager.bind("right", right.get());
  manager.setup();
  CertifiedResult r;
  manager.continuousCollide(JointMotion::linear(*tree, VectorXd::Zero(1), VectorXd::Constant(1, 0.1)), {}, r);
  ASSERT_TRUE(touchesAt(r, 0.5));
}

TEST(Manager, MimicJointBeyondTheProvenRangeIsRefused) {
  auto tree = std::make_shared<KinematicTree>("gear");
  for (const char* link : {"base", "slow", "fast"}) tree->addLink(link);
  tree->addJoint(makeJoint("master", JointType::continuous, "base", "slow", Vector3d::UnitZ()));
  Joint fast = makeJoint("fast", JointType::continuous, "base", "fast", Vector3d::UnitZ());
  fast.mimics = true;
  fast.mimic = {"master", 1e4, 0};
  tree->addJoint(fast);
  const VectorXd q0 = VectorXd::Zero(1), q1 = VectorXd::Constant(1, 100);
  EXPECT_NE(messageOf<std::invalid_argument>([&] { JointMotion::linear(*tree, q0, q1); }).find("'fast'"),
            std::string::npos);
}

TEST(Manager, MeshInsideASolidTouchesMeshInsideAMeshDoesNot) {
  Cart cart(cubeMesh(0.1));
  auto around = object(std::make_shared<fcl::Boxd>(1, 1, 1));
  cart.manager->registerObject(around.get());
  cart.manager->setup();
  EXPECT_EQ(cart.run(0, 0.1).status, Status::contact);  // shapes are solids
  cart.manager->unregisterObject(around.get());
  auto shell = object(cubeMesh(0.5));
  cart.manager->registerObject(shell.get());
  cart.manager->setup();
  EXPECT_EQ(cart.run(0, 0.1).status, Status::free);  // meshes are surfaces
}

TEST(Manager, SameBitsOverThreadsAndRepeats) {
  Cart cart(cubeMesh(0.2));
  auto wall = object(std::make_shared<fcl::Cylinderd>(0.3, 1), pose({1, 0.05, 0.01}));
  cart.manager->registerObject(wall.get());
  cart.manager->setup();
  const CertifiedResult alone = cart.run(0, 1);
  ASSERT_EQ(alone.status, Status::contact);
  std::vector<int> different(8, 0);
  std::vector<std::thread> threads;
  for (int i = 0; i < 8; ++i) {
    threads.emplace_back([&, i] {
      for (int k = 0; k < 50; ++k) {
        cart.run(0, 0.1 * (k % 7));  // another query between, so that history differs
        const CertifiedResult r = cart.run(0, 1);
        different[static_cast<std::size_t>(i)] +=
            r.t_lower != alone.t_lower || r.t_upper != alone.t_upper || r.contacts[0].point != alone.contacts[0].point;
      }
    });
  }
  for (std::thread& t : threads) t.join();
  for (int d : different) EXPECT_EQ(d, 0);
}

// A query from within another's progress callback has a workspace of its own; and what the callback throws comes out.
TEST(Manager, ProgressMayAskAnotherQueryOrThrow) {
  // A crank that grazes two posts for long, so that there is progress to tell.
  auto tree = std::make_shared<KinematicTree>("crank");
  tree->addLink("base");
  tree->addLink("arm");
  tree->addJoint(makeJoint("turn", JointType::continuous, "base", "arm", Vector3d::UnitZ()));
  auto arm = object(cubeMesh(0.5));
  ArticulatedCollisionManager manager(tree);
  manager.bind("arm", arm.get());
  std::vector<std::shared_ptr<fcl::CollisionObjectd>> posts;
  for (int i = 0; i < 12; ++i) {
    const double angle = kPi * i / 6;
    posts.push_back(object(cubeMesh(0.1), pose({0.808 * std::cos(angle), 0.808 * std::sin(angle), 0.6001})));
    manager.registerObject(posts.back().get());
  }
  manager.setup();
  const auto motion = JointMotion::linear(*tree, VectorXd::Zero(1), VectorXd::Constant(1, 300.0));
  CertifiedResult alone, nested, inner;
  CertifiedRequest request;
  manager.continuousCollide(motion, request, alone);
  ASSERT_EQ(alone.status, Status::free);
  int calls = 0;
  request.progress = [&](double) {
    ++calls;
    manager.continuousCollide(JointMotion::linear(*tree, VectorXd::Zero(1), VectorXd::Constant(1, 1)), {}, inner);
    return true;
  };
  manager.continuousCollide(motion, request, nested);
  EXPECT_GT(calls, 0);
  EXPECT_EQ(nested.status, alone.status);
  EXPECT_EQ(nested.statistics.node_tests, alone.statistics.node_tests);
  request.progress = [](double) -> bool { throw std::runtime_error("stop"); };
  EXPECT_EQ(messageOf<std::runtime_error>([&] { manager.continuousCollide(motion, request, nested); }), "stop");
  manager.continuousCollide(motion, {}, nested);
  EXPECT_EQ(nested.status, alone.status);
  EXPECT_EQ(nested.statistics.node_tests, alone.statistics.node_tests);
}

TEST(Manager, MovedObstacleIsReadByUpdate) {
  Cart cart;
  auto wall = object(std::make_shared<fcl::Boxd>(1, 1, 1), pose({1, 0, 0}));
  cart.manager->registerObject(wall.get());
  cart.manager->setup();
  ASSERT_EQ(cart.run(0, 1).status, Status::contact);
  wall->setTranslation({1, 3, 0});
  EXPECT_EQ(cart.run(0, 1).status, Status::contact);  // not read yet
  cart.manager->update(wall.get());
  EXPECT_EQ(cart.run(0, 1).status, Status::free);
}

TEST(ManagerBadInput, EachIsRefusedByNameAndChangesNothing) {
  Cart cart;
  ArticulatedCollisionManager& manager = *cart.manager;
  auto wall = object(std::make_shared<fcl::Boxd>(1, 1, 1), pose({1, 0, 0}));
  manager.registerObject(wall.get(), "wall");
  EXPECT_NE(messageOf<std::logic_error>([&] { cart.run(0, 1); }).find("setup()"), std::string::npos);
  manager.setup();
  EXPECT_NE(messageOf<std::invalid_argument>([&] { manager.registerObject(wall.get()); }).find("wall"),
            std::string::npos);
  EXPECT_NE(messageOf<std::invalid_argument>([&] {
              manager.registerObject(static_cast<fcl::CollisionObjectd*>(nullptr), "none");
            }).find("null"),
            std::string::npos);
  // Allowed pairs go by name: those of the link would excuse the obstacle.
  auto namesake = object(std::make_shared<fcl::Boxd>(1, 1, 1));
  EXPECT_NE(messageOf<std::invalid_argument>([&] { manager.registerObject(namesake.get(), "rail"); }).find("'rail'"),
            std::string::npos);
  auto empty = object(std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>());
  EXPECT_NE(messageOf<std::invalid_argument>([&] { manager.registerObject(empty.get(), "empty"); }).find("'empty'"),
            std::string::npos);
  auto flat = object(std::make_shared<fcl::Boxd>(1, 0, 1));
  EXPECT_NE(messageOf<std::invalid_argument>([&] { manager.registerObject(flat.get(), "flat"); }).find("Box"),
            std::string::npos);
  auto lost = object(std::make_shared<fcl::Boxd>(1, 1, 1), pose({std::nan(""), 0, 0}));
  EXPECT_NE(messageOf<std::invalid_argument>([&] { manager.registerObject(lost.get(), "lost"); }).find("not finite"),
            std::string::npos);
  auto other = object(std::make_shared<fcl::Boxd>(1, 1, 1));
  EXPECT_NE(messageOf<std::invalid_argument>([&] { manager.bind("hand", other.get()); }).find("'hand'"),
            std::string::npos);
  EXPECT_NE(messageOf<std::invalid_argument>([&] { manager.bind(7, other.get()); }).find('7'), std::string::npos);
  EXPECT_NE(messageOf<std::invalid_argument>([&] { manager.unregisterObject(other.get()); }).find("not registered"),
            std::string::npos);
  EXPECT_NE(messageOf<std::invalid_argument>([&] { cart.run(0, std::nan("")); }).find("slide"), std::string::npos);
  EXPECT_NE(messageOf<std::invalid_argument>([&] {
              JointMotion::linear(*cart.tree, VectorXd::Zero(2), VectorXd::Zero(2));
            }).find('2'),
            std::string::npos);
  CertifiedRequest request;
  request.tolerance_time = 0;
  EXPECT_NE(messageOf<std::invalid_argument>([&] { cart.run(0, 1, request); }).find("tolerance_time"),
            std::string::npos);
  request.tolerance_time = 1e-6;
  request.margin = std::numeric_limits<double>::infinity();
  EXPECT_NE(messageOf<std::invalid_argument>([&] { cart.run(0, 1, request); }).find("margin"), std::string::npos);
  // After all of this the manager is as it was.
  EXPECT_EQ(manager.size(), 1u);
  EXPECT_EQ(cart.run(0, 1).status, Status::contact);
}

}  // namespace manager_test
