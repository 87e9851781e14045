// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include <fcl_artic/bracket.h>
#include <moveit/collision_detection/collision_env.hpp>
#include <moveit/collision_detection/collision_matrix.hpp>
#include <moveit/planning_scene/planning_scene.hpp>
#include <moveit/robot_trajectory/robot_trajectory.hpp>

#include "fcl_artic_moveit/cell.h"
#include "fcl_artic_moveit/motion.h"

namespace fcl_artic_moveit {

struct CertifierOptions {
  MotionOptions motion;
  /// Distance that every checked pair has to keep, m, beyond the links' padding; finite, at least 0.
  double margin = 0;
  /// How far robot and scene may be from MoveIt's: `free` holds for every path within these tolerances.
  CellTolerances tolerances;
  /// Number of tests after which the answer is `undecided`; 0: no limit.
  std::uint64_t budget = 0;
  /// Time after which the answer is `undecided`, s; 0: no limit. The time to read a robot when it is first seen does
  /// not count.
  double time_limit = 0;

  /// @throws std::invalid_argument naming the value: margin, a tolerance, blend or time limit negative or not finite;
  ///   `blends` without a blend; Turns::shortest beside an interpolation that says itself which way round.
  void check() const;
};

/// The answer about one trajectory. Times are s from the trajectory's start, as in its message, or waypoints' numbers.
struct Verdict : fcl_artic::Bracket {
  Interpolation interpolation = Interpolation::linear;  ///< that was used
  bool timed = false;                                   ///< whether times are seconds
  std::size_t waypoints = 0;                            ///< number of them
  std::size_t pairs = 0;                                ///< pairs of bodies that were checked
  struct Contact {
    BodyName body1, body2;
    double t = 0;                                      ///< the pair is proven free before it, between these waypoints
    bool certain = false;                              ///< whether contact is proven
    Eigen::Vector3d point = Eigen::Vector3d::Zero();   ///< in the model's frame, m
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< from body 1 to body 2
    double padding = 0;                                ///< m, that the links' padding has the two keep
  };
  /// The first contact, and those of all other pairs of bodies that touch between the same two waypoints, each pair's
  /// first. Empty where there is none. Only before the first one's time it is proven that nothing touches.
  std::vector<Contact> contacts;
  std::size_t waypoint = 0;  ///< that is at or before the first contact
  /// Values of the group's joint variables at the first contact, with their names, rad or m. With tolerances, and if it
  /// is certain, those within them at which the two bodies touch.
  std::vector<std::pair<std::string, double>> joints;
  double margin = 0;               ///< m, CertifierOptions::margin
  std::string tolerances;          ///< CertifierOptions::tolerances, for people; empty: none
  bool out_of_time = false;        ///< CertifierOptions::time_limit made it undecided
  std::vector<std::string> notes;  ///< what was accepted though unusual, one line each
  std::string message;             ///< verdict, contact and cure, for a log
};

struct RepairOptions {
  double clearance = 0.005;     ///< m, that detours keep beyond margin and padding; less only where no way does
  double seconds = 5;           ///< that it may take, about
  double velocity_scaling = 1;  ///< of the time parameterization, above 0, up to 1
  double acceleration_scaling = 1;
};

/// A way around the obstacles that a trajectory touches, certified free.
struct Repair {
  robot_trajectory::RobotTrajectoryPtr trajectory;
  Verdict verdict;
  std::size_t detours = 0;  ///< stretches that were replaced
};

/// Certifies trajectories of MoveIt: whether the motion that a controller makes of one touches, and when first. It
/// keeps what was made of a robot from call to call. Its const members may be called from many threads at once.
class Certifier {
 public:
  Certifier();
  ~Certifier();

  /// Certifies one trajectory in a scene: a plan, a stored one, or one that MoveIt Task Constructor has put together:
  /// certify(*sub_trajectory.start()->scene(), *sub_trajectory.trajectory()).
  /// @param scene  its world, padding and allowed pairs; its state is what the robot starts from.
  /// @throws std::invalid_argument as the other form.
  Verdict certify(const planning_scene::PlanningScene& scene, const robot_trajectory::RobotTrajectory& trajectory,
                  const CertifierOptions& options = {}) const;

  /// Certifies one trajectory.
  /// @param env         of the planning scene (PlanningScene::getCollisionEnv()): its world and the links' padding.
  /// @param acm         PlanningScene::getAllowedCollisionMatrix().
  /// @param trajectory  whose first waypoint has the attached bodies.
  /// @param start       what the robot starts from; null: waypoint 0 is taken at its word.
  /// @throws std::invalid_argument as CertifierOptions::check(), toMotion() and Cell::update(). Also if a waypoint
  ///   carries other bodies than the first. Also if the first lacks a body which `start` carries, or has it on another
  ///   link or elsewhere: nothing is claimed then.
  Verdict certify(const collision_detection::CollisionEnv& env, const collision_detection::AllowedCollisionMatrix& acm,
                  const robot_trajectory::RobotTrajectory& trajectory, const moveit::core::RobotState* start = nullptr,
                  const CertifierOptions& options = {}) const;

  /// Whether this package was built with what repair() needs: fcl_artic's component ompl.
  static bool canRepair();

  /// Finds a way around the obstacles that a trajectory touches (fcl_artic::planning::mend()), and certifies it as any
  /// other. If the trajectory had times, MoveIt's time optimal parameterization times the way anew, within the model's
  /// limits.
  /// @param trajectory  that certify() answers for without throwing.
  /// @throws std::invalid_argument as certify().
  /// @throws std::runtime_error: no such way was found, or it could not be timed so that it is free; that this package
  ///   was built without the component.
  Repair repair(const collision_detection::CollisionEnv& env, const collision_detection::AllowedCollisionMatrix& acm,
                const robot_trajectory::RobotTrajectory& trajectory, const CertifierOptions& options,
                const RepairOptions& how) const;

 private:
  std::unique_ptr<Cell> idleCell(const moveit::core::RobotModelConstPtr& model) const;
  void giveBack(std::unique_ptr<Cell> cell) const;

  mutable std::mutex mutex_;
  mutable std::vector<std::unique_ptr<Cell>> idle_;  ///< one for each thread that was here at the same time
};

}  // namespace fcl_artic_moveit
