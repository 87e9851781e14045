// SPDX-License-Identifier: BSD-3-Clause
#include "fcl_artic/ompl/planning_setup.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include <ompl/base/ScopedState.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/base/spaces/SO2StateSpace.h>

#include "../../src/visibility/executor.h"
#include "../urdf/temp_folder.h"
#include "slide.h"

namespace fcl_artic::planning {
namespace planning_setup_test {
namespace {

namespace ob = ::ompl::base;
using Names = std::vector<std::string>;

/// A cart on a rail with a turntable; on that an arm with a finger, its mimic, and a flag on a branch of its own.
constexpr const char* kUrdf = R"(<robot name="cart">
  <link name="rail"/>
  <link name="cart"><collision><geometry><box size="1 1 1"/></geometry></collision></link>
  <link name="table"/>
  <link name="arm"><collision><origin xyz="1 0 2"/><geometry><sphere radius="0.1"/></geometry></collision></link>
  <link name="finger"/> <link name="thumb"/> <link name="flag"/>
  <joint name="slide" type="prismatic"><parent link="rail"/><child link="cart"/><axis xyz="1 0 0"/>
    <limit lower="-10" upper="10" effort="1" velocity="1"/></joint>
  <joint name="turn" type="continuous"><parent link="cart"/><child link="table"/><axis xyz="0 0 1"/></joint>
  <joint name="weld" type="fixed"><parent link="table"/><child link="arm"/></joint>
  <joint name="grip" type="prismatic"><parent link="arm"/><child link="finger"/><axis xyz="0 1 0"/>
    <limit lower="0.01" upper="0.04" effort="1" velocity="1"/></joint>
  <joint name="grip2" type="prismatic"><parent link="arm"/><child link="thumb"/><axis xyz="0 -1 0"/>
    <limit lower="0.01" upper="0.04" effort="1" velocity="1"/><mimic joint="grip"/></joint>
  <joint name="wave" type="revolute"><parent link="cart"/><child link="flag"/><axis xyz="0 0 1"/>
    <limit lower="1" upper="2" effort="1" velocity="1"/></joint>
</robot>)";

constexpr const char* kSrdf = R"(<robot name="cart">
  <virtual_joint name="stand" type="fixed" parent_frame="world" child_link="rail"/>
  <virtual_joint name="drive" type="planar" parent_frame="world" child_link="rail"/>
  <group name="chain"><chain base_link="rail" tip_link="arm"/></group>
  <group name="from_cart"><chain base_link="cart" tip_link="thumb"/></group>
  <group name="over_the_top"><chain base_link="flag" tip_link="arm"/></group>
  <group name="joints"><joint name="wave"/><joint name="slide"/><joint name="weld"/><joint name="stand"/></group>
  <group name="links"><link name="rail"/><link name="flag"/><link name="finger"/><link name="thumb"/></group>
  <group name="both"><group name="joints"/><chain base_link="rail" tip_link="cart"/></group>
  <group name="passive"><joint name="slide"/><joint name="wave"/><passive_joint name="wave"/></group>
  <group name="loop"><joint name="slide"/><group name="pool"/></group>
  <group name="pool"><group name="loop"/></group>
  <group name="nothing"><joint name="weld"/></group>
  <group name="no_joint"><joint name="elbow"/></group>
  <group name="no_link"><chain base_link="rail" tip_link="nose"/></group>
  <group name="no_group"><group name="choir"/></group>
  <group name="moving_base"><joint name="drive"/><joint name="slide"/></group>
  <group name="nameless"><joint/></group>
</robot>)";

// A box that the cart meets at x = 2, above it a thin post that the arm's ball meets; both by MoveIt's format.
constexpr const char* kScene = R"((noname)+
* box
1
box
1 1 1
3 0 0
0 0 0 1
0 0 0 0
.
)";

class PlanningSetupTest : public TempFolderTest {
 protected:
  std::string urdf_ = write("cart.urdf", kUrdf), srdf_ = write("cart.srdf", kSrdf), scene_ = write("box.scene", kScene);
  Names group(const std::string& name) const { return groupJoints(srdf_, *loadUrdf(urdf_).tree, name); }
};

TEST_F(PlanningSetupTest, GroupsAreReadAsMoveItReadsThem) {
  EXPECT_EQ(group("chain"), (Names{"slide", "turn"}));
  EXPECT_EQ(group("from_cart"), (Names{"turn"})) << "neither the base's own joint nor a mimic";
  EXPECT_EQ(group("over_the_top"), (Names{"turn", "wave"}));
  EXPECT_EQ(group("joints"), (Names{"slide", "wave"}));
  EXPECT_EQ(group("links"), (Names{"grip", "wave"}));
  EXPECT_EQ(group("both"), (Names{"slide", "wave"}));
  EXPECT_EQ(group("passive"), (Names{"slide"}));
}

TEST_F(PlanningSetupTest, BadGroupsAreNamed) {
  for (const auto& [name, part] : {std::make_pair("legs", "no group 'legs'; it has 'chain'"),
                                   {"loop", "'loop' holds itself"},
                                   {"nothing", "'nothing' moves no joint"},
                                   {"no_joint", "'elbow'"},
                                   {"no_link", "'nose'"},
                                   {"no_group", "'choir'"},
                                   {"moving_base", "'drive', which is planar"},
                                   {"nameless", "no attribute 'name'"}}) {
    const std::string message = messageOf([&, n = name] { group(n); });
    expectContains(message, srdf_);
    expectContains(message, part);
  }
  expectContains(messageOf([&] { groupJoints(path("none.srdf"), *loadUrdf(urdf_).tree, "chain"); }), "none.srdf");
  expectContains(messageOf([&] { groupJoints(urdf_ + "x", *loadUrdf(urdf_).tree, "chain"); }), "cart.urdfx");
}

TEST_F(PlanningSetupTest, FromFilesToAnswers) {
  const PlanningSetup setup = setUpPlanning(urdf_, srdf_, scene_, "chain");
  EXPECT_EQ(setup.joints, (Names{"slide", "turn"}));
  ASSERT_TRUE(setup.space->isCompound());
  EXPECT_EQ(setup.space->getDimension(), 2u);
  EXPECT_TRUE(setup.si->isSetup());
  ob::ScopedState<> s1(setup.space), s2(setup.space);
  setup.setState(s1.get(), {0, 2.5});
  setup.setState(s2.get(), {1.9, 2.5 + 4 * 3.14159265358979323846});
  EXPECT_NEAR(setup.values(s2.get())[1], 2.5, 1e-14) << "as an angle of SO2";
  EXPECT_TRUE(setup.si->satisfiesBounds(s2.get()));
  EXPECT_TRUE(setup.si->checkMotion(s1.get(), s2.get()));
  setup.setState(s2.get(), {4, -2.5});
  EXPECT_EQ(setup.values(s2.get()), (std::vector<double>{4, -2.5}));
  std::pair<ob::State*, double> last{nullptr, 2};
  EXPECT_FALSE(setup.si->checkMotion(s1.get(), s2.get(), last));
  EXPECT_NEAR(last.second, 0.5, 3 * 0x1p-12);
  EXPECT_LT(last.second, 0.5);
  EXPECT_THROW(setup.setState(s1.get(), {1}), std::invalid_argument);
}

/// Stage 2 in what validator and checker ask, by the culler of the options.
TEST_F(PlanningSetupTest, CullingByVisibilityIsDoneByTheCullerGiven) {
  int made = 0;
  SetupOptions options;
  options.visibility = std::make_shared<VisibilityCuller>(VisibilityOptions(), "mine",
                                                          [&made]() -> std::unique_ptr<visibility::Executor> {
                                                            ++made;
                                                            throw std::runtime_error("no driver");
                                                          });
  for (const VisibilityMode mode : {VisibilityMode::off, VisibilityMode::on}) {
    made = 0;
    options.request.visibility = mode;
    const PlanningSetup setup = setUpPlanning(urdf_, srdf_, scene_, "chain", options);
    ob::ScopedState<> s1(setup.space), s2(setup.space);
    setup.setState(s1.get(), {0, 2.5});
    setup.setState(s2.get(), {1.9, 2.5});
    EXPECT_TRUE(setup.si->checkMotion(s1.get(), s2.get()));
    setup.setState(s2.get(), {4, -2.5});
    std::pair<ob::State*, double> last{nullptr, 2};
    EXPECT_FALSE(setup.si->checkMotion(s1.get(), s2.get(), last));
    EXPECT_NEAR(last.second, 0.5, 3 * 0x1p-12);
    EXPECT_LT(last.second, 0.5);
    if (mode == VisibilityMode::off) {
      EXPECT_EQ(made, 0);
      EXPECT_EQ(options.visibility->fallbackReason(), "");
    } else {
      EXPECT_EQ(options.visibility->fallbackReason(), "mine: no driver");
    }
  }
}

/// A link's allowed pairs do not hold for an obstacle with the name of the other link.
TEST_F(PlanningSetupTest, AnObstacleWithALinksNameIsMet) {
  std::string scene = kScene, srdf = kSrdf;
  scene.replace(scene.find("box"), 3, "arm");
  srdf.insert(srdf.find("</robot>"), "<disable_collisions link1=\"cart\" link2=\"arm\" reason=\"Never\"/>");
  const PlanningSetup setup = setUpPlanning(urdf_, write("allowed.srdf", srdf), write("arm.scene", scene), "joints");
  ob::ScopedState<> s1(setup.space), s2(setup.space);
  setup.setState(s1.get(), {0, 1.5});
  setup.setState(s2.get(), {4, 1.5});
  std::pair<ob::State*, double> last{nullptr, 2};
  EXPECT_FALSE(setup.si->checkMotion(s1.get(), s2.get(), last));
  EXPECT_NEAR(last.second, 0.5, 3 * 0x1p-12);
  ASSERT_EQ(setup.notes.size(), 2u);
  const std::string notes = setup.notes[0] + setup.notes[1];
  expectContains(notes, "base is planar by its virtual_joint, and stands still here");
  expectContains(notes, "'arm' is called 'arm#2'");
}

// The cart within a box of 8 m, a mesh: where it is a solid no state in it is valid, and no motion.
TEST_F(PlanningSetupTest, SolidMeshes) {
  const std::string box = write("box.obj",
                                "v -4 -4 -4\nv 4 -4 -4\nv 4 4 -4\nv -4 4 -4\nv -4 -4 4\nv 4 -4 4\nv 4 4 4\nv -4 4 4\n"
                                "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 2 3 7 6\nf 4 1 5 8\n");
  for (const bool solid : {false, true}) {
    SetupOptions options;
    options.scene.solid_meshes = solid;
    const PlanningSetup setup = setUpPlanning(urdf_, srdf_, box, "joints", options);
    ob::ScopedState<> s1(setup.space), s2(setup.space), out(setup.space);
    setup.setState(s1.get(), {0, 1.5});
    setup.setState(s2.get(), {1, 1.5});
    setup.setState(out.get(), {8, 1.5});
    EXPECT_EQ(setup.si->isValid(s1.get()), !solid);
    EXPECT_EQ(setup.si->checkMotion(s1.get(), s2.get()), !solid);
    EXPECT_TRUE(setup.si->isValid(out.get()));
    EXPECT_TRUE(setup.si->checkMotion(out.get(), out.get()));
    EXPECT_FALSE(setup.si->checkMotion(out.get(), s1.get()));
  }
}

TEST_F(PlanningSetupTest, JointsWithoutRoomStandStill) {
  std::string urdf = kUrdf;
  urdf.replace(urdf.find("lower=\"1\" upper=\"2\""), 19, "lower=\"1.5\" upper=\"1.5\"");
  const std::string file = write("stiff.urdf", urdf);
  EXPECT_EQ(setUpPlanning(file, srdf_, scene_, "joints").joints, (Names{"slide"}));
  EXPECT_EQ(setUpPlanning(file, srdf_, scene_, "over_the_top").joints, (Names{"turn"}));
  const auto manager = std::make_shared<ArticulatedCollisionManager>(loadUrdf(file).tree);
  manager->setup();
  EXPECT_EQ(setUpPlanning(manager, {}).joints, (Names{"slide", "turn", "grip"}));
  expectContains(messageOf<std::invalid_argument>([&] { setUpPlanning(manager, {"wave"}); }), "'wave' has no room");
}

TEST_F(PlanningSetupTest, LimitsThatNoQueryTakesAreNamed) {
  std::string urdf = kUrdf;
  urdf.replace(urdf.find("upper=\"10\""), 10, "upper=\"1e9\"");
  const std::string file = write("endless.urdf", urdf);
  const std::string message = messageOf<std::invalid_argument>([&] { setUpPlanning(file, srdf_, scene_, "joints"); });
  expectContains(message, "'slide' has limits");
  auto tree = std::make_shared<KinematicTree>("ship");
  tree->addLink("sea");
  tree->addLink("ship");
  tree->addJoint(makeJoint("swim", JointType::planar, "sea", "ship", Eigen::Vector3d::UnitZ()));
  const auto manager = World(tree).manager();
  SetupOptions options;
  for (const double far : {0.0, std::nan(""), 1e6, std::numeric_limits<double>::infinity()}) {
    options.position_upper.setConstant(far);
    const std::string message = messageOf<std::invalid_argument>([&] { setUpPlanning(manager, {}, options); });
    expectContains(message, "'swim' needs options");
  }
  options.position_upper.setConstant(100);
  EXPECT_EQ(setUpPlanning(manager, {}, options).space->getDimension(), 3u);
}

TEST_F(PlanningSetupTest, UnknownCellsAreObstaclesOnRequest) {
  // In the cube of edge 2 at the origin, octants 0, 1 and 7 are known, and 1 and 7 occupied.
  const std::string cells = write("cells.bt", std::string("# Octomap OcTree binary file\nid OcTree\nsize 4\n"
                                                          "res 0.000030517578125\ndata\n\x09\x80"));
  SetupOptions options;
  options.fixed["turn"] = 0;
  const auto obstacles = [&] { return setUpPlanning(urdf_, srdf_, cells, "joints", options).manager->size(); };
  EXPECT_EQ(obstacles(), 2u);
  options.scene.unknown_cells = true;
  EXPECT_EQ(obstacles(), 7u);
}

TEST_F(PlanningSetupTest, LivesAsLongAsItsSpaceInformation) {
  const ob::SpaceInformationPtr si = setUpPlanning(urdf_, srdf_, scene_, "joints").si;
  ob::ScopedState<ob::RealVectorStateSpace> s1(si), s2(si);
  s1->values[0] = 0;
  s2->values[0] = 2.5;
  s1->values[1] = s2->values[1] = 1.5;
  EXPECT_TRUE(si->isValid(s1.get()));
  EXPECT_FALSE(si->isValid(s2.get()));
  EXPECT_FALSE(si->checkMotion(s1.get(), s2.get()));
}

TEST_F(PlanningSetupTest, OtherJointsStandWhereTheyAreFixed) {
  // Where the slide is fixed decides whether the cart touches the box.
  SetupOptions options;
  const auto valid = [&] {
    const PlanningSetup setup = setUpPlanning(urdf_, srdf_, scene_, "from_cart", options);
    const ob::ScopedState<ob::SO2StateSpace> state(setup.si);
    return setup.si->isValid(state.get());
  };
  EXPECT_TRUE(valid());
  options.fixed["slide"] = 3;
  EXPECT_FALSE(valid());
  for (const char* name : {"elbow", "weld", "grip2", "turn"}) {
    options.fixed = {{name, 0.0}};
    expectContains(messageOf<std::invalid_argument>([&] { valid(); }), std::string("'") + name + "'");
  }
  options.fixed = {{"slide", std::nan("")}};
  expectContains(messageOf<std::invalid_argument>([&] { valid(); }), "slide");
}

TEST_F(PlanningSetupTest, WithoutASceneOnlyTheRobotCounts) {
  const PlanningSetup setup = setUpPlanning(urdf_, srdf_, "", "joints");
  EXPECT_EQ(setup.manager->size(), 0u);
  ob::ScopedState<ob::RealVectorStateSpace> state(setup.si);
  state->values[0] = 3;
  EXPECT_TRUE(setup.si->isValid(state.get()));
  // Other joints stand at the limit that is nearest to 0, within their bounds.
  EXPECT_THROW(setUpPlanning(urdf_, srdf_, path("none.scene"), "joints"), std::runtime_error);
}

TEST_F(PlanningSetupTest, BadJointsOfAManagerAreNamed) {
  const auto manager = slideWorld();
  const auto message = [&](const Names& joints) {
    return messageOf<std::invalid_argument>([&] { setUpPlanning(manager.manager(), joints); });
  };
  expectContains(message({"elbow"}), "'elbow'");
  expectContains(message({"slide", "slide"}), "'slide' is named twice");
  EXPECT_THROW(setUpPlanning(nullptr, {}), std::invalid_argument);
  auto tree = std::make_shared<KinematicTree>("endless");
  tree->addLink("a");
  tree->addLink("b");
  tree->addJoint(makeJoint("slide", JointType::prismatic, "a", "b", Eigen::Vector3d::UnitX()));
  expectContains(messageOf<std::invalid_argument>([&] { setUpPlanning(World(tree).manager(), {}); }),
                 "'slide' has no limits");
}

}  // namespace
}  // namespace planning_setup_test
}  // namespace fcl_artic::planning
