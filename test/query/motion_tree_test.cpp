// SPDX-License-Identifier: BSD-3-Clause
//
// A motion is refused by every tree but those with its own joint variables. Other numbers of the same count would be
// read as other joints', or beyond the motion's end.
#include <functional>
#include <random>

#include <fcl/geometry/shape/box.h>
#include <gtest/gtest.h>

#include "arms.h"
#include "fcl_artic/fcl_link_motion.h"
#include "fcl_artic/in_between.h"

namespace motion_tree_test {

using namespace fcl_artic;
using namespace fcl_artic::test;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

struct JointChoice {
  std::string name;
  JointType type;
};

/// A chain of these joints; every link is 0.3 m long.
std::shared_ptr<KinematicTree> chain(const std::string& name, const std::vector<JointChoice>& joints) {
  auto tree = std::make_shared<KinematicTree>(name);
  tree->addLink("link0");
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const std::string link = "link" + std::to_string(i + 1);
    tree->addLink(link);
    tree->addJoint(makeJoint(joints[i].name, joints[i].type, "link" + std::to_string(i), link, Vector3d::UnitZ(),
                             pose({0.3, 0, 0})));
  }
  return tree;
}

std::shared_ptr<KinematicTree> arm(const std::string& name = "arm", const std::string& joint = "turn") {
  std::vector<JointChoice> joints;
  for (int i = 0; i < 7; ++i) joints.push_back({joint + std::to_string(i), JointType::revolute});
  return chain(name, joints);
}

/// Every way of asking about a motion.
struct Asked {
  std::shared_ptr<const KinematicTree> tree;
  std::shared_ptr<fcl::CollisionObjectd> wall = object(std::make_shared<fcl::Boxd>(1, 1, 1), pose({9, 0, 0}));
  std::vector<std::shared_ptr<fcl::CollisionObjectd>> bodies;
  ArticulatedCollisionManager manager;
  explicit Asked(const std::shared_ptr<const KinematicTree>& of) : tree(of), manager(of) {
    for (LinkId link = 0; link < tree->numLinks(); ++link) {
      bodies.push_back(ball(0.1));
      manager.bind(link, bodies.back().get());
    }
    manager.registerObject(wall.get(), "wall");
    manager.setup();
  }
  /// The message of each way that refuses; empty if it does not.
  std::vector<std::string> refusals(const JointMotion& motion) const {
    const std::vector<std::function<void()>> ways = {
        [&] {
          CertifiedResult r;
          manager.continuousCollide(motion, {}, r);
        },
        [&] {
          std::vector<CertifiedResult> r;
          manager.continuousCollide(std::vector<JointMotion>{motion, motion}, {}, r);
        },
        [&] { (void)manager.clearance(motion); },
        [&] { FclLinkMotion(*tree, motion, tree->numLinks() - 1); },
    };
    std::vector<std::string> said;
    for (const auto& way : ways) {
      said.emplace_back();
      try {
        way();
      } catch (const std::invalid_argument& e) {
        said.back() = e.what();
      }
    }
    return said;
  }
};

JointMotion still(const KinematicTree& tree) {
  return JointMotion::linear(tree, tree.neutralConfiguration(), tree.neutralConfiguration());
}

}  // namespace

TEST(MotionTree, OtherJointsOfTheSameNumberAreRefused) {
  const auto robot = arm("arm");
  const std::vector<std::shared_ptr<KinematicTree>> others = {
      chain("drone", {{"fly", JointType::floating}}),
      chain("ball", {{"wrist", JointType::spherical}, {"plane", JointType::planar}}),
      chain("mixed", {{"turn0", JointType::revolute},
                      {"turn1", JointType::revolute},
                      {"turn2", JointType::revolute},
                      {"wrist", JointType::spherical}}),
      chain("sliding", {{"turn0", JointType::prismatic},
                        {"turn1", JointType::revolute},
                        {"turn2", JointType::revolute},
                        {"turn3", JointType::revolute},
                        {"turn4", JointType::revolute},
                        {"turn5", JointType::revolute},
                        {"turn6", JointType::revolute}}),
      arm("left", "left_turn"),
  };
  std::vector<std::shared_ptr<KinematicTree>> all = others;
  all.push_back(robot);
  int refused = 0;
  for (const auto& tree : all) {
    const Asked asked(tree);
    for (const auto& other : all) {
      ASSERT_EQ(other->dof(), 7);
      const JointMotion motion = still(*other);
      EXPECT_EQ(motion.isOf(*tree), tree == other) << tree->name() << ' ' << other->name();
      if (motion.degree() == 1 && tree == other) {
        for (const std::string& said : asked.refusals(motion)) EXPECT_EQ(said, "") << tree->name();
      } else {
        for (const std::string& said : asked.refusals(motion)) {
          EXPECT_NE(said.find("robot '" + tree->name() + "'"), std::string::npos) << said;
          EXPECT_NE(said.find("robot '" + other->name() + "'"), std::string::npos) << said;
          ++refused;
        }
      }
      CertifiedResult result;
      const JointTrajectory trajectory =
          JointTrajectory::linear(*other, {0, 1}, {other->neutralConfiguration(), other->neutralConfiguration()});
      if (tree == other) {
        EXPECT_NO_THROW(asked.manager.continuousCollide(trajectory, {}, result));
      } else {
        EXPECT_THROW(asked.manager.continuousCollide(trajectory, {}, result), std::invalid_argument);
        EXPECT_THROW(static_cast<void>(asked.manager.clearance(trajectory)), std::invalid_argument);
      }
    }
  }
  EXPECT_EQ(refused, 30 * 4);
}

TEST(MotionTree, OtherNumbersOfVariablesAreRefusedToo) {
  const auto robot = arm("arm"), shorter = chain("short", {{"turn0", JointType::revolute}});
  const Asked asked(robot);
  for (const std::string& said : asked.refusals(still(*shorter))) {
    EXPECT_NE(said.find("robot 'short', with 1 joint values; robot 'arm' has 7"), std::string::npos) << said;
  }
}

// A mimic's multiplier is part of what a motion was checked for: 9e4 rad of the master may be 9e7 of the follower.
TEST(MotionTree, OtherMimicsAreRefused) {
  const auto follower = [](double multiplier, double offset) {
    auto tree = chain("pair", {{"lead", JointType::revolute}});
    tree->addLink("other");
    Joint joint = makeJoint("follow", JointType::revolute, "link1", "other", Vector3d::UnitZ(), pose({0.3, 0, 0}));
    joint.mimics = true;
    joint.mimic = {"lead", multiplier, offset};
    tree->addJoint(joint);
    return tree;
  };
  const auto tree = follower(1, 0);
  const JointMotion motion = JointMotion::linear(*tree, VectorXd::Constant(1, 9e4), VectorXd::Constant(1, 9e4));
  EXPECT_TRUE(motion.isOf(*follower(1, 0)));
  EXPECT_FALSE(motion.isOf(*follower(1000, 0)));
  EXPECT_FALSE(motion.isOf(*follower(1, 0.5)));
  EXPECT_FALSE(motion.isOf(*chain("pair", {{"lead", JointType::revolute}})));
  const Asked asked(follower(1000, 0));
  for (const std::string& said : asked.refusals(motion)) EXPECT_NE(said, "");
}

// The same robot made twice, a copy, one at another base, one with limits: the same joint variables.
TEST(MotionTree, TreesWithTheSameVariablesTakeTheSameMotions) {
  const auto robot = arm();
  const JointMotion motion = still(*robot);
  const auto copy = std::make_shared<KinematicTree>(*robot);
  KinematicTree source = *robot;
  const auto moved = std::make_shared<KinematicTree>(std::move(source));
  const auto assigned = std::make_shared<KinematicTree>("empty");
  *assigned = *robot;
  const auto based = std::make_shared<KinematicTree>("based");
  based->addLink("world");
  for (LinkId link = 0; link < robot->numLinks(); ++link) based->addLink(robot->linkName(link));
  based->addJoint(makeJoint("base", JointType::fixed, "world", "link0", Vector3d::UnitX(), pose({1, 2, 0})));
  for (JointId j = 0; j < robot->numJoints(); ++j) {
    Joint joint = robot->joint(j);
    joint.lower = -1;
    joint.upper = 1;
    based->addJoint(joint);
  }
  for (const auto& tree : {arm(), copy, moved, assigned, based}) {
    EXPECT_TRUE(motion.isOf(*tree)) << tree->name();
    EXPECT_EQ(robot->content().sameAs(tree->content()), tree != based);
    const Asked asked(tree);
    for (const std::string& said : asked.refusals(motion)) EXPECT_EQ(said, "") << tree->name();
  }
}

// NOLINTBEGIN(bugprone-use-after-move, clang-analyzer-cplusplus.Move): what this is about
TEST(MotionTree, MovedFromIsRefused) {
  const auto robot = chain("drone", {{"fly", JointType::floating}});
  const Asked asked(robot);
  const auto refusedByAll = [&](const JointMotion& motion) {
    EXPECT_FALSE(motion.isOf(*robot));
    for (const std::string& said : asked.refusals(motion)) {
      EXPECT_NE(said.find("has been moved from"), std::string::npos) << said;
    }
    EXPECT_THROW(motion.configuration(0.5), std::invalid_argument);
    EXPECT_THROW(motion.q0(), std::invalid_argument);
  };
  JointMotion from = still(*robot), to = still(*arm());
  const JointMotion constructed = std::move(from);
  refusedByAll(from);
  EXPECT_TRUE(constructed.isOf(*robot));
  from = constructed;
  EXPECT_TRUE(from.isOf(*robot));
  to = std::move(from);
  refusedByAll(from);
  EXPECT_TRUE(to.isOf(*robot));

  JointTrajectory trajectory =
      JointTrajectory::linear(*robot, {3, 4}, {robot->neutralConfiguration(), robot->neutralConfiguration()});
  const JointTrajectory taken = std::move(trajectory);
  CertifiedResult result;
  EXPECT_THROW(asked.manager.continuousCollide(trajectory, {}, result), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(asked.manager.clearance(trajectory)), std::invalid_argument);
  EXPECT_THROW(trajectory.beginTime(), std::out_of_range);
  EXPECT_THROW(trajectory.endTime(), std::out_of_range);
  EXPECT_THROW(trajectory.size(), std::out_of_range);
  EXPECT_THROW(trajectory.configuration(3), std::out_of_range);
  EXPECT_THROW(trajectory.piece(0), std::out_of_range);
  EXPECT_NO_THROW(asked.manager.continuousCollide(taken, {}, result));

  // A tree without joints has motions of no variables; what was moved from is none of these.
  const auto statue = chain("statue", {});
  JointMotion stays = still(*statue);
  const Asked of_statue(statue);
  for (const std::string& said : of_statue.refusals(stays)) EXPECT_EQ(said, "");
  const JointMotion kept = std::move(stays);
  for (const std::string& said : of_statue.refusals(stays)) EXPECT_NE(said, "");  // NOLINT(bugprone-use-after-move)
}
// NOLINTEND(bugprone-use-after-move, clang-analyzer-cplusplus.Move)

// Motions in between are of the tree that inBetweenTree() made, and of no other one with as many variables.
TEST(MotionTree, InBetweenMotions) {
  const auto robot = chain("one", {{"turn", JointType::revolute}});
  const auto between = inBetweenTree(*robot), again = inBetweenTree(*robot);
  const std::vector<Eigen::Isometry3d> poses(2, Eigen::Isometry3d::Identity());
  const JointMotion motion = inBetweenMotion(*between, poses, poses);
  EXPECT_TRUE(motion.isOf(*again));
  EXPECT_FALSE(motion.isOf(*robot));
  EXPECT_FALSE(motion.isOf(*arm()));
  std::vector<JointChoice> fourteen;
  for (int i = 0; i < 14; ++i) fourteen.push_back({"turn" + std::to_string(i), JointType::revolute});
  const Asked asked(chain("snake", fourteen));
  ASSERT_EQ(motion.size(), 14);
  for (const std::string& said : asked.refusals(motion)) EXPECT_NE(said, "");
}

// A tree is its owner's to add to; a manager that was set up for less says so, instead of reading other variables.
TEST(MotionTree, TreeThatGrowsAfterSetup) {
  auto tree = chain("arm", {{"turn", JointType::revolute}});
  const auto body = ball(0.1), wall = ball(0.1, {0.3, 0.3, 0});
  ArticulatedCollisionManager manager(tree);
  manager.bind("link1", body.get());
  manager.registerObject(wall.get(), "wall");
  manager.setup();
  const JointMotion before = still(*tree);
  CertifiedResult result;
  manager.continuousCollide(before, {}, result);
  EXPECT_TRUE(result.isFree());
  tree->addLink("base");
  EXPECT_THROW(manager.continuousCollide(before, {}, result), std::logic_error);
  tree->addJoint(makeJoint("lift", JointType::prismatic, "base", "link0", Vector3d::UnitY()));
  const JointMotion after = JointMotion::linear(*tree, VectorXd::Zero(2), Eigen::Vector2d(0, 1));
  EXPECT_THROW(manager.continuousCollide(before, {}, result), std::logic_error);
  EXPECT_THROW(manager.continuousCollide(after, {}, result), std::logic_error);
  manager.setup();
  EXPECT_THROW(manager.continuousCollide(before, {}, result), std::invalid_argument);
  manager.continuousCollide(after, {}, result);
  EXPECT_EQ(result.status, Status::contact);  // lifted by 0.1 m
  *tree = *chain("other", {});
  wall->setTranslation(Vector3d(0.3, 3, 0));
  EXPECT_THROW(manager.setup(), std::invalid_argument);  // link1 is gone
  EXPECT_THROW(manager.continuousCollide(after, {}, result), std::logic_error);
}

// The refusal comes before anything is read: the tree put back, the manager answers as before, and update() reads.
TEST(MotionTree, RefusedSetupReadsNothing) {
  auto tree = chain("arm", {{"lift", JointType::prismatic}});
  const KinematicTree own = *tree;
  const auto body = ball(0.1), wall = ball(0.1, {0.3, 0, 0.5});
  ArticulatedCollisionManager manager(tree);
  manager.bind("link1", body.get());
  manager.registerObject(wall.get(), "wall");
  manager.setup();
  const JointMotion up = JointMotion::linear(*tree, VectorXd::Zero(1), VectorXd::Ones(1));
  *tree = *chain("other", {});
  wall->setTranslation(Vector3d(0, 5, 0));
  EXPECT_THROW(manager.setup(), std::invalid_argument);
  EXPECT_THROW(manager.update(wall.get()), std::invalid_argument);
  *tree = own;
  CertifiedResult result;
  manager.continuousCollide(up, {}, result);
  EXPECT_EQ(result.status, Status::contact);  // the wall is where it was read
  manager.update();
  manager.continuousCollide(up, {}, result);
  EXPECT_TRUE(result.isFree());
}

// A planar joint goes across its axis, whatever the axis, also next to -z, where the shortest turn of z to it is hardly
// defined.
TEST(MotionTree, PlanarJointsGoAcrossTheirAxis) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < 3000; ++i) {
    // From -z, or z, by 1e-20 to 1 rad; and any axis.
    const double off = std::pow(10, -10 + 10 * unit(random));
    Vector3d axis = Vector3d(unit(random), unit(random), 0) * off + Vector3d(0, 0, i % 2 ? -1 : 1);
    if (i % 5 == 0) axis = Vector3d(unit(random), unit(random), unit(random));
    axis.normalize();
    KinematicTree tree;
    tree.addLink("world");
    tree.addLink("cart");
    const JointId joint = tree.addJoint(makeJoint("drive", JointType::planar, "world", "cart", axis));
    const Vector3d x = tree.jointPose(joint, Vector3d(1, 0, 0)).translation(),
                   y = tree.jointPose(joint, Vector3d(0, 1, 0)).translation();
    EXPECT_NEAR(x.dot(axis), 0, 1e-15) << axis.transpose() << ", off by " << off;
    EXPECT_NEAR(y.dot(axis), 0, 1e-15) << axis.transpose() << ", off by " << off;
    EXPECT_NEAR(x.norm(), 1, 1e-15);
    EXPECT_NEAR(x.dot(y), 0, 1e-15);
    EXPECT_LT((x.cross(y) - axis).norm(), 1e-15);
    // The shortest way: what is across both z and the axis stays as it is.
    const Vector3d across = Vector3d(-axis.y(), axis.x(), 0);
    if (across.norm() > 1e-100) {
      const Vector3d n = across.normalized();
      EXPECT_LT((n.x() * x + n.y() * y - n).norm(), 1e-15) << axis.transpose();
    }
  }
}

// Every single difference that counts changes the fingerprint, and none that does not.
TEST(MotionTree, FingerprintsOfRandomTrees) {
  std::mt19937_64 random(4);
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  int changed = 0, kept = 0;
  for (int i = 0; i < 2000; ++i) {
    std::vector<Joint> joints;
    const int n = 1 + below(6);
    for (int k = 0; k < n; ++k) {
      constexpr JointType kTypes[] = {JointType::revolute, JointType::continuous, JointType::prismatic,
                                      JointType::planar,   JointType::spherical,  JointType::floating,
                                      JointType::fixed};
      joints.push_back(makeJoint("joint" + std::to_string(k), kTypes[below(7)], "link" + std::to_string(below(k + 1)),
                                 "link" + std::to_string(k + 1), Vector3d::UnitY()));
      if (k == 0 || joints.back().type == JointType::fixed || KinematicTree::numVariables(joints.back().type) != 1)
        continue;
      const Joint& master = joints[static_cast<std::size_t>(below(k))];
      if (KinematicTree::numVariables(master.type) != 1 || master.mimics) continue;
      joints.back().mimics = true;
      joints.back().mimic = {master.name, 2, 0.25};
    }
    const auto build = [&] {
      KinematicTree tree;
      for (int k = 0; k <= n; ++k) tree.addLink("link" + std::to_string(k));
      for (const Joint& joint : joints) tree.addJoint(joint);
      return tree;
    };
    const KinematicTree tree = build();
    EXPECT_TRUE(tree.content().sameAs(build().content()));
    Joint& joint = joints[static_cast<std::size_t>(below(n))];
    const Joint original = joint;
    const bool moves = joint.type != JointType::fixed;
    bool counts = false;
    switch (below(5)) {
      case 0:
        joint.origin.translation().z() += 1e-9;
        break;
      case 1:
        joint.upper += 1;
        break;
      case 2:
        joint.axis = Vector3d::UnitZ();
        break;
      case 3:
        counts = moves && joint.mimics;
        joint.mimic.multiplier = 2.0000000001;
        if (!joint.mimics) continue;
        break;
      default:
        if (joint.mimics || KinematicTree::numVariables(joint.type) != 1 || joint.type == JointType::prismatic)
          continue;
        joint.type = JointType::prismatic;
        counts = true;
    }
    const KinematicTree other = build();
    EXPECT_FALSE(tree.content().sameAs(other.content()));
    EXPECT_EQ(tree.jointSpace().sameAs(other.jointSpace()), !counts);
    ++(counts ? changed : kept);
    joint = original;
  }
  EXPECT_GT(changed, 100);
  EXPECT_GT(kept, 500);
}

}  // namespace motion_tree_test
