// SPDX-License-Identifier: BSD-3-Clause
// Where the robot stands and what it carries, as options say it.
#include "robot_options.h"

#include <cmath>

#include <nlohmann/json.hpp>

#include "run_program.h"

namespace fcl_artic::app {
namespace robot_options_test {
namespace {

using Json = nlohmann::json;

TEST(PoseTest, AnglesTurnAboutFixedAxes) {
  const Eigen::Isometry3d M = parsePose("1, -2,+3, 90deg,0,90deg", "--base");
  EXPECT_EQ(M.translation(), Eigen::Vector3d(1, -2, 3));
  // About x first: y to z; then about z: z stays, x to y.
  EXPECT_LT((M.linear() * Eigen::Vector3d::UnitY() - Eigen::Vector3d::UnitZ()).norm(), 1e-15);
  EXPECT_LT((M.linear() * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY()).norm(), 1e-15);
  EXPECT_EQ(parsePose("1,2,3", "--base").linear(), Eigen::Matrix3d::Identity());
  for (const char* bad :
       {"", "1", "1,2", "1,2,3,4", "1,2,3,4,5,6,7", "1,2,x", "1,2,3deg", "1,2,nan", "1,,3", "1,2,3,0,0,inf"}) {
    const std::string message = messageOf<std::invalid_argument>([&] { parsePose(bad, "--base"); });
    expectContains(message, "--base: '" + std::string(bad) + "' is no pose x,y,z or x,y,z,roll,pitch,yaw");
  }
}

TEST(AttachmentTest, NamesLinksFileAndPose) {
  KinematicTree tree("r");
  for (const char* name : {"hand", "left", "right"}) tree.addLink(name);
  Attachment a = parseAttachment(tree, "hand=cup.stl");
  EXPECT_EQ(a.link, "hand");
  EXPECT_EQ(a.file, "cup.stl");
  EXPECT_TRUE(a.touch_links.empty());
  EXPECT_EQ(a.pose.matrix(), Eigen::Matrix4d::Identity());
  a = parseAttachment(tree, "hand+left+right=a@b/cup@2.stl@0,0,0.1,0,0,90deg");
  EXPECT_EQ(a.touch_links, (std::vector<std::string>{"left", "right"}));
  EXPECT_EQ(a.file, "a@b/cup@2.stl");
  EXPECT_EQ(a.pose.translation(), Eigen::Vector3d(0, 0, 0.1));
  EXPECT_EQ(parseAttachment(tree, "hand=a@b.stl").file, "a@b.stl");
  const auto error = [&](const char* text) {
    return messageOf<std::invalid_argument>([&] { parseAttachment(tree, text); });
  };
  expectContains(error("cup.stl"), "--attach cup.stl: is not LINK=FILE");
  expectContains(error("=cup.stl"), "is not LINK=FILE");
  expectContains(error("hand="), "is not LINK=FILE");
  expectContains(error("hnad=cup.stl"), "has no link 'hnad'; did you mean 'hand'?");
  expectContains(error("hand+lefft=cup.stl"), "did you mean 'left'?");
  expectContains(error("hand=cup.stl@0,0"), "'0,0' is no pose");
}

// The arm's ball is met earlier when the base is turned towards it, and not at all when it is far away.
TEST_F(ProgramTest, BaseMovesTheRobot) {
  const std::string check = "check --json " + armAndBall();
  const auto timeOf = [&](const std::string& options) {
    const Outcome run = this->run(check + options);
    EXPECT_EQ(run.status, 1) << run.err;
    return run.status == 1 ? Json::parse(run.out).at("t_lower").get<double>() : -1;
  };
  const double contact = M_PI / 3 - std::asin(0.15 / 0.6);
  EXPECT_NEAR(timeOf(" --from 0,0 --to 1,0"), contact, 1e-5);
  EXPECT_NEAR(timeOf(" --from 0,0 --to 1,0 --base 0,0,0,0,0,0.25"), contact - 0.25, 1e-5);
  EXPECT_EQ(this->run(check + " --from 0,0 --to 1,0 --base -5,0,0").status, 0);
  // The same turn by the base itself, from no rotation to 2 atan(1) = 90 degrees, along the shorter way.
  const std::string floating =
      " --floating-base --from 0,0,0,0,0,0,1,0,0 --state "
      "hinge=0,rail=0,floating_base/trans_x=0,floating_base/trans_y=0,"
      "floating_base/trans_z=0,floating_base/rot_x=0,floating_base/rot_y=0 --to ";
  const Outcome turned =
      this->run(check + floating + "floating_base/rot_z=0.70710678118654757,floating_base/rot_w=0.70710678118654757");
  ASSERT_EQ(turned.status, 1) << turned.err << turned.out;
  EXPECT_NEAR(Json::parse(turned.out).at("t_lower").get<double>(), contact / (M_PI / 2), 1e-5);
  const Outcome bad = this->run(check + " --from 0,0 --to 1,0 --base 1,2");
  EXPECT_EQ(bad.status, 2);
  EXPECT_NE(bad.err.find("--base: '1,2' is no pose"), std::string::npos) << bad.err;
}

// As MoveIt has it: the SRDF's virtual joint moves the base, by the messages' poses; its name is theirs.
TEST_F(ProgramTest, VirtualJointsMoveTheBase) {
  const auto srdf = [&](const std::string& type, const std::string& child = "base") {
    return write(type + child + ".srdf",
                 R"(<robot name="arm"><virtual_joint name="world_joint" type=")" + type +
                     R"(" parent_frame="odom" child_link=")" + child +
                     R"("/><disable_collisions link1="base" link2="arm" reason="Adjacent"/></robot>)");
  };
  const auto message = [&](double x) {
    const auto pose = [](double at) {
      return R"({"translation": {"x": )" + std::to_string(at) +
             R"(, "y": 0, "z": 0}, "rotation": {"x": 0, "y": 0, "z": 0, "w": 1}})";
    };
    return write(
        "drive.json", R"({"joint_trajectory": {"joint_names": [], "points": []}, "state": {"hinge": 0, "rail": 0},
      "multi_dof_joint_trajectory": {"joint_names": ["world_joint"], "points": [
      {"transforms": [)" + pose(0) +
                          R"(], "time_from_start": 0}, {"transforms": [)" + pose(x) + R"(], "time_from_start": 2}]}})");
  };
  // A ball of 0.1 m, which the arm's tip meets when the base has come near enough.
  const std::string far = write("ahead.urdf", R"(<robot name="far"><link name="far"><collision>
    <origin xyz="3 0 0"/><geometry><sphere radius="0.1"/></geometry></collision></link></robot>)");
  const auto certify = [&](const std::string& options, double x) {
    return this->run("certify " + message(x) + " --robot " + arm() + " --scene " + far + " " + options);
  };
  for (const char* type : {"planar", "floating"}) {
    EXPECT_EQ(certify("--virtual-joint --srdf " + srdf(type), 1).status, 0) << type;
    const Outcome met = certify("--virtual-joint --srdf " + srdf(type), 3);
    EXPECT_EQ(met.status, 1) << met.err << met.out;
  }
  EXPECT_NE(certify("--virtual-joint --srdf " + srdf("fixed"), 1).err.find("has no planar or floating virtual_joint"),
            std::string::npos);
  const Outcome still = certify("--srdf " + srdf("planar"), 1);
  EXPECT_EQ(still.status, 2);
  EXPECT_NE((still.out + still.err).find("stands still here (--virtual-joint moves it)"), std::string::npos);
  EXPECT_NE(still.out.find("virtual_joint of this name moves its base (--srdf, --virtual-joint)"), std::string::npos)
      << still.out;
  EXPECT_NE(certify("--floating-base --virtual-joint --srdf " + srdf("planar"), 1).err.find("leave floating_base out"),
            std::string::npos);
  EXPECT_NE(certify("--virtual-joint --srdf " + srdf("planar", "arm"), 1)
                .err.find("moves link 'arm', and the root is 'base'"),
            std::string::npos);
  EXPECT_NE(certify("--virtual-joint --srdf " + srdf("prismatic"), 1).err.find("not fixed, planar or floating"),
            std::string::npos);
  // The joints of the arm alone: where the base stands nobody has said.
  const std::string check = "check --robot " + arm() + " --scene " + far + " --virtual-joint --srdf " + srdf("planar") +
                            " --from hinge=0,rail=0 --to hinge=1,rail=0";
  EXPECT_NE(this->run(check).err.find("--state world_joint/x=VALUE,world_joint/y=VALUE,world_joint/theta=VALUE"),
            std::string::npos);
  EXPECT_EQ(this->run(check + " --state world_joint/x=0,world_joint/y=0,world_joint/theta=0").status, 0);
}

// A rod of 1 m that the arm holds out beyond the ball's distance, turned up or along the arm.
TEST_F(ProgramTest, LinksCarryObjects) {
  const std::string block =
      write("block.obj", "v 0 0 0\nv 0.2 0 0\nv 0 0.2 0\nv 0 0 0.2\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  const std::string far = write("far.urdf", R"(<robot name="far"><link name="far"><collision>
    <origin xyz="0 1.15 0"/><geometry><sphere radius="0.05"/></geometry></collision></link></robot>)");
  const std::string check = "check --json --robot " + arm() + " --scene " + far + " --from 0,0 --to 90deg,0";
  EXPECT_EQ(this->run(check).status, 0);
  const Outcome held = this->run(check + " --attach arm=" + block + "@1.05,-0.05,0");
  ASSERT_EQ(held.status, 1) << held.err << held.out;
  const Json contact = Json::parse(held.out).at("contacts").at(0);
  EXPECT_EQ(contact.at("body1").at("name").get<std::string>() + contact.at("body2").at("name").get<std::string>(),
            "blockfar");
  // It is named as what it is, and the link that carries it.
  const bool first = contact.at("body1").at("name") == "block";
  const Json& block_body = contact.at(first ? "body1" : "body2");
  EXPECT_EQ(block_body.at("kind"), "attached object");
  EXPECT_EQ(block_body.at("link"), "arm");
  EXPECT_EQ(contact.at(first ? "body2" : "body1").at("kind"), "obstacle");
  EXPECT_FALSE(contact.at(first ? "body2" : "body1").contains("link"));
  const std::string text_check =
      "check --robot " + arm() + " --scene " + far + " --from 0,0 --to 90deg,0 --attach arm=";
  const Outcome text = this->run(text_check + block + "@1.05,-0.05,0");
  EXPECT_NE(text.out.find("attached object 'block' on link 'arm'"), std::string::npos) << text.out;
  EXPECT_EQ(text.out.find("link 'block'"), std::string::npos) << text.out;
  EXPECT_EQ(this->run(check + " --attach arm=" + block + "@1.05,0,3").status, 0);
  EXPECT_EQ(this->run(check + " --no-scene --attach arm=" + block + "@1.05,-0.05,0").status, 0);
  // At the other link's place it touches that, which may be allowed.
  const Outcome touching = this->run(check + " --attach arm=" + block + "@0,0,2");
  EXPECT_EQ(touching.status, 1) << touching.err;
  EXPECT_EQ(this->run(check + " --attach arm+slide=" + block + "@0,0,2").status, 0);
  const Outcome unknown = this->run(check + " --attach amr=" + block);
  EXPECT_EQ(unknown.status, 2);
  EXPECT_NE(unknown.err.find("did you mean 'arm'?"), std::string::npos) << unknown.err;
  const Outcome missing = this->run(check + " --attach arm=/nowhere/x.stl");
  EXPECT_EQ(missing.status, 2);
  EXPECT_NE(missing.err.find("/nowhere/x.stl"), std::string::npos) << missing.err;
}

TEST_F(ProgramTest, ScenesAreFilesAndNoFolders) {
  const Outcome folder = this->run("check --robot " + arm() + " --from 0,0 --to 1,0 --scene " + folder_.string());
  EXPECT_EQ(folder.status, 2);
  EXPECT_NE(folder.err.find("is a directory, not a file"), std::string::npos) << folder.err;
  // A file that the shell passes on is read.
  const Outcome passed_on = this->run("check --robot /dev/stdin --from 0,0 --to 0.1,0 <" + arm());
  EXPECT_EQ(passed_on.status, 0) << passed_on.err;
  // Its paths begin where the program runs.
  const std::string meshed = write("meshed.urdf",
                                   "<robot name='m'><link name='a'><collision><geometry><mesh filename='m/t.obj'/>"
                                   "</geometry></collision></link></robot>");
  write("m/t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(folder_);
  const Outcome here = this->run("info /dev/stdin <" + meshed);
  std::filesystem::current_path(before);
  EXPECT_EQ(here.status, 0) << here.err;
}

}  // namespace
}  // namespace robot_options_test
}  // namespace fcl_artic::app
