// SPDX-License-Identifier: BSD-3-Clause
//
// Ways around the obstacles that a trajectory touches. (Needs fcl_artic's component ompl.)
#include <stdexcept>

#include "fcl_artic_moveit/certifier.h"

#ifdef FCL_ARTIC_MOVEIT_OMPL
#include <fcl_artic/ompl/mend.h>
#include <moveit/trajectory_processing/time_optimal_trajectory_generation.hpp>
#endif

namespace fcl_artic_moveit {

#ifdef FCL_ARTIC_MOVEIT_OMPL
namespace {

namespace planning = fcl_artic::planning;
using robot_trajectory::RobotTrajectory;
using robot_trajectory::RobotTrajectoryPtr;

// The time parameterization rounds corners by this much, rad or m. A rounded corner may touch an obstacle that is
// nearer, so each rounding is certified, the roundest first.
constexpr double kRoundings[] = {1e-2, 1e-3, 1e-4};

/// Waypoints of all variables as a trajectory, with all else as on the first waypoint of another.
RobotTrajectoryPtr trajectoryOf(const RobotTree& robot, const std::vector<int>& variables,
                                const fcl_artic::Waypoints& way, bool timed, const RobotTrajectory& like) {
  auto out = std::make_shared<RobotTrajectory>(like.getRobotModel(), like.getGroup());
  moveit::core::RobotState at(like.getWayPoint(0));
  at.dropVelocities();
  at.dropAccelerations();
  for (std::size_t k = 0; k < way.positions.size(); ++k) {
    for (const int v : variables) {
      at.setVariablePosition(static_cast<int>(robot.variables[static_cast<std::size_t>(v)]), way.positions[k][v]);
    }
    at.update();
    out->addSuffixWayPoint(at, k == 0 || !timed ? 0 : way.times[k] - way.times[k - 1]);
  }
  return out;
}

}  // namespace

bool Certifier::canRepair() {
  return true;
}

Repair Certifier::repair(const collision_detection::CollisionEnv& env,
                         const collision_detection::AllowedCollisionMatrix& acm, const RobotTrajectory& trajectory,
                         const CertifierOptions& options, const RepairOptions& how) const {
  options.check();
  std::unique_ptr<Cell> cell = idleCell(trajectory.getRobotModel());
  cell->update(env, acm, trajectory.getWayPoint(0), trajectory.getGroup(), options.tolerances);
  const RobotTree& robot = cell->robot();
  const Motion motion = toMotion(robot, trajectory, options.motion);
  std::vector<int> variables;
  for (int v = 0; v < robot.tree->dof(); ++v) {
    const std::string& joint = robot.tree->joint(robot.tree->variableJoint(v)).name;
    if (movesWith(trajectory.getGroup(), *trajectory.getRobotModel()->getJointModel(joint))) variables.push_back(v);
  }
  planning::MendOptions mending;
  mending.seconds = how.seconds;
  mending.clearance = how.clearance;
  mending.request.added_margin = options.margin;
  const bool shortest = fcl_artic::turnsOf(options.motion.interpolation, options.motion.turns) == Turns::shortest;
  const auto unwrap = shortest ? fcl_artic::JointTrajectory::Unwrap::yes : fcl_artic::JointTrajectory::Unwrap::no;
  const planning::Mended mended = planning::mend(cell->sharedManager(), motion.waypoints, variables, unwrap, mending);
  const RobotTrajectoryPtr straight = trajectoryOf(robot, variables, mended.waypoints, motion.timed, trajectory);
  giveBack(std::move(cell));
  CertifierOptions as_mended = options;
  if (as_mended.motion.turns == Turns::shortest) as_mended.motion.turns = Turns::given;  // its steps were proven
  Repair out;
  out.detours = mended.detours;
  for (const double rounding : kRoundings) {
    out.trajectory = std::make_shared<RobotTrajectory>(*straight, true);
    if (motion.timed) {
      const trajectory_processing::TimeOptimalTrajectoryGeneration timing(rounding);
      if (!timing.computeTimeStamps(*out.trajectory, how.velocity_scaling, how.acceleration_scaling)) {
        throw std::runtime_error(
            "the mended way could not be timed; MoveIt's log says why (it needs limits of acceleration)");
      }
    }
    out.verdict = certify(env, acm, *out.trajectory, nullptr, as_mended);
    if (out.verdict.isFree() || !motion.timed) break;
  }
  if (!out.verdict.isFree()) throw std::runtime_error("the mended way, timed: " + out.verdict.message);
  return out;
}
#else
bool Certifier::canRepair() {
  return false;
}

Repair Certifier::repair(const collision_detection::CollisionEnv&, const collision_detection::AllowedCollisionMatrix&,
                         const robot_trajectory::RobotTrajectory&, const CertifierOptions&,
                         const RepairOptions&) const {
  throw std::runtime_error("this package was built without fcl_artic's component ompl, which finds detours");
}
#endif

}  // namespace fcl_artic_moveit
