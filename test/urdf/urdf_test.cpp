// SPDX-License-Identifier: BSD-3-Clause
#include "fcl_artic/urdf/urdf.h"

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>

#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <optional>

#include "temp_folder.h"

/// Readers leak on broken files: urdfdom where joints close a loop, assimp where it gives up. Not ours to mend.
extern "C" const char* __lsan_default_suppressions() {  // NOLINT: its name
  return "leak:liburdfdom_model\nleak:libassimp\n";
}

namespace fcl_artic {
namespace urdf_test {
namespace {

const char* const kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

std::string robot(const std::string& body) {
  return "<?xml version=\"1.0\"?><robot name=\"r\">" + body + "</robot>";
}
std::string joint(const std::string& name, const std::string& type, const std::string& parent, const std::string& child,
                  const std::string& more = "<limit lower='-1' upper='1' effort='1' velocity='1'/>") {
  return "<joint name='" + name + "' type='" + type + "'><parent link='" + parent + "'/><child link='" + child + "'/>" +
         more + "</joint>";
}
std::string collision(const std::string& geometry, const std::string& origin = "") {
  return "<collision>" + origin + "<geometry>" + geometry + "</geometry></collision>";
}
std::string linkWith(const std::string& content) {
  return "<link name='a'>" + content + "</link>";
}

/// Seconds of this process's own work.
template <class Work>
double secondsOf(const Work& work) {
  const std::clock_t begin = std::clock();
  work();
  return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
}

class UrdfTest : public TempFolderTest {
 protected:
  Robot load(const std::string& body) { return loadUrdf(write("r.urdf", robot(body))); }
  std::string errorOf(const std::string& body) {
    return messageOf([&] { load(body); });
  }
};

TEST_F(UrdfTest, ReadsTreeInTheOrderOfTheFile) {
  const Robot r = load("<link name='z'/><link name='m'/><link name='a'/><link name='b'/><link name='c'/>" +
                       joint("follow", "prismatic", "z", "c",
                             "<axis xyz='0 0 2'/><limit lower='0' upper='1' effort='1' velocity='1'/>"
                             "<mimic joint='zeta' multiplier='-0.5' offset='0.25'/>") +
                       joint("zeta", "revolute", "z", "m",
                             "<origin xyz='1 2 3' rpy='0 0 1.5707963267948966'/><axis xyz='0 1 0'/>"
                             "<limit lower='-2' upper='0.5' effort='1' velocity='1'/>") +
                       joint("alpha", "continuous", "m", "a", "") + joint("fixed", "fixed", "a", "b", ""));
  const KinematicTree& tree = *r.tree;
  EXPECT_EQ(tree.name(), "r");
  ASSERT_EQ(tree.numLinks(), 5);
  EXPECT_EQ(tree.linkName(0), "z");
  EXPECT_EQ(tree.linkName(2), "a");
  ASSERT_EQ(tree.dof(), 2);
  EXPECT_EQ(tree.variableName(0), "zeta");
  EXPECT_EQ(tree.variableName(1), "alpha");

  const Joint& zeta = tree.joint(tree.jointId("zeta"));
  EXPECT_EQ(zeta.type, JointType::revolute);
  EXPECT_EQ(zeta.lower, -2);
  EXPECT_EQ(zeta.upper, 0.5);
  EXPECT_EQ(zeta.axis, Eigen::Vector3d(0, 1, 0));
  EXPECT_EQ(zeta.origin.translation(), Eigen::Vector3d(1, 2, 3));
  EXPECT_LT((zeta.origin.linear() * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY()).norm(), 1e-15);
  EXPECT_EQ(tree.joint(tree.jointId("alpha")).type, JointType::continuous);
  EXPECT_EQ(tree.joint(tree.jointId("alpha")).axis, Eigen::Vector3d(1, 0, 0)) << "URDF's default axis";
  EXPECT_EQ(tree.jointValue(tree.jointId("follow"), Eigen::Vector2d(1, 0)), -0.25);
  EXPECT_EQ(tree.joint(tree.jointId("follow")).axis, Eigen::Vector3d(0, 0, 1));
}

// In the file followers stand before those that they follow, and the last one's master mimics the fixed joint.
TEST_F(UrdfTest, MimicsOfMimicsStandInAnyOrder) {
  const auto follows = [](const char* name, const char* child, const char* mimic) {
    return joint(name, "revolute", "z", child,
                 std::string("<axis xyz='0 0 1'/><limit lower='-9' upper='9' effort='1' velocity='1'/>") + mimic);
  };
  const std::string joints[] = {follows("third", "c", "<mimic joint='second' multiplier='0.5' offset='1'/>"),
                                follows("second", "b", "<mimic joint='first' multiplier='-2' offset='0.125'/>"),
                                follows("first", "a", ""),
                                follows("stiff", "e", "<mimic joint='held' multiplier='3' offset='0.25'/>"),
                                follows("held", "d", "<mimic joint='lock' offset='0.5'/>"),
                                joint("lock", "fixed", "z", "f", "")};
  std::vector<std::size_t> order = {0, 1, 2, 3, 4, 5};
  int orders = 0;
  do {
    std::string body =
        "<link name='z'/><link name='a'/><link name='b'/><link name='c'/><link name='d'/><link name='e'/>"
        "<link name='f'/>";
    for (const std::size_t i : order) body += joints[i];
    const Robot r = load(body);
    const KinematicTree& tree = *r.tree;
    ASSERT_EQ(tree.dof(), 1);
    const Eigen::VectorXd q = Eigen::VectorXd::Constant(1, 0.5);
    EXPECT_EQ(tree.jointValue(tree.jointId("second"), q), -0.875);
    EXPECT_EQ(tree.jointValue(tree.jointId("third"), q), 0.5625);
    EXPECT_EQ(tree.joint(tree.jointId("stiff")).type, JointType::fixed);
    const Eigen::Vector3d x = tree.linkPose(tree.linkId("e"), q) * Eigen::Vector3d::UnitX();
    EXPECT_LT((x - Eigen::Vector3d(std::cos(1.75), std::sin(1.75), 0)).norm(), 1e-15);
    ++orders;
  } while (std::next_permutation(order.begin(), order.end()));
  EXPECT_EQ(orders, 720);
}

TEST_F(UrdfTest, ReadsFloatingAndPlanarJoints) {
  const Robot r =
      load("<link name='a'/><link name='b'/><link name='c'/><link name='d'/>" + joint("free", "floating", "a", "b") +
           joint("base", "planar", "b", "c", "<axis xyz='0 0 1'/>") + joint("wall", "planar", "c", "d", ""));
  const KinematicTree& tree = *r.tree;
  ASSERT_EQ(tree.dof(), 13);
  EXPECT_EQ(tree.joint(tree.jointId("free")).type, JointType::floating);
  EXPECT_EQ(tree.variableName(6), "free/rot_w");
  EXPECT_EQ(tree.variableName(9), "base/theta");
  EXPECT_EQ(tree.joint(tree.jointId("wall")).axis, Eigen::Vector3d(1, 0, 0));
  ASSERT_EQ(r.notes.size(), 2u) << "no geometry, and the axis that some tools ignore";
  EXPECT_NE(r.notes[0].find("joint 'wall' is planar across its axis"), std::string::npos) << r.notes[0];
}

TEST_F(UrdfTest, ReadsShapesWithOffsetsSeveralForALink) {
  const Robot r =
      load(linkWith(collision("<box size='1 2 3'/>", "<origin xyz='0 0 4' rpy='0 0 0'/>") +
                    collision("<cylinder radius='0.5' length='2'/>") + collision("<sphere radius='0.25'/>")));
  ASSERT_EQ(r.geometry.size(), 3u);
  EXPECT_TRUE(r.notes.empty());
  const auto* box = dynamic_cast<const fcl::Boxd*>(r.geometry[0].object->collisionGeometry().get());
  ASSERT_TRUE(box);
  EXPECT_EQ(box->side, fcl::Vector3d(1, 2, 3));
  EXPECT_EQ(r.geometry[0].link, 0);
  EXPECT_EQ(r.geometry[0].source, "box");
  EXPECT_EQ(r.geometry[0].offset.translation(), Eigen::Vector3d(0, 0, 4));
  const auto* cylinder = dynamic_cast<const fcl::Cylinderd*>(r.geometry[1].object->collisionGeometry().get());
  ASSERT_TRUE(cylinder);
  EXPECT_EQ(cylinder->radius, 0.5);
  EXPECT_EQ(cylinder->lz, 2);
  const auto* sphere = dynamic_cast<const fcl::Sphered*>(r.geometry[2].object->collisionGeometry().get());
  ASSERT_TRUE(sphere);
  EXPECT_EQ(sphere->radius, 0.25);
}

TEST_F(UrdfTest, FindsMeshesByEveryKindOfPath) {
  const std::string file = write("ws/my_robot/meshes/t.obj", kTriangle);
  const std::string other = write("elsewhere/t.obj", kTriangle);
  const auto loadWith = [&](const std::string& uri, const UrdfOptions& options = {}) {
    return loadUrdf(
        write("ws/my_robot/urdf/r.urdf", robot(linkWith(collision("<mesh filename='" + uri + "' scale='1 2 3'/>")))),
        options);
  };
  for (const std::string& uri :
       {std::string("../meshes/t.obj"), file, "file://" + file, std::string("package://my_robot/meshes/t.obj")}) {
    SCOPED_TRACE(uri);
    const Robot r = loadWith(uri);
    ASSERT_EQ(r.geometry.size(), 1u);
    EXPECT_TRUE(std::filesystem::equivalent(r.geometry[0].source, file));
    EXPECT_EQ(r.geometry[0].object->collisionGeometry()->aabb_local.max_, fcl::Vector3d(1, 2, 0));
  }
  UrdfOptions named;
  named.packages["my_robot"] = path("elsewhere");
  EXPECT_EQ(loadWith("package://my_robot/t.obj", named).geometry.at(0).source, other);
  EXPECT_EQ(loadWith("package://my_robot//t.obj", named).geometry.at(0).source, other);  // not /t.obj
  // A package beside one of the parents.
  EXPECT_TRUE(std::filesystem::equivalent(loadWith("package://elsewhere/t.obj").geometry.at(0).source, other));

  const auto error = [&](const std::string& uri) { return messageOf([&] { loadWith(uri); }); };
  expectContains(error("../meshes/none.obj"), "none.obj': no such file");
  expectContains(error("package://my_robot/none.obj"), "none.obj': no such file in '" + path("ws/my_robot") + "'");
  expectContains(error("package://not_here/t.obj"), "there is no package 'not_here': ");
  expectContains(error("package:///"), "names no file");
  expectContains(error("package://my_robot/"), "names no file");
  expectContains(error("package://my_robot//"), "names no file");
  expectContains(error("package://my_robot/" + file), "t.obj': no such file in '" + path("ws/my_robot") + "'");
  expectContains(error("../meshes"), "meshes': is a directory, not a file");
  expectContains(error("https://example.org/t.obj"), "only file:// and package:// are read");
  expectContains(error("../meshes/none.obj"), "r.urdf': link 'a'");
}

/// Sets a variable of the environment while it lives.
class Variable {
 public:
  Variable(const char* name, const std::string& value) : name_(name) {
    if (const char* old = std::getenv(name)) old_ = old;
    setenv(name, value.c_str(), 1);
  }
  ~Variable() { old_ ? setenv(name_, old_->c_str(), 1) : unsetenv(name_); }

 private:
  const char* name_;
  std::optional<std::string> old_;
};

TEST_F(UrdfTest, FindsPackagesAsRosDoes) {
  const auto sourceOf = [&](const std::string& uri) {
    return loadUrdf(write("ws/src/arm/urdf/r.urdf", robot(linkWith(collision("<mesh filename='" + uri + "'/>")))))
        .geometry.at(0)
        .source;
  };
  const auto manifest = [](const std::string& name) { return "<package><name>\n " + name + " </name></package>"; };
  const Variable no_ros("ROS_PACKAGE_PATH", ""), no_ament("AMENT_PREFIX_PATH", "");
  // Above the file, by the name in package.xml: the folder has another one.
  write("ws/src/arm/package.xml", manifest("arm_description"));
  const std::string in_workspace = write("ws/src/arm/t.obj", kTriangle);
  EXPECT_EQ(sourceOf("package:///arm_description/t.obj"), in_workspace);
  EXPECT_EQ(sourceOf("package://arm_description/t.obj"), path("ws/src/arm/t.obj"));

  const std::string nowhere = messageOf([&] { sourceOf("package://hand/t.obj"); });
  expectContains(nowhere,
                 "there is no package 'hand': searched for 'hand' by folder name and by package.xml at and above '" +
                     path("ws/src/arm/urdf") + "'");
  expectContains(nowhere, "below ROS_PACKAGE_PATH (which is not set)");
  expectContains(nowhere, "in share/ of AMENT_PREFIX_PATH (which is not set)");
  expectContains(nowhere, "--package hand=DIR");

  const std::string in_ament = write("opt/share/hand/t.obj", kTriangle);
  const Variable ament("AMENT_PREFIX_PATH", path("none") + ":" + path("opt"));
  EXPECT_EQ(sourceOf("package://hand/t.obj"), in_ament);

  // Below a folder of the path, by package.xml, but not within packages or where a file says that there are none.
  const std::string in_ros = write("catkin/group/right_hand/t.obj", kTriangle);
  write("catkin/group/right_hand/package.xml", manifest("hand"));
  write("catkin/a/package.xml", manifest("a"));
  write("catkin/a/hand/t.obj", kTriangle);
  write("catkin/b/CATKIN_IGNORE", "");
  write("catkin/b/hand/t.obj", kTriangle);
  std::filesystem::create_directory_symlink(path("catkin"), path("catkin/z"));  // a circle
  const Variable ros("ROS_PACKAGE_PATH", path("none") + "::" + path("catkin"));
  EXPECT_EQ(sourceOf("package://hand/t.obj"), in_ros);
  // The first folder that has the file is taken; an error names all of them.
  const std::string in_share = write("opt/share/hand/u.obj", kTriangle);
  EXPECT_EQ(sourceOf("package://hand/u.obj"), in_share);
  const std::string missing = messageOf([&] { sourceOf("package://hand/none.obj"); });
  expectContains(missing, "no such file in '" + path("catkin/group/right_hand") + "'");
  expectContains(missing, ", '" + path("opt/share/hand") + "'; also searched for 'hand'");
  expectContains(missing, "below ROS_PACKAGE_PATH '" + path("none") + "::" + path("catkin") + "'");
  // A package that the caller names is not looked for.
  UrdfOptions named;
  named.packages["hand"] = path("ws");
  const std::string refused = messageOf([&] { loadUrdf(path("ws/src/arm/urdf/r.urdf"), named); });
  expectContains(refused, "no such file in '" + path("ws") + "'");
}

TEST_F(UrdfTest, StandsWhereItsBaseIs) {
  const std::string file = write(
      "r.urdf",
      robot("<link name='world'/><link name='a'/>" +
            joint("j", "revolute", "world", "a",
                  "<origin xyz='1 0 0'/><axis xyz='0 0 1'/><limit lower='-1' upper='1' effort='1' velocity='1'/>")));
  UrdfOptions options;
  EXPECT_EQ(loadUrdf(file, options).tree->numLinks(), 2) << "no link is added where none is needed";
  options.base = Eigen::Translation3d(0, 0, 5) * Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ());
  const auto placed = loadUrdf(file, options).tree;
  EXPECT_EQ(placed->numLinks(), 3);
  EXPECT_EQ(placed->linkName(2), "world_") << "the robot has a 'world' of its own";
  EXPECT_EQ(placed->dof(), 1);
  const Eigen::VectorXd q = Eigen::VectorXd::Zero(1);
  EXPECT_LT((placed->linkPose(placed->linkId("a"), q).translation() - Eigen::Vector3d(0, 1, 5)).norm(), 1e-12);

  options.floating_base = true;
  const auto floating = loadUrdf(file, options).tree;
  ASSERT_EQ(floating->dof(), 8);
  EXPECT_EQ(floating->variableName(0), "floating_base/trans_x");
  EXPECT_EQ(floating->variableName(7), "j");
  Eigen::VectorXd away = floating->neutralConfiguration();
  EXPECT_LT((floating->linkPose(1, away).translation() - Eigen::Vector3d(0, 1, 5)).norm(), 1e-12);
  away[0] = 2;  // along the base's x
  EXPECT_LT((floating->linkPose(1, away).translation() - Eigen::Vector3d(0, 3, 5)).norm(), 1e-12);

  options.base.linear() *= 2;
  expectContains(messageOf([&] { loadUrdf(file, options); }),
                 "r.urdf': robot 'r': joint 'floating_base' has an origin");
}

// Three links of 1 m, a slide of 0.5 m on the second; a ball of 0.1 m at the end, and a base far away.
TEST_F(UrdfTest, ReachIsTheLengthOfTheLinks) {
  const std::string up = "<origin xyz='0 0 1'/>", axis = "<axis xyz='1 0 0'/>";
  const std::string file =
      write("r.urdf",
            robot("<link name='a'/><link name='b'/><link name='c'/><link name='d'>" +
                  collision("<sphere radius='0.1'/>", up) + "</link>" + joint("ab", "continuous", "a", "b", up + axis) +
                  joint("bc", "prismatic", "b", "c",
                        up + axis + "<limit lower='-0.5' upper='0.25' effort='1' velocity='1'/>") +
                  joint("cd", "continuous", "c", "d", up + axis)));
  UrdfOptions options;
  for (const bool floating : {false, true}) {
    options.floating_base = floating;
    const Robot r = loadUrdf(file, options);
    EXPECT_DOUBLE_EQ(reachUpper(*r.tree), 3.5);
    EXPECT_NEAR(reachUpper(*r.tree, r.geometry), 4.6, 1e-12);
    options.base = Eigen::Translation3d(100, 0, 0);
  }
}

TEST_F(UrdfTest, LoadsAMeshOnceForAllItsLinks) {
  write("t.obj", kTriangle);
  const std::string mesh = collision("<mesh filename='t.obj'/>");
  const Robot r =
      load("<link name='a'>" + mesh + "</link><link name='b'>" + mesh + "</link>" + joint("j", "fixed", "a", "b", ""));
  ASSERT_EQ(r.geometry.size(), 2u);
  EXPECT_EQ(r.geometry[0].object->collisionGeometry(), r.geometry[1].object->collisionGeometry());
}

TEST_F(UrdfTest, ReadsManyMeshesInTheOrderOfTheFile) {
  constexpr int kLinks = 40;  // over threads
  std::string body;
  for (int i = 0; i < kLinks; ++i) {
    const std::string number = std::to_string(i), file = "m" + number + ".obj";
    write(file, "v 0 0 " + number + "\nv 1 0 " + number + "\nv 0 1 " + number + "\nf 1 2 3\nf 1 1 2\n");
    // Links by their names are in another order.
    body +=
        "<link name='l" + std::to_string(kLinks - i) + "'>" + collision("<mesh filename='" + file + "'/>") + "</link>";
    if (i > 0) body += joint("j" + number, "fixed", "l" + std::to_string(kLinks), "l" + std::to_string(kLinks - i), "");
  }
  const Robot r = load(body);
  ASSERT_EQ(r.geometry.size(), std::size_t{kLinks});
  ASSERT_EQ(r.notes.size(), std::size_t{kLinks});
  for (std::size_t i = 0; i < kLinks; ++i) {
    EXPECT_EQ(r.geometry[i].object->collisionGeometry()->aabb_local.min_[2], static_cast<double>(i));
    expectContains(r.notes[i], "m" + std::to_string(i) + ".obj': 1 of 2 triangles have no area");
  }
  // The first in the file that is wrong is named.
  write("m20.obj", "v 0 0 0\n");
  write("m31.obj", "v 0 0 0\n");
  const std::string error = errorOf(body);
  expectContains(error, "link 'l20': ");
  expectContains(error, "m20.obj");
}

TEST_F(UrdfTest, NotesWhatIsUnusual) {
  write("flat.obj", std::string(kTriangle) + "f 1 1 2\n");
  const Robot r = load("<link name='a'>" + collision("<mesh filename='flat.obj'/>") +
                       "</link><link name='b'><visual><geometry><sphere radius='1'/></geometry></visual></link>"
                       "<link name='c'/>" +
                       joint("lock", "fixed", "a", "b", "") +
                       joint("follow", "prismatic", "b", "c",
                             "<axis xyz='0 0 2'/><limit lower='0' upper='1' effort='1' velocity='1'/>"
                             "<mimic joint='lock' offset='0.5'/>"));
  std::string all;
  for (const std::string& note : r.notes) all += note + "\n";
  EXPECT_EQ(r.notes.size(), 3u) << all;
  expectContains(all, "flat.obj': 1 of 2 triangles have no area");
  expectContains(all, "link 'b' has a visual but no collision geometry");
  expectContains(all, "joint 'follow' mimics the fixed joint 'lock'");
  EXPECT_EQ(r.tree->dof(), 0);
  EXPECT_EQ(r.tree->joint(1).origin.translation(), Eigen::Vector3d(0, 0, 0.5));
  expectContains(load("<link name='a'/>").notes.at(0), "robot 'r' has no collision geometry");
  const auto limits = [](const char* numbers) {
    return "<axis xyz='0 0 1'/><limit " + std::string(numbers) + " effort='1' velocity='1'/>";
  };
  const Robot limp = load("<link name='a'/><link name='b'/><link name='c'/><link name='d'/>" +
                          joint("limp", "revolute", "a", "b", limits("")) +
                          joint("stiff", "revolute", "b", "c", limits("lower='1' upper='1'")) +
                          joint("swapped", "revolute", "c", "d", limits("lower='1' upper='-1'")));
  ASSERT_EQ(limp.notes.size(), 3u);
  expectContains(limp.notes[0], "joint 'limp' has limits that are both 0");
  expectContains(limp.notes[1], "joint 'swapped' has its lower limit above its upper one");
  EXPECT_FALSE(hasLimits(limp.tree->joint(0)));
  EXPECT_TRUE(hasLimits(limp.tree->joint(1)));
  EXPECT_FALSE(hasLimits(limp.tree->joint(2)));

  // The end that is missing is 0 by URDF's rules, which few people know.
  const Robot half = load("<link name='a'/><link name='b'/><link name='c'/><link name='d'/><link name='e'/>" +
                          joint("low", "revolute", "a", "b", limits("lower='-2'")) +
                          joint("high", "prismatic", "b", "c", limits("upper='2'")) +
                          joint("wheel", "continuous", "c", "d", limits("upper='2'")) +
                          joint("whole", "revolute", "d", "e", limits("lower='-2' upper='2'")));
  ASSERT_EQ(half.notes.size(), 3u);
  expectContains(half.notes[0], "joint 'low' has a limit with 'lower' and no 'upper', which is 0 then");
  expectContains(half.notes[1], "joint 'high' has a limit with 'upper' and no 'lower', which is 0 then");
  EXPECT_EQ(half.tree->joint(0).lower, -2);
  EXPECT_EQ(half.tree->joint(0).upper, 0);
}

// The set-up's work for a link does not grow with the number of links above it. (It took 8 s, with the cube of the
// links.)
TEST_F(UrdfTest, ChainsOfThousandsOfLinksAreSetUpAtOnce) {
  constexpr int kLinks = 3000;
  std::string body = linkWith(collision("<sphere radius='0.01'/>"));
  for (int k = 1; k <= kLinks; ++k) {
    const std::string parent = k == 1 ? "a" : "l" + std::to_string(k - 1), link = "l" + std::to_string(k);
    body += "<link name='" + link + "'/>" +
            joint("j" + std::to_string(k), "continuous", parent, link, "<origin xyz='0 0 0.1'/><axis xyz='0 1 0'/>");
  }
  const Robot chain = load(body);
  ArticulatedCollisionManager manager(chain.tree);
  chain.addTo(manager);
  EXPECT_LT(secondsOf([&] { manager.setup(); }), 1);  // a twentieth of that
}

// Names are looked up, and links are sorted, in n log n steps. With their square 20,000 links take 10 s.
TEST_F(UrdfTest, TimeToReadGrowsWithTheFile) {
  constexpr int kLinks = 20000;
  std::string body = "<link name='l0'/>", srdf = "<robot name='r'>", strange = srdf;
  for (int k = 1; k <= kLinks; ++k) {
    const std::string parent = "l" + std::to_string(k - 1), link = "l" + std::to_string(k);
    body += "<link name='" + link + "'/>" + joint("j" + std::to_string(k), "continuous", parent, link);
    srdf += "<disable_collisions link1='" + parent + "' link2='" + link + "' reason='Adjacent'/>";
    strange += "<disable_collisions link1='l0' link2='of_another_robot" + std::to_string(k) + "'/>";
  }
  Robot chain;
  EXPECT_LT(secondsOf([&] { chain = load(body); }), 3);
  EXPECT_EQ(chain.tree->topologicalOrder().back(), kLinks);
  const std::string pairs = write("chain.srdf", srdf + "</robot>");
  EXPECT_LT(secondsOf([&] { EXPECT_EQ(loadSrdf(pairs, *chain.tree).pairs().size(), std::size_t{kLinks}); }), 3);
  const std::string unknown = write("strange.srdf", strange + "</robot>");
  EXPECT_LT(secondsOf([&] { EXPECT_EQ(loadSrdf(unknown, *chain.tree).pairs().size(), 0u); }), 3);

  // Elements that urdfdom does not get stand after as many others.
  std::string parts, materials;
  for (int k = 0; k < kLinks; ++k) {
    parts += collision("<sphere radius='0.1'/>");
    materials += "<material name='m" + std::to_string(k) + "'/>";
  }
  for (int k = 0; k < kLinks; ++k) parts += "<visual/>";
  EXPECT_LT(secondsOf([&] { EXPECT_EQ(load(linkWith(parts) + materials).geometry.size(), std::size_t{kLinks}); }), 3);
}

// Python's strings, and messages of all kinds, are of characters.
TEST_F(UrdfTest, NamesAreUtf8) {
  const std::string latin1 = "caf\xE9", utf8 = "caf\xC3\xA9";
  EXPECT_EQ(load("<link name='" + utf8 + "'/>").tree->linkName(0), utf8);
  const auto errorOf = [&](const std::string& body) {
    try {
      load("<!-- " + latin1 + " -->\n" + body);  // not in a comment
      return std::string("is read");
    } catch (const std::runtime_error& error) {
      return std::string(error.what());
    }
  };
  EXPECT_EQ(errorOf("<link name='a'/>"), "is read");
  expectContains(errorOf("<link name='" + latin1 + "'/>"), "line 2, <link>");
  expectContains(errorOf("<link name='" + latin1 + "'/>"), "no UTF-8; save the file as UTF-8");
  const std::string links = "<link name='a'/><link name='b'/>";
  expectContains(errorOf(links + joint(latin1, "fixed", "a", "b", "")),
                 "the attribute 'name' has bytes that are no UTF-8");
  for (const char* wrong : {"\xC0\x80", "\xED\xA0\x80", "\xF5\x80\x80\x80", "\xE2\x82", "\x80", "\xF0\x80\x80\x80"}) {
    expectContains(errorOf("<link name='a" + std::string(wrong) + "'/>"), "no UTF-8");
  }
}

TEST_F(UrdfTest, IsBoundAsAWholeOrNotAtAll) {
  Robot r = load(linkWith(collision("<sphere radius='1'/>") + collision("<sphere radius='2'/>")));
  ASSERT_EQ(r.geometry.size(), 2u);
  ArticulatedCollisionManager manager(r.tree);
  Robot bad = r;
  bad.geometry[1].link = 9;
  expectContains(messageOf<std::invalid_argument>([&] { bad.addTo(manager); }), "no link 9");
  EXPECT_TRUE(manager.boundObjects().empty());
  bad = r;
  bad.allowed.allow("nobody", r.tree->linkName(0));
  expectContains(messageOf<std::invalid_argument>([&] { bad.addTo(manager); }), "nobody");
  EXPECT_TRUE(manager.boundObjects().empty());
  r.addTo(manager);
  EXPECT_EQ(manager.boundObjects().size(), 2u);
}

// Geometries go by numbers of links. A manager of another robot would check them at other links.
TEST_F(UrdfTest, IsRefusedByAManagerOfAnotherRobot) {
  const Robot r = load(linkWith(collision("<sphere radius='1'/>")));
  KinematicTree other("other");
  other.addLink("elsewhere");
  for (LinkId link = 1; link < r.tree->numLinks(); ++link) other.addLink(r.tree->linkName(link));
  ArticulatedCollisionManager manager(std::make_shared<const KinematicTree>(other));
  expectContains(messageOf<std::invalid_argument>([&] { r.addTo(manager); }), "its link 0 is 'elsewhere', not '");
  ArticulatedCollisionManager none(std::make_shared<const KinematicTree>(KinematicTree()));
  expectContains(messageOf<std::invalid_argument>([&] { r.addTo(none); }), "its link 0 is missing, not '");
  EXPECT_TRUE(manager.boundObjects().empty() && none.boundObjects().empty());
}

// Points of contact, as some makers mark them for simulators.
TEST_F(UrdfTest, ASphereOfRadiusZeroIsNoBody) {
  const Robot r = load(linkWith(collision("<sphere radius='0'/>") + collision("<box size='1 1 1'/>") +
                                collision("<sphere radius='0.0'/>", "<origin xyz='1 0 0'/>")));
  ASSERT_EQ(r.geometry.size(), 1u);
  EXPECT_EQ(r.geometry[0].source, "box");
  ASSERT_EQ(r.notes.size(), 2u);
  EXPECT_EQ(r.notes[0], "link 'a' has a sphere of radius 0: it is no body, and is not checked");
  // Other shapes without a size are none that can be left out.
  EXPECT_NE(errorOf(linkWith(collision("<sphere radius='-1'/>"))).find("is not a positive length"), std::string::npos);
  EXPECT_NE(errorOf(linkWith(collision("<cylinder radius='0' length='1'/>"))).find("is not a positive length"),
            std::string::npos);
}

TEST_F(UrdfTest, VisualAndInertialElementsDoNotMatter) {
  // urdfdom alone goes on without the collision elements of a link whose visual or inertial element it cannot read.
  const Robot r =
      load(linkWith("<inertial><mass value='heavy'/></inertial><visual><geometry><torus/></geometry>"
                    "<material name='nowhere'/></visual>" +
                    collision("<sphere radius='1'/>")));
  EXPECT_EQ(r.geometry.size(), 1u);
  EXPECT_TRUE(r.notes.empty());
}

struct BadUrdf {
  const char* what;
  std::string body;
  const char* reason;
};

TEST_F(UrdfTest, BrokenFilesGiveErrorsThatNameFileAndReason) {
  const std::string ab = "<link name='a'/><link name='b'/>", abc = ab + "<link name='c'/>";
  const std::vector<BadUrdf> cases = {
      {"no links", "", "link"},
      {"repeated link", ab + "<link name='a'/>" + joint("j", "fixed", "a", "b"), "'a'"},
      {"repeated joint", abc + joint("j", "fixed", "a", "b") + joint("j", "fixed", "b", "c"), "'j'"},
      {"two parents", abc + joint("j", "fixed", "a", "b") + joint("k", "fixed", "c", "b"), ""},
      {"two parents, one root",
       abc + joint("j", "fixed", "a", "b") + joint("l", "fixed", "a", "c") + joint("k", "fixed", "c", "b"),
       "second parent of link 'b'"},
      {"loop of all", ab + joint("j", "fixed", "a", "b") + joint("k", "fixed", "b", "a"), "root"},
      {"loop beside the root", abc + joint("j", "fixed", "b", "c") + joint("k", "fixed", "c", "b"), "loop"},
      {"loop on itself", ab + joint("j", "fixed", "b", "b"), "loop"},
      {"two roots", ab, "root"},
      {"unknown parent", ab + joint("j", "fixed", "zz", "b"), "zz"},
      {"unknown child", ab + joint("j", "fixed", "a", "zz"), "zz"},
      {"no limits", ab + joint("j", "revolute", "a", "b", ""), "limit"},
      {"bad limit", ab + joint("j", "revolute", "a", "b", "<limit lower='x' upper='1' effort='1' velocity='1'/>"), "j"},
      {"NaN limit", ab + joint("j", "revolute", "a", "b", "<limit lower='nan' upper='1' effort='1' velocity='1'/>"),
       "j"},
      {"bad type", ab + joint("j", "screw", "a", "b"), "screw"},
      {"floating mimics",
       abc + joint("k", "continuous", "b", "c") + joint("j", "floating", "a", "b", "<mimic joint='k'/>"),
       "joint 'j' has more than one variable and cannot mimic"},
      {"mimics planar", abc + joint("k", "planar", "a", "b") + joint("j", "continuous", "b", "c", "<mimic joint='k'/>"),
       "joint 'j' mimics joint 'k', which has more than one variable"},
      {"zero axis", ab + joint("j", "continuous", "a", "b", "<axis xyz='0 0 0'/>"), "joint 'j' has an axis"},
      {"short axis", ab + joint("j", "continuous", "a", "b", "<axis xyz='0 1'/>"), "axis"},
      {"bad origin", ab + joint("j", "fixed", "a", "b", "<origin xyz='0 0 far'/>"), "j"},
      {"mimics itself", ab + joint("j", "continuous", "a", "b", "<mimic joint='j'/>"),
       "joints mimic each other in a circle: 'j' mimics 'j'"},
      {"mimics in a circle",
       abc + "<link name='d'/>" + joint("i", "continuous", "c", "d", "<mimic joint='j'/>") +
           joint("j", "continuous", "a", "b", "<mimic joint='k'/>") +
           joint("k", "continuous", "b", "c", "<mimic joint='j'/>"),
       "joints mimic each other in a circle: 'j' mimics 'k', which mimics 'j'"},
      {"unknown master's follower",
       abc + joint("j", "continuous", "a", "b", "<mimic joint='k'/>") +
           joint("k", "continuous", "b", "c", "<mimic joint='l'/>"),
       "'k' mimics an unknown joint 'l'"},
      {"unknown master", ab + joint("j", "continuous", "a", "b", "<mimic joint='k'/>"), "unknown joint 'k'"},
      {"xacro", "<xacro:property name='x' value='1'/>" + ab, "xacro"},
      {"empty mesh name", linkWith(collision("<mesh filename=''/>")), ""},
      {"missing mesh", linkWith(collision("<mesh filename='none.stl'/>")), "none.stl"},
      {"empty mesh", linkWith(collision("<mesh filename='empty.stl'/>")), "empty.stl"},
      {"zero scale", linkWith(collision("<mesh filename='t.obj' scale='0 1 1'/>")), "scale"},
      {"bad scale", linkWith(collision("<mesh filename='t.obj' scale='1 1'/>")), "scale"},
      {"negative box", linkWith(collision("<box size='1 -1 1'/>")), "link 'a': box size -1"},
      {"negative sphere", linkWith(collision("<sphere radius='-1'/>")), "link 'a': sphere radius -1"},
      {"bad sphere", linkWith(collision("<sphere radius='big'/>")), "big"},
      {"zero cylinder", linkWith(collision("<cylinder radius='1' length='0'/>")), "link 'a': cylinder length 0"},
      {"unknown shape", linkWith(collision("<torus radius='1'/>")), "torus"},
      {"bad shape after a good one", linkWith(collision("<sphere radius='1'/>") + collision("<torus/>")), "torus"},
      {"bad collision origin", linkWith(collision("<sphere radius='1'/>", "<origin xyz='0 x 0'/>")), "a"},
      {"no geometry", linkWith("<collision/>"), "<collision> of link 'a': it has no <geometry>"},
      {"empty geometry", linkWith(collision("")), "needs one geometry element with one shape"},
      {"two shapes", linkWith(collision("<sphere radius='1'/><sphere radius='2'/>")),
       "<sphere> of link 'a': <geometry> may have only one"},
  };
  write("t.obj", kTriangle);
  write("empty.stl", "solid x\nendsolid x\n");
  for (const BadUrdf& c : cases) {
    SCOPED_TRACE(c.what);
    testing::internal::CaptureStderr();
    const std::string message = errorOf(c.body);
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << "the reason belongs into the error";
    expectContains(message, "r.urdf': ");
    expectContains(message, c.reason);
    EXPECT_EQ(message.find("no reason"), std::string::npos) << message;
  }
}

// Whatever could be geometry, place or motion is understood, or refused by name.
TEST_F(UrdfTest, WhatIsNotUnderstoodIsRefusedByName) {
  const std::string ball = "<geometry><sphere radius='1'/></geometry>", ab = "<link name='a'/><link name='b'/>";
  const auto inCollision = [&](const std::string& more) {
    return linkWith("<collision>" + ball + more + "</collision>");
  };
  const auto inJoint = [&](const std::string& more) { return ab + joint("j", "continuous", "a", "b", more); };
  const std::vector<BadUrdf> cases = {
      {"xacro in a link", linkWith("<xacro:if value='1'><collision>" + ball + "</collision></xacro:if>"),
       "<xacro:if> of link 'a': is left of xacro"},
      {"xacro in a collision", inCollision("<xacro:insert_block name='o'/>"), "is left of xacro"},
      {"xacro in a joint", inJoint("<xacro:insert_block name='o'/>"), "<xacro:insert_block> of joint 'j'"},
      {"block", inJoint("<insert_block name='o'/>"), "is left of xacro"},
      {"inclusion", ab + joint("j", "fixed", "a", "b") + "<xi:include href='c.urdf'/>", "is an inclusion"},
      {"quaternion", inCollision("<origin xyz='0 0 0' quat_xyzw='0 0 1 0'/>"), "write the rotation as rpy"},
      {"slip in a joint", inJoint("<orgin xyz='1 0 0'/>"), "did you mean 'origin'?"},
      {"slip in a collision", inCollision("<Origin xyz='1 0 0'/>"), "did you mean 'origin'?"},
      {"scale in capitals", linkWith(collision("<mesh filename='t.obj' Scale='2 2 2'/>")), "did you mean 'scale'?"},
      {"collision in capitals", linkWith("<Collision>" + ball + "</Collision>"), "did you mean 'collision'?"},
      {"group", linkWith("<group><collision>" + ball + "</collision></group>"), "line 1, <group> of link 'a'"},
      {"two origins", inCollision("<origin xyz='1 0 0'/><origin xyz='2 0 0'/>"), "may have only one"},
      {"two parents", ab + "<joint name='j' type='fixed'><parent link='a'/><parent link='b'/><child link='b'/></joint>",
       "may have only one"},
      {"two axes", inJoint("<axis xyz='1 0 0'/><axis xyz='0 0 1'/>"), "may have only one"},
      {"no child", ab + "<joint name='j' type='fixed'><parent link='a'/></joint>", "<joint> 'j': it has no <child>"},
      {"attribute twice", linkWith(collision("<sphere radius='1' radius='2'/>")), "sphere"},
      {"robot in a robot", ab + "<robot name='c'/>", "<robot>"},
      {"soft body", linkWith("") + "<deformable name='d'/>", "<deformable>"},
      {"text", linkWith("<collision>${shape}" + ball + "</collision>"), "the text '${shape}'"},
      {"angles of an axis", inJoint("<axis xyz='1 0 0' rpy='0 1 0'/>"), "'rpy'"},
      {"a limit's slip", inJoint("<limit Lower='0' upper='1'/>"), "'Lower'"},
      {"a mimic's factor", inJoint("<mimic joint='k' multiplyer='2'/>"), "did you mean 'multiplier'?"},
      {"nested collision", inCollision("<collision>" + ball + "</collision>"), "<collision>"},
  };
  for (const BadUrdf& c : cases) {
    SCOPED_TRACE(c.what);
    const std::string message = errorOf(c.body);
    expectContains(message, c.reason);
    expectContains(message, "ine ");  // or Line
  }
  const auto wholeFile = [&](const std::string& text) {
    return messageOf([&] { loadUrdf(write("whole.urdf", text)); });
  };
  expectContains(wholeFile("<robot name='a'>" + linkWith("") + "</robot><robot name='b'/>"), "a second root element");
  expectContains(wholeFile("<!DOCTYPE robot><robot name='a'>" + linkWith("") + "</robot>"),
                 "document types are not read");
}

TEST_F(UrdfTest, WhatSurelyIsNoGeometryIsPassedOver) {
  const Robot r = load(
      "<material name='m'/><gazebo reference='a'><collision/></gazebo><transmission name='t'/><ros2_control/>"
      "<link name='a' type='x'><visual/><contact><stiffness value='1'/></contact><self_filter><geometry/></self_filter>"
      "<collision name='c'>" +
      std::string("<geometry><sphere radius='1'/></geometry><verbose value='1'/></collision>") +
      "</link><link name='b'/>" +
      joint("j", "continuous", "a", "b",
            "<axis xyz='1 0 0' rpy='0 0 0'/><dynamics damping='1'/><calibration rising='0'/>"
            "<limit effort='1' velocity='1' acceleration='2'/>"));
  EXPECT_EQ(r.geometry.size(), 1u);
}

// A ".." after a link leads to another folder than the text without both.
TEST_F(UrdfTest, PathsAreOpenedAsTheyStand) {
  write("there/deep/x", "");
  const std::string small = write("there/t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  write("t.obj", "v 0 0 0\nv 9 0 0\nv 0 9 0\nf 1 2 3\n");
  std::filesystem::create_directory_symlink(path("there/deep"), path("link"));
  const auto size = [&](const std::string& uri) {
    const std::string text = robot(linkWith(collision("<mesh filename='" + uri + "'/>")));
    return loadUrdf(write("r.urdf", text)).geometry.at(0).object->collisionGeometry()->aabb_local.max_.x();
  };
  EXPECT_EQ(size("link/../t.obj"), 1) << "what " << small << " holds";
  EXPECT_EQ(size(path("link/../t.obj")), 1);
  write("a b.obj", "v 0 0 0\nv 3 0 0\nv 0 3 0\nf 1 2 3\n");
  EXPECT_EQ(size("file://" + path("a%20b.obj")), 3);
  EXPECT_EQ(size("file://localhost" + path("a%20b.obj")), 3);
  expectContains(messageOf([&] { size("file://a.obj"); }), "needs an absolute path");
  expectContains(messageOf([&] { size("file:///a%2.obj"); }), "two hexadecimal digits");
}

TEST_F(UrdfTest, PackagesThatStandInTwoPlacesAreNoted) {
  const Variable no_ros("ROS_PACKAGE_PATH", ""), ament("AMENT_PREFIX_PATH", path("over") + ":" + path("under"));
  write("over/share/arm/t.obj", kTriangle);
  write("under/share/arm/t.obj", "v 0 0 0\nv 9 0 0\nv 0 9 0\nf 1 2 3\n");
  const std::string file = write("r.urdf", robot(linkWith(collision("<mesh filename='package://arm/t.obj'/>"))));
  const auto notes = [&] {
    std::string all;
    for (const std::string& note : loadUrdf(file).notes) all += note + "\n";
    return all;
  };
  expectContains(notes(), "is taken from '" + path("over/share/arm/t.obj") + "'; '" + path("under/share/arm/t.obj"));
  write("under/share/arm/t.obj", kTriangle);
  EXPECT_EQ(notes(), "") << "they are the same";
}

// In /dev/shm stand files as in any folder.
TEST_F(UrdfTest, FilesInSharedMemoryHaveAFolder) {
  const std::filesystem::path folder = "/dev/shm/fcl_artic_urdf_test_" + std::to_string(getpid());
  std::error_code error;
  if (!std::filesystem::create_directories(folder, error)) GTEST_SKIP() << "no /dev/shm";
  std::ofstream(folder / "t.obj") << kTriangle;
  std::ofstream(folder / "r.urdf") << robot(linkWith(collision("<mesh filename='t.obj'/>")));
  EXPECT_EQ(loadUrdf((folder / "r.urdf").string()).geometry.size(), 1u);
  std::filesystem::remove_all(folder);
}

TEST_F(UrdfTest, ScenesFindPackagesAndSayWhereTheirJointsStand) {
  write("ws/arm/t.obj", kTriangle);
  const std::string file =
      write("cell.urdf", robot("<link name='a'>" + collision("<mesh filename='package://arm_of_mine/t.obj'/>") +
                               "</link><link name='b'/>" +
                               joint("j", "revolute", "a", "b",
                                     "<axis xyz='1 0 0'/><limit lower='1' upper='2' effort='1' velocity='1'/>")));
  SceneOptions options;
  options.packages["arm_of_mine"] = path("ws/arm");
  const Scene scene = loadScene(file, options);
  EXPECT_EQ(scene.obstacles.size(), 1u);
  ASSERT_EQ(scene.notes.size(), 1u);
  expectContains(scene.notes[0], "its joints stand at 0, which the limits of these exclude: 'j'");
}

/// A slider of half length 0.1 along x, and a wall whose face stands at x = 0.9: they meet at q = 0.8.
class LoadedQueryTest : public UrdfTest {
 protected:
  LoadedQueryTest()
      : robot_(load("<link name='rail'>" + collision("<sphere radius='0.05'/>", "<origin xyz='0.5 0 0.09'/>") +
                    "</link><link name='slider'>" + collision("<box size='0.2 0.2 0.2'/>") + "</link>" +
                    joint("x", "prismatic", "rail", "slider",
                          "<axis xyz='1 0 0'/><limit lower='0' upper='1' effort='1' velocity='1'/>"))),
        scene_(loadScene(write("wall.scene", "s\n* wall\n1\nbox\n0.2 1 1\n1 0 0\n0 0 0 1\n0 0 0 0\n.\n"))),
        manager_(robot_.tree) {
    robot_.allowed.allow("slider", "rail");
    robot_.addTo(manager_);
    scene_.addTo(manager_);
    manager_.setup();
  }
  CertifiedResult moveTo(double q) {
    CertifiedResult result;
    manager_.continuousCollide(
        JointMotion::linear(*robot_.tree, Eigen::VectorXd::Zero(1), Eigen::VectorXd::Constant(1, q)), {}, result);
    return result;
  }
  Robot robot_;
  Scene scene_;
  ArticulatedCollisionManager manager_;
};

TEST_F(LoadedQueryTest, RobotAndSceneReachTheManager) {
  EXPECT_EQ(manager_.boundObjects().size(), 2u);
  EXPECT_EQ(manager_.size(), 1u);
  EXPECT_TRUE(manager_.allowedCollisions().allowed("rail", "slider"));
  for (const LinkGeometry& g : robot_.geometry) {
    EXPECT_EQ(manager_.boundOffset(g.object.get()).matrix(), g.offset.matrix());
  }
}

TEST_F(LoadedQueryTest, ContactAtTheTimeWorkedOutByHand) {
  const CertifiedResult hit = moveTo(2);  // 0.8 / 2
  ASSERT_EQ(hit.status, Status::contact);
  EXPECT_LE(hit.t_lower, 0.4);
  EXPECT_GT(hit.t_lower, 0.4 - 1e-5);
  EXPECT_GE(hit.t_upper, 0.4);
  ASSERT_EQ(hit.contacts.size(), 1u);
  EXPECT_EQ(hit.contacts[0].body1.name, "slider");
  EXPECT_EQ(hit.contacts[0].body2.name, "wall");
  EXPECT_EQ(moveTo(0.79).status, Status::free);
}

TEST_F(UrdfTest, FilesThatAreNoUrdf) {
  const auto error = [&](const std::string& file) { return messageOf([&] { loadUrdf(file); }); };
  expectContains(error(path("none.urdf")), "none.urdf': cannot be read");
  expectContains(error(folder_.string()), "': is a directory, not a file");
  // Refused at once: an endless file, and a pipe that nobody writes to.
  expectContains(error("/dev/zero"), "'/dev/zero': is a device, not a file");
  ASSERT_EQ(mkfifo(path("pipe.urdf").c_str(), 0600), 0);
  expectContains(error(path("pipe.urdf")), "pipe.urdf': is a pipe, not a file");
  for (const char* ending : {".obj", ".scene", ".bt"}) {
    const std::string pipe = path(std::string("pipe") + ending);
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    expectContains(messageOf([&] { loadScene(pipe); }), "is a pipe, not a file");
  }
  std::filesystem::create_symlink("/dev/zero", path("zero.stl"));
  expectContains(messageOf([&] { loadScene(path("zero.stl")); }), "is a device, not a file");
  expectContains(messageOf([&] { loadScene(folder_.string()); }), "is a directory, not a file");
  expectContains(error(write("empty.urdf", "")), "empty.urdf': ");
  expectContains(error(write("cut.urdf", "<robot name='r'><link name='a'>")), "cut.urdf': ");
  expectContains(error(write("text.urdf", "hello")), "text.urdf': ");
  expectContains(error(write("sdf.urdf", "<sdf/>")), "sdf.urdf': is not a URDF");
  expectContains(error(write("unnamed.urdf", "<robot><link name='a'/></robot>")), "name");
}

}  // namespace
}  // namespace urdf_test
}  // namespace fcl_artic
