// SPDX-License-Identifier: BSD-3-Clause
//
// While a trajectory is executed: may the robot go on, and how fast? (doc/GUARD.md)
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include <Eigen/Core>

#include "fcl_artic/export.h"
#include "fcl_artic/manager.h"
#include "fcl_artic/request.h"
#include "fcl_artic/result.h"
#include "fcl_artic/trajectory.h"

namespace fcl_artic {

/// A scene that one thread renews while others ask about it. Nobody waits: who asks has the last scene until the next
/// one is complete. All members may be called from any thread.
class FCL_ARTIC_EXPORT LiveScene {
 public:
  /// The scene as a sensor saw it at one time. Nobody changes it any more.
  struct Snapshot {
    ArticulatedCollisionManager manager;  ///< Set up.
    double seen_at;                       ///< s, by the caller's clock.
  };

  /// Takes a manager over and calls its setup().
  /// @param seen_at  s, by the caller's clock, finite.
  /// @throws std::invalid_argument as ArticulatedCollisionManager::setup(), and for a time that is not finite.
  explicit LiveScene(ArticulatedCollisionManager manager, double seen_at = 0);
  ~LiveScene();
  LiveScene(const LiveScene&) = delete;
  LiveScene& operator=(const LiveScene&) = delete;

  /// The scene that is complete. It stays as it is for as long as it is held.
  std::shared_ptr<const Snapshot> latest() const;
  /// Renews the scene: changes a copy of it, sets that up and makes it the latest. Objects that stay are not read
  /// again, so their geometry must not be changed in place. Calls follow one another.
  /// @param seen_at  s, by the caller's clock, finite: when the sensor saw all of this.
  /// @param change  of the copy; it must not call renew(). Objects should be given by shared_ptr, as older scenes may
  ///   still be in use.
  /// @throws whatever `change` throws; std::invalid_argument as update(). The scene then stays as it was.
  void renew(double seen_at, const std::function<void(ArticulatedCollisionManager&)>& change);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Settings of a guard, which stay.
struct GuardOptions : Scope {
  /// How much the drives can brake along the path, beyond what the trajectory itself asks of them: rad/s² or m/s²,
  /// above 0, tree().dof() entries. For a quaternion, x, y and z count, each about any axis.
  Eigen::VectorXd deceleration;
  /// s, above 0: the next answer comes within it. If none comes, the robot begins to stop.
  double period = 0.004;
  /// s, at least 0: an answer counts from that time after `now` on, at the latest.
  double reaction = 0;
  /// s, at least 0: a scene that was seen longer ago lets nothing move.
  double most_age = 0.1;
  /// m, at least 0: margin of pairs that have none of their own, and what is added to all (Tolerances).
  double margin = 0, added_margin = 0;
  /// Most speeds that are tried between the slowest and the full one. They end as soon as two differ by no more than
  /// 2^-tries.
  int tries = 5;
  /// Most tests of one answer, all speeds together; 0: no limit. If it ends, only the way that is proven by then
  /// counts.
  std::uint64_t work_budget = 20000;
};

/// Why an answer is no larger.
enum class GuardReason {
  none,       ///< Full speed.
  near,       ///< Two bodies may come too near: GuardAnswer::body1 and body2.
  budget,     ///< GuardOptions::work_budget is spent.
  old_scene,  ///< The scene was seen too long ago, or after now.
};

/// The lengths of which ISO 13855 and ISO/TS 15066 make the separation from a person, m: S = S_h + S_r + S_s + C + Z_d
/// + Z_r. They are upper bounds for the answer at hand. The guard itself checks the bodies, which is sharper; these are
/// for the file.
struct Separation {
  double human_reacting = 0;  ///< S_h, first part: the fastest object, from when it was seen until the robot brakes.
  double human_stopping = 0;  ///< S_h, second part: the same object while the robot stops.
  double robot_reacting = 0;  ///< S_r: a point of the robot until it brakes.
  double robot_stopping = 0;  ///< S_s: the same while it stops.
  double object = 0;          ///< C + Z_d: the largest tolerance of an object (setObjectTolerance()).
  double robot = 0;           ///< Z_r: by the tolerances of joints and base.
  double sum() const { return human_reacting + human_stopping + robot_reacting + robot_stopping + object + robot; }
};

/// How the robot may go on until `valid_until`.
struct GuardAnswer {
  /// Largest factor on the trajectory's own speed that is certified, 0 to 1. 0: stop now, by `braking`.
  double speed = 0;
  /// s, by the caller's clock: until then the answer counts. After it the robot brakes to a stop.
  double valid_until = 0;
  /// 1/s: how fast the factor falls while the robot brakes; infinite where nothing moves. An answer that is not
  /// certified repeats that of the last one that was. (A robot that did not get that one brakes as the one said that it
  /// followed.)
  double braking = 0;
  /// s: until the robot stands, from now on, if it goes on at `speed` as long as it may.
  double stop_time = 0;
  /// The trajectory's time at which it then stands.
  double stop_at = 0;
  /// Whether all of this is proven free. False only with `speed` 0: then the robot brakes on what an earlier answer has
  /// proven, and the scene has changed by more than that allowed for.
  bool certified = false;
  GuardReason reason = GuardReason::none;
  BodyRef body1, body2;   ///< The pair that limits the speed, with GuardReason::near.
  double near_at = 0;     ///< The trajectory's time at which they may be too near, at a speed that was refused.
  Separation separation;  ///< For `speed`.
  std::uint64_t tests = 0;
};

/// How far ahead a trajectory is free at its full speed.
struct AheadAnswer {
  /// The trajectory's time before which nothing comes too near; its end if all is free.
  double free_until = 0;
  /// The trajectory's time until which the robot may go on: a stop that begins no later ends before `free_until`. The
  /// trajectory's end if all is free. Before the time asked for: even a stop at once is not certified.
  double run_until = 0;
  double braking = 0;  ///< 1/s, as GuardAnswer::braking.
  bool all_free = false;
  GuardReason reason = GuardReason::none;
  BodyRef body1, body2;
  std::uint64_t tests = 0;
};

/// Lets a robot follow a trajectory only while a stop is certified. The robot keeps to the path: it is slowed by
/// stretching the trajectory's time. An answer covers the motion until the next one, and the stop after it, against the
/// scene, with all tolerances, and against objects that move by themselves (ObjectSpeed). So if every answer is
/// followed, the robot stands before anything can touch it, also if no further answer comes (doc/GUARD.md).
///
/// The memory of ask() and lookAhead() grows to what the largest question so far took, and stays: after the first
/// answers they allocate none. One thread at a time; LiveScene is for several.
class FCL_ARTIC_EXPORT Guard {
 public:
  /// @throws std::invalid_argument, naming the value: tree is null, another number of decelerations than tree->dof(), a
  ///   value outside the ranges that GuardOptions gives.
  Guard(std::shared_ptr<const KinematicTree> tree, GuardOptions options);
  ~Guard();
  Guard(Guard&&) noexcept;
  Guard& operator=(Guard&&) noexcept;

  /// Takes the trajectory that the robot follows from now on. Its times are in s. A robot that moves keeps to the last
  /// answer about the old trajectory, its braking too, until an answer about the new one is certified.
  /// @throws std::invalid_argument if it is of other joint variables.
  void follow(const JointTrajectory& trajectory);

  /// How the robot may go on.
  /// @param scene  as LiveScene::latest() has it, with obstacles that stand still or move by themselves (ObjectSpeed:
  ///   `since` counts from when the scene was seen).
  /// @param now  s, by the same clock as the scene's.
  /// @param path_time  the trajectory's time at which the robot is now; clamped to the trajectory.
  /// @param path_speed  no less than the largest factor of speed that the robot may have until the answer is followed,
  ///   0 to 1.
  /// @param[out] answer  its memory is used again. After an error it has speed 0 and no certificate.
  /// @throws std::invalid_argument for numbers that are not finite or out of range, a scene of another robot, and an
  ///   obstacle with a motion of its own (registerObject() of a ContinuousCollisionObject).
  /// @throws std::logic_error before follow(), and as ArticulatedCollisionManager::continuousCollide().
  void ask(const LiveScene::Snapshot& scene, double now, double path_time, double path_speed, GuardAnswer& answer);

  /// How far ahead the trajectory is free at full speed, and until when a stop is possible that ends before that. It
  /// holds for a robot that is at full speed from now on: one that is slower meets objects that move later than that.
  /// @param scene, now, path_time  as for ask().
  /// @param[out] answer  its memory is used again. After an error nothing is free.
  /// @throws as ask().
  void lookAhead(const LiveScene::Snapshot& scene, double now, double path_time, AheadAnswer& answer);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fcl_artic
