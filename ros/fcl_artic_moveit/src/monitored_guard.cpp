// SPDX-License-Identifier: BSD-3-Clause
#include "fcl_artic_moveit/monitored_guard.h"

#include <chrono>
#include <mutex>
#include <stdexcept>
#include <utility>

#include "node_parameters.h"
#include "numbers.h"

namespace fcl_artic_moveit {
namespace {

using planning_scene_monitor::LockedPlanningSceneRO;
using planning_scene_monitor::PlanningSceneMonitor;

constexpr double kNever = -1e12;  // s: before all times of all clocks

/// The values of the parameters.
struct Settings {
  ExecutionGuardOptions guard;
  double start_delay = 0, latency = 0;  ///< s
};

Settings settingsOf(rclcpp::Node& node, const std::string& prefix) {
  using rclcpp::ParameterValue;
  Settings out;
  const std::vector<std::string> none;
  NodeParameters of(node, prefix + ".");
  of.declareCertifier(static_cast<std::int64_t>(out.guard.certifier.budget));
  of.declare("deceleration", ParameterValue(0.0),
             "rad/s^2 or m/s^2 by which each joint can brake; 0: see decelerations", 0);
  of.declare("decelerations", ParameterValue(none), "of single joints, in place of this: JOINT=VALUE");
  of.declare("period", ParameterValue(out.guard.period), "s within which the next answer comes", 0);
  of.declare("reaction", ParameterValue(out.guard.reaction), "s from a question until the drives follow the answer", 0);
  of.declare("start_delay", ParameterValue(0.05), "s after begin() by which the controller has begun", 0);
  of.declare("most_age", ParameterValue(out.guard.most_age), "s after which a scene is too old; 0: nothing in it moves",
             0);
  of.declare("latency", ParameterValue(0.05), "s by which the monitor's scene is later than the sensors, at most", 0);
  of.declare("object_speed", ParameterValue(0.0), "m/s by which each object of the world may move by itself", 0);
  of.declare("object_speeds", ParameterValue(none), "of single objects, in place of this: OBJECT=VALUE");
  try {
    out.guard.certifier = of.certifier();
    out.guard.certifier.tolerances.object_speed = of.number("object_speed");
    out.guard.certifier.tolerances.object_speeds = of.numbers("object_speeds");
    out.guard.deceleration = of.number("deceleration");
    out.guard.decelerations = of.numbers("decelerations");
    out.guard.period = of.number("period");
    out.start_delay = of.number("start_delay");
    out.guard.reaction = of.number("reaction") + out.start_delay;  // it may have begun at once
    out.guard.most_age = of.number("most_age");
    out.latency = of.number("latency");
    requireAtLeast0("latency", out.latency);
    requireAtLeast0("start_delay", out.start_delay);
    out.guard.check();
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument("parameters " + of.prefix() + "*: " + error.what());
  }
  return out;
}

}  // namespace

struct MonitoredGuard::Impl {
  Impl(const rclcpp::Node::SharedPtr& on, const planning_scene_monitor::PlanningSceneMonitorPtr& with,
       const std::string& prefix)
      : node(on), monitor(with), settings(settingsOf(*on, prefix)), guard(with->getRobotModel(), settings.guard) {}

  double now() const { return node->get_clock()->now().seconds(); }
  void update(PlanningSceneMonitor::SceneUpdateType type);
  GuardReply ask(double path_speed);

  const rclcpp::Node::SharedPtr node;
  const planning_scene_monitor::PlanningSceneMonitorPtr monitor;
  const Settings settings;
  ExecutionGuard guard;
  rclcpp::CallbackGroup::SharedPtr group;  ///< of the timer alone
  rclcpp::TimerBase::SharedPtr timer;

  std::mutex mutex;         ///< of what follows
  double seen_at = kNever;  ///< s: when the sensors saw the objects
  double begun = 0;         ///< s
  std::function<void(const GuardReply&)> on_must_stop;
};

/// A new state of the robot says nothing about when objects were seen.
void MonitoredGuard::Impl::update(PlanningSceneMonitor::SceneUpdateType type) {
  double seen = 0;
  {
    const std::lock_guard<std::mutex> lock(mutex);
    if (type & PlanningSceneMonitor::UPDATE_GEOMETRY) seen_at = now() - settings.latency;
    seen = seen_at;
  }
  const LockedPlanningSceneRO locked(monitor);
  const planning_scene::PlanningSceneConstPtr& scene = locked;
  guard.renew(*scene, seen);
}

GuardReply MonitoredGuard::Impl::ask(double path_speed) {
  double from = 0;
  {
    const std::lock_guard<std::mutex> lock(mutex);
    from = begun + settings.start_delay;
  }
  const double time = now();
  return guard.ask(time, time - from, path_speed);  // no later than the robot is
}

MonitoredGuard::MonitoredGuard(const rclcpp::Node::SharedPtr& node,
                               const planning_scene_monitor::PlanningSceneMonitorPtr& monitor,
                               const std::string& prefix) {
  if (!node || !monitor) throw std::invalid_argument("MonitoredGuard: the node or the monitor is null");
  impl_ = std::make_shared<Impl>(node, monitor, prefix);
  // The monitor keeps its callbacks for good.
  const std::weak_ptr<Impl> weak = impl_;
  monitor->addUpdateCallback([weak](PlanningSceneMonitor::SceneUpdateType type) {
    if (const std::shared_ptr<Impl> impl = weak.lock()) impl->update(type);
  });
  impl_->group = node->create_callback_group(rclcpp::CallbackGroupType::MutuallyExclusive);
  impl_->timer = node->create_wall_timer(
      std::chrono::duration<double>(impl_->settings.guard.period / 2),
      [weak] {
        if (const std::shared_ptr<Impl> impl = weak.lock()) (void)impl->ask(1);
      },
      impl_->group);
  impl_->timer->cancel();
}

MonitoredGuard::~MonitoredGuard() = default;

void MonitoredGuard::onMustStop(std::function<void(const GuardReply&)> call) {
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  impl_->on_must_stop = std::move(call);
}

GuardReply MonitoredGuard::begin(const robot_trajectory::RobotTrajectory& trajectory) {
  impl_->timer->cancel();
  impl_->guard.onMustStop({});
  double seen = 0;
  {
    const std::lock_guard<std::mutex> lock(impl_->mutex);
    seen = impl_->seen_at;
  }
  {
    const LockedPlanningSceneRO locked(impl_->monitor);
    const planning_scene::PlanningSceneConstPtr& scene = locked;
    impl_->guard.follow(*scene, seen, trajectory);
  }
  {
    const std::lock_guard<std::mutex> lock(impl_->mutex);
    impl_->begun = impl_->now();
  }
  GuardReply reply = impl_->ask(0);
  if (reply.must_stop) return reply;
  impl_->guard.onMustStop([impl = impl_.get()](const GuardReply& stop) {
    RCLCPP_ERROR(impl->node->get_logger(), "%s", stop.message.c_str());
    std::function<void(const GuardReply&)> call;
    {
      const std::lock_guard<std::mutex> lock(impl->mutex);
      call = impl->on_must_stop;
    }
    if (call) call(stop);
  });
  impl_->timer->reset();
  return reply;
}

void MonitoredGuard::end() {
  impl_->timer->cancel();
  impl_->guard.onMustStop({});
}

}  // namespace fcl_artic_moveit
