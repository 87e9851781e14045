// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "fcl_artic/urdf/urdf.h"
#include "temp_folder.h"

namespace fcl_artic {
namespace srdf_test {
namespace {

class SrdfTest : public TempFolderTest {
 protected:
  SrdfTest() {
    for (const char* link : {"a", "b", "c", "d"}) tree_.addLink(link);
  }
  AllowedCollisionMatrix load(const std::string& body) {
    notes_.clear();
    return loadSrdf(write("r.srdf", "<robot name='r'>" + body + "</robot>"), tree_, &notes_);
  }
  std::vector<std::string> notes_;
  KinematicTree tree_{"r"};
};

TEST_F(SrdfTest, ReadsDisabledPairs) {
  const auto matrix = load(
      "<group name='arm'><link name='a'/></group>"
      "<disable_collisions link1='b' link2='a' reason='Adjacent'/><disable_collisions link1='c' link2='a'/>");
  EXPECT_EQ(matrix.pairs().size(), 2u);
  EXPECT_TRUE(matrix.allowed("a", "b"));
  EXPECT_TRUE(matrix.allowed("c", "a"));
  EXPECT_FALSE(matrix.allowed("b", "c"));
}

TEST_F(SrdfTest, DefaultsYieldToNamedPairs) {
  const auto matrix = load(
      "<disable_collisions link1='c' link2='a'/><enable_collisions link1='a' link2='b'/>"
      "<enable_collisions link1='a' link2='c'/><disable_default_collisions link='a'/>");
  EXPECT_FALSE(matrix.allowed("a", "b"));
  EXPECT_TRUE(matrix.allowed("a", "c")) << "disabled wins over enabled";
  EXPECT_TRUE(matrix.allowed("a", "d"));
  EXPECT_FALSE(matrix.allowed("b", "c"));
}

TEST_F(SrdfTest, NamesAreUtf8) {
  const auto errorOf = [&](const std::string& body, bool virtual_joint) {
    try {
      load(body);
      if (virtual_joint) loadVirtualJoint(write("r.srdf", "<robot name='r'>" + body + "</robot>"));
      return std::string("is read");
    } catch (const std::runtime_error& error) {
      return std::string(error.what());
    }
  };
  expectContains(errorOf("\n<disable_collisions link1='a' link2='caf\xE9'/>", false), "line 2, <disable_collisions>");
  expectContains(errorOf("\n<disable_collisions link1='a' link2='caf\xE9'/>", false),
                 "no UTF-8; save the file as UTF-8");
  const std::string moving = "<virtual_joint name='v' type='planar' parent_frame='caf\xE9' child_link='a'/>";
  EXPECT_EQ(errorOf(moving, false), "is read");
  expectContains(errorOf(moving, true), "the attribute 'parent_frame' of <virtual_joint> has bytes that are no UTF-8");
}

// A maker's SRDF names links that not all of its URDFs have. Passed over, such entries leave no pair unchecked.
TEST_F(SrdfTest, EntriesWithLinksThatTheRobotLacksAreNoted) {
  const auto matrix = load(
      "<disable_collisions link1='b' link2='a'/><disable_collisions link1='a' link2='gripper_left'/>"
      "<disable_collisions link1='x1' link2='x2'/><disable_collisions link1='x3' link2='x1'/>"
      "<disable_default_collisions link='x4'/><enable_collisions link1='c' link2='x1'/>");
  EXPECT_EQ(matrix.pairs().size(), 1u);
  EXPECT_TRUE(matrix.allowed("a", "b"));
  ASSERT_EQ(notes_.size(), 1u);
  expectContains(notes_[0], "r.srdf': 5 of 6 entries name links that robot 'r' does not have, ");
  expectContains(notes_[0], "'x4', 'x1', 'gripper_left' and 2 more; they are passed over");
  EXPECT_EQ(notes_[0].find("did you mean"), std::string::npos) << notes_[0];
  load("<disable_collisions link1='b' link2='a'/>");
  EXPECT_TRUE(notes_.empty());
  loadSrdf(write("r.srdf", "<robot name='r'><disable_collisions link1='b' link2='x'/></robot>"), tree_);  // no notes
}

TEST_F(SrdfTest, ASlipIsHintedAt) {
  tree_.addLink("forearm_link");
  tree_.addLink("wrist_left");
  load("<disable_collisions link1='a' link2='forearm_lnk'/>");
  ASSERT_EQ(notes_.size(), 1u);
  expectContains(notes_[0], "; did you mean 'forearm_link' by 'forearm_lnk'?");
  // A link that the file names elsewhere is not the one that is meant.
  load("<disable_collisions link1='a' link2='wrist_left'/><disable_collisions link1='a' link2='wrist_lef2'/>");
  ASSERT_EQ(notes_.size(), 1u);
  EXPECT_EQ(notes_[0].find("did you mean"), std::string::npos) << notes_[0];
}

TEST_F(SrdfTest, AnotherRobotsIsRefused) {
  const std::string message =
      messageOf([&] { load("<disable_collisions link1='w' link2='x'/><disable_collisions link1='y' link2='z'/>"); });
  expectContains(message, "is of another robot: of the 4 links that it names, 'w', 'x', 'y' and 1 more, robot 'r' has");
  EXPECT_NO_THROW(load("")) << "a file without pairs is of no other robot";
}

// An exception from a default with a slip in it would leave the pair that is meant unchecked.
TEST_F(SrdfTest, AnEnabledPairWithAnUnknownLinkIsRefusedWhereItCounts) {
  for (const char* entry : {"<enable_collisions link1='a' link2='bb'/>", "<enable_collisions link1='bb' link2='a'/>"}) {
    const std::string message = messageOf([&] { load(std::string("<disable_default_collisions link='a'/>") + entry); });
    expectContains(message, "<enable_collisions> names link 'bb', which robot 'r' does not have, and 'a', which is");
    expectContains(message, "did you mean 'b'?");
  }
  EXPECT_NO_THROW(load("<disable_default_collisions link='a'/><enable_collisions link1='c' link2='bb'/>"));
}

TEST_F(SrdfTest, PairsComeWithTheirReasons) {
  const std::string file = write("r.srdf",
                                 "<robot name='r'><disable_default_collisions link='d'/>"
                                 "<disable_collisions link1='b' link2='a' reason='Never'/>"
                                 "<disable_collisions link1='d' link2='c'/></robot>");
  std::string all;
  for (const SrdfPair& p : readSrdf(file, tree_)) all += p.link1 + p.link2 + "=" + p.reason + " ";
  EXPECT_EQ(all, "ab=Never ad=disable_default_collisions bd=disable_default_collisions cd= ");
}

// An enabled pair that is passed over goes unchecked.
TEST_F(SrdfTest, WhatMaySayWhichPairsAreCheckedIsReadOrRefused) {
  const std::string defaults = "<disable_default_collisions link='a'/>",
                    enabled = "<enable_collisions link1='a' link2='b'/>";
  const auto error = [&](const std::string& body) { return messageOf([&] { load(body); }); };
  expectContains(
      error(defaults + "<enable_collision link1='a' link2='b'/>"),
      "line 1, <enable_collision>: in <robot> it is not understood, and may say which pairs are checked; did "
      "you mean 'enable_collisions'?");
  expectContains(error("<Disable_Collisions link1='a' link2='b'/>"), "did you mean 'disable_collisions'?");
  expectContains(error(defaults + "<xacro:if value='1'>" + enabled + "</xacro:if>"), "left of xacro");
  expectContains(error("<disable_default_collisions link='a'>" + enabled + "</disable_default_collisions>"),
                 "<enable_collisions>");
  expectContains(error("<disable_collisions link1='a' link2='b' margin='0.1'/>"), "'margin' is not understood");
  expectContains(error("<collision_margins default_margin='0.01'/>"), "<collision_margins>");
  expectContains(error(defaults + "</robot><robot>" + enabled), "a second root element");
  expectContains(error(defaults + "</robot><!-- --><!DOCTYPE x><robot>" + enabled), "document types are not read");
  const std::string text = "<robot name='r'>" + defaults + "</robot>" + std::string(1, '\0') + enabled;
  expectContains(messageOf([&] { loadSrdf(write("r.srdf", text), tree_); }), "byte 0");
  EXPECT_NO_THROW(
      load("<group name='g'><chain base_link='a' tip_link='b'/></group><group_state name='s' group='g'/>"
           "<end_effector name='e'/><passive_joint name='p'/><joint_property joint_name='j'/>"
           "\\ <gripper name=\'g\'/><specificities><feet/></specificities><link_sphere_approximation link='a'><sphere "
           "center='0 0 0' radius='1'/></link_sphere_approximation>"));
}

TEST_F(SrdfTest, ABaseThatMovesByTheFileIsNoted) {
  const auto virtualJoint = [](const std::string& type) {
    return "<virtual_joint name='v' type='" + type + "' parent_frame='odom' child_link='a'/>";
  };
  load(virtualJoint("fixed"));
  EXPECT_TRUE(notes_.empty());
  load(virtualJoint("planar"));
  ASSERT_EQ(notes_.size(), 1u);
  expectContains(notes_[0], "line 1: the robot's base is planar by its virtual_joint, and stands still here");
  tree_.addLink("world");
  Joint joint = Joint::fixed("floating_base", "world", "a", Eigen::Isometry3d::Identity());
  joint.type = JointType::floating;
  tree_.addJoint(joint);
  load(virtualJoint("floating"));
  EXPECT_TRUE(notes_.empty());
}

TEST_F(SrdfTest, ErrorsNameFileAndReason) {
  const auto error = [&](const std::string& body) { return messageOf([&] { load(body); }); };
  expectContains(error("<disable_collisions link1='a'/>"), "no attribute 'link2'");
  expectContains(error("<disable_default_collisions/>"), "r.srdf', line 1: ");
  expectContains(error("<oops"), "r.srdf': ");
  expectContains(messageOf([&] { loadSrdf(path("none.srdf"), tree_); }), "none.srdf': cannot be read");
  expectContains(messageOf([&] { loadSrdf(write("x.srdf", "<sdf/>"), tree_); }), "x.srdf': is not an SRDF");
}

/// base -turn(z)- arm -(fixed)- frame, without geometry -bend(z)- tip. Fixed links from the base, in a chain: plate;
/// near, which overlaps the base; far, out of reach. Then wall, which the tip meets at some angles; shelf, which the
/// tip meets at q = 0.
const char* const kRobot = R"(<robot name="mill">
<link name="base"><collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>
<link name="arm"><collision><origin xyz="0.5 0 0"/><geometry><box size="0.7 0.1 0.1"/></geometry></collision></link>
<link name="frame"/>
<link name="tip"><collision><origin xyz="0.3 0 0"/><geometry><box size="0.3 0.1 0.1"/></geometry></collision></link>
<link name="plate"><collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision></link>
<link name="near"><collision><geometry><sphere radius="0.3"/></geometry></collision></link>
<link name="far"><collision><geometry><sphere radius="0.3"/></geometry></collision></link>
<link name="wall"><collision><geometry><box size="0.1 2 1"/></geometry></collision></link>
<link name="shelf"><collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision></link>
<joint name="turn" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/></joint>
<joint name="mount" type="fixed"><parent link="arm"/><child link="frame"/><origin xyz="0.9 0 0"/></joint>
<joint name="bend" type="revolute"><parent link="frame"/><child link="tip"/><axis xyz="0 0 1"/>
  <limit lower="-0.5" upper="0.5" effort="1" velocity="1"/></joint>
<joint name="p" type="fixed"><parent link="base"/><child link="plate"/><origin xyz="0 0 -0.1"/></joint>
<joint name="n" type="fixed"><parent link="plate"/><child link="near"/><origin xyz="0 0 -0.15"/></joint>
<joint name="f" type="fixed"><parent link="near"/><child link="far"/><origin xyz="0 0 5"/></joint>
<joint name="w" type="fixed"><parent link="far"/><child link="wall"/><origin xyz="-1 0 -4.75"/></joint>
<joint name="s" type="fixed"><parent link="wall"/><child link="shelf"/><origin xyz="2.2 0 0"/></joint>
</robot>)";

using Kinds = std::map<std::pair<std::string, std::string>, LinkPairKind>;

Kinds kinds(const LinkPairReport& report) {
  Kinds by_name;
  for (const LinkPairFinding& p : report.pairs) {
    EXPECT_TRUE(by_name.emplace(std::minmax(p.link1, p.link2), p.kind).second) << p.link1 << " " << p.link2;
  }
  return by_name;
}

TEST_F(SrdfTest, GeneratesPairsWithTheirKinds) {
  const Robot robot = loadUrdf(write("mill.urdf", kRobot));
  const LinkPairReport report = generateAllowedCollisions(robot);
  const Kinds by_name = kinds(report);
  const auto kind = [&](const std::string& a, const std::string& b) { return by_name.at(std::minmax(a, b)); };
  for (const LinkPairFinding& pair : report.pairs) {
    const std::set<std::string> names{pair.link1, pair.link2};
    const bool one_joint = names == std::set<std::string>{"base", "arm"} ||
                           names == std::set<std::string>{"arm", "tip"};  // over a link without geometry
    if (one_joint) EXPECT_TRUE(pair.neighbours) << pair.link1 << " " << pair.link2;
  }
  EXPECT_EQ(kind("base", "near"), LinkPairKind::always) << "no joint moves them apart";
  EXPECT_EQ(kind("arm", "far"), LinkPairKind::never);
  EXPECT_EQ(kind("tip", "far"), LinkPairKind::never);
  EXPECT_EQ(kind("tip", "shelf"), LinkPairKind::sometimes) << "touches at q = 0, though not everywhere";
  EXPECT_EQ(kind("tip", "wall"), LinkPairKind::sometimes);
  EXPECT_EQ(by_name.count({"frame", "tip"}), 0u) << "no geometry, no entry";

  // Written and read again it is the same matrix.
  writeSrdf(path("mill.srdf"), "mill", report);
  EXPECT_EQ(loadSrdf(path("mill.srdf"), *robot.tree).pairs(), report.needNoCheck().pairs());
}

TEST_F(SrdfTest, ProofsGoWithTheRobot) {
  Robot robot = loadUrdf(write("mill.urdf", kRobot));
  const LinkPairReport report = generateAllowedCollisions(robot);
  robot.allowed = report.needNoCheck();
  const auto unproven = [&] {
    ArticulatedCollisionManager manager(robot.tree);
    robot.addTo(manager);
    manager.setup();
    return manager.collide(Eigen::Vector2d(1, 0)).unproven_allowed_pairs;
  };
  // Pairs that stand still against each other are no exceptions, and set-up has proofs of its own for neighbours.
  const auto standStill = [](const std::string& a, const std::string& b) {
    const std::set<std::string> on_base{"base", "plate", "near", "far", "wall", "shelf"};
    return on_base.count(a) > 0 && on_base.count(b) > 0;
  };
  const auto touching = report.alwaysTouching().pairs();
  const auto always = std::count_if(touching.begin(), touching.end(),
                                    [&](const auto& pair) { return !standStill(pair.first, pair.second); });
  const auto never = std::count_if(report.pairs.begin(), report.pairs.end(), [&](const LinkPairFinding& pair) {
    return pair.kind == LinkPairKind::never && !pair.neighbours && !standStill(pair.link1, pair.link2);
  });
  EXPECT_GT(never, 0);
  EXPECT_EQ(unproven(), static_cast<std::size_t>(never + always));
  robot.proofs = report.proofs;
  EXPECT_EQ(unproven(), static_cast<std::size_t>(always));
}

// For neighbours the file's word is the only one.
TEST_F(SrdfTest, ASrdfSpeaksOfNeighboursToo) {
  Robot robot = loadUrdf(write("two.urdf", R"(<robot name="two">
<link name="base"><collision><geometry><sphere radius="0.2"/></geometry></collision></link>
<link name="arm"><collision><geometry><sphere radius="0.2"/></geometry></collision></link>
<joint name="j" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/></joint></robot>)"));
  const auto answer = [&](const std::string& entries) {
    const std::string file = write("two.srdf", "<robot name='two'>" + entries + "</robot>");
    robot.allowed = loadSrdf(file, *robot.tree);
    ArticulatedCollisionManager manager(robot.tree);
    robot.addTo(manager);
    manager.setup();
    return manager.collide(Eigen::VectorXd::Zero(1)).status;
  };
  EXPECT_EQ(answer(""), Status::contact);
  EXPECT_EQ(answer("<disable_collisions link1='base' link2='arm' reason='Adjacent'/>"), Status::free);
  EXPECT_EQ(answer("<disable_default_collisions link='base'/>"), Status::free);
  EXPECT_EQ(answer("<disable_default_collisions link='base'/><enable_collisions link1='arm' link2='base'/>"),
            Status::contact);
}

/// base -x- slider, and base - stop - block, all of them boxes along x.
std::string slideRobot(const std::string& limits, const std::string& block) {
  return R"(<robot name="slide">
<link name="base"><collision><origin xyz="9 9 9"/><geometry><sphere radius="0.1"/></geometry></collision></link>
<link name="slider"><collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>
<link name="stop"><collision><origin xyz="0 0 1"/><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>
<link name="block">)" +
         block + R"(</link>
<joint name="x" type="prismatic"><parent link="base"/><child link="slider"/><axis xyz="1 0 0"/>
  <limit )" +
         limits + R"( effort="1" velocity="1"/></joint>
<joint name="s" type="fixed"><parent link="base"/><child link="stop"/></joint>
<joint name="b" type="fixed"><parent link="stop"/><child link="block"/></joint></robot>)";
}

TEST_F(SrdfTest, WhatIsApartAtRestIsNotAlwaysInContact) {
  // The block has a slot for the slider, 1e-6 m wider than it: at 0 they are apart, elsewhere they touch.
  const Robot robot = loadUrdf(write("slide.urdf", slideRobot(R"(lower="-1" upper="1")", R"(
<collision><origin xyz="1.1000005 0 0"/><geometry><box size="2 0.2 0.2"/></geometry></collision>
<collision><origin xyz="-1.1000005 0 0"/><geometry><box size="2 0.2 0.2"/></geometry></collision>)")));
  const Kinds by_name = kinds(generateAllowedCollisions(robot));
  EXPECT_EQ(by_name.at({"block", "slider"}), LinkPairKind::sometimes);
  EXPECT_EQ(by_name.at({"slider", "stop"}), LinkPairKind::never);
}

TEST_F(SrdfTest, RestIsWithinTheLimits) {
  // They touch at 0, which the limits exclude, and at few of the places within: the pair must stay checked.
  const Robot robot = loadUrdf(write("slide.urdf", slideRobot(R"(lower="1" upper="2")", R"(
<collision><geometry><box size="2 0.2 0.2"/></geometry></collision>)")));
  EXPECT_EQ(kinds(generateAllowedCollisions(robot)).at({"block", "slider"}), LinkPairKind::sometimes);
  for (const LinkPairFinding& pair : generateAllowedCollisions(robot).pairs) {
    if (pair.kind == LinkPairKind::sometimes) EXPECT_GE(pair.configuration[0], 1);
  }
}

TEST_F(SrdfTest, NothingIsProvenAcrossPlanarAndFloatingJoints) {
  // Two of a kind float apart, each with a far tip on a spherical joint's stem, which never comes near its foot.
  std::string xml = "<robot name='two'><link name='world'/>";
  for (const std::string name : {"a", "b"}) {
    const auto link = [&](const std::string& part) {
      return "<link name='" + name + part +
             "'><collision><geometry><sphere radius='0.1'/></geometry></collision></link>";
    };
    xml += link("foot") + link("stem") + link("tip");
    xml += "<joint name='" + name + "1' type='" + (name == "a" ? "floating" : "planar") +
           "'><parent link='world'/><child link='" + name + "foot'/><origin xyz='" + (name == "a" ? "3" : "0") +
           " 0 0'/><axis xyz='0 0 1'/></joint>";
    xml += "<joint name='" + name + "2' type='continuous'><parent link='" + name + "foot'/><child link='" + name +
           "stem'/><origin xyz='1 0 0'/></joint>";
    xml += "<joint name='" + name + "3' type='continuous'><parent link='" + name + "stem'/><child link='" + name +
           "tip'/><origin xyz='1 0 0'/></joint>";
  }
  const Kinds by_name = kinds(generateAllowedCollisions(loadUrdf(write("two.urdf", xml + "</robot>"))));
  EXPECT_EQ(by_name.at({"afoot", "atip"}), LinkPairKind::never);
  EXPECT_EQ(by_name.at({"bfoot", "btip"}), LinkPairKind::never);
  for (const auto& [pair, kind] : by_name) {
    if (pair.first[0] != pair.second[0]) EXPECT_EQ(kind, LinkPairKind::unproven) << pair.first << " " << pair.second;
  }
}

TEST_F(SrdfTest, RefusesBadArguments) {
  const Robot robot = loadUrdf(write("mill.urdf", kRobot));
  LinkPairOptions none;
  none.samples = 0;
  expectContains(messageOf<std::invalid_argument>([&] { generateAllowedCollisions(robot, none); }), "samples is 0");
  expectContains(messageOf<std::invalid_argument>([&] { generateAllowedCollisions(Robot()); }), "no tree");
  expectContains(messageOf([&] { writeSrdf(path("none/x.srdf"), "r", {}); }), "x.srdf': No such file");
}

}  // namespace
}  // namespace srdf_test
}  // namespace fcl_artic
