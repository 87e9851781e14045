// SPDX-License-Identifier: BSD-3-Clause
//
// Several robots in one forest, and robots among OctoMap cells, at times worked out by hand.
#include <cmath>

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/sphere.h>
#include "fcl_artic/urdf/urdf.h"

#include "temp_folder.h"

namespace fcl_artic {
namespace many_robots_test {
namespace {

constexpr double kPi = 3.14159265358979323846;

testing::AssertionResult touchesAt(const CertifiedResult& r, double t) {
  if (r.status != Status::contact || !r.certain) return testing::AssertionFailure() << "no certain contact";
  if (r.t_lower <= t + 1e-11 && r.t_upper >= t - 1e-11 && r.t_upper - r.t_lower <= 1e-6)
    return testing::AssertionSuccess();
  return testing::AssertionFailure() << "[" << r.t_lower << ", " << r.t_upper << "] instead of " << t;
}

CertifiedResult ask(const ArticulatedCollisionManager& manager, const std::vector<double>& from,
                    const std::vector<double>& to) {
  const auto vector = [](const std::vector<double>& q) {
    return Eigen::VectorXd(Eigen::VectorXd::Map(q.data(), static_cast<Eigen::Index>(q.size())));
  };
  CertifiedResult result;
  manager.continuousCollide(JointMotion::linear(manager.tree(), vector(from), vector(to)), {}, result);
  return result;
}

class ManyRobotsTest : public TempFolderTest {
 protected:
  /// An arm of length 1 that turns about z, a ball of 0.1 at its end; its base is a ball of 0.2. A second joint, a
  /// finger without geometry, mimics the first.
  Robot arm() {
    return loadUrdf(write("arm.urdf", R"(<robot name="arm">
<link name="base"><collision><geometry><sphere radius="0.2"/></geometry></collision></link>
<link name="arm"><collision><origin xyz="1 0 0"/><geometry><sphere radius="0.1"/></geometry></collision></link>
<link name="finger"/>
<joint name="turn" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/></joint>
<joint name="bend" type="continuous"><parent link="arm"/><child link="finger"/><axis xyz="0 0 1"/>
<mimic joint="turn" multiplier="2"/></joint></robot>)"));
  }
  static Eigen::Isometry3d facing(double x) {
    return Eigen::Translation3d(x, 0, 0) * Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitZ());
  }
};

// Two arms that face each other, 2 apart, and come together like doors: their ends are 2 - 2 cos(a) apart, a from a
// quarter to 0, and touch at cos(a) = 0.9.
TEST_F(ManyRobotsTest, TwoArmsMeet) {
  const Robot one = arm();
  Robot both = combineRobots({{&one, "left_"}, {&one, "right_", facing(2)}}, "pair");
  EXPECT_EQ(both.tree->name(), "pair");
  EXPECT_EQ(both.tree->dof(), 2);
  EXPECT_EQ(both.tree->variableName(0), "left_turn");
  EXPECT_EQ(both.tree->variableName(1), "right_turn");
  EXPECT_EQ(both.tree->joint(both.tree->jointId("right_bend")).mimic.master, "right_turn");
  EXPECT_EQ(both.geometry.size(), 4u);
  EXPECT_NE(both.geometry[0].object, both.geometry[2].object);
  EXPECT_EQ(both.geometry[0].object->collisionGeometry(), both.geometry[2].object->collisionGeometry());
  ArticulatedCollisionManager manager(both.tree);
  both.addTo(manager);
  manager.setup();
  const CertifiedResult r = ask(manager, {kPi / 2, -kPi / 2}, {0, 0});
  EXPECT_TRUE(touchesAt(r, 1 - std::acos(0.9) * 2 / kPi));
  ASSERT_EQ(r.contacts.size(), 1u);
  EXPECT_EQ(r.contacts[0].body1.name, "left_arm");
  EXPECT_EQ(r.contacts[0].body2.name, "right_arm");
  EXPECT_NEAR(r.contacts[0].point.x(), 1, 1e-5);
  // One after the other they pass.
  EXPECT_TRUE(ask(manager, {kPi / 2, -kPi / 2}, {kPi / 2, -kPi}).isFree());
  AllowedCollisionMatrix allowed = both.allowed;
  allowed.allow("left_arm", "right_arm");
  manager.setAllowedCollisions(allowed);
  manager.setup();
  EXPECT_TRUE(ask(manager, {kPi / 2, -kPi / 2}, {0, 0}).isFree());
}

// 1 apart, the second arm sweeps over the base of the first: its end is 2 sin(b / 2) from there. They are no
// neighbours, though one joint only is between them.
TEST_F(ManyRobotsTest, ArmMeetsTheOtherOnesBase) {
  const Robot one = arm();
  Robot both = combineRobots({{&one, "left_"}, {&one, "right_", facing(1)}});
  ArticulatedCollisionManager manager(both.tree);
  both.addTo(manager);
  manager.setup();
  const CertifiedResult r = ask(manager, {kPi, kPi / 2}, {kPi, 0});
  EXPECT_TRUE(touchesAt(r, 1 - 2 * std::asin(0.15) * 2 / kPi));
  ASSERT_EQ(r.contacts.size(), 1u);
  EXPECT_EQ(r.contacts[0].body1.name, "left_base");
  EXPECT_EQ(r.contacts[0].body2.name, "right_arm");
}

// The same of robots that were combined before: each root has a mount of its own.
TEST_F(ManyRobotsTest, CombinedTwiceTheyAreNoNeighboursEither) {
  const Robot one = arm();
  const Robot both = combineRobots({{&one, "left_"}, {&one, "right_", facing(1)}});
  const Robot again = combineRobots({{&both, "cell_", Eigen::Isometry3d(Eigen::Translation3d(5, 0, 0))}, {&one, "c_"}});
  EXPECT_TRUE(again.tree->hasLink("cell_mount_of_left_mount"));
  EXPECT_TRUE(again.tree->hasLink("c_mount"));
  ArticulatedCollisionManager manager(again.tree);
  again.addTo(manager);
  manager.setup();
  const CertifiedResult r = ask(manager, {kPi, kPi / 2, 0}, {kPi, 0, 0});
  EXPECT_TRUE(touchesAt(r, 1 - 2 * std::asin(0.15) * 2 / kPi));
}

TEST_F(ManyRobotsTest, WhatTheirMatricesSayOfNeighboursStays) {
  const Robot plain = arm();
  Robot complete = arm();
  complete.allowed.setComplete();
  EXPECT_TRUE(combineRobots({{&complete, "a_"}, {&complete, "b_"}}).allowed.complete());
  const Robot both = combineRobots({{&complete, "a_"}, {&plain, "b_"}});
  EXPECT_FALSE(both.allowed.complete());
  EXPECT_TRUE(both.allowed.mustBeChecked("a_arm", "a_base"));
  EXPECT_FALSE(both.allowed.mustBeChecked("b_arm", "b_base"));
}

TEST_F(ManyRobotsTest, AllowedPairsGetThePrefixAndBadInputIsNamed) {
  Robot one = arm();
  one.allowed.allow("base", "finger");
  const Robot both = combineRobots({{&one, "a/"}, {&one, "b/"}});
  EXPECT_TRUE(both.allowed.allowed("b/base", "b/finger"));
  EXPECT_FALSE(both.allowed.allowed("a/base", "b/finger"));
  try {
    combineRobots({{&one, "a/"}, {&one, "a/"}});
    ADD_FAILURE() << "accepted";
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find("a/"), std::string::npos) << e.what();
  }
  EXPECT_THROW(combineRobots({{nullptr, "a/"}}), std::invalid_argument);
  Eigen::Isometry3d bent = Eigen::Isometry3d::Identity();
  bent.linear()(0, 1) = 1;
  EXPECT_THROW(combineRobots({{&one, "a/", bent}}), std::invalid_argument);
}

/// A rail, and a cart on it that starts from `from`.
std::shared_ptr<const KinematicTree> slider(const Eigen::Vector3d& axis,
                                            const Eigen::Vector3d& from = Eigen::Vector3d::Zero()) {
  auto tree = std::make_shared<KinematicTree>("slider");
  tree->addLink("rail");
  tree->addLink("cart");
  Joint joint;
  joint.name = "slide";
  joint.type = JointType::prismatic;
  joint.parent = "rail";
  joint.child = "cart";
  joint.axis = axis;
  joint.origin.translation() = from;
  tree->addJoint(joint);
  return tree;
}

// 2 x - 6 = 0, turned by a quarter about z: y = 3. The slider's ball of 0.1 goes along y from 1 to 4.
TEST_F(ManyRobotsTest, PlaneOfAMoveItScene) {
  const Scene scene = loadScene(write("plane.scene",
                                      "s\n* wall\n1\nplane\n2 0 0 -6\n0 0 0\n"
                                      "0 0 0.70710678118654757 0.70710678118654757\n0 0 0 0\n.\n"));
  ASSERT_EQ(scene.obstacles.size(), 1u);
  ArticulatedCollisionManager manager(slider(Eigen::Vector3d::UnitY()));
  fcl::CollisionObjectd ball(std::make_shared<fcl::Sphered>(0.1));
  manager.bind("cart", &ball);
  scene.addTo(manager);
  manager.setup();
  EXPECT_TRUE(touchesAt(ask(manager, {1}, {4}), 1.9 / 3));
  EXPECT_TRUE(ask(manager, {1}, {2.8}).isFree());
  EXPECT_NE(messageOf([&] {
              loadScene(write("bad.scene", "s\n* wall\n1\nplane\n0 0 0 1\n0 0 0\n0 0 0 1\n0 0 0 0\n.\n"));
            }).find("normal is zero"),
            std::string::npos);
}

/// A node of a full OctoMap tree: its log-odds as a float, and which children follow.
std::string node(float log_odds, unsigned char children) {
  std::string bytes(reinterpret_cast<const char*>(&log_odds), sizeof log_odds);
  return bytes + static_cast<char>(children);
}
/// 16 levels, whose root is a cube of edge 2 at the origin.
std::string octomap(int nodes, const std::string& data) {
  return "# Octomap OcTree file\nid OcTree\nsize " + std::to_string(nodes) + "\nres 0.000030517578125\ndata\n" + data;
}

// Octant 0 is free, 1 (x > 0, y < 0, z < 0) and 7 (all > 0) are occupied, the others unknown. A ball of 0.1 on a slider
// goes along x from -2 to 2.
TEST_F(ManyRobotsTest, UnknownCellsOfAnOctoMap) {
  const std::string path = write("cells.ot", octomap(4, node(1, 0x83) + node(-1, 0) + node(1, 0) + node(1, 0)));
  SceneOptions options;
  EXPECT_EQ(loadScene(path, options).obstacles.size(), 2u);
  options.unknown_cells = true;
  const Scene all = loadScene(path, options);
  ASSERT_EQ(all.obstacles.size(), 7u);
  EXPECT_EQ(all.obstacles[0].name, "cells");
  EXPECT_EQ(all.obstacles[1].name, "cells/unknown");
  const auto run = [&](double y, double z, bool unknown) {
    ArticulatedCollisionManager manager(slider(Eigen::Vector3d::UnitX(), {0, y, z}));
    fcl::CollisionObjectd ball(std::make_shared<fcl::Sphered>(0.1));
    manager.bind("cart", &ball);
    SceneOptions scene_options;
    scene_options.unknown_cells = unknown;
    const Scene scene = loadScene(path, scene_options);
    scene.addTo(manager);
    manager.setup();
    return ask(manager, {-2}, {2});
  };
  // Through free space to the occupied cell that begins at x = 0.
  EXPECT_TRUE(touchesAt(run(-0.5, -0.5, false), 1.9 / 4));
  EXPECT_TRUE(touchesAt(run(-0.5, -0.5, true), 1.9 / 4));
  // Unknown from x = -1 on, occupied from 0 on.
  EXPECT_TRUE(touchesAt(run(0.5, 0.5, false), 1.9 / 4));
  EXPECT_TRUE(touchesAt(run(0.5, 0.5, true), 0.9 / 4));
  // Unknown only.
  EXPECT_TRUE(run(0.5, -0.5, false).isFree());
  EXPECT_TRUE(touchesAt(run(0.5, -0.5, true), 0.9 / 4));
}

// Two cells of octant 7 are known: a free one at its corner 0, and an occupied one at x, y > 1/2. So within the box of
// both, the two cells beside them are unknown, and nothing else of the root.
TEST_F(ManyRobotsTest, UnknownEndsWhereKnowledgeEnds) {
  const std::string path = write("part.ot", octomap(4, node(1, 0x80) + node(1, 0x09) + node(-1, 0) + node(1, 0)));
  SceneOptions options;
  options.unknown_cells = true;
  const Scene scene = loadScene(path, options);
  ASSERT_EQ(scene.obstacles.size(), 3u);
  EXPECT_EQ(scene.obstacles[0].name, "part/unknown");
  EXPECT_TRUE(scene.obstacles[0].object->getTranslation().isApprox(Eigen::Vector3d(0.75, 0.25, 0.25)));
  EXPECT_EQ(scene.obstacles[1].name, "part/unknown#2");
  EXPECT_TRUE(scene.obstacles[1].object->getTranslation().isApprox(Eigen::Vector3d(0.25, 0.75, 0.25)));
  EXPECT_EQ(scene.obstacles[2].name, "part");
  EXPECT_EQ(loadScene(path).obstacles.size(), 1u);
}

/// A node at the end of a path of octants, with all above it.
std::string branch(const std::vector<int>& octants, std::size_t from) {
  std::string nodes;
  for (std::size_t i = from; i < octants.size(); ++i) nodes += node(1, static_cast<unsigned char>(1 << octants[i]));
  return nodes + node(1, 0);
}

// Two cells of the last level, far from each other: their box cuts the cells between them at no coarse level. The
// unknown space is a few hundred boxes that fill it, not a cell for each square of its faces (10^9 of them).
TEST_F(ManyRobotsTest, UnknownSpaceIsFewBoxes) {
  std::vector<int> one = {0}, other = {7};
  for (int level = 2; level <= 16; ++level) {
    one.push_back(level % 2 ? 3 : 4);
    other.push_back(level % 2 ? 1 : 6);
  }
  const std::string data = node(1, 0x81) + branch(one, 1) + branch(other, 1);
  SceneOptions options;
  options.unknown_cells = true;
  const Scene scene = loadScene(write("far.ot", octomap(33, data)), options);
  EXPECT_LT(scene.obstacles.size(), 300u);
  double filled = 0;
  Eigen::Array3d lower = Eigen::Array3d::Constant(2), upper = -lower;
  for (const Scene::Obstacle& obstacle : scene.obstacles) {
    const auto& box = dynamic_cast<const fcl::Boxd&>(*obstacle.object->collisionGeometry());
    const Eigen::Array3d center = obstacle.object->getTranslation();
    filled += box.side.prod();
    lower = lower.min(center - 0.5 * box.side.array());
    upper = upper.max(center + 0.5 * box.side.array());
  }
  const double whole = (upper - lower).prod();
  EXPECT_GT(whole, 0.1);
  EXPECT_NEAR(filled, whole, 1e-9 * whole);
}

}  // namespace
}  // namespace many_robots_test
}  // namespace fcl_artic
