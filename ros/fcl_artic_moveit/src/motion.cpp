// SPDX-License-Identifier: BSD-3-Clause
#include "fcl_artic_moveit/motion.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <moveit/robot_model/planar_joint_model.hpp>

namespace fcl_artic_moveit {
namespace {

using Eigen::VectorXd;
using fcl_artic::Joint;
using fcl_artic::JointTrajectory;
using fcl_artic::JointType;
using moveit::core::RobotState;
using robot_trajectory::RobotTrajectory;

constexpr double kHalfTurn = 3.14159265358979323846;
constexpr double kNearHalfTurn = 2e-6;  // cosine of half the angle between quaternions, below which no sense is sure
constexpr double kSame = 1e-6;          // rad or m: within it a joint outside the group counts as standing still

[[noreturn]] void refuse(const std::string& what) {
  throw std::invalid_argument(what);
}

std::string shown(double value) {
  std::ostringstream out;
  out.precision(9);
  out << value;
  return out.str();
}

std::string waypoint(std::size_t k) {
  return "waypoint " + std::to_string(k);
}

/// Variables of the tree that belong to the trajectory's group.
std::vector<bool> variablesOf(const RobotTree& robot, const RobotTrajectory& trajectory) {
  std::vector<bool> out;
  const moveit::core::RobotModel& model = *trajectory.getRobotModel();
  for (int v = 0; v < robot.tree->dof(); ++v) {
    const std::string& joint = robot.tree->joint(robot.tree->variableJoint(v)).name;
    out.push_back(movesWith(trajectory.getGroup(), *model.getJointModel(joint)));
  }
  return out;
}

std::vector<VectorXd> waypointsOf(const RobotTree& robot, const RobotTrajectory& trajectory,
                                  const std::vector<bool>& in_group, double mimic_tolerance,
                                  std::vector<std::string>& notes) {
  const moveit::core::RobotModel& model = *trajectory.getRobotModel();
  std::vector<VectorXd> out;
  for (std::size_t k = 0; k < trajectory.getWayPointCount(); ++k) {
    try {
      out.push_back(robot.configuration(trajectory.getWayPoint(k), mimic_tolerance));
    } catch (const std::invalid_argument& error) {
      refuse(waypoint(k) + ": " + error.what());
    }
    const auto [follower, off] = robot.farthestFollower(trajectory.getWayPoint(k));
    if (off > RobotTree::kFollows && notes.empty()) {
      notes.push_back(waypoint(k) + ": joint '" + follower->name + "' is " + shown(off) +
                      " off from where the joint that it mimics has it, and is taken to be there");
    }
    for (int v = 0; v < robot.tree->dof(); ++v) {
      if (in_group[static_cast<std::size_t>(v)]) continue;
      // Many planners put a follower that stands where it was measured to the place where its master has it.
      const bool follows = model.getJointModel(robot.tree->joint(robot.tree->variableJoint(v)).name)->getMimic();
      if (std::abs(out[k][v] - out[0][v]) > (follows ? std::max(kSame, mimic_tolerance) : kSame)) {
        refuse(waypoint(k) + ": '" + robot.tree->variableName(v) + "' moves from " + shown(out[0][v]) + " to " +
               shown(out[k][v]) + " and is not in the group '" + trajectory.getGroupName() +
               "', whose joints alone are sent to a controller");
      }
      out[k][v] = out[0][v];
    }
  }
  return out;
}

/// Rates of the group's variables; all others stand still.
std::vector<VectorXd> ratesOf(const RobotTree& robot, const RobotTrajectory& trajectory,
                              const std::vector<bool>& in_group, const char* what,
                              const double* (RobotState::*values)() const) {
  std::vector<VectorXd> out;
  for (std::size_t k = 0; k < trajectory.getWayPointCount(); ++k) {
    const double* all = (trajectory.getWayPoint(k).*values)();
    VectorXd& rates = out.emplace_back(VectorXd::Zero(robot.tree->dof()));
    for (int v = 0; v < robot.tree->dof(); ++v) {
      if (!in_group[static_cast<std::size_t>(v)]) continue;
      rates[v] = all[robot.variables[static_cast<std::size_t>(v)]];
      if (!std::isfinite(rates[v])) {
        refuse(waypoint(k) + ": the " + what + " of '" + robot.tree->variableName(v) + "' is " + shown(rates[v]));
      }
    }
  }
  return out;
}

/// How many waypoints have velocities or accelerations: all or none.
bool allHave(const RobotTrajectory& trajectory, const char* what, bool (RobotState::*has)() const) {
  const std::size_t n = trajectory.getWayPointCount();
  std::size_t with = 0, without = 0;
  for (std::size_t k = 0; k < n; ++k) ((trajectory.getWayPoint(k).*has)() ? with : without) = k + 1;
  if (with && without) {
    refuse(waypoint(with - 1) + " has " + what + ", " + waypoint(without - 1) +
           " has none: the parameter `interpolation` says what is meant");
  }
  return with > 0;
}

Interpolation chosen(const RobotTrajectory& trajectory, Interpolation asked, bool timed) {
  fcl_artic::WaypointValues given{timed, false, false};
  const bool most = asked == Interpolation::automatic || asked == Interpolation::jtc ||
                    asked == Interpolation::jtcUpsampled;  // takes the most that there is
  if (asked == Interpolation::cubic || asked == Interpolation::quintic || (most && timed)) {
    given.velocities = allHave(trajectory, "velocities", &RobotState::hasVelocities);
  }
  if (asked == Interpolation::quintic || (most && timed)) {  // rates say nothing without times
    given.accelerations = allHave(trajectory, "accelerations", &RobotState::hasAccelerations);
  }
  return fcl_artic::curveOf(asked, given);
}

[[noreturn]] void refuseFloating(const Joint& joint) {
  refuse("joint '" + joint.name +
         "' floats and moves: no controller of joints runs its quaternion, and what the velocities of one mean is not "
         "defined; interpolation linear is the way to certify it");
}

void requireNoTurningRates(const RobotTree& robot, const std::vector<VectorXd>& velocities) {
  for (fcl_artic::JointId j = 0; j < robot.tree->numJoints(); ++j) {
    const int v = robot.tree->quaternionVariable(j);
    for (const VectorXd& one : velocities) {
      if (v >= 0 && !one.segment<4>(v).isZero(0)) refuseFloating(robot.tree->joint(j));
    }
  }
}

/// Refuses half a turn from one waypoint to the next: it does not say which way round, and executors have rules of
/// their own.
void requireSenses(const RobotTree& robot, const std::vector<VectorXd>& q) {
  for (fcl_artic::JointId j = 0; j < robot.tree->numJoints(); ++j) {
    const int v = robot.tree->quaternionVariable(j);
    for (std::size_t k = 1; v >= 0 && k < q.size(); ++k) {
      const Eigen::Vector4d from = q[k - 1].segment<4>(v), to = q[k].segment<4>(v);
      if (!(std::abs(from.dot(to)) <= kNearHalfTurn * from.norm() * to.norm())) continue;
      refuse(waypoint(k) + ": joint '" + robot.tree->joint(j).name + "' turns by half a turn from " + waypoint(k - 1) +
             ", which says not which way round: a waypoint between them says it");
    }
  }
}

/// Notes and refusals where MoveIt's joints mean something that this library's do not, or the other way round.
void judgeJoints(const RobotTree& robot, const RobotTrajectory& trajectory, const std::vector<VectorXd>& q,
                 Interpolation kind, const MotionOptions& options) {
  const bool controller = fcl_artic::isController(options.interpolation);
  const bool asks = fcl_artic::turnsOf(options.interpolation, options.turns) == Turns::ask;
  requireSenses(robot, q);
  const auto& tree = *robot.tree;
  const auto moves = [&](int v, int n) {
    for (const VectorXd& one : q) {
      if (one.segment(v, n) != q[0].segment(v, n)) return true;
    }
    return false;
  };
  for (int v = 0; v < tree.dof(); ++v) {
    const Joint& joint = tree.joint(tree.variableJoint(v));
    if (joint.type == JointType::floating && tree.jointVariable(tree.variableJoint(v)) == v && moves(v, 7) &&
        (kind != Interpolation::linear || controller)) {
      refuseFloating(joint);
    }
    if (joint.type == JointType::planar && tree.isAngle(v) && moves(v - 2, 3) &&
        (options.interpolation == Interpolation::automatic || controller)) {
      const auto* planar =
          static_cast<const moveit::core::PlanarJointModel*>(trajectory.getRobotModel()->getJointModel(joint.name));
      if (planar->getMotionModel() == moveit::core::PlanarJointModel::DIFF_DRIVE) {
        refuse("joint '" + joint.name + "' has a differential drive, whose way between waypoints is no straight one: " +
               "the parameter `interpolation` (linear, cubic, quintic) states what x, y and theta do");
      }
    }
    const bool forever = joint.type == JointType::continuous || (joint.type == JointType::planar && tree.isAngle(v));
    for (std::size_t k = 1; forever && asks && k < q.size(); ++k) {
      const double step = q[k][v] - q[k - 1][v];
      if (std::abs(step) < kHalfTurn) continue;
      refuse("'" + tree.variableName(v) + "' turns forever and goes by " + shown(step) + " rad from waypoint " +
             std::to_string(k - 1) + " to " + std::to_string(k) +
             ": the parameter `turns` says whether as given or the shorter way round");
    }
  }
}

}  // namespace

bool movesWith(const moveit::core::JointModelGroup* group, const moveit::core::JointModel& joint) {
  if (!group) return true;
  return group->hasJointModel(joint.getName()) ||
         (joint.getMimic() && group->hasJointModel(joint.getMimic()->getName()));
}

std::size_t Motion::waypointBefore(double t) const {
  const auto after = std::upper_bound(times.begin(), times.end(), t);
  return after == times.begin() ? 0 : static_cast<std::size_t>(after - times.begin()) - 1;
}

Motion toMotion(const RobotTree& robot, const RobotTrajectory& trajectory, const MotionOptions& options) {
  const std::size_t n = trajectory.getWayPointCount();
  if (n == 0) refuse("the trajectory has no waypoint");
  const std::vector<bool> in_group = variablesOf(robot, trajectory);
  std::vector<std::string> notes;
  std::vector<VectorXd> q = waypointsOf(robot, trajectory, in_group, options.mimic_tolerance, notes);
  std::vector<double> times;
  double t = 0;
  for (std::size_t k = 0; k < n; ++k) times.push_back(t += trajectory.getWayPointDurationFromPrevious(k));
  if (n == 1) {
    notes.emplace_back("the trajectory has one waypoint: it stands still");
    const fcl_artic::Waypoints still{{0, 1}, {q[0], q[0]}, {}, {}};
    return {Interpolation::linear,
            false,
            still.times,
            still,
            JointTrajectory::linear(*robot.tree, still.times, still.positions),
            notes};
  }
  bool timed = false;
  for (std::size_t k = 1; k < n; ++k) timed = timed || trajectory.getWayPointDurationFromPrevious(k) != 0;
  if (!timed) {
    notes.emplace_back("the trajectory has no times: they are the waypoints' numbers");
    for (std::size_t k = 0; k < n; ++k) times[k] = static_cast<double>(k);
  }
  for (std::size_t k = 1; k < n; ++k) {
    if (times[k] > times[k - 1] && std::isfinite(times[k])) continue;
    refuse(waypoint(k) + ": its time " + shown(times[k]) + " is not later than that of waypoint " +
           std::to_string(k - 1) + ", " + shown(times[k - 1]));
  }
  if (timed && times[0] > 0) {
    notes.push_back("the first waypoint is at t = " + shown(times[0]) + ": the way to it is no part of the trajectory");
  }
  if (options.interpolation == Interpolation::jtcNone) {
    notes.emplace_back(
        "interpolation jtc-none: the controller gives each waypoint at once; that all joints go straight "
        "to it, and arrive together, is taken for granted");
  }
  const Interpolation kind = chosen(trajectory, options.interpolation, timed);
  if (kind == Interpolation::jtcUpsampled) {
    notes.emplace_back(
        "interpolation jtc-upsampled: the controller upsamples messages on its topic, and no goals of its action, "
        "which "
        "MoveIt sends");
  }
  judgeJoints(robot, trajectory, q, kind, options);
  const auto unwrap = options.turns == Turns::shortest ? JointTrajectory::Unwrap::yes : JointTrajectory::Unwrap::no;
  fcl_artic::Waypoints through{times, q, {}, {}};
  if (kind == Interpolation::cubic || kind == Interpolation::quintic) {
    through.velocities = ratesOf(robot, trajectory, in_group, "velocity", &RobotState::getVariableVelocities);
    requireNoTurningRates(robot, through.velocities);
  }
  if (kind == Interpolation::quintic) {
    through.accelerations = ratesOf(robot, trajectory, in_group, "acceleration", &RobotState::getVariableAccelerations);
  }
  JointTrajectory motion = fcl_artic::makeTrajectory(*robot.tree, kind, through, options.blend, unwrap);
  return {kind, timed, std::move(times), std::move(through), std::move(motion), std::move(notes)};
}

}  // namespace fcl_artic_moveit
