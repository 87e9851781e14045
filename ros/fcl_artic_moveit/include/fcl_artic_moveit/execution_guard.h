// SPDX-License-Identifier: BSD-3-Clause
//
// While MoveIt executes a trajectory: is it still free in the newest scene, and can the robot still stop?
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>

#include <fcl_artic/guard.h>
#include <moveit/planning_scene/planning_scene.hpp>
#include <moveit/robot_trajectory/robot_trajectory.hpp>

#include "fcl_artic_moveit/certifier.h"

namespace fcl_artic_moveit {

/// How the robot stops, and whether it can slow down.
enum class Executor {
  /// At full speed until it is stopped. Then each joint brakes by itself, by its deceleration or more, and the robot
  /// leaves its path: joint_trajectory_controller with `decelerate_on_cancel`, when its goal is cancelled.
  joints,
  /// It follows GuardAnswer::speed, and keeps to its path while it slows down and stops.
  path,
};

/// "joints" or "path".
/// @throws std::invalid_argument naming another one.
Executor executorNamed(const std::string& name);

struct ExecutionGuardOptions {
  ExecutionGuardOptions() { certifier.budget = fcl_artic::GuardOptions().work_budget; }

  /// As for plans: interpolation, margin, tolerances. `tolerances` has the objects' speeds. The budget is of one
  /// answer; the time limit does not count.
  CertifierOptions certifier;
  Executor executor = Executor::joints;
  /// How much each joint can brake, rad/s² or m/s²; beyond what the trajectory asks of it, with Executor::path. 0: each
  /// joint that moves has one of its own.
  double deceleration = 0;
  std::map<std::string, double> decelerations;  ///< of single joints, in place of that
  double period = 0.05;                         ///< s, above 0: the next answer comes within it
  double reaction = 0.05;  ///< s, at least 0: from `now` of an answer until the robot follows it, at the latest
  /// s: a scene that was seen longer ago stops the robot. 0: no limit, only if no object has a speed.
  double most_age = 0.2;

  /// @throws std::invalid_argument naming the value, as CertifierOptions::check() does.
  void check() const;
};

/// Whether the execution may go on. Times are s from the trajectory's start, as in its message.
struct GuardReply {
  bool must_stop = true;
  fcl_artic::GuardAnswer answer;  ///< `speed` is the largest factor of speed that is certified
  /// At full speed: nothing touches until `free_until`, and a stop by `run_until` at the latest ends before. After an
  /// error it has no meaning.
  fcl_artic::AheadAnswer ahead;
  BodyName body1, body2;  ///< that limit the speed; `id` empty: none do
  std::string message;    ///< why it must stop or slow down; empty: neither
};

/// Watches one execution after the other: each answer covers the motion until the next one and the stop after it, in
/// the newest scene (fcl_artic::Guard, doc/GUARD.md). It is no safety function. All members may be called from any
/// thread; ask() does not wait for renew().
class ExecutionGuard {
 public:
  /// @throws std::invalid_argument if the model is null, and as ExecutionGuardOptions::check().
  ExecutionGuard(moveit::core::RobotModelConstPtr model, ExecutionGuardOptions options);
  ~ExecutionGuard();

  /// Sets who is called when an answer is the first that says stop, by ask(), on its thread.
  void onMustStop(std::function<void(const GuardReply&)> call);

  /// Takes the trajectory that is to be executed, before it begins.
  /// @param scene  locked for reading if it is a monitor's; it is not needed afterwards.
  /// @param seen_at  s, by the clock of ask(): when the sensors saw all of the scene's objects. Not when it came.
  /// @throws std::invalid_argument as Certifier::certify(); also for a trajectory without times, and for a joint of the
  ///   group that moves and has no deceleration. With Executor::joints also for joints of several variables that move,
  ///   and tangents of half angles. Nothing is guarded then: ask() says stop.
  void follow(const planning_scene::PlanningScene& scene, double seen_at,
              const robot_trajectory::RobotTrajectory& trajectory);

  /// Takes over a newer scene: its world, padding, allowed pairs. Shapes that are the same are kept; an octomap is read
  /// again. The answers say stop from a scene that cannot be taken over until one that can. The robot must carry what
  /// the trajectory says, and joints outside the group must be where waypoint 0 has them.
  /// @param scene, seen_at  as for follow().
  void renew(const planning_scene::PlanningScene& scene, double seen_at);

  /// Whether the execution may go on. With Executor::joints an execution that had to stop once must stop, until
  /// follow().
  /// @param now  s, by the clock of `seen_at`.
  /// @param path_time  no later than where the robot is on the trajectory, s. How far it may be ahead of this is a part
  ///   of `reaction`.
  /// @param path_speed  no less than the largest factor of speed until the answer counts, 0 to 1; with Executor::joints
  ///   1, but 0 before it begins.
  GuardReply ask(double now, double path_time, double path_speed = 1);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fcl_artic_moveit
