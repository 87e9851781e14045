// SPDX-License-Identifier: BSD-3-Clause
#include "fcl_artic/kinematic_tree.h"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "fcl_artic/joint_motion.h"
#include "temp_folder.h"

namespace fcl_artic {
namespace kinematic_tree_test {
namespace {

constexpr double kPi = 3.141592653589793;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
/// Roundings of a few products of numbers of size 1.
constexpr double kRounding = 1e-14;

Joint makeJoint(const std::string& name, JointType type, const std::string& parent, const std::string& child,
                const Eigen::Vector3d& position, const Eigen::Vector3d& axis) {
  Joint joint;
  joint.name = name;
  joint.type = type;
  joint.parent = parent;
  joint.child = child;
  joint.origin = Eigen::Translation3d(position);
  joint.axis = axis;
  return joint;
}

/// base -shoulder(z)- upper -elbow(z, 1 m on)- lower -tool(fixed, 0.5 m on)- hand, all along x at q = 0.
KinematicTree planarArm() {
  KinematicTree tree("arm");
  for (const char* link : {"base", "upper", "lower", "hand"}) tree.addLink(link);
  tree.addJoint(makeJoint("shoulder", JointType::revolute, "base", "upper", {0, 0, 0}, {0, 0, 1}));
  tree.addJoint(makeJoint("elbow", JointType::continuous, "upper", "lower", {1, 0, 0}, {0, 0, 3}));
  tree.addJoint(makeJoint("tool", JointType::fixed, "lower", "hand", {0.5, 0, 0}, {0, 0, 0}));
  return tree;
}

void expectPose(const Eigen::Isometry3d& M, const Eigen::Vector3d& position, const Eigen::Matrix3d& rotation) {
  EXPECT_LT((M.translation() - position).norm(), kRounding) << M.translation().transpose();
  EXPECT_LT((M.linear() - rotation).norm(), kRounding) << M.linear();
}

TEST(KinematicTree, PlanarArmByHand) {
  const KinematicTree tree = planarArm();
  EXPECT_EQ(tree.numLinks(), 4);
  EXPECT_EQ(tree.numJoints(), 3);
  ASSERT_EQ(tree.dof(), 2);
  EXPECT_EQ(tree.variableName(1), "elbow");
  EXPECT_EQ(tree.joint(1).axis, Eigen::Vector3d(0, 0, 1)) << "the axis is normalised";

  // Shoulder +90°: the elbow is at (0, 1). Elbow -90°: the lower arm points along x again, the hand is at (0.5, 1).
  std::vector<Eigen::Isometry3d> M_0;
  tree.forwardKinematics(Eigen::Vector2d(kPi / 2, -kPi / 2), M_0);
  ASSERT_EQ(M_0.size(), 4u);
  expectPose(M_0[0], {0, 0, 0}, Eigen::Matrix3d::Identity());
  const Eigen::Matrix3d quarter_turn = (Eigen::Matrix3d() << 0, -1, 0, 1, 0, 0, 0, 0, 1).finished();
  expectPose(M_0[1], {0, 0, 0}, quarter_turn);
  expectPose(M_0[2], {0, 1, 0}, Eigen::Matrix3d::Identity());
  expectPose(M_0[3], {0.5, 1, 0}, Eigen::Matrix3d::Identity());
}

/// Links b and a stand alone, and joints come in no order: each is a tree of its own for a while.
TEST(KinematicTree, JointsThatAreAddedTogetherMakeTheSameTree) {
  const std::vector<Joint> joints{makeJoint("three", JointType::revolute, "c", "d", {1, 0, 0}, {0, 0, 1}),
                                  makeJoint("one", JointType::planar, "a", "b", {0, 0, 0}, {0, 0, 1}),
                                  makeJoint("four", JointType::prismatic, "c", "e", {0, 1, 0}, {0, 1, 0}),
                                  makeJoint("two", JointType::continuous, "b", "c", {0, 0, 1}, {1, 0, 0})};
  const auto links = [] {
    KinematicTree tree("robot");
    for (const char* link : {"e", "b", "a", "c", "d"}) tree.addLink(link);
    return tree;
  };
  KinematicTree each = links(), all = links();
  for (const Joint& joint : joints) each.addJoint(joint);
  all.addJoints(joints);
  EXPECT_TRUE(all.content().sameAs(each.content()));
  EXPECT_TRUE(all.jointSpace().sameAs(each.jointSpace()));
  EXPECT_EQ(all.topologicalOrder(), each.topologicalOrder());
  EXPECT_EQ(all.topologicalOrder(), (std::vector<LinkId>{2, 1, 3, 0, 4})) << "a, b, c, then its children by number";
  EXPECT_EQ(all.findJoint("four"), 2);
  EXPECT_EQ(all.findJoint("five"), -1);
  EXPECT_EQ(all.findVariable("one/theta"), 3);
  EXPECT_EQ(all.variableName(all.findVariable("two")), "two");
  EXPECT_EQ(all.findVariable("one"), -1) << "a joint of three variables";
  EXPECT_EQ(all.addLink("f"), 5);
  EXPECT_EQ(all.topologicalOrder(), (std::vector<LinkId>{2, 5, 1, 3, 0, 4})) << "the last of the roots";

  // The last of three is refused, and none is added.
  KinematicTree same = links();
  std::vector<Joint> loop{joints[3], joints[0], makeJoint("back", JointType::fixed, "d", "b", {0, 0, 0}, {0, 0, 0})};
  EXPECT_THROW(same.addJoints(loop), std::invalid_argument) << "b carries c, which carries d";
  EXPECT_EQ(same.numJoints(), 0);
  EXPECT_EQ(same.findJoint("two"), -1);
  EXPECT_TRUE(same.content().sameAs(links().content()));
  EXPECT_EQ(same.topologicalOrder(), links().topologicalOrder());
}

// A planar joint p has the variables p/x, p/y and p/theta.
TEST(KinematicTree, VariablesOfOneNameAreRefused) {
  KinematicTree tree("r");
  for (const char* link : {"a", "b", "c"}) tree.addLink(link);
  Joint planar;
  planar.name = "p";
  planar.type = JointType::planar;
  planar.parent = "a";
  planar.child = "b";
  planar.axis = Eigen::Vector3d::UnitZ();
  tree.addJoint(planar);
  Joint slide = planar;
  slide.name = "p/x";
  slide.type = JointType::prismatic;
  slide.parent = "b";
  slide.child = "c";
  try {
    tree.addJoint(slide);
    ADD_FAILURE() << "accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("would have the variable 'p/x', which joint 'p' has already"),
              std::string::npos)
        << error.what();
  }
  EXPECT_EQ(tree.numJoints(), 1);
  slide.name = "slide";
  tree.addJoint(slide);
  EXPECT_EQ(tree.dof(), 4);
}

TEST(KinematicTree, PrismaticAxisTurnsWithItsOrigin) {
  KinematicTree tree;
  tree.addLink("base");
  tree.addLink("slider");
  Joint joint = makeJoint("rail", JointType::prismatic, "base", "slider", {1, 2, 3}, {2, 0, 0});
  joint.origin.rotate(Eigen::AngleAxisd(kPi / 2, Eigen::Vector3d::UnitZ()));
  tree.addJoint(joint);
  std::vector<Eigen::Isometry3d> M_0;
  tree.forwardKinematics(Eigen::VectorXd::Constant(1, 0.25), M_0);
  EXPECT_LT((M_0[1].translation() - Eigen::Vector3d(1, 2.25, 3)).norm(), kRounding);  // the joint's x is the base's y
}

TEST(KinematicTree, MimicFollowsItsMaster) {
  KinematicTree tree("gripper");
  for (const char* link : {"palm", "left", "right"}) tree.addLink(link);
  tree.addJoint(makeJoint("left_finger", JointType::prismatic, "palm", "left", {0, 0, 0}, {0, 1, 0}));
  Joint right = makeJoint("right_finger", JointType::prismatic, "palm", "right", {0, 0, 0}, {0, 1, 0});
  right.mimics = true;
  right.mimic = {"left_finger", -2, 0.125};
  tree.addJoint(right);

  EXPECT_EQ(tree.dof(), 1);
  EXPECT_EQ(tree.jointVariable(tree.jointId("right_finger")), 0);
  const Eigen::VectorXd q = Eigen::VectorXd::Constant(1, 0.5);
  EXPECT_EQ(tree.jointValue(1, q), -0.875);
  std::vector<Eigen::Isometry3d> M_0;
  tree.forwardKinematics(q, M_0);
  EXPECT_EQ(M_0[1].translation(), Eigen::Vector3d(0, 0.5, 0));
  EXPECT_EQ(M_0[2].translation(), Eigen::Vector3d(0, -0.875, 0));
}

// second = -2 first + 0.125, third = 0.5 second + 1 = -first + 1.0625.
TEST(KinematicTree, MimicOfAMimicFollowsTheLastMaster) {
  KinematicTree tree("hand");
  for (const char* link : {"palm", "a", "b", "c", "d"}) tree.addLink(link);
  const auto add = [&](const char* name, const char* child, const Mimic& mimic) {
    Joint joint = makeJoint(name, JointType::prismatic, "palm", child, {0, 0, 0}, {0, 1, 0});
    joint.mimics = !mimic.master.empty();
    joint.mimic = mimic;
    return tree.addJoint(joint);
  };
  add("first", "a", {});
  add("second", "b", {"first", -2, 0.125});
  const JointId third = add("third", "c", {"second", 0.5, 1});
  EXPECT_EQ(tree.dof(), 1);
  EXPECT_EQ(tree.jointVariable(third), 0);
  EXPECT_EQ(tree.joint(third).mimic.master, "first");
  EXPECT_EQ(tree.joint(third).mimic.multiplier, -1);
  EXPECT_EQ(tree.joint(third).mimic.offset, 1.0625);
  const JointId fourth = add("fourth", "d", {"third", 4, 0});
  const Eigen::VectorXd q = Eigen::VectorXd::Constant(1, 0.5);
  EXPECT_EQ(tree.jointValue(third, q), 0.5625);
  EXPECT_EQ(tree.jointValue(fourth, q), 2.25);
  EXPECT_EQ(tree.linkPose(tree.linkId("d"), q).translation(), Eigen::Vector3d(0, 2.25, 0));
}

// A chain's factors multiply, and what they come to is kept within the proven range.
TEST(KinematicTree, MimicOfAMimicBeyondTheProvenRangeIsRefused) {
  KinematicTree tree("gears");
  for (const char* link : {"base", "a", "b", "c"}) tree.addLink(link);
  tree.addJoint(makeJoint("turn", JointType::revolute, "base", "a", {0, 0, 0}, {0, 0, 1}));
  Joint fast = makeJoint("fast", JointType::revolute, "base", "b", {0, 0, 0}, {0, 0, 1});
  fast.mimics = true;
  fast.mimic = {"turn", 400, 0};
  tree.addJoint(fast);
  const Eigen::VectorXd q0 = Eigen::VectorXd::Zero(1), q1 = Eigen::VectorXd::Ones(1);
  EXPECT_NO_THROW(JointMotion::linear(tree, q0, q1));
  Joint faster = makeJoint("faster", JointType::revolute, "base", "c", {0, 0, 0}, {0, 0, 1});
  faster.mimics = true;
  faster.mimic = {"fast", 400, 0};
  tree.addJoint(faster);
  expectContains(messageOf<std::invalid_argument>([&] { JointMotion::linear(tree, q0, q1); }), "'faster'");
}

TEST(KinematicTree, OneLinksPoseIsThatOfAll) {
  const KinematicTree tree = planarArm();
  const Eigen::Vector2d q(0.7, -1.9);
  std::vector<Eigen::Isometry3d> M_0;
  tree.forwardKinematics(q, M_0);
  EXPECT_GT(M_0[3].translation().norm(), 0.5);
  for (LinkId link = 0; link < tree.numLinks(); ++link) {
    EXPECT_EQ(tree.linkPose(link, q).matrix(), M_0[static_cast<std::size_t>(link)].matrix()) << tree.linkName(link);
  }
  EXPECT_THROW(tree.linkPose(4, q), std::out_of_range);
  EXPECT_THROW(tree.linkPose(3, Eigen::Vector2d(kNaN, 0)), std::invalid_argument);
}

/// Breadth first, the children of a link by number, whatever order links and joints come in.
TEST(KinematicTree, LinksAreSortedBreadthFirst) {
  std::uint64_t random = 1;
  const auto below = [&](int count) {
    random = random * 6364136223846793005u + 1442695040888963407u;
    return static_cast<int>((random >> 33) % static_cast<std::uint64_t>(count));
  };
  for (int forest = 0; forest < 50; ++forest) {
    KinematicTree tree;
    for (int step = 0; step < 40; ++step) {
      if (tree.numLinks() < 2 || below(2) == 0) {
        tree.addLink("l" + std::to_string(tree.numLinks()));
      } else {
        const std::string parent = tree.linkName(below(tree.numLinks())), child = tree.linkName(below(tree.numLinks()));
        try {
          tree.addJoint(Joint::fixed("j" + std::to_string(tree.numJoints()), parent, child));
        } catch (const std::invalid_argument&) {  // a second parent, or a loop
        }
      }
      std::vector<LinkId> expected;
      for (std::size_t i = 0; i <= expected.size(); ++i) {
        const LinkId parent = i == 0 ? -1 : expected[i - 1];
        for (LinkId link = 0; link < tree.numLinks(); ++link) {
          if (tree.parentLink(link) == parent) expected.push_back(link);
        }
      }
      ASSERT_EQ(tree.topologicalOrder(), expected) << "forest " << forest << ", step " << step;
    }
  }
}

TEST(KinematicTree, ForestKeepsEachRootAtTheOrigin) {
  KinematicTree tree("two robots");
  for (const char* link : {"b_tip", "b_base", "a_base", "a_tip"}) tree.addLink(link);  // a child before its parent
  tree.addJoint(makeJoint("a", JointType::prismatic, "a_base", "a_tip", {0, 0, 0}, {1, 0, 0}));
  tree.addJoint(makeJoint("b", JointType::prismatic, "b_base", "b_tip", {0, 0, 0}, {0, 0, 1}));
  EXPECT_EQ(tree.parentJoint(tree.linkId("a_base")), -1);
  EXPECT_EQ(tree.parentLink(tree.linkId("b_tip")), tree.linkId("b_base"));
  const std::vector<LinkId> order = tree.topologicalOrder();
  ASSERT_EQ(order.size(), 4u);
  const auto at = [&](const char* name) { return std::find(order.begin(), order.end(), tree.linkId(name)); };
  EXPECT_LT(at("b_base"), at("b_tip"));
  EXPECT_LT(at("a_base"), at("a_tip"));

  std::vector<Eigen::Isometry3d> M_0;
  tree.forwardKinematics(Eigen::Vector2d(0.5, 2), M_0);
  EXPECT_EQ(M_0[tree.linkId("a_base")].matrix(), Eigen::Matrix4d::Identity());
  EXPECT_EQ(M_0[tree.linkId("b_base")].matrix(), Eigen::Matrix4d::Identity());
  EXPECT_EQ(M_0[tree.linkId("a_tip")].translation(), Eigen::Vector3d(0.5, 0, 0));
  EXPECT_EQ(M_0[tree.linkId("b_tip")].translation(), Eigen::Vector3d(0, 0, 2));
}

TEST(KinematicTree, LinkErrorsNameTheLink) {
  KinematicTree tree("arm");
  tree.addLink("base");
  expectContains(messageOf<std::invalid_argument>([&] { tree.addLink("base"); }), "'base'");
  expectContains(messageOf<std::invalid_argument>([&] { tree.addLink(""); }), "robot 'arm'");
  expectContains(messageOf<std::out_of_range>([&] { tree.linkId("hand"); }), "robot 'arm' has no link 'hand'");
  expectContains(messageOf<std::out_of_range>([&] { tree.jointId("wrist"); }), "robot 'arm' has no joint 'wrist'");
  expectContains(messageOf<std::out_of_range>([&] { tree.linkId("bas"); }), "has no link 'bas'; did you mean 'base'?");
  EXPECT_TRUE(tree.hasLink("base"));
  EXPECT_FALSE(tree.hasLink("hand"));
  EXPECT_EQ(tree.numLinks(), 1);
}

struct BadJoint {
  const char* what;
  std::function<void(Joint&)> spoil;
  const char* reason;
};

TEST(KinematicTree, JointErrorsNameTheJointAndChangeNothing) {
  const std::vector<BadJoint> cases = {
      {"no name", [](Joint& j) { j.name = ""; }, "has no name"},
      {"repeated name", [](Joint& j) { j.name = "elbow"; }, "'elbow' exists already"},
      {"unknown parent", [](Joint& j) { j.parent = "nowhere"; }, "unknown parent link 'nowhere'"},
      {"unknown child", [](Joint& j) { j.child = "nothing"; }, "unknown child link 'nothing'"},
      {"second parent", [](Joint& j) { j.child = "lower"; }, "second parent of link 'lower', which joint 'elbow'"},
      {"loop", [](Joint& j) { j.parent = "hand", j.child = "base"; }, "closes a loop at link 'base'"},
      {"own child", [](Joint& j) { j.parent = "extra"; }, "closes a loop at link 'extra'"},
      {"zero axis", [](Joint& j) { j.axis.setZero(); }, "axis that is zero or not finite"},
      {"NaN axis", [](Joint& j) { j.axis.y() = kNaN; }, "axis that is zero or not finite"},
      {"scaled", [](Joint& j) { j.origin.linear() *= 1.001; }, "no rigid transform"},
      {"mirrored", [](Joint& j) { j.origin.linear()(0, 0) = -1; }, "no rigid transform"},
      {"NaN rotation", [](Joint& j) { j.origin.linear()(0, 0) = kNaN; }, "no rigid transform"},
      {"infinite origin", [](Joint& j) { j.origin.translation().x() = INFINITY; }, "no rigid transform"},
      {"NaN limit", [](Joint& j) { j.upper = kNaN; }, "limit that is not a number"},
      {"unknown master", [](Joint& j) { j.mimics = true, j.mimic.master = "wrist"; }, "unknown joint 'wrist'"},
      {"fixed master", [](Joint& j) { j.mimics = true, j.mimic.master = "tool"; }, "'tool', which is fixed"},
      {"chain beyond doubles",
       [](Joint& j) {
         j.mimics = true, j.mimic = {"copy", 1e308, 0};
       },
       "mimics joint 'elbow' through 'copy' with a multiplier or offset that is not finite"},
      {"itself", [](Joint& j) { j.mimics = true, j.mimic.master = "new"; }, "mimics an unknown joint 'new'"},
      {"NaN multiplier",
       [](Joint& j) {
         j.mimics = true, j.mimic = {"elbow", kNaN, 0};
       },
       "not finite"},
      {"fixed mimics", [](Joint& j) { j.type = JointType::fixed, j.mimics = true, j.mimic.master = "elbow"; },
       "is fixed and cannot mimic"},
  };
  KinematicTree tree = planarArm();
  tree.addLink("copied");
  tree.addLink("extra");
  Joint copy = makeJoint("copy", JointType::revolute, "base", "copied", {0, 0, 0}, {0, 0, 1});
  copy.mimics = true;
  copy.mimic = {"elbow", 2, 0};
  tree.addJoint(copy);
  const Joint good = makeJoint("new", JointType::revolute, "hand", "extra", {0, 0, 0}, {0, 0, 1});
  for (const BadJoint& c : cases) {
    SCOPED_TRACE(c.what);
    Joint bad = good;
    c.spoil(bad);
    const std::string message = messageOf<std::invalid_argument>([&] { tree.addJoint(bad); });
    expectContains(message, "joint '" + bad.name + "'");
    expectContains(message, c.reason);
    EXPECT_EQ(tree.numJoints(), 4);
    EXPECT_EQ(tree.dof(), 2);
    EXPECT_EQ(tree.parentJoint(tree.linkId("extra")), -1);
  }
  EXPECT_EQ(tree.addJoint(good), 4);  // the base of all cases is itself accepted
  EXPECT_EQ(tree.dof(), 3);
}

TEST(KinematicTree, RefusesConfigurationsOfAnotherSizeOrNotFinite) {
  const KinematicTree tree = planarArm();
  std::vector<Eigen::Isometry3d> M_0;
  expectContains(messageOf<std::invalid_argument>([&] { tree.forwardKinematics(Eigen::Vector3d(0, 0, 0), M_0); }),
                 "q has 3 entries, robot 'arm' has 2");
  expectContains(messageOf<std::invalid_argument>([&] { tree.jointValue(0, Eigen::VectorXd::Zero(1)); }),
                 "q has 1 entry");
  expectContains(messageOf<std::invalid_argument>([&] { tree.jointPose(0, Eigen::VectorXd::Zero(3)); }),
                 "q has 3 entries");
  expectContains(messageOf<std::out_of_range>([&] { tree.linkName(99); }), "has no link 99: there are");
  expectContains(messageOf<std::out_of_range>([&] { tree.variableName(-1); }), "has no joint variable -1");
  expectContains(messageOf<std::invalid_argument>([&] { tree.requireConfiguration(Eigen::Vector2d(0, kNaN), "goal"); }),
                 "goal: the value nan of joint 'elbow'");
}

TEST(KinematicTree, NotesValuesBeyondLimits) {
  KinematicTree tree;
  for (const char* link : {"a", "b", "c", "d"}) tree.addLink(link);
  Joint limited = makeJoint("limited", JointType::revolute, "a", "b", {0, 0, 0}, {0, 0, 1});
  limited.lower = -1;
  limited.upper = 0.5;
  tree.addJoint(limited);
  Joint continuous = makeJoint("continuous", JointType::continuous, "b", "c", {0, 0, 0}, {0, 0, 1});
  continuous.lower = -1;
  continuous.upper = 1;
  tree.addJoint(continuous);
  tree.addJoint(makeJoint("unlimited", JointType::prismatic, "c", "d", {0, 0, 0}, {0, 0, 1}));
  EXPECT_TRUE(tree.limitNotes(Eigen::Vector3d(0.5, 9, 9)).empty());
  const auto notes = tree.limitNotes(Eigen::Vector3d(0.75, 9, 9));
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_EQ(notes[0], "joint 'limited' at 0.75 is beyond its limits [-1, 0.5]");
  EXPECT_EQ(tree.limitNotes(Eigen::Vector3d(-1.5, 0, 0)).size(), 1u);
}

TEST(JointMotion, LinearGoesStraightAndShortestWraps) {
  const KinematicTree tree = planarArm();  // the elbow is continuous, the shoulder is not
  const Eigen::Vector2d q0(-3, -3), q1(3, 3);
  EXPECT_EQ(JointMotion::linear(tree, q0, q1).dq(), Eigen::Vector2d(6, 6));
  const JointMotion shortest = JointMotion::shortest(tree, q0, q1);
  EXPECT_EQ(shortest.q0(), q0);
  EXPECT_EQ(shortest.dq()[0], 6);
  EXPECT_NEAR(shortest.dq()[1], 6 - 2 * kPi, kRounding);
  EXPECT_NEAR(shortest.configuration(0.5)[1], -3 + (3 - kPi), kRounding);
  EXPECT_EQ(JointMotion::shortest(tree, Eigen::Vector2d(0, 1), Eigen::Vector2d(0, 3)).dq()[1], 2);
}

TEST(JointMotion, RefusesBadEnds) {
  const KinematicTree tree = planarArm();
  const Eigen::Vector2d zero(0, 0);
  const auto linear = [&](const Eigen::VectorXd& q0, const Eigen::VectorXd& q1) {
    return messageOf<std::invalid_argument>([&] { JointMotion::linear(tree, q0, q1); });
  };
  expectContains(linear(Eigen::VectorXd::Zero(3), zero), "q0 has 3 entries, robot 'arm' has 2");
  expectContains(linear(zero, Eigen::VectorXd::Zero(1)), "q1 has 1 entry, robot 'arm' has 2");
  expectContains(linear(zero, Eigen::Vector2d(0, INFINITY)), "q1: the value inf of joint 'elbow'");
  expectContains(linear(Eigen::Vector2d(1.1e5, 0), zero), "joint 'shoulder' is beyond 1e5");
  expectContains(messageOf<std::invalid_argument>([&] { JointMotion::shortest(tree, zero, Eigen::Vector2d(0, kNaN)); }),
                 "'elbow'");
}

TEST(JointMotion, ShortestRefusesMimicsThatWouldEndElsewhere) {
  const auto withMimic = [](JointType type, double multiplier) {
    KinematicTree tree = planarArm();
    tree.addLink("geared");
    Joint mimic = makeJoint("gear", type, "base", "geared", {0, 0, 0}, {0, 0, 1});
    mimic.mimics = true;
    mimic.mimic = {"elbow", multiplier, 0};
    tree.addJoint(mimic);
    return tree;
  };
  const Eigen::Vector2d q0(0, -3), q1(0, 3), near(0, -2);
  EXPECT_NEAR(JointMotion::shortest(withMimic(JointType::revolute, -2), q0, q1).dq()[1], 6 - 2 * kPi, kRounding);
  const KinematicTree half = withMimic(JointType::revolute, 0.5), rack = withMimic(JointType::prismatic, 1);
  for (const KinematicTree* tree : {&half, &rack}) {
    EXPECT_EQ(JointMotion::shortest(*tree, q0, near).dq()[1], 1);  // nothing to wrap
    expectContains(messageOf<std::invalid_argument>([&] { JointMotion::shortest(*tree, q0, q1); }),
                   "'gear' mimics the continuous joint 'elbow'");
  }
}

}  // namespace
}  // namespace kinematic_tree_test
}  // namespace fcl_artic
