// SPDX-License-Identifier: BSD-3-Clause
// The plug-in as a pipeline has it: loaded by name, told its parameters, given a planning scene and a response.
#include <chrono>
#include <thread>

#include <class_loader/class_loader.hpp>
#include <moveit/planning_interface/planning_interface.hpp>
#include <moveit/planning_interface/planning_response_adapter.hpp>
#include <moveit/planning_scene/planning_scene.hpp>
#include <rclcpp/rclcpp.hpp>
#include <trajectory_msgs/msg/joint_trajectory.hpp>
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
  ASSERT_EQ(shown[1].markers.size(), 7U);
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

/// A pole of 2 cm, which the arm can go around before it comes to the end of the rail's way.
TEST_F(CertifySolution, RepairReplacesThePlan) {
  scene->getWorldNonConst()->addToObject("pole", std::make_shared<shapes::Cylinder>(0.01, 1),
                                         Eigen::Isometry3d(Eigen::Translation3d(1.6, 0, 0)));
  const auto plan = [&] {
    MotionPlanResponse out = response();
    out.trajectory->clear();
    for (const double turn : {-1.0, 1.0}) {
      moveit::core::RobotState state(scene->getCurrentState());
      state.setVariablePosition("rail", 0.5);
      state.setVariablePosition("turn", turn);
      state.update();
      out.trajectory->addSuffixWayPoint(state, turn + 1);
    }
    planning_interface::MotionPlanRequest request;
    request.max_velocity_scaling_factor = request.max_acceleration_scaling_factor = 1;
    adapter->adapt(scene, request, out);
    return out;
  };
  adapter->initialize(node, "ompl");
  EXPECT_EQ(plan().error_code.val, kInvalid);
  const auto set = node->set_parameter({"ompl.certify_solution.repair", true});
  if (!set.successful) {
    expectContains(set.reason, "component ompl");
    GTEST_SKIP() << set.reason;
  }
  const MotionPlanResponse mended = plan();
  EXPECT_EQ(mended.error_code.val, kSuccess) << mended.error_code.message;
  EXPECT_GT(mended.trajectory->getWayPointCount(), 2U);
}

TEST_F(CertifySolution, WrongParametersAreNamed) {
  node->declare_parameter<std::string>("a.certify_solution.interpolation", "straight");
  expectContains(refusal([&] { adapter->initialize(node, "a"); }), "'straight' is no value of interpolation");
  node->declare_parameter<std::string>("e.certify_solution.interpolation", "totg");
  expectContains(refusal([&] { adapter->initialize(node, "e"); }), "certify its result, by interpolation jtc");
  node->declare_parameter<std::string>("f.certify_solution.interpolation", "jtc");
  node->declare_parameter<std::string>("f.certify_solution.turns", "shortest");
  expectContains(refusal([&] { adapter->initialize(node, "f"); }), "interpolation jtc says which way round");
  node->declare_parameter<std::string>("b.certify_solution.on_undecided", "accept");
  expectContains(refusal([&] { adapter->initialize(node, "b"); }),
                 "b.certify_solution.*: 'accept' is no value of on_undecided");
  node->declare_parameter<double>("c.certify_solution.margin", -0.1);
  expectContains(refusal([&] { adapter->initialize(node, "c"); }), "margin -0.1");
  node->declare_parameter<int64_t>("d.certify_solution.budget", -1);
  expectContains(refusal([&] { adapter->initialize(node, "d"); }), "budget is -1");
}

/// As YAML files have them: a whole number is an integer; move_group declares them before the adapter does.
TEST_F(CertifySolution, WholeNumbersAndParametersThatAreDeclared) {
  for (const bool declared : {false, true}) {
    SCOPED_TRACE(declared);
    rclcpp::NodeOptions options;
    options.automatically_declare_parameters_from_overrides(declared);
    options.parameter_overrides({{"ompl.certify_solution.margin", 0}, {"ompl.certify_solution.time_limit", 5}});
    node = rclcpp::Node::make_shared(declared ? "declared" : "undeclared", options);
    adapter->initialize(node, "ompl");
    EXPECT_EQ(adapted().error_code.val, kSuccess);
    const auto margin = node->describe_parameter("ompl.certify_solution.margin");
    expectContains(margin.description, "m that every pair has to keep");
    ASSERT_EQ(margin.floating_point_range.size(), 1U);
    EXPECT_EQ(margin.floating_point_range[0].from_value, 0);
  }
}

TEST_F(CertifySolution, ParametersAreSetWhileItRunsOrNotAtAll) {
  adapter->initialize(node, "ompl");
  EXPECT_EQ(adapted().error_code.val, kSuccess);
  const auto set = [&](const char* name, const rclcpp::ParameterValue& value) {
    return node->set_parameter(rclcpp::Parameter(std::string("ompl.certify_solution.") + name, value));
  };
  EXPECT_TRUE(set("margin", rclcpp::ParameterValue(0.6)).successful);
  EXPECT_EQ(adapted().error_code.val, kInvalid) << "arm and finger are 0.05 m apart";
  EXPECT_TRUE(set("margin", rclcpp::ParameterValue(0)).successful);
  EXPECT_EQ(adapted().error_code.val, kSuccess);
  EXPECT_FALSE(set("margin", rclcpp::ParameterValue(-1)).successful) << "an integer, of no range";
  EXPECT_FALSE(set("margin", rclcpp::ParameterValue(-1.0)).successful);
  EXPECT_FALSE(set("margin", rclcpp::ParameterValue("wide")).successful);
  const auto refused = set("interpolation", rclcpp::ParameterValue("straight"));
  EXPECT_FALSE(refused.successful);
  expectContains(refused.reason, "'straight' is no value of interpolation");
  EXPECT_FALSE(set("display_contacts_topic", rclcpp::ParameterValue("elsewhere")).successful);
  EXPECT_EQ(adapted().error_code.val, kSuccess) << "nothing was changed";
}

/// Arm and finger are 0.05 m apart, joined by a slide; the finger comes to the wall when the rail is at 0.5.
TEST_F(CertifySolution, TolerancesCount) {
  adapter->initialize(node, "ompl");
  const auto set = [&](const char* name, const rclcpp::ParameterValue& value) {
    return node->set_parameter(rclcpp::Parameter(std::string("ompl.certify_solution.") + name, value));
  };
  const auto own = [&](const std::vector<std::string>& all) {
    return set("joint_tolerances", rclcpp::ParameterValue(all));
  };
  EXPECT_TRUE(set("joint_tolerance_length", rclcpp::ParameterValue(0.04)).successful);
  EXPECT_EQ(adapted().error_code.val, kSuccess);
  EXPECT_TRUE(set("joint_tolerance_length", rclcpp::ParameterValue(0.06)).successful);
  const MotionPlanResponse refused = adapted();
  EXPECT_EQ(refused.error_code.val, kInvalid);
  expectContains(refused.error_code.message, "within the tolerances (joints 60 mm)");
  EXPECT_TRUE(own({"reach=0.04"}).successful);
  EXPECT_EQ(adapted().error_code.val, kSuccess) << "its own counts in place of that of all";
  EXPECT_TRUE(own({}).successful);
  EXPECT_TRUE(set("joint_tolerance_length", rclcpp::ParameterValue(0.0)).successful);
  EXPECT_EQ(adapted().error_code.val, kSuccess) << "and none is left";

  scene->getWorldNonConst()->addToObject("beside", std::make_shared<shapes::Box>(9, 0.1, 0.1),
                                         Eigen::Isometry3d(Eigen::Translation3d(0, 0.2, 0)));
  EXPECT_EQ(adapted().error_code.val, kSuccess) << "the cart passes 0.05 m beside it";
  for (const char* name : {"base_tolerance_length", "object_tolerance"}) {
    EXPECT_TRUE(set(name, rclcpp::ParameterValue(0.04)).successful);
    EXPECT_EQ(adapted().error_code.val, kSuccess) << name;
    EXPECT_TRUE(set(name, rclcpp::ParameterValue(0.06)).successful);
    EXPECT_EQ(adapted().error_code.val, kInvalid) << name;
    EXPECT_TRUE(set(name, rclcpp::ParameterValue(0.0)).successful);
  }
  EXPECT_TRUE(set("base_tolerance_angle", rclcpp::ParameterValue(0.1)).successful);
  EXPECT_EQ(adapted().error_code.val, kInvalid);
  EXPECT_TRUE(set("base_tolerance_angle", rclcpp::ParameterValue(0.0)).successful);
  EXPECT_TRUE(set("joint_tolerance_angle", rclcpp::ParameterValue(0.2)).successful);
  EXPECT_EQ(adapted().error_code.val, kInvalid) << "the arm may turn to the box";

  EXPECT_FALSE(set("joint_tolerance_angle", rclcpp::ParameterValue(-1.0)).successful);
  for (const char* wrong : {"reach", "=0.1", "reach=wide", "reach=0.1m", "reach=-1"})
    EXPECT_FALSE(own({wrong}).successful);
  EXPECT_FALSE(own({"reach=0.1", "reach=0.2"}).successful);
  EXPECT_TRUE(own({"raech=0.1"}).successful) << "the robot comes with the plan";
  expectContains(adapted().error_code.message, "has no joint 'raech'");
}

TEST_F(CertifySolution, MarkersGoAtEveryRefusal) {
  adapter->initialize(node, "ompl");
  addWall();
  EXPECT_EQ(adapted().error_code.val, kInvalid);
  ASSERT_TRUE(seen(1));
  EXPECT_EQ(shown[0].markers.size(), 7U) << "of the finger, and of the arm";
  scene->getCollisionEnvNonConst()->setLinkScale("arm", 0.9);
  EXPECT_EQ(adapted().error_code.val, kInvalid);
  ASSERT_TRUE(seen(2));
  ASSERT_EQ(shown[1].markers.size(), 1U);
  EXPECT_EQ(shown[1].markers[0].action, Marker::DELETEALL);
}

TEST_F(CertifySolution, TheRequestsTimeIsALimit) {
  adapter->initialize(node, "ompl");
  MotionPlanResponse out = response();
  moveit::core::RobotState end(out.trajectory->getLastWayPoint());
  end.setVariablePosition("rail", 0.9);
  end.update();
  out.trajectory->addSuffixWayPoint(end, 1);
  planning_interface::MotionPlanRequest request;
  request.allowed_planning_time = 1e-9;
  MotionPlanResponse refused = out;
  adapter->adapt(scene, request, refused);
  EXPECT_EQ(refused.error_code.val, kInvalid);
  expectContains(refused.error_code.message, "the time ran out");
  request.allowed_planning_time = 3600;
  adapter->adapt(scene, request, out);
  EXPECT_EQ(out.error_code.val, kSuccess);
}

/// The request's own trajectory as a plan, on the joints that it names.
TEST_F(CertifySolution, StoredTrajectories) {
  const auto planner =
      loader.createUniqueInstance<planning_interface::PlannerManager>("fcl_artic_moveit::StoredTrajectory");
  ASSERT_TRUE(planner->initialize(scene->getRobotModel(), node, "certify"));
  adapter->initialize(node, "certify");
  moveit::core::RobotState& state = scene->getCurrentStateNonConst();
  state.setVariablePosition("reach", 0.1);
  state.setVariableVelocity("rail", 0.5);  // as the robot comes to rest
  state.update();
  planning_interface::MotionPlanRequest request;
  request.group_name = "rail_only";
  EXPECT_FALSE(planner->canServiceRequest(request));
  const auto solved = [&] {
    moveit_msgs::msg::MoveItErrorCodes code;
    const auto context = planner->getPlanningContext(scene, request, code);
    EXPECT_EQ(code.val, kSuccess);
    MotionPlanResponse out;
    context->solve(out);
    if (out.trajectory) adapter->adapt(scene, request, out);
    return out;
  };
  expectContains(solved().error_code.message, "reference_trajectories has to have one entry");
  trajectory_msgs::msg::JointTrajectory stored;
  stored.joint_names = {"rail"};
  stored.points.resize(2);
  stored.points[0].positions = {0};
  stored.points[1].positions = {1};
  stored.points[1].time_from_start.sec = 2;
  const auto ask = [&](const trajectory_msgs::msg::JointTrajectory& trajectory) {
    request.reference_trajectories.resize(1);
    request.reference_trajectories[0].joint_trajectory = {trajectory};
    return solved();
  };
  MotionPlanResponse out = ask(stored);
  EXPECT_TRUE(planner->canServiceRequest(request));
  EXPECT_EQ(out.error_code.val, kSuccess);
  ASSERT_EQ(out.trajectory->getWayPointCount(), 2U);
  EXPECT_EQ(out.trajectory->getWayPoint(1).getVariablePosition("reach"), 0.1) << "where the robot has it";
  EXPECT_FALSE(out.trajectory->getWayPoint(1).hasVelocities()) << "the robot's are none of the trajectory's";
  addWall();
  out = ask(stored);
  EXPECT_EQ(out.error_code.val, kInvalid);
  expectContains(out.error_code.message, "link 'finger' and object 'wall' touch at t = 0.8");  // the rail at 0.4
  auto wrong = stored;
  wrong.joint_names = {"turn"};
  expectContains(ask(wrong).error_code.message, "joint 'turn' is none of the group 'rail_only'");
  wrong = stored;
  wrong.points[1].positions = {1, 2};
  expectContains(ask(wrong).error_code.message, "point 1 has 2 positions for 1 joints");
  wrong = stored;
  wrong.points[1].velocities = {1, 2};
  expectContains(ask(wrong).error_code.message, "point 1 has 2 velocities for 1 joints");
  wrong = stored;
  wrong.joint_names = {"rail", "rail"};
  expectContains(ask(wrong).error_code.message, "joint 'rail' is named twice");
  request.group_name = "none";
  expectContains(ask(stored).error_code.message, "there is no group 'none'");
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
