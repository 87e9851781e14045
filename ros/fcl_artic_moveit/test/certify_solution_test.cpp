// SPDX-License-Identifier: BSD-3-Clause
// The plug-in as a pipeline has it: loaded by name, told its parameters, given a planning scene and a response.
#include <chrono>
#include <thread>

#include <class_loader/class_loader.hpp>
#include <moveit/planning_interface/planning_response_adapter.hpp>
#include <moveit/planning_scene/planning_scene.hpp>
#include <rclcpp/rclcpp.hpp>
#include <visualization_msgs/msg/marker_array.hpp>

#include "models.h"

namespace fcl_artic_moveit {
namespace {

using planning_interface::MotionPlanResponse;
using visualization_msgs::msg::Marker;
using visualization_msgs::msg::MarkerArray;
constexpr auto kInvalid = moveit_msgs::msg::MoveItErrorCodes::INVALID_MOTION_PLAN;
constexpr auto kSuccess = moveit_msgs::msg::MoveItErrorCodes::SUCCESS;

class CertifySolution : public testing::Test {
 protected:
  void SetUp() override {
    static bool once = (rclcpp::init(0, nullptr), true);
    (void)once;
    static int count = 0;
    node = rclcpp::Node::make_shared("certify_solution_test_" + std::to_string(++count));
    adapter =
        loader.createUniqueInstance<planning_interface::PlanningResponseAdapter>("fcl_artic_moveit::CertifySolution");
    topic = "contacts_" + std::to_string(count);
    node->declare_parameter<std::string>("ompl.certify_solution.display_contacts_topic", topic);
    listener = node->create_subscription<MarkerArray>(topic, rclcpp::SystemDefaultsQoS(),
                                                      [this](MarkerArray::ConstSharedPtr m) { shown.push_back(*m); });
    scene = std::make_shared<planning_scene::PlanningScene>(slider());
  }
  /// A wall at x from 1.65 on: met by the finger when the rail is at 0.5.
  void addWall() {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation() << 1.7, 0, 0;
    scene->getWorldNonConst()->addToObject("wall", std::make_shared<shapes::Box>(0.1, 1, 1), pose);
  }
  MotionPlanResponse response() const {
    MotionPlanResponse out;
    out.error_code.val = kSuccess;
    out.trajectory = std::make_shared<robot_trajectory::RobotTrajectory>(scene->getRobotModel(), "all");
    for (const double rail : {0.0, 1.0}) {
      moveit::core::RobotState state(scene->getCurrentState());
      state.setVariablePosition("rail", rail);
      state.update();
      out.trajectory->addSuffixWayPoint(state, rail);
    }
    return out;
  }
  MotionPlanResponse adapted() {
    MotionPlanResponse out = response();
    adapter->adapt(scene, planning_interface::MotionPlanRequest(), out);
    return out;
  }
  bool seen(std::size_t count) {
    for (int i = 0; i < 100 && shown.size() < count; ++i) {
      rclcpp::spin_some(node);
      if (shown.size() < count) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return shown.size() == count;
  }

  class_loader::ClassLoader loader{PLUGINS};
  rclcpp::Node::SharedPtr node;
  class_loader::ClassLoader::UniquePtr<planning_interface::PlanningResponseAdapter> adapter;
  rclcpp::Subscription<MarkerArray>::SharedPtr listener;
  planning_scene::PlanningScenePtr scene;
  std::string topic;
  std::vector<MarkerArray> shown;
};

TEST_F(CertifySolution, RefusesWithMessageAndMarkers) {
  adapter->initialize(node, "ompl");
  EXPECT_EQ(adapter->getDescription(), "CertifySolution");
  EXPECT_EQ(adapted().error_code.val, kSuccess);
  ASSERT_TRUE(seen(1));
  EXPECT_EQ(shown[0].markers.size(), 1U) << "what was shown before is deleted";
  addWall();
  const MotionPlanResponse refused = adapted();
  EXPECT_EQ(refused.error_code.val, kInvalid);
  expectContains(refused.error_code.message, "link 'finger' and object 'wall' touch at t = 0.5");
  EXPECT_EQ(refused.error_code.source, "CertifySolution");
  ASSERT_TRUE(seen(2));
  ASSERT_EQ(shown[1].markers.size(), 4U);
  EXPECT_EQ(shown[1].markers[0].action, Marker::DELETEALL);
  EXPECT_EQ(shown[1].markers[1].header.frame_id, scene->getPlanningFrame());
  EXPECT_NEAR(shown[1].markers[1].pose.position.x, 1.65, 1e-5);
  EXPECT_EQ(shown[1].markers[3].text, "finger - wall");
  // The pair that the scene's matrix allows.
  scene->getAllowedCollisionMatrixNonConst().setEntry("finger", "wall", true);
  scene->getAllowedCollisionMatrixNonConst().setEntry("arm", "wall", true);
  EXPECT_EQ(adapted().error_code.val, kSuccess);
}

TEST_F(CertifySolution, ParametersCount) {
  node->declare_parameter<double>("ompl.certify_solution.margin", 0.6);
  node->declare_parameter<std::string>("ompl.certify_solution.interpolation", "linear");
  adapter->initialize(node, "ompl");
  EXPECT_EQ(adapted().error_code.val, kInvalid) << "arm and finger are 0.05 m apart";
  const auto other =
      loader.createUniqueInstance<planning_interface::PlanningResponseAdapter>("fcl_artic_moveit::CertifySolution");
  node->declare_parameter<std::string>("pilz.certify_solution.interpolation", "quintic");
  other->initialize(node, "pilz");
  MotionPlanResponse one = response();
  other->adapt(scene, planning_interface::MotionPlanRequest(), one);
  EXPECT_EQ(one.error_code.val, kInvalid);
  expectContains(one.error_code.message, "quintic needs velocities");
}

TEST_F(CertifySolution, WrongParametersAreNamed) {
  node->declare_parameter<std::string>("a.certify_solution.interpolation", "straight");
  expectContains(refusal([&] { adapter->initialize(node, "a"); }), "'straight' is no value of interpolation");
  node->declare_parameter<std::string>("b.certify_solution.on_undecided", "accept");
  expectContains(refusal([&] { adapter->initialize(node, "b"); }), "b.certify_solution.on_undecided");
  node->declare_parameter<double>("c.certify_solution.margin", -0.1);
  expectContains(refusal([&] { adapter->initialize(node, "c"); }), "margin -0.1");
  node->declare_parameter<int64_t>("d.certify_solution.budget", -1);
  expectContains(refusal([&] { adapter->initialize(node, "d"); }), "budget is -1");
}

TEST_F(CertifySolution, UndecidedIsRefusedUnlessAskedOtherwise) {
  addWall();
  scene->getWorldNonConst()->addToObject("ball", std::make_shared<shapes::Sphere>(0.05),
                                         Eigen::Isometry3d(Eigen::Translation3d(0.5, 0.11, 0)));
  node->declare_parameter<int64_t>("ompl.certify_solution.budget", 1);
  adapter->initialize(node, "ompl");
  const MotionPlanResponse refused = adapted();
  EXPECT_EQ(refused.error_code.val, kInvalid);
  expectContains(refused.error_code.message, "the budget ran out");
  node->declare_parameter<int64_t>("pilz.certify_solution.budget", 1);
  node->declare_parameter<std::string>("pilz.certify_solution.on_undecided", "warn");
  adapter->initialize(node, "pilz");
  EXPECT_EQ(adapted().error_code.val, kSuccess);
}

TEST_F(CertifySolution, WhatCannotBeCertifiedIsRefused) {
  MotionPlanResponse out = response();
  adapter->adapt(scene, planning_interface::MotionPlanRequest(), out);
  EXPECT_EQ(out.error_code.val, kInvalid) << "initialize() was not called";
  adapter->initialize(node, "ompl");
  out = {};
  out.error_code.val = kSuccess;
  adapter->adapt(scene, planning_interface::MotionPlanRequest(), out);
  EXPECT_EQ(out.error_code.val, kInvalid) << "no trajectory";
  scene->getCollisionEnvNonConst()->setLinkScale("arm", 0.9);
  out = adapted();
  EXPECT_EQ(out.error_code.val, kInvalid);
  expectContains(out.error_code.message, "link 'arm' is scaled by 0.9");
  scene->getCollisionEnvNonConst()->setLinkScale("arm", 1);
  EXPECT_EQ(adapted().error_code.val, kSuccess) << "the next one is looked at anew";
}

/// The scene's state carries what the waypoints have lost.
TEST_F(CertifySolution, WhatTheRobotCarriesIsOnTheWaypoints) {
  adapter->initialize(node, "ompl");
  MotionPlanResponse out = response();
  const auto box = std::make_shared<shapes::Box>(0.1, 0.1, 0.1);
  scene->getCurrentStateNonConst().attachBody("tool", Eigen::Isometry3d(Eigen::Translation3d(0.2, 0, 0)), {box},
                                              EigenSTL::vector_Isometry3d{Eigen::Isometry3d::Identity()},
                                              std::set<std::string>{"finger"}, "finger");
  adapter->adapt(scene, planning_interface::MotionPlanRequest(), out);
  EXPECT_EQ(out.error_code.val, kInvalid);
  expectContains(out.error_code.message, "the robot starts with 'tool' on link 'finger'");
  EXPECT_EQ(adapted().error_code.val, kSuccess) << "states copied with all that they carry";
}

/// A diff of a scene, as pipelines get them, and its world count as the scene itself.
TEST_F(CertifySolution, DiffsOfScenes) {
  adapter->initialize(node, "ompl");
  const planning_scene::PlanningScenePtr parent = scene;
  scene = parent->diff();
  EXPECT_EQ(adapted().error_code.val, kSuccess);
  addWall();
  EXPECT_EQ(adapted().error_code.val, kInvalid);
  scene = parent;
  EXPECT_EQ(adapted().error_code.val, kSuccess);
}

}  // namespace
}  // namespace fcl_artic_moveit
