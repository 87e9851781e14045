// SPDX-License-Identifier: BSD-3-Clause
//
// Neighbours: links with at most one moving joint between them. The manager's rule for them if nobody says whether they
// may touch, and who can say so instead.
#include <cmath>
#include <sstream>

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/math/motion/translation_motion.h>
#include <fcl/narrowphase/continuous_collision_object.h>
#include <gtest/gtest.h>

#include "fcl_artic/manager.h"

namespace neighbours_test {

using namespace fcl_artic;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kPi = 3.14159265358979323846;

VectorXd at(double q) {
  return VectorXd::Constant(1, q);
}

std::shared_ptr<fcl::CollisionObjectd> box(double x, double y, double z) {
  return std::make_shared<fcl::CollisionObjectd>(std::make_shared<fcl::Boxd>(x, y, z));
}

Isometry3d to(double x, double y, double z) {
  return Isometry3d(Eigen::Translation3d(x, y, z));
}

/// A base and an arm that turns about z, by -pi to pi:
///
///     base [ ]<=====================  1.5 m         | post, 1 m from the base along y
///           axis
struct PostRobot {
  explicit PostRobot(JointType type = JointType::revolute) {
    auto made = std::make_shared<KinematicTree>("post");
    made->addLink("base");
    made->addLink("arm");
    Joint joint;
    joint.name = "joint";
    joint.type = type;
    joint.parent = "base";
    joint.child = "arm";
    joint.axis = type == JointType::prismatic ? Vector3d::UnitX() : Vector3d::UnitZ();
    if (type == JointType::revolute) {
      joint.lower = -kPi;
      joint.upper = kPi;
    }
    made->addJoint(joint);
    tree = made;
  }
  /// @param post  whether the base has one.
  /// @param gap  between base and arm along the axis; below 0: they overlap in the joint.
  ArticulatedCollisionManager manager(bool post, double gap) const {
    ArticulatedCollisionManager manager(tree);
    manager.bind("base", box(0.2, 0.2, 0.2), to(0, 0, -0.15 - gap));
    if (post) manager.bind("base", box(0.1, 0.1, 1), to(0, 1, 0));
    manager.bind("arm", box(1.5, 0.1, 0.1), to(0.75, 0, 0));
    return manager;
  }
  std::shared_ptr<const KinematicTree> tree;
};

TEST(Neighbours, AnArmMeetsThePostOfItsOwnBase) {
  ArticulatedCollisionManager manager = PostRobot().manager(true, 0.01);
  manager.setup();
  const CertifiedResult r = manager.continuousCollide(at(0), at(kPi));
  ASSERT_EQ(r.status, Status::contact);
  EXPECT_TRUE(r.certain);
  // The corner (c, d) = (0.05, 0.95) meets the side y = 0.05 of the arm: -c sin(q) + d cos(q) = 0.05.
  const double q = std::acos(0.05 / std::hypot(0.05, 0.95)) - std::atan2(0.05, 0.95);
  EXPECT_NEAR(r.t_lower, q / kPi, 1e-5);
  ASSERT_EQ(manager.neighbours().size(), 1u);
  EXPECT_EQ(manager.neighbours()[0].kind, LinkPairKind::sometimes);
  EXPECT_TRUE(manager.notes().empty());
  EXPECT_TRUE(manager.continuousCollide(at(0), at(kPi / 4)).isFree());
}

TEST(Neighbours, ProvenApartNothingIsSaid) {
  ArticulatedCollisionManager manager = PostRobot().manager(false, 0.01);
  manager.setup();
  EXPECT_EQ(manager.neighbours().at(0).kind, LinkPairKind::never);
  EXPECT_TRUE(manager.notes().empty());
  const CertifiedResult r = manager.continuousCollide(at(0), at(kPi));
  EXPECT_TRUE(r.isFree() && !r.nothingChecked());
  EXPECT_EQ(exceptionsOf(r), "");
}

TEST(Neighbours, HousingsThatOverlapAreNamedOnce) {
  ArticulatedCollisionManager manager = PostRobot().manager(false, -0.01);
  manager.setup();
  ASSERT_EQ(manager.notes().size(), 1u);
  EXPECT_NE(manager.notes()[0].find("'base' and 'arm'"), std::string::npos) << manager.notes()[0];
  const CertifiedResult r = manager.continuousCollide(at(0), at(kPi));
  EXPECT_TRUE(r.nothingChecked()) << "there is no other pair";
  EXPECT_EQ(r.unproven_allowed_pairs, 0u);
  EXPECT_TRUE(manager.checkedLinkPairs().empty());
}

// A housing that overlaps in the joint excuses no other part of the two links.
TEST(Neighbours, AnArmWhoseHousingOverlapsMeetsThePostOfItsOwnBase) {
  ArticulatedCollisionManager manager = PostRobot().manager(true, -0.01);
  manager.setup();
  const CertifiedResult r = manager.continuousCollide(at(0), at(kPi));
  ASSERT_EQ(r.status, Status::contact);
  EXPECT_NEAR(r.t_lower, (std::acos(0.05 / std::hypot(0.05, 0.95)) - std::atan2(0.05, 0.95)) / kPi, 1e-5);
  ASSERT_EQ(manager.notes().size(), 1u);
  EXPECT_NE(manager.notes()[0].find("'base' and 'arm' (but for their parts"), std::string::npos) << manager.notes()[0];
  const CertifiedResult before = manager.continuousCollide(at(0), at(kPi / 4));
  EXPECT_TRUE(before.isFree() && !before.nothingChecked());
  CertifiedRequest wide;
  wide.margin = 0.5;
  EXPECT_TRUE(manager.continuousCollide(JointMotion::linear(manager.tree(), at(0), at(0.1)), wide).isFree())
      << "for touching";
  // Set up again nothing is looked at anew, and the same parts are checked.
  manager.disallow("base", "arm");
  manager.setAllowedCollisions({});
  manager.setup();
  EXPECT_EQ(manager.continuousCollide(at(0), at(kPi)).t_lower, r.t_lower);
  // Who allows the two has it counted: their parts that are apart may meet.
  manager.allow("base", "arm");
  manager.setup();
  EXPECT_EQ(manager.continuousCollide(at(0), at(kPi)).unproven_allowed_pairs, 1u);
}

// A slide without limits: there is no range to look at.
TEST(Neighbours, UndecidedOnesAreCountedInEachAnswer) {
  ArticulatedCollisionManager manager = PostRobot(JointType::prismatic).manager(false, -0.01);
  const auto obstacle = box(0.1, 0.1, 0.1);
  obstacle->setTranslation(Vector3d(0, 0, 5));
  manager.registerObject(obstacle, "far");
  manager.setup();
  const CertifiedResult r = manager.continuousCollide(at(0), at(1));
  EXPECT_TRUE(r.isFree());
  EXPECT_EQ(exceptionsOf(r), "but for 1 pair of neighbours not proven apart: base, arm");
  EXPECT_EQ(r.unproven_allowed_pairs, 1u);
  EXPECT_EQ(manager.notes().size(), 1u);
  const auto way = JointTrajectory::linear(*PostRobot(JointType::prismatic).tree, {0, 1}, {at(0), at(1)});
  EXPECT_EQ(exceptionsOf(manager.continuousCollide(way)), exceptionsOf(r));
  CertifiedRequest scene;
  scene.check_self = false;
  EXPECT_EQ(exceptionsOf(manager.continuousCollide(JointMotion::linear(manager.tree(), at(0), at(1)), scene)), "");
  const ArticulatedCollisionManager shared = manager.shareRobot();
  EXPECT_EQ(shared.neighbours().size(), 1u);
  manager.allow("base", "arm");
  manager.setup();
  EXPECT_EQ(exceptionsOf(manager.continuousCollide(at(0), at(1))), "but for 1 allowed pair not proven apart");
}

TEST(Neighbours, WhoIsAskedForIsChecked) {
  for (const bool by_matrix : {false, true}) {
    ArticulatedCollisionManager manager = PostRobot().manager(false, -0.01);
    AllowedCollisionMatrix matrix;
    matrix.setComplete();
    if (by_matrix) manager.setAllowedCollisions(matrix);
    if (!by_matrix) manager.disallow("arm", "base");
    manager.setup();
    EXPECT_EQ(manager.collide(at(0)).status, Status::contact);
    EXPECT_TRUE(manager.neighbours().empty());
    manager.allow("arm", "base");
    manager.setup();
    EXPECT_TRUE(manager.collide(at(0)).isFree());
    manager.disallow("base", "arm");
    manager.setup();
    EXPECT_EQ(manager.shareRobot().collide(at(0)).status, Status::contact);
  }
  ArticulatedCollisionManager manager = PostRobot().manager(false, -0.01);
  AllowedCollisionMatrix wrong;
  wrong.disallow("base", "nobody");
  EXPECT_THROW(manager.setAllowedCollisions(wrong), std::invalid_argument);
}

// `free` does not cover allowed neighbours: those that touch at some values only are counted.
TEST(Neighbours, AllowedOnesCountWhereTheyTouchAtSomeValuesOnly) {
  ArticulatedCollisionManager post = PostRobot().manager(true, 0.01), housing = PostRobot().manager(false, -0.01);
  for (ArticulatedCollisionManager* manager : {&post, &housing}) {
    manager->allow("base", "arm");
    manager->setup();
    EXPECT_TRUE(manager->notes().empty()) << "somebody said so";
  }
  EXPECT_EQ(post.continuousCollide(at(0), at(kPi)).unproven_allowed_pairs, 1u);
  EXPECT_EQ(housing.continuousCollide(at(0), at(kPi)).unproven_allowed_pairs, 0u);
}

TEST(Neighbours, AreCheckedForTouchingUnlessThePairHasAMargin) {
  ArticulatedCollisionManager manager = PostRobot().manager(true, 0.01);
  manager.setMargin("arm", 0.02);
  manager.setup();
  CertifiedRequest wide;
  wide.margin = 0.03;
  const JointMotion motion = JointMotion::linear(manager.tree(), at(0), at(kPi / 4));
  EXPECT_TRUE(manager.continuousCollide(motion, wide).isFree());
  EXPECT_EQ(manager.continuousCollide(at(0), at(kPi)).status, Status::contact);
  EXPECT_GT(manager.clearance(motion).lower, 0.1) << "the gap in the joint is no clearance";
  wide.added_margin = 0.02;
  EXPECT_EQ(manager.continuousCollide(motion, wide).status, Status::contact);
  manager.setMargin("arm", "base", 0.02);
  manager.setup();
  EXPECT_EQ(manager.continuousCollide(at(0), at(kPi / 4)).status, Status::contact);
  manager.resetMargins();
  manager.disallow("arm", "base");
  manager.setup();
  wide.added_margin = 0;
  EXPECT_EQ(manager.continuousCollide(motion, wide).status, Status::contact);
}

// Neighbours are judged anew if the geometry has changed, also in place.
TEST(Neighbours, AreLookedAtAgainWhenTheyChange) {
  const auto shape = std::make_shared<fcl::Boxd>(0.2, 0.2, 0.2);
  const auto base = std::make_shared<fcl::CollisionObjectd>(shape);
  ArticulatedCollisionManager manager(PostRobot().tree);
  manager.bind("base", base, to(0, 0, -0.16));
  manager.bind("arm", box(1.5, 0.1, 0.1), to(0.75, 0, 0));
  manager.setup();
  EXPECT_EQ(manager.neighbours().at(0).kind, LinkPairKind::never);
  shape->side[2] = 0.4;
  manager.setup();
  EXPECT_TRUE(manager.neighbours().at(0).touchThroughout());
  const auto post = box(0.1, 0.1, 1);
  shape->side[2] = 0.2;
  manager.bind("base", post, to(0, 1, 0));
  manager.setup();
  EXPECT_EQ(manager.continuousCollide(at(0), at(kPi)).status, Status::contact);
  manager.unbind(post);
  manager.setup();
  EXPECT_TRUE(manager.continuousCollide(at(0), at(kPi)).isFree());
}

TEST(Neighbours, AreClassifiedAsAnyPair) {
  const LinkPairReport report = PostRobot().manager(true, 0.01).classifyLinkPairs();
  ASSERT_EQ(report.pairs.size(), 1u);
  EXPECT_TRUE(report.pairs[0].neighbours);
  EXPECT_EQ(report.pairs[0].kind, LinkPairKind::sometimes);
  EXPECT_TRUE(report.needNoCheck().pairs().empty());
  const LinkPairReport housing = PostRobot().manager(false, -0.01).classifyLinkPairs();
  EXPECT_EQ(housing.pairs.at(0).kind, LinkPairKind::always);
  EXPECT_TRUE(housing.alwaysTouching().pairs().empty()) << "the manager's own to find";
  EXPECT_EQ(housing.needNoCheck().pairs().size(), 1u);
}

/// A base with two fixtures that overlap, on a table; an arm with a tool and a cover that overlap it and each other:
///
///        arm =======[tool[cover]
///     [base]  [left[right]
///     ========== table
class StillPairs : public ::testing::Test {
 protected:
  StillPairs() {
    auto made = std::make_shared<KinematicTree>("cell");
    for (const char* link : {"base", "left", "right", "arm", "tool", "cover"}) made->addLink(link);
    const auto add = [&](const char* name, JointType type, const char* parent, const char* child) {
      Joint joint;
      joint.name = name;
      joint.type = type;
      joint.parent = parent;
      joint.child = child;
      joint.axis = Vector3d::UnitZ();
      if (type == JointType::revolute) joint.lower = -kPi, joint.upper = kPi;
      made->addJoint(joint);
    };
    add("left", JointType::fixed, "base", "left");
    add("right", JointType::fixed, "left", "right");
    add("turn", JointType::revolute, "base", "arm");
    add("tool", JointType::fixed, "arm", "tool");
    add("cover", JointType::fixed, "tool", "cover");
    tree_ = made;
  }
  ArticulatedCollisionManager manager(bool table = true) const {
    ArticulatedCollisionManager manager(tree_);
    manager.bind("base", box(0.2, 0.2, 0.2), to(0, 0, -0.2));
    manager.bind("left", box(0.2, 0.2, 0.2), to(0.3, 0, -0.2));
    manager.bind("right", box(0.2, 0.2, 0.2), to(0.4, 0, -0.2));
    manager.bind("arm", box(1, 0.1, 0.1), to(0.5, 0, 0.1));
    manager.bind("tool", box(0.1, 0.1, 0.1), to(1, 0, 0.1));
    manager.bind("cover", box(0.1, 0.1, 0.1), to(1.05, 0, 0.1));
    if (table) manager.registerObject(table_.get(), "table");
    manager.setup();
    return manager;
  }
  static std::string stillNote(const ArticulatedCollisionManager& manager) {
    for (const std::string& note : manager.notes()) {
      if (note.find("stand still against each other") != std::string::npos) return note;
    }
    return {};
  }

  std::shared_ptr<fcl::CollisionObjectd> table_ = std::make_shared<fcl::CollisionObjectd>(
      std::make_shared<fcl::Boxd>(3, 3, 0.1), fcl::Transform3d(Eigen::Translation3d(0, 0, -0.32)));
  std::shared_ptr<const KinematicTree> tree_;
};

TEST_F(StillPairs, AreNoContactOfAMotion) {
  ArticulatedCollisionManager robot = manager();
  for (const double margin : {0.0, 0.05}) {
    CertifiedRequest request;
    request.margin = margin;
    const CertifiedResult result = robot.continuousCollide(at(0), at(3), request);
    EXPECT_TRUE(result.isFree());
    EXPECT_EQ(result.unproven_allowed_pairs, 0u);
    EXPECT_TRUE(result.ignored_initial_contacts.empty());
    EXPECT_GT(result.statistics.pairs, 0u) << "the arm and the table";
    EXPECT_TRUE(robot.collide(at(0), request).isFree());
  }
  EXPECT_TRUE(robot.clearance(JointMotion::linear(*tree_, at(0), at(3))).lower > 0.1);
  const std::string note = stillNote(robot);
  for (const char* pair : {"'base' and 'table'", "'left' and 'table'", "'right' and 'table'", "'left' and 'right'",
                           "'arm' and 'tool'", "'arm' and 'cover'", "'cover' and 'tool'"}) {
    EXPECT_NE(note.find(pair), std::string::npos) << pair << " in: " << note;
  }
  for (const char* pair : {"'base' and 'left'", "'base' and 'right'", "'arm' and 'table'", "'arm' and 'base'"}) {
    EXPECT_EQ(note.find(pair), std::string::npos) << pair << " in: " << note;
  }
}

TEST_F(StillPairs, AreCheckedWhereSomebodyAsks) {
  const std::pair<std::string, std::string> pairs[] = {{"base", "table"}, {"left", "right"}, {"cover", "arm"}};
  for (const auto& [a, b] : pairs) {
    ArticulatedCollisionManager robot = manager();
    robot.disallow(a, b);
    robot.setup();
    const CertifiedResult result = robot.continuousCollide(at(0), at(1));
    ASSERT_EQ(result.status, Status::contact) << a;
    EXPECT_EQ(result.t_lower, 0);
    EXPECT_EQ(std::minmax(result.first()->body1.name, result.first()->body2.name), std::minmax(a, b));
    EXPECT_EQ(stillNote(robot).find("'" + std::min(a, b) + "' and '" + std::max(a, b) + "'"), std::string::npos);
  }
  // A matrix that is complete says which pairs may touch, and none that stand still is a matter of a motion.
  ArticulatedCollisionManager robot = manager();
  AllowedCollisionMatrix matrix;
  matrix.setComplete();
  robot.setAllowedCollisions(matrix);
  robot.setup();
  EXPECT_TRUE(robot.continuousCollide(at(0), at(1)).isFree());
}

TEST_F(StillPairs, WhateverMovesIsChecked) {
  // An obstacle in the arm's way, one that the arm carries into its own base, and one that moves through the base.
  const auto post = std::make_shared<fcl::CollisionObjectd>(std::make_shared<fcl::Boxd>(0.1, 0.1, 1),
                                                            fcl::Transform3d(Eigen::Translation3d(0, 0.8, 0)));
  ArticulatedCollisionManager robot = manager();
  robot.registerObject(post.get(), "post");
  robot.setup();
  EXPECT_EQ(robot.continuousCollide(at(0), at(3)).status, Status::contact);
  EXPECT_NE(stillNote(robot).find("'base' and 'table'"), std::string::npos);
  // Carried by the arm beside the tool, into which it reaches, it stands still against both; not against the table.
  robot.attach("arm", post.get(), to(0.95, 0, 0.1));
  robot.setup();
  EXPECT_NE(stillNote(robot).find("'post' and 'tool'"), std::string::npos);
  const CertifiedResult low = robot.continuousCollide(at(0), at(3));
  ASSERT_EQ(low.status, Status::contact);
  EXPECT_TRUE(low.first()->body1.name == "post" || low.first()->body2.name == "post");
  EXPECT_NE(low.first()->body1.name, "tool");
  EXPECT_NE(low.first()->body2.name, "tool");

  ArticulatedCollisionManager alone = manager(false);
  fcl::ContinuousCollisionObjectd cart(
      std::make_shared<fcl::Boxd>(0.1, 0.1, 0.1),
      std::make_shared<fcl::TranslationMotiond>(fcl::Transform3d(Eigen::Translation3d(-2, 0, -0.2)),
                                                fcl::Transform3d(Eigen::Translation3d(0, 0, -0.2))));
  alone.registerObject(&cart, "cart");
  alone.setup();
  const CertifiedResult met = alone.continuousCollide(at(0), at(0));
  ASSERT_EQ(met.status, Status::contact);
  EXPECT_NEAR(met.t_lower, (2 - 0.15) / 2, 1e-5);
}

/// A joint between the world and an arm that reaches 1 m along its x axis, moved over what is in the arm's way: an
/// obstacle, or a post of the world's own.
/// @param how  a limit leaves the joint one value ("locked"), or it follows one that moves nothing ("mimic").
void expectThatItMoves(JointType type, const std::string& how) {
  auto tree = std::make_shared<KinematicTree>("arm");
  for (const char* link : {"world", "lead", "arm"}) tree->addLink(link);
  if (how == "mimic") tree->addJoint(Joint::prismatic("lead", "world", "lead", Vector3d::UnitZ()));
  Joint joint;
  joint.name = "joint";
  joint.type = type;
  joint.parent = "world";
  joint.child = "arm";
  joint.axis = type == JointType::prismatic ? Vector3d::UnitY() : Vector3d::UnitZ();
  if (how == "locked") joint.lower = joint.upper = 0.25;
  joint.mimics = how == "mimic";
  if (joint.mimics) joint.mimic = {"lead", 1, 0};
  tree->addJoint(joint);
  VectorXd q0 = tree->neutralConfiguration(), q1 = q0;
  if (type == JointType::spherical) {
    q1 << 0, 0, std::sin(1), std::cos(1);
  } else {
    q1[tree->dof() > 1 ? 1 : 0] = 2;
  }
  const JointMotion motion = JointMotion::linear(*tree, q0, q1);
  const Isometry3d met = tree->linkPose(tree->linkId("arm"), motion.configuration(0.5)) * to(1, 0, 0);
  for (const bool own : {false, true}) {
    ArticulatedCollisionManager manager(tree);
    manager.bind("arm", box(0.1, 0.1, 0.1), to(1, 0, 0));
    const auto post = box(0.1, 0.1, 0.1);
    if (own) {
      manager.bind("world", post, met);
      manager.disallow("arm", "world");  // the rule for neighbours can't decide on joints without limits
    } else {
      post->setTransform(met);
      manager.registerObject(post, "post");
    }
    manager.setup();
    const CertifiedResult result = manager.continuousCollide(motion);
    EXPECT_EQ(result.status, Status::contact) << static_cast<int>(type) << ' ' << how << ' ' << own;
    EXPECT_GT(result.t_lower, 0.3) << static_cast<int>(type) << ' ' << how << ' ' << own;
  }
}

TEST(StillPairsOfJoints, NoneThatAJointOfAnyKindMoves) {
  for (const JointType type : {JointType::revolute, JointType::continuous, JointType::prismatic, JointType::planar,
                               JointType::spherical, JointType::floating}) {
    expectThatItMoves(type, "");
  }
  for (const JointType type : {JointType::revolute, JointType::continuous, JointType::prismatic}) {
    expectThatItMoves(type, "mimic");
    if (type != JointType::continuous) expectThatItMoves(type, "locked");
  }
}

// Two that are carried are checked against each other, whatever links they may touch.
TEST(StillPairsOfJoints, TwoThatAreCarriedMeet) {
  const PostRobot robot;
  ArticulatedCollisionManager manager(robot.tree);
  const auto tool = box(0.1, 0.1, 0.1), lamp = box(0.1, 0.1, 0.1);
  manager.registerObject(tool, "tool");
  manager.registerObject(lamp, "lamp");
  manager.attach("arm", tool, to(1, 0, 0), {"base"});
  manager.attach("base", lamp, to(0, 1, 0), {"arm"});
  manager.setup();
  EXPECT_EQ(manager.continuousCollide(at(0), at(3)).status, Status::contact);
}

// The next obstacle of a name is another object.
TEST(StillPairsOfJoints, WhatWasAllowedGoesWithItsObstacle) {
  const PostRobot robot;
  ArticulatedCollisionManager manager(robot.tree);
  manager.bind("arm", box(0.1, 0.1, 0.1), to(1, 0, 0));
  const auto first = box(0.1, 0.1, 0.1), second = box(0.1, 0.1, 0.1);
  for (const auto& post : {first, second}) post->setTransform(to(0, 1, 0));
  manager.registerObject(first, "post");
  manager.allow("arm", "post");
  manager.setup();
  EXPECT_TRUE(manager.continuousCollide(at(0), at(3)).isFree());
  manager.unregisterObject(first);
  manager.registerObject(second, "post");
  manager.setup();
  EXPECT_EQ(manager.continuousCollide(at(0), at(3)).status, Status::contact);
}

}  // namespace neighbours_test
