// SPDX-License-Identifier: BSD-3-Clause
// The guard on a node and a planning scene monitor, in real time: an execution is a clock that somebody stops.
#include <atomic>
#include <chrono>
#include <thread>

#include <moveit/planning_scene_monitor/planning_scene_monitor.hpp>
#include <moveit/robot_model_loader/robot_model_loader.hpp>
#include <rclcpp/rclcpp.hpp>

#include "fcl_artic_moveit/monitored_guard.h"
#include "models.h"

namespace fcl_artic_moveit {
namespace {

using planning_scene_monitor::LockedPlanningSceneRW;
using planning_scene_monitor::PlanningSceneMonitor;

/// The rail runs at 1 m/s from 0 to 3.
class Monitored : public testing::Test {
 protected:
  static void SetUpTestSuite() { rclcpp::init(0, nullptr); }
  static void TearDownTestSuite() { rclcpp::shutdown(); }
  void SetUp() override {
    static int count = 0;
    node = rclcpp::Node::make_shared("monitored_guard_test_" + std::to_string(++count));
    robot_model_loader::RobotModelLoader::Options options(sliderUrdf(), sliderSrdf());
    options.load_kinematics_solvers = false;
    monitor = std::make_shared<PlanningSceneMonitor>(
        node, std::make_shared<robot_model_loader::RobotModelLoader>(node, options));
    set("deceleration", 2.0);
    set("most_age", 0.3);
    set("start_delay", 0.0);
    executor.add_node(node);
    spinning = std::thread([this] { executor.spin(); });
  }
  void TearDown() override {
    executor.cancel();
    spinning.join();
  }
  template <class T>
  void set(const std::string& name, const T& value) {
    node->declare_parameter<T>("execution_guard." + name, value);
  }
  robot_trajectory::RobotTrajectory trajectory() const {
    robot_trajectory::RobotTrajectory out(monitor->getRobotModel(), "all");
    moveit::core::RobotState state(monitor->getRobotModel());
    state.setToDefaultValues();
    for (const double rail : {0.0, 3.0}) {
      state.setVariablePosition("rail", rail);
      state.update();
      out.addSuffixWayPoint(state, rail);
    }
    return out;
  }
  void addBox() {
    {
      LockedPlanningSceneRW scene(monitor);
      scene->getWorldNonConst()->addToObject("box", std::make_shared<shapes::Box>(0.1, 1, 1),
                                             Eigen::Isometry3d(Eigen::Translation3d(3.2, 0, 0)));
    }
    monitor->triggerSceneUpdateEvent(PlanningSceneMonitor::UPDATE_GEOMETRY);
  }
  /// Executes, with sensors that look every 0.1 s.
  /// @return where the rail is when the guard says stop; 3 if it does not.
  double execute(MonitoredGuard& guard, double appears_at) {
    std::atomic<bool> stop{false};
    guard.onMustStop([&](const GuardReply& reply) {
      message = reply.message;
      stop = true;
    });
    monitor->triggerSceneUpdateEvent(PlanningSceneMonitor::UPDATE_GEOMETRY);
    if (guard.begin(trajectory()).must_stop) return 0;
    const auto begin = std::chrono::steady_clock::now();
    double t = 0;
    for (int tick = 0; t < 3 && !stop; ++tick) {
      if (tick % 50 == 0) monitor->triggerSceneUpdateEvent(PlanningSceneMonitor::UPDATE_GEOMETRY);
      if (appears_at >= 0 && t >= appears_at) {
        addBox();
        appears_at = -1;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
      t = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    }
    guard.end();
    return std::min(3.0, t);
  }

  rclcpp::Node::SharedPtr node;
  planning_scene_monitor::PlanningSceneMonitorPtr monitor;
  rclcpp::executors::MultiThreadedExecutor executor;
  std::thread spinning;
  std::string message;
};

TEST_F(Monitored, StopsBeforeABoxThatAppears) {
  MonitoredGuard guard(node, monitor);
  const double stopped = execute(guard, 0.5);
  EXPECT_GT(stopped, 0.5);
  EXPECT_LT(stopped, 2 - 0.25) << "the finger comes to the box at 2, and a stop takes 0.25";
  expectContains(message, "object 'box'");
}

TEST_F(Monitored, GoesOnWithNothingInTheWay) {
  node->set_parameter(rclcpp::Parameter("execution_guard.most_age", 2.0));  // also if the machine has much to do
  MonitoredGuard guard(node, monitor);
  EXPECT_EQ(execute(guard, -1), 3) << message;
}

TEST_F(Monitored, SensorsThatLookNoMoreStopIt) {
  MonitoredGuard guard(node, monitor);
  EXPECT_TRUE(guard.begin(trajectory()).must_stop) << "none has looked";
  monitor->triggerSceneUpdateEvent(PlanningSceneMonitor::UPDATE_GEOMETRY);
  std::atomic<int> stops{0};
  guard.onMustStop([&](const GuardReply&) { ++stops; });
  EXPECT_FALSE(guard.begin(trajectory()).must_stop);
  for (int i = 0; i < 10 && !stops; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    monitor->triggerSceneUpdateEvent(PlanningSceneMonitor::UPDATE_STATE);
  }
  EXPECT_EQ(stops, 1) << "a new state of the robot is no look at the objects";
}

TEST_F(Monitored, ParametersAreReadAndRefused) {
  set("margin", -1.0);
  expectContains(refusal([&] { MonitoredGuard(node, monitor); }), "parameters execution_guard.*: the margin");
  node->set_parameter(rclcpp::Parameter("execution_guard.margin", 0.0));
  node->set_parameter(rclcpp::Parameter("execution_guard.object_speeds", std::vector<std::string>{"person"}));
  expectContains(refusal([&] { MonitoredGuard(node, monitor); }), "object_speeds: 'person' is not NAME=NUMBER");
}

}  // namespace
}  // namespace fcl_artic_moveit
