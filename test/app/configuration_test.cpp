// SPDX-License-Identifier: BSD-3-Clause
#include "configuration.h"

#include <gtest/gtest.h>

#include <cmath>

namespace configuration_test {

namespace {

using fcl_artic::Joint;
using fcl_artic::JointType;
using fcl_artic::KinematicTree;
using fcl_artic::app::parseConfiguration;

KinematicTree threeJoints() {
  KinematicTree tree("rob");
  for (const char* link : {"l0", "l1", "l2", "l3", "l4", "l5"}) tree.addLink(link);
  const auto add = [&](const char* name, JointType type, const char* parent, const char* child, const char* master) {
    Joint joint;
    joint.name = name;
    joint.type = type;
    joint.parent = parent;
    joint.child = child;
    if (master) {
      joint.mimics = true;
      joint.mimic.master = master;
    }
    tree.addJoint(joint);
  };
  add("turn", JointType::revolute, "l0", "l1", nullptr);
  add("weld", JointType::fixed, "l1", "l2", nullptr);
  add("lift", JointType::prismatic, "l2", "l3", nullptr);
  add("spin", JointType::continuous, "l3", "l4", nullptr);
  add("echo", JointType::revolute, "l4", "l5", "turn");
  return tree;
}

std::string refusal(const std::vector<std::string>& words) {
  try {
    parseConfiguration(threeJoints(), words, "--from");
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  ADD_FAILURE() << "accepted";
  return {};
}

TEST(Configuration, ListsTakeCommasBlanksAndDegrees) {
  const KinematicTree tree = threeJoints();
  const Eigen::Vector3d wanted(-M_PI / 2, 0.25, 1e-3);
  EXPECT_LT((parseConfiguration(tree, {"-90deg, 0.25 1e-3"}, "--from") - wanted).norm(), 1e-15);
  EXPECT_LT((parseConfiguration(tree, {"-90deg", "+0.25,", "0.001"}, "--from") - wanted).norm(), 1e-15);
}

TEST(Configuration, OthersStandWhereTheStateHasThem) {
  for (const std::vector<std::string>& words : {std::vector<std::string>{"spin=180deg", "lift=-.5"}, {"-.5 180deg"}}) {
    const Eigen::VectorXd q = parseConfiguration(threeJoints(), words, "--from", {{"turn", 0.25}});
    EXPECT_EQ(q[0], 0.25);
    EXPECT_EQ(q[1], -0.5);
    EXPECT_DOUBLE_EQ(q[2], M_PI);
  }
  EXPECT_NE(refusal({"lift=1"}).find("--from has no joint 'turn', 'spin': --state turn=VALUE,spin=VALUE"),
            std::string::npos);
}

TEST(Configuration, WrongCountsListTheJoints) {
  EXPECT_EQ(refusal({"1 2"}), "--from has 2 values, robot 'rob' has 3 joints: turn, lift, spin");
  EXPECT_EQ(refusal({""}), "--from has 0 values, robot 'rob' has 3 joints: turn, lift, spin");
}

TEST(Configuration, RefusalsNameTheJoint) {
  for (const char* bad : {"nan", "inf", "1e999", "1x", "", "deg", "0x10", "90degrees", "+-1"}) {
    EXPECT_NE(refusal({std::string("lift=") + bad}).find("'lift'"), std::string::npos) << bad;
  }
  EXPECT_NE(refusal({"lift=10deg"}).find("prismatic"), std::string::npos);
  EXPECT_NE(refusal({"weld=1"}).find("'weld' is fixed"), std::string::npos);
  EXPECT_NE(refusal({"echo=1"}).find("'echo' follows joint 'turn'"), std::string::npos);
  EXPECT_NE(refusal({"elbow=1"}).find("no joint 'elbow'; its joints are: turn, lift, spin"), std::string::npos);
  EXPECT_NE(refusal({"lift=1 lift=2"}).find("'lift' is given twice"), std::string::npos);
  EXPECT_NE(refusal({"lift=1 2"}).find("'2'"), std::string::npos);
}

}  // namespace

}  // namespace configuration_test
