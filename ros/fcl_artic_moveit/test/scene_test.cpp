// SPDX-License-Identifier: BSD-3-Clause
// Which pairs are checked, and with which distance: configurations beside MoveIt's own answer with FCL.
#include <iostream>

#include <octomap/octomap.h>

#include "fcl_artic_moveit/cell.h"
#include "models.h"

namespace fcl_artic_moveit {
namespace {

using fcl_artic::Status;

/// Whether the cell says contact at a state.
bool collides(Cell& cell, const Surroundings& all, const moveit::core::RobotState& state, const std::string& group) {
  cell.update(*all.env, all.acm, state, group.empty() ? nullptr : all.model->getJointModelGroup(group));
  return !cell.manager().collide(cell.robot().configuration(state)).isFree();
}
bool collides(Cell& cell, const Surroundings& all, const std::string& group = "") {
  return collides(cell, all, all.state, group);
}

/// Random configurations of the slider beside MoveIt's answer.
struct Counts {
  int free = 0, contact = 0, other = 0;
};
Counts compare(const Surroundings& all, int configurations, const std::string& group = "all") {
  Cell cell(all.model);
  Counts out;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> rail(-1, 1), turn(-2, 2), reach(-0.3, 1);
  moveit::core::RobotState state(all.state);
  for (int i = 0; i < configurations; ++i) {
    state.setVariablePosition("rail", rail(random));
    state.setVariablePosition("turn", turn(random));
    state.setVariablePosition("reach", reach(random));
    state.update();
    const bool theirs = all.moveitCollides(state, group);
    const bool ours = collides(cell, all, state, group);
    ++(theirs != ours ? out.other : ours ? out.contact : out.free);
  }
  EXPECT_LE(cell.robotsRead(), 2) << "once, and once more as arm and finger, neighbours, are to be checked";
  return out;
}

TEST(Scene, EveryShapeIsWhereMoveItHasIt) {
  auto cells = std::make_shared<octomap::OcTree>(0.05);
  for (float x = -0.2F; x < 0.2F; x += 0.05F) {
    for (float y = -0.2F; y < 0.2F; y += 0.05F) cells->updateNode(octomap::point3d(x, y, 0.02F), true);
  }
  const std::vector<std::pair<const char*, shapes::ShapeConstPtr>> shapes{
      {"sphere", std::make_shared<shapes::Sphere>(0.3)},
      {"box", std::make_shared<shapes::Box>(0.3, 0.6, 0.2)},
      {"cylinder", std::make_shared<shapes::Cylinder>(0.2, 0.6)},
      {"cone", std::make_shared<shapes::Cone>(0.3, 0.7)},
      {"mesh", boxMesh(0.3, 0.6, 0.4)},
      {"plane", std::make_shared<shapes::Plane>(0.3, 1, 0.1, 0)},
      {"octree", std::make_shared<shapes::OcTree>(cells)}};
  for (const auto& [name, shape] : shapes) {
    SCOPED_TRACE(name);
    Surroundings all(slider());
    Eigen::Isometry3d object = Eigen::Isometry3d::Identity(), in_object = Eigen::Isometry3d::Identity();
    object.translation() << 0.9, 0.3, 0;
    object.linear() = Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    in_object.translation() << 0, 0.2, 0.03;
    in_object.linear() = Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitX()).toRotationMatrix();
    all.world->addToObject(name, object, shape, in_object);
    const Counts counts = compare(all, 150);
    std::cout << name << ": " << counts.free << " free, " << counts.contact << " in contact, " << counts.other
              << " other than MoveIt's\n";
    EXPECT_GE(counts.free, 15);
    EXPECT_GE(counts.contact, 15);
    EXPECT_EQ(counts.other, 0);
  }
}

/// A plane's equation as shape_msgs/Plane has it: z = 0.2 with normal up, through the finger at z in [-0.05, 0.05].
TEST(Scene, PlaneIsItsEquation) {
  Surroundings all(slider());
  const auto at = [&](double d) {
    all.world->removeObject("plane");
    all.add("plane", std::make_shared<shapes::Plane>(0, 0, 1, d), Eigen::Vector3d::Zero());
  };
  Cell cell(all.model);
  at(-0.2);  // z = 0.2
  EXPECT_FALSE(collides(cell, all, "all"));
  at(-0.04);
  EXPECT_TRUE(collides(cell, all, "all"));
  at(0.2);  // z = -0.2
  EXPECT_FALSE(collides(cell, all, "all"));
  at(0.04);
  EXPECT_TRUE(collides(cell, all, "all"));
}

TEST(Scene, BaseAndGroupAsInMoveIt) {
  Surroundings all(slider());
  all.add("floor", std::make_shared<shapes::Box>(1, 1, 0.2), {0, 0, -1.1});  // the base stands in it
  Cell cell(all.model);
  EXPECT_FALSE(collides(cell, all)) << "no joint moves the base against the floor, also without a group";
  EXPECT_TRUE(all.moveitCollides(all.state));
  ASSERT_EQ(cell.manager().notes().size(), 1U) << "which says so";
  expectContains(cell.manager().notes()[0], "floor");
  EXPECT_FALSE(collides(cell, all, "all")) << "the base moves with no joint of the group";
  EXPECT_FALSE(all.moveitCollides(all.state, "all"));
  all.add("block", std::make_shared<shapes::Box>(0.1, 0.1, 0.1), {0.5, 0, 0});  // the arm is in it
  EXPECT_TRUE(collides(cell, all, "all"));
  EXPECT_FALSE(collides(cell, all, "reach_only")) << "the arm does not move";
  EXPECT_FALSE(all.moveitCollides(all.state, "reach_only"));
  EXPECT_TRUE(collides(cell, all, "rail_only")) << "the rail carries the arm";
  EXPECT_EQ(cell.robotsRead(), 2);
}

TEST(Scene, NeighboursAreCheckedWhereNothingAllowsThem) {
  Surroundings all(slider(""));  // cart and arm overlap, and no SRDF says that they may
  Cell cell(all.model);
  EXPECT_TRUE(all.moveitCollides(all.state, "all"));
  EXPECT_TRUE(collides(cell, all, "all"));
  const auto first = cell.manager().collide(cell.robot().configuration(all.state));
  EXPECT_EQ(cell.nameOf(first.first()->body1).kind, BodyName::link);
  // Arm and finger: neighbours that touch only where the finger is drawn in.
  Surroundings allowed(slider());
  Cell other(allowed.model);
  EXPECT_FALSE(collides(other, allowed, "all"));
  EXPECT_EQ(other.robotsRead(), 2) << "pairs of neighbours are to be checked: read again";
  allowed.state.setVariablePosition("reach", -0.2);
  allowed.state.update();
  EXPECT_TRUE(allowed.moveitCollides(allowed.state, "all"));
  EXPECT_TRUE(collides(other, allowed, "all"));
  const auto result = other.manager().collide(other.robot().configuration(allowed.state));
  const std::set<std::string> names{other.nameOf(result.first()->body1).id, other.nameOf(result.first()->body2).id};
  EXPECT_EQ(names, (std::set<std::string>{"arm", "finger"}));
}

TEST(Scene, RandomConfigurationsWithSelfContact) {
  Surroundings all(slider());
  all.add("post", std::make_shared<shapes::Cylinder>(0.1, 1), {0.5, 0.6, 0});
  const Counts counts = [&] {
    Cell warm(all.model);
    (void)collides(warm, all, "all");
    EXPECT_EQ(warm.robotsRead(), 2);
    Counts out;
    std::mt19937 random(11);
    std::uniform_real_distribution<double> rail(-1, 1), turn(-2, 2), reach(-0.3, 1);
    for (int i = 0; i < 200; ++i) {
      all.state.setVariablePosition("rail", rail(random));
      all.state.setVariablePosition("turn", turn(random));
      all.state.setVariablePosition("reach", reach(random));
      all.state.update();
      const bool theirs = all.moveitCollides(all.state, "all"), ours = collides(warm, all, "all");
      ++(theirs != ours ? out.other : ours ? out.contact : out.free);
    }
    return out;
  }();
  std::cout << counts.free << " free, " << counts.contact << " in contact\n";
  EXPECT_GE(counts.free, 30);
  EXPECT_GE(counts.contact, 30);
  EXPECT_EQ(counts.other, 0);
}

TEST(Scene, AllowedCollisionMatrix) {
  Surroundings all(slider());
  all.add("block", std::make_shared<shapes::Box>(0.1, 0.1, 0.1), {0.5, 0, 0});
  Cell cell(all.model);
  const auto both = [&](const char* what, bool wanted) {
    SCOPED_TRACE(what);
    EXPECT_EQ(collides(cell, all, "all"), wanted);
    EXPECT_EQ(all.moveitCollides(all.state, "all"), wanted);
  };
  both("no entry", true);
  all.acm.setEntry("block", "arm", true);
  both("an entry that allows", false);
  all.acm.setEntry("block", "arm", false);
  both("an entry that forbids", true);
  all.acm.setDefaultEntry("block", true);
  both("the entry counts before a default", true);
  all.acm.removeEntry("block", "arm");
  both("a default of one", false);
  all.acm.setDefaultEntry("arm", false);
  both("defaults of both: one forbids", true);
  all.acm.setDefaultEntry("arm", true);
  both("defaults of both", false);
  all.acm = collision_detection::AllowedCollisionMatrix(*all.model->getSRDF());
  collision_detection::DecideContactFn never_bad = [](collision_detection::Contact&) { return true; };
  all.acm.setEntry("block", "arm", never_bad);
  EXPECT_FALSE(all.moveitCollides(all.state, "all"));
  EXPECT_TRUE(collides(cell, all, "all")) << "a condition can't be decided ahead: the pair is checked";
}

/// The arm's box ends at y = 0.05, the wall begins at y = 0.15: 0.1 m apart.
TEST(Scene, PaddingIsADistanceToTheWorldOnly) {
  Surroundings all(slider());
  all.add("wall", std::make_shared<shapes::Box>(0.1, 0.2, 0.1), {0.5, 0.25, 0});
  Cell cell(all.model);
  const auto at = [&](double padding) {
    all.env->setLinkPadding("arm", padding);
    return collides(cell, all, "all");
  };
  EXPECT_FALSE(at(0));
  EXPECT_FALSE(at(0.09));
  EXPECT_TRUE(at(0.11));
  EXPECT_TRUE(all.moveitCollides(all.state, "all"));
  // Arm and finger are 0.05 m apart: padding does not count between links.
  EXPECT_FALSE(at(0.099));
  EXPECT_FALSE(all.moveitCollides(all.state, "all"));
  EXPECT_TRUE(at(0.2));
  EXPECT_FALSE(at(0));
  // A body that a link carries is padded as the link.
  all.attach("tool", "finger", std::make_shared<shapes::Box>(0.1, 0.1, 0.1), {0.1, 0.3, 0}, {"finger"});
  all.add("post", std::make_shared<shapes::Box>(0.1, 0.1, 0.1), {1.1, 0.5, 0});  // 0.1 m from the tool
  EXPECT_FALSE(at(0));
  all.env->setLinkPadding("finger", 0.09);
  EXPECT_FALSE(collides(cell, all, "all"));
  all.env->setLinkPadding("finger", 0.11);
  EXPECT_TRUE(collides(cell, all, "all"));
  EXPECT_TRUE(all.moveitCollides(all.state, "all"));
}

TEST(Scene, AttachedBodies) {
  Surroundings all(slider());
  Cell cell(all.model);
  (void)collides(cell, all, "all");
  const int read = cell.robotsRead();
  const auto box = std::make_shared<shapes::Box>(0.1, 0.1, 0.1);
  // A tool beside the finger, that overlaps it: allowed by its touch links, or not.
  all.attach("tool", "finger", box, {0.1, 0.08, 0}, {"finger"});
  EXPECT_FALSE(collides(cell, all, "all"));
  EXPECT_FALSE(all.moveitCollides(all.state, "all"));
  EXPECT_EQ(cell.robotsRead(), read);
  all.state.clearAttachedBodies();
  all.attach("tool", "finger", box, {0.1, 0.08, 0}, {});
  EXPECT_TRUE(all.moveitCollides(all.state, "all"));
  EXPECT_FALSE(collides(cell, all, "all")) << "no touch link, but no joint moves the two against each other";
  ASSERT_EQ(cell.manager().notes().size(), 1U) << "which says so";
  expectContains(cell.manager().notes()[0], "tool");
  EXPECT_EQ(cell.robotsRead(), read + 1);
  // Apart from the finger and without touch links.
  all.state.clearAttachedBodies();
  all.attach("tool", "finger", box, {0.1, 0.3, 0}, {});
  EXPECT_FALSE(all.moveitCollides(all.state, "all"));
  EXPECT_FALSE(collides(cell, all, "all"));
  // It comes to the arm, the finger's neighbour, when it is drawn in.
  all.state.clearAttachedBodies();
  all.attach("tool", "finger", box, {-0.1, 0.08, 0}, {"finger"});
  EXPECT_TRUE(all.moveitCollides(all.state, "all"));
  EXPECT_TRUE(collides(cell, all, "all"));
  all.state.clearAttachedBodies();
  all.attach("tool", "finger", box, {-0.1, 0.08, 0}, {"finger", "arm"});
  EXPECT_FALSE(all.moveitCollides(all.state, "all"));
  EXPECT_FALSE(collides(cell, all, "all"));
  // Touch links say nothing of the world.
  all.add("post", box, {0.9, 0.1, 0});
  EXPECT_TRUE(all.moveitCollides(all.state, "all"));
  EXPECT_TRUE(collides(cell, all, "all"));
  all.world->removeObject("post");
  EXPECT_FALSE(collides(cell, all, "all"));
  // Two bodies on one link may overlap; on two links one has to list the other.
  all.attach("tool2", "finger", box, {-0.1, 0.1, 0}, {"finger", "arm"});
  EXPECT_FALSE(all.moveitCollides(all.state, "all"));
  EXPECT_FALSE(collides(cell, all, "all"));
  all.state.clearAttachedBody("tool2");
  all.attach("tool2", "arm", box, {0.9, 0.1, 0}, {"finger", "arm"});
  EXPECT_TRUE(all.moveitCollides(all.state, "all"));
  EXPECT_TRUE(collides(cell, all, "all"));
  all.state.clearAttachedBody("tool2");
  all.attach("tool2", "arm", box, {0.9, 0.1, 0}, {"finger", "arm", "tool"});
  EXPECT_FALSE(all.moveitCollides(all.state, "all"));
  EXPECT_FALSE(collides(cell, all, "all"));
}

/// Bodies that stay the same are kept, bodies that change are not: an object that comes, moves and goes, one that is
/// taken up.
TEST(Scene, ChangesArriveAndTheRobotStays) {
  Surroundings all(slider());
  Cell cell(all.model);
  (void)collides(cell, all, "all");
  const int read = cell.robotsRead();
  const auto box = std::make_shared<shapes::Box>(0.1, 0.1, 0.1);
  EXPECT_FALSE(collides(cell, all, "all"));
  all.add("block", box, {0.5, 0, 0});
  EXPECT_TRUE(collides(cell, all, "all"));
  Eigen::Isometry3d away = Eigen::Isometry3d::Identity();
  away.translation() << 0, 0.5, 0;
  all.world->moveObject("block", away);
  EXPECT_FALSE(collides(cell, all, "all"));
  all.add("block", std::make_shared<shapes::Box>(0.1, 1, 0.1), {0.5, 0, 0});  // its second shape, y from 0 to 1
  EXPECT_TRUE(collides(cell, all, "all"));
  all.world->removeObject("block");
  EXPECT_FALSE(collides(cell, all, "all"));
  all.attach("block", "finger", box, {0.3, 0, 0}, {"finger"});
  EXPECT_FALSE(collides(cell, all, "all"));
  all.add("wall", box, {1.3, 0, 0});
  EXPECT_TRUE(collides(cell, all, "all"));
  all.state.clearAttachedBodies();
  EXPECT_FALSE(collides(cell, all, "all"));
  // Octrees change in place.
  auto cells = std::make_shared<octomap::OcTree>(0.05);
  cells->updateNode(octomap::point3d(0.5F, 2, 0), true);
  all.add("<octomap>", std::make_shared<shapes::OcTree>(cells), Eigen::Vector3d::Zero());
  EXPECT_FALSE(collides(cell, all, "all"));
  cells->updateNode(octomap::point3d(0.5F, 0, 0), true);
  EXPECT_TRUE(collides(cell, all, "all"));
  EXPECT_EQ(cell.robotsRead(), read);
}

/// Objects of one name with a link or with another object's second shape are told from one another.
TEST(Scene, NamesThatComeTwice) {
  Surroundings all(slider());
  const auto box = std::make_shared<shapes::Box>(0.1, 0.1, 0.1);
  all.add("arm", box, {5, 0, 0});
  all.add("box", box, {5, 1, 0});
  all.add("box", box, {0.5, 0, 0});
  all.add("box#2", box, {5, 2, 0});
  Cell cell(all.model);
  EXPECT_TRUE(collides(cell, all, "all"));
  const auto result = cell.manager().collide(cell.robot().configuration(all.state));
  EXPECT_EQ(cell.nameOf(result.first()->body1).id, "arm");
  EXPECT_EQ(cell.nameOf(result.first()->body1).kind, BodyName::link);
  EXPECT_EQ(cell.nameOf(result.first()->body2).id, "box");
  EXPECT_EQ(cell.nameOf(result.first()->body2).kind, BodyName::object);
}

TEST(Scene, WhatCannotBeCertifiedIsRefused) {
  Surroundings all(slider());
  Cell cell(all.model);
  all.env->setLinkScale("arm", 1.1);
  expectContains(refusal([&] { (void)collides(cell, all, "all"); }), "link 'arm' is scaled by 1.1");
  all.env->setLinkScale("arm", 1);
  all.attach("wall", "arm", std::make_shared<shapes::Plane>(0, 0, 1, 0), {0, 0, 0}, {});
  Cell other(all.model);
  expectContains(refusal([&] { (void)collides(other, all, "all"); }), "attached body 'wall'");
  all.state.clearAttachedBodies();
  auto mesh = std::make_shared<shapes::Mesh>(3, 0);
  all.add("nothing", mesh, {0, 0, 0});
  Cell third(all.model);
  expectContains(refusal([&] { (void)collides(third, all, "all"); }), "object 'nothing' has a mesh without triangles");
  Surroundings foreign(slider());
  expectContains(refusal([&] { (void)collides(third, foreign, "all"); }), "another robot model");
}

}  // namespace
}  // namespace fcl_artic_moveit
