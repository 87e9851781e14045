// SPDX-License-Identifier: BSD-3-Clause
//
// Objects that links take up and put down.
#include <cmath>
#include <limits>

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/halfspace.h>
#include <fcl/math/motion/translation_motion.h>

#include "expect_time.h"

namespace attached_object_test {

using namespace fcl_artic;
using namespace fcl_artic::test;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

/// The cart, a cup (a ball of 0.05) on the way, and a wall whose face is at x = 2.
struct Kitchen : Cart {
  std::shared_ptr<fcl::CollisionObjectd> cup = ball(0.05, {0.5, 0, 0});
  std::shared_ptr<fcl::CollisionObjectd> wall = object(std::make_shared<fcl::Boxd>(1, 4, 4), pose({2.5, 0, 0}));
  Kitchen() {
    manager->registerObject(cup.get(), "cup");
    manager->registerObject(wall.get(), "wall");
    manager->setup();
  }
};

}  // namespace

// The cart's ball of 0.1 meets the cup at x = 0.5 - 0.15. Held 0.3 before it, the cup meets the wall at x = 2 - 0.35.
// Put down at x = 1, it is met at 1 - 0.15.
TEST(AttachedObject, IsMetThenCarriedThenMetAgain) {
  Kitchen k;
  EXPECT_TRUE(touchesAt(k.run(0, 2), 0.35 / 2));
  k.manager->attach("cart", k.cup.get(), pose({0.3, 0, 0}));
  EXPECT_THROW(k.run(0, 2), std::logic_error);
  k.manager->setup();
  const CertifiedResult r = k.run(0, 2);
  EXPECT_TRUE(touchesAt(r, 1.65 / 2));
  ASSERT_EQ(r.contacts.size(), 1u);
  EXPECT_EQ(r.contacts[0].body1.name, "cup");
  EXPECT_EQ(r.contacts[0].body1.object, k.cup.get());
  EXPECT_EQ(r.contacts[0].body1.link, k.tree->linkId("cart"));
  EXPECT_EQ(r.contacts[0].body2.name, "wall");
  EXPECT_EQ(k.manager->size(), 1u);
  EXPECT_EQ(k.manager->boundObjects().size(), 2u);
  EXPECT_TRUE(k.manager->boundOffset(k.cup.get()).isApprox(pose({0.3, 0, 0})));

  k.manager->update();  // its own transform is not looked at while it is carried
  EXPECT_TRUE(touchesAt(k.run(0, 2), 1.65 / 2));
  k.cup->setTransform(pose({1, 0, 0}));
  k.manager->detach(k.cup.get());
  k.manager->setup();
  EXPECT_TRUE(touchesAt(k.run(0, 2), 0.85 / 2));
  EXPECT_EQ(k.manager->size(), 2u);
  EXPECT_EQ(k.run(0, 2).contacts[0].body2.name, "cup");
  EXPECT_EQ(k.run(0, 2).contacts[0].body2.link, -1);
  k.manager->attach("cart", k.cup.get(), pose({0.3, 0, 0}));
  k.manager->setup();
  EXPECT_TRUE(touchesAt(k.run(0, 2), 1.65 / 2));
  k.manager->unregisterObject(k.cup.get());
  k.manager->setup();
  EXPECT_TRUE(touchesAt(k.run(0, 2), 1.9 / 2));
  k.manager->registerObject(k.cup.get(), "cup");  // its name is free again
}

// A second slider, y up, on the cart: its link "hand" is the cart's neighbour. An object held by the hand 0.5 below its
// origin comes down on the cart at y - 0.5 = 0.15; the hand itself, a neighbour, never counts.
TEST(AttachedObject, TouchesNeighboursButForTouchLinks) {
  auto tree = std::make_shared<KinematicTree>("lift");
  for (const char* name : {"rail", "cart", "hand", "finger"}) tree->addLink(name);
  tree->addJoint(makeJoint("slide", JointType::prismatic, "rail", "cart", Vector3d::UnitX()));
  tree->addJoint(makeJoint("lift", JointType::prismatic, "cart", "hand", Vector3d::UnitY()));
  tree->addJoint(makeJoint("grip", JointType::prismatic, "hand", "finger", Vector3d::UnitZ()));
  ArticulatedCollisionManager manager(tree);
  const auto cart = ball(0.1), hand = ball(0.1), finger = ball(0.02), held = ball(0.05, {9, 9, 9});
  manager.bind("cart", cart.get());
  manager.bind("hand", hand.get());
  manager.bind("finger", finger.get(), pose({0, 0, 5}));
  manager.registerObject(held.get(), "held");
  const auto run = [&](double y0, double y1, double z0, double z1) {
    manager.setup();
    return ask(manager, (VectorXd(3) << 0, y0, z0).finished(), (VectorXd(3) << 1, y1, z1).finished());
  };
  EXPECT_TRUE(run(1, 0, 0, 0).isFree());
  manager.attach("hand", held.get(), pose({0, -0.5, 0}));
  const CertifiedResult r = run(1, 0, 0, 0);
  EXPECT_TRUE(touchesAt(r, 0.35));
  ASSERT_EQ(r.contacts.size(), 1u);
  EXPECT_TRUE(r.contacts[0].body1.name == "held" || r.contacts[0].body2.name == "held");
  // Inside of the hand that carries it, nothing is said; the finger comes at 5 - z = 0.07.
  manager.detach(held.get());
  manager.attach("hand", held.get(), pose({0, 0, 0}));
  EXPECT_TRUE(run(1, 1, 0, -4).isFree());
  EXPECT_TRUE(touchesAt(run(1, 1, 0, -5), 4.93 / 5));
  manager.detach(held.get());
  manager.attach("hand", held.get(), pose({0, 0, 0}), {"finger"});
  EXPECT_TRUE(run(1, 1, 0, -5).isFree());
  EXPECT_TRUE(touchesAt(run(1, 0, 0, 0), 0.85));  // the cart still
  manager.detach(held.get());
  manager.attach("hand", held.get(), pose({0, -0.5, 0}), {"cart"});
  EXPECT_TRUE(run(1, 0, 0, 0).isFree());
  // Touch links end with the holding; what is allowed of the object does not.
  manager.detach(held.get());
  manager.attach("hand", held.get(), pose({0, -0.5, 0}));
  EXPECT_TRUE(touchesAt(run(1, 0, 0, 0), 0.35));
  AllowedCollisionMatrix allowed;
  allowed.allow("held", "cart");
  manager.setAllowedCollisions(allowed);
  EXPECT_TRUE(run(1, 0, 0, 0).isFree());
}

TEST(AttachedObject, AllowedPairsFollowItsName) {
  Kitchen k;
  AllowedCollisionMatrix allowed;
  allowed.allow("cup", "wall");
  k.manager->setAllowedCollisions(allowed);
  k.manager->attach("cart", k.cup.get(), pose({0.3, 0, 0}));
  k.manager->setup();
  EXPECT_TRUE(touchesAt(k.run(0, 2), 1.9 / 2));  // the cart itself
}

// The cup held 0.3 before the cart; a ball of 0.2 comes from x = 2.45 to 0.45 while the cart stays: 2.45 - 2 t = 0.55.
TEST(AttachedObject, MeetsMovingObstacles) {
  Cart cart;
  const auto cup = ball(0.05);
  cart.manager->registerObject(cup.get(), "cup");
  fcl::ContinuousCollisionObjectd bowl(
      std::make_shared<fcl::Sphered>(0.2),
      std::make_shared<fcl::TranslationMotiond>(pose({2.45, 0, 0}), pose({0.45, 0, 0})));
  cart.manager->registerObject(&bowl, "bowl");
  cart.manager->attach("cart", cup.get(), pose({0.3, 0, 0}));
  cart.manager->setup();
  const CertifiedResult r = cart.run(0, 0);
  EXPECT_TRUE(touchesAt(r, 1.9 / 2));
  ASSERT_EQ(r.contacts.size(), 1u);
  EXPECT_EQ(r.contacts[0].body1.name, "cup");
  EXPECT_EQ(r.contacts[0].body2.name, "bowl");
}

TEST(AttachedObject, BadInputChangesNothing) {
  Kitchen k;
  const auto stranger = ball(0.1);
  const auto ground = object(std::make_shared<fcl::Halfspaced>(Vector3d::UnitZ(), -5));
  k.manager->registerObject(ground.get(), "ground");
  k.manager->setup();
  Eigen::Isometry3d bent = Eigen::Isometry3d::Identity();
  bent.linear()(0, 1) = 0.5;
  const auto refused = [&](auto&& call, const std::string& part) {
    try {
      call();
    } catch (const std::invalid_argument& e) {
      const std::string said = e.what();
      return said.find(part) != std::string::npos ? testing::AssertionSuccess() : testing::AssertionFailure() << said;
    }
    return testing::AssertionFailure() << "accepted";
  };
  ArticulatedCollisionManager& m = *k.manager;
  const Eigen::Isometry3d here = pose({0.3, 0, 0});
  EXPECT_TRUE(refused([&] { m.attach("cart", nullptr, here); }, "not registered"));
  EXPECT_TRUE(refused([&] { m.attach("cart", stranger.get(), here); }, "not registered"));
  EXPECT_TRUE(refused([&] { m.attach("cart", k.body.get(), here); }, "not registered"));
  EXPECT_TRUE(refused([&] { m.attach("hook", k.cup.get(), here); }, "'hook'"));
  EXPECT_TRUE(refused([&] { m.attach(7, k.cup.get(), here); }, "7"));
  EXPECT_TRUE(refused([&] { m.attach("cart", k.cup.get(), bent); }, "'cup'"));
  EXPECT_TRUE(refused([&] { m.attach("cart", k.cup.get(), here, {"cart", "hook"}); }, "'hook'"));
  EXPECT_TRUE(refused([&] { m.attach("cart", ground.get(), here); }, "'ground'"));
  EXPECT_TRUE(refused([&] { m.detach(k.cup.get()); }, "not attached"));
  EXPECT_TRUE(refused([&] { m.detach(k.body.get()); }, "not attached"));
  EXPECT_TRUE(touchesAt(k.run(0, 2), 0.35 / 2));  // still set up
  m.attach("cart", k.cup.get(), here);
  EXPECT_TRUE(refused([&] { m.attach("cart", k.cup.get(), here); }, "carried by 'cart' already"));
  EXPECT_TRUE(refused([&] { m.unbind(k.cup.get()); }, "detach"));
  EXPECT_TRUE(refused([&] { m.registerObject(k.cup.get(), "other"); }, "'cup'"));
  EXPECT_TRUE(refused([&] { m.registerObject(stranger.get(), "cup"); }, "taken"));
  EXPECT_TRUE(refused([&] { m.unregisterObject(k.body.get()); }, "not registered"));
  k.cup->setTranslation(Vector3d(std::numeric_limits<double>::infinity(), 0, 0));
  EXPECT_TRUE(refused([&] { m.detach(k.cup.get()); }, "'cup'"));
  m.setup();
  EXPECT_TRUE(touchesAt(k.run(0, 2), 1.65 / 2));
}

}  // namespace attached_object_test
