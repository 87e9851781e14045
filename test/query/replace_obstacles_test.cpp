// SPDX-License-Identifier: BSD-3-Clause
//
// One robot, many scenes: obstacles replaced, and managers that share a robot, answer as managers made anew.
#include <random>
#include <stdexcept>
#include <thread>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/math/bv/OBBRSS.h>

#include "expect_time.h"

namespace replace_obstacles_test {

using namespace fcl_artic;
using namespace fcl_artic::test;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

using Objects = std::vector<std::shared_ptr<const fcl::CollisionObjectd>>;

/// A tetrahedron, as a mesh.
std::shared_ptr<fcl::CollisionGeometryd> mesh(double size) {
  auto model = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
  const Vector3d p[] = {{0, 0, 0}, {size, 0, 0}, {0, size, 0}, {0, 0, size}};
  model->beginModel();
  for (const auto& [a, b, c] : {std::tuple(0, 2, 1), std::tuple(0, 1, 3), std::tuple(0, 3, 2), std::tuple(1, 2, 3)}) {
    model->addTriangle(p[a], p[b], p[c]);
  }
  model->endModel();
  return model;
}

/// An arm of four joints that can fold onto itself.
struct Arm {
  std::shared_ptr<KinematicTree> tree = std::make_shared<KinematicTree>("arm");
  std::vector<std::shared_ptr<fcl::CollisionObjectd>> objects;

  Arm() {
    tree->addLink("base");
    objects.push_back(object(std::make_shared<fcl::Boxd>(0.7, 0.7, 0.1)));
    for (int j = 1; j <= 4; ++j) {
      const std::string name = "link" + std::to_string(j), parent = j == 1 ? "base" : "link" + std::to_string(j - 1);
      tree->addLink(name);
      Joint joint = makeJoint("joint" + std::to_string(j), JointType::revolute, parent, name,
                              j % 2 ? Vector3d::UnitZ() : Vector3d::UnitY(), pose({0, 0, 0.3}));
      joint.lower = -3;
      joint.upper = 3;
      tree->addJoint(joint);
      objects.push_back(object(j == 4 ? mesh(0.3) : std::make_shared<fcl::Cylinderd>(0.05, 0.25)));
    }
  }
  void addTo(ArticulatedCollisionManager& manager) const {
    manager.bind("base", objects[0]);
    for (int j = 1; j <= 4; ++j) {
      manager.bind("link" + std::to_string(j), objects[static_cast<std::size_t>(j)], pose({0, 0, 0.15}));
    }
  }
};

Objects randomScene(std::mt19937& random, int count) {
  std::uniform_real_distribution<double> u(-1, 1);
  Objects scene;
  for (int k = 0; k < count; ++k) {
    std::shared_ptr<fcl::CollisionGeometryd> shape;
    switch (random() % 5) {
      case 0:
        shape = std::make_shared<fcl::Sphered>(0.1);
        break;
      case 1:
        shape = std::make_shared<fcl::Capsuled>(0.05, 0.3);
        break;
      case 2:
        shape = mesh(0.3);
        break;
      default:
        shape = std::make_shared<fcl::Boxd>(0.2, 0.3, 0.1);
    }
    scene.push_back(object(shape, pose(Vector3d(u(random), u(random), 0.6 + u(random)), u(random), Vector3d(1, 2, 3))));
  }
  return scene;
}

std::vector<JointMotion> randomMotions(const KinematicTree& tree, std::mt19937& random, int count) {
  std::uniform_real_distribution<double> u(-2.5, 2.5);
  std::vector<JointMotion> motions;
  for (int i = 0; i < count; ++i) {
    VectorXd q0(4), q1(4);
    for (int v = 0; v < 4; ++v) {
      q0[v] = u(random);
      q1[v] = u(random);
    }
    motions.push_back(JointMotion::linear(tree, q0, q1));
  }
  return motions;
}

/// Status, times, bodies and their objects.
std::string textOf(const CertifiedResult& r) {
  char times[128];
  std::snprintf(times, sizeof times, "%a %a", r.t_lower, r.t_upper);
  std::string text = std::string(toString(r.status)) + " " + times + " pairs " + std::to_string(r.statistics.pairs);
  for (const CertifiedContact& c : r.contacts) text += " " + c.body1.name + " " + c.body2.name;
  return text;
}

CertifiedContact firstOf(const CertifiedResult& result) {
  return result.contacts.at(0);
}

TEST(ReplaceObstacles, AnswersAreThoseOfAManagerMadeAnew) {
  const Arm arm;
  ArticulatedCollisionManager kept(arm.tree);
  arm.addTo(kept);
  kept.setup();
  const ArticulatedCollisionManager robot = kept.shareRobot();
  EXPECT_EQ(robot.checkedLinkPairs(), kept.checkedLinkPairs());
  std::mt19937 random(11);
  int free = 0, self = 0, scene_contacts = 0;
  for (int s = 0; s < 12; ++s) {
    const Objects scene = randomScene(random, s == 5 ? 0 : 5 + s);
    ArticulatedCollisionManager fresh(arm.tree), other = robot.shareRobot();
    arm.addTo(fresh);
    for (const auto& object : scene) fresh.registerObject(object);
    fresh.setup();
    kept.replaceObstacles(scene);
    other.replaceObstacles(scene);
    EXPECT_EQ(kept.size(), scene.size());
    for (const JointMotion& motion : randomMotions(*arm.tree, random, 40)) {
      CertifiedResult wanted, result;
      fresh.continuousCollide(motion, {}, wanted);
      for (const ArticulatedCollisionManager* manager : {&kept, &other}) {
        manager->continuousCollide(motion, {}, result);
        ASSERT_EQ(textOf(result), textOf(wanted)) << "scene " << s;
      }
      free += wanted.isFree();
      if (wanted.first()) ++(wanted.first()->body2.link < 0 ? scene_contacts : self);
    }
  }
  std::printf("%d free, %d contacts of links, %d with obstacles\n", free, self, scene_contacts);
  EXPECT_GT(free, 20);
  EXPECT_GT(self, 10);
  EXPECT_GT(scene_contacts, 100);
}

TEST(ReplaceObstacles, ThreadsHaveAManagerEach) {
  const Arm arm;
  ArticulatedCollisionManager robot(arm.tree);
  arm.addTo(robot);
  robot.setup();
  constexpr int kScenes = 8;
  std::vector<std::string> wanted(kScenes), found(kScenes);
  const auto answer = [&](int s, std::string& text, ArticulatedCollisionManager& manager) {
    std::mt19937 random(static_cast<unsigned>(100 + s));
    manager.replaceObstacles(randomScene(random, 10));
    for (const JointMotion& motion : randomMotions(*arm.tree, random, 20)) {
      CertifiedResult result;
      manager.continuousCollide(motion, {}, result);
      text += textOf(result) + "\n";
    }
  };
  for (int s = 0; s < kScenes; ++s) {
    ArticulatedCollisionManager manager = robot.shareRobot();
    answer(s, wanted[static_cast<std::size_t>(s)], manager);
  }
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      ArticulatedCollisionManager manager = robot.shareRobot();
      for (int s = t; s < kScenes; s += 4) answer(s, found[static_cast<std::size_t>(s)], manager);
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(found, wanted);
}

// An object that was read before is read again if it has changed, also in place.
TEST(ReplaceObstacles, ObjectsThatStayAreReadAgainWhereTheyChanged) {
  auto tree = sliderTree({"rail", "slide"});
  ArticulatedCollisionManager manager(tree);
  const auto slide = ball(0.1);
  manager.bind("slide", slide);
  manager.setup();
  const auto touch = [&] {
    CertifiedResult r = ask(manager, VectorXd::Zero(1), VectorXd::Constant(1, 4));
    return r;
  };
  const auto obstacle = ball(0.4, {2, 0, 0});
  manager.replaceObstacles({obstacle});
  EXPECT_TRUE(touchesAt(touch(), 1.5 / 4));
  obstacle->setTranslation(Vector3d(3, 0, 0));
  manager.replaceObstacles({obstacle, ball(0.1, {0, 5, 0})});
  EXPECT_TRUE(touchesAt(touch(), 2.5 / 4));
  const auto box = std::make_shared<fcl::Boxd>(0.2, 1, 1);
  const auto changing = object(box, pose({2, 0, 0}));
  manager.replaceObstacles({changing}, {"gate"});
  EXPECT_TRUE(touchesAt(touch(), 1.8 / 4));
  EXPECT_EQ(firstOf(touch()).body2.name, "gate");
  box->side[0] = 1;
  manager.replaceObstacles({changing});
  EXPECT_TRUE(touchesAt(touch(), 1.4 / 4));
  EXPECT_EQ(firstOf(touch()).body2.name, "obstacle0");
  manager.replaceObstacles({});
  EXPECT_TRUE(touch().isFree());
}

TEST(ReplaceObstacles, IsAllOrNothing) {
  auto tree = sliderTree({"rail", "slide"});
  ArticulatedCollisionManager manager(tree);
  const auto slide = ball(0.1), first = ball(0.4, {2, 0, 0});
  manager.bind("slide", slide);
  manager.registerObject(first, "first");
  manager.setup();
  const auto good = ball(0.1, {1, 0, 0});
  const auto thrown = [&](const Objects& objects, const std::vector<std::string>& names) -> std::string {
    try {
      manager.replaceObstacles(objects, names);
    } catch (const std::invalid_argument& error) {
      const CertifiedResult r = ask(manager, VectorXd::Zero(1), VectorXd::Constant(1, 4));
      EXPECT_TRUE(touchesAt(r, 1.5 / 4));
      EXPECT_EQ(r.first()->body2.name, "first");
      return error.what();
    }
    return "nothing was thrown";
  };
  EXPECT_NE(thrown({good, nullptr}, {}).find("obstacle 'obstacle1': the object is null"), std::string::npos);
  EXPECT_NE(thrown({good, good}, {}).find("is there already"), std::string::npos);
  EXPECT_NE(thrown({good, slide}, {}).find("is there already"), std::string::npos);
  EXPECT_NE(thrown({good}, {"slide"}).find("that of a link"), std::string::npos);
  EXPECT_NE(thrown({good, ball(1)}, {"a", "a"}).find("'a': the name is taken"), std::string::npos);
  EXPECT_NE(thrown({good}, {"a", "b"}).find("2 names for 1 objects"), std::string::npos);
  const auto skewed = ball(0.1);
  Eigen::Isometry3d M = Eigen::Isometry3d::Identity();
  M.linear() *= 1.1;
  skewed->setTransform(M);
  EXPECT_NE(thrown({good, skewed}, {}).find("obstacle1"), std::string::npos);
  manager.replaceObstacles({good}, {"first"});
  EXPECT_TRUE(touchesAt(ask(manager, VectorXd::Zero(1), VectorXd::Constant(1, 4)), 0.8 / 4));
}

// A name that is given again is the same place in the scene; a number is not.
TEST(ReplaceObstacles, MarginsAndAllowedPairsAreOfNamesThatAreGivenAgain) {
  ArticulatedCollisionManager manager(sliderTree({"rail", "slide"}));
  const auto slide = ball(0.1), wall = ball(0.4, {3, 0, 0}), other = ball(0.4, {3, 0, 0});
  manager.bind("slide", slide);
  const auto run = [&] { return ask(manager, VectorXd::Zero(1), VectorXd::Constant(1, 4)); };
  manager.replaceObstacles({wall}, {"wall"});
  manager.setMargin("wall", 0.2);
  manager.replaceObstacles({other}, {"wall"});
  EXPECT_TRUE(touchesAt(run(), 2.3 / 4));
  manager.replaceObstacles({other}, {"post"});
  manager.replaceObstacles({wall}, {"wall"});
  EXPECT_TRUE(touchesAt(run(), 2.5 / 4));
  manager.allow("wall", "slide");
  manager.replaceObstacles({other}, {"wall"});
  EXPECT_TRUE(run().isFree());
  manager.replaceObstacles({other}, {"post"});
  EXPECT_TRUE(manager.allowedCollisions().pairs().empty());
  manager.replaceObstacles({wall});
  manager.allow("obstacle0", "slide");
  manager.replaceObstacles({other});
  EXPECT_TRUE(touchesAt(run(), 2.5 / 4));
  // Nor is it where some names are given, and this object has none.
  manager.allow("obstacle0", "slide");
  manager.setMargin("obstacle0", 0.2);
  manager.replaceObstacles({wall, ball(0.1, {0, 9, 0})}, {"", "lamp"});
  EXPECT_TRUE(touchesAt(run(), 2.5 / 4));
  EXPECT_TRUE(manager.allowedCollisions().pairs().empty());
}

// Carried objects, margins and allowed pairs go with the robot, those of obstacles stay behind.
TEST(ReplaceObstacles, WhatIsSharedIsTheRobot) {
  auto tree = sliderTree({"rail", "slide"});
  ArticulatedCollisionManager manager(tree);
  const auto slide = ball(0.1), load = ball(0.1), wall = ball(0.4, {3, 0, 0});
  manager.bind("slide", slide);
  manager.registerObject(load, "load");
  manager.registerObject(wall, "wall");
  manager.attach("slide", load, pose({0.5, 0, 0}));
  manager.setMargin("slide", 0.05);
  manager.setMargin("wall", 0.2);
  manager.allow("wall", "load");
  EXPECT_THROW((void)manager.shareRobot(), std::logic_error);
  manager.setup();
  // The load may pass: the slide itself is to keep 0.2 from the wall.
  EXPECT_TRUE(touchesAt(ask(manager, VectorXd::Zero(1), VectorXd::Constant(1, 4)), 2.3 / 4));
  ArticulatedCollisionManager other = manager.shareRobot();
  EXPECT_EQ(other.size(), 0u);
  EXPECT_TRUE(ask(other, VectorXd::Zero(1), VectorXd::Constant(1, 4)).isFree());
  other.replaceObstacles({wall}, {"wall"});
  EXPECT_TRUE(touchesAt(ask(other, VectorXd::Zero(1), VectorXd::Constant(1, 4)), 2.0 / 4)) << "the load touches";
  EXPECT_EQ(firstOf(ask(other, VectorXd::Zero(1), VectorXd::Constant(1, 4))).body1.name, "load");
  other.unbind(slide);
  other.setup();
  EXPECT_TRUE(touchesAt(ask(manager, VectorXd::Zero(1), VectorXd::Constant(1, 4)), 2.3 / 4))
      << "the first is as before";
}

}  // namespace

}  // namespace replace_obstacles_test
