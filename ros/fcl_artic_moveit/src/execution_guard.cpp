// SPDX-License-Identifier: BSD-3-Clause
//
// With Executor::joints the robot leaves its path when it stops. Let joint v brake by a_v or more from the place q(s)
// where the stop begins, at no more than its speed |q_v'|. It then stays within |q_v'|^2 / 2 a_v of q_v(s), and stands
// after |q_v'| / a_v. So all that a stop passes is within these tolerances of q(s), and it is no later than the stop
// along the path, 1 / d with d the least a_v / |q_v'|. Each joint gets its largest such length as a tolerance more.
#include "fcl_artic_moveit/execution_guard.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "carried.h"
#include "fcl_artic_moveit/cell.h"
#include "fcl_artic_moveit/motion.h"
#include "numbers.h"

namespace fcl_artic_moveit {
namespace {

using Eigen::VectorXd;
using fcl_artic::GuardReason;
using fcl_artic::KinematicTree;
using moveit::core::RobotState;
using planning_scene::PlanningScene;

/// Sums and products of a few positive numbers, rounded, times this are no less than the true ones.
constexpr double kUp = 1 + 0x1p-40;

/// Upper bounds of the variables' speeds, rad/s or m/s: of each piece, the sum of its derivative's terms.
VectorXd fastest(const fcl_artic::JointTrajectory& trajectory) {
  VectorXd out = VectorXd::Zero(trajectory.size());
  for (std::size_t k = 0; k < trajectory.numPieces(); ++k) {
    const Eigen::MatrixXd& c = trajectory.piece(k).variables();
    VectorXd sum = VectorXd::Zero(c.rows());
    for (Eigen::Index j = 1; j < c.cols(); ++j) sum += static_cast<double>(j) * c.col(j).cwiseAbs();
    out = out.cwiseMax(kUp * sum / (trajectory.times()[k + 1] - trajectory.times()[k]));
  }
  return out;
}

}  // namespace

Executor executorNamed(const std::string& name) {
  if (name == "joints") return Executor::joints;
  if (name == "path") return Executor::path;
  throw std::invalid_argument("'" + name + "' is no executor: joints, path are");
}

void ExecutionGuardOptions::check() const {
  certifier.check();
  requireAtLeast0("object_speed", certifier.tolerances.object_speed);
  for (const auto& [object, speed] : certifier.tolerances.object_speeds) {
    requireAtLeast0("object_speeds: " + object, speed);
  }
  requireAtLeast0("deceleration", deceleration);
  for (const auto& [joint, value] : decelerations) requireAtLeast0("decelerations: " + joint, value);
  requireAtLeast0("period", period);
  if (period == 0) throw std::invalid_argument("period is 0; it has to be above");
  requireAtLeast0("reaction", reaction);
  requireAtLeast0("most_age", most_age);
  const auto moves = [](const auto& entry) { return entry.second > 0; };
  const CellTolerances& of = certifier.tolerances;
  if (most_age == 0 && (of.object_speed > 0 || std::any_of(of.object_speeds.begin(), of.object_speeds.end(), moves))) {
    throw std::invalid_argument("most_age is 0, no limit, where objects move: it says how old their places may be");
  }
}

struct ExecutionGuard::Impl {
  void takeOver(const PlanningScene& from);
  void requireAtRest(const RobotState& now) const;
  VectorXd decelerationsOf(const KinematicTree& tree, const VectorXd& speeds) const;
  void addStops(const KinematicTree& tree, const VectorXd& speeds, const VectorXd& decelerations);
  void begin(const PlanningScene& from, double seen_at, const robot_trajectory::RobotTrajectory& trajectory);
  void answer(double now, double path_time, double path_speed, GuardReply& reply);
  std::string reasonOf(double age, const GuardReply& reply) const;
  void setFailure(const std::string& why) {
    const std::lock_guard<std::mutex> lock(telling);
    failure = why;
    if (cell) names = cell->names();
  }
  std::string getFailure() {
    const std::lock_guard<std::mutex> lock(telling);
    return failure;
  }
  BodyName nameOf(const fcl_artic::BodyRef& body) {
    const std::lock_guard<std::mutex> lock(telling);
    const auto found = names.find(body.name);
    if (found != names.end()) return found->second.first;
    return {body.link >= 0 ? BodyName::link : BodyName::object, body.name};  // of a scene before
  }

  moveit::core::RobotModelConstPtr model;
  ExecutionGuardOptions options;

  std::mutex renewing;  ///< of the cell and what it is made from
  std::unique_ptr<Cell> cell;
  std::optional<RobotState> first;  ///< waypoint 0
  const moveit::core::JointModelGroup* group = nullptr;
  CellTolerances tolerances;

  std::mutex asking;                            ///< of what follows; `scene` is replaced with both held
  std::unique_ptr<fcl_artic::LiveScene> scene;  ///< null: no trajectory is followed
  std::optional<fcl_artic::Guard> guard, looking_ahead;
  bool stopped = true;
  std::function<void(const GuardReply&)> on_must_stop;

  std::mutex telling;
  std::string failure;                                       ///< why the newest scene was not taken over
  std::map<std::string, std::pair<BodyName, double>> names;  ///< Cell::names()
};

/// As the certifier does. @throws std::invalid_argument; the cell is then made anew.
void ExecutionGuard::Impl::takeOver(const PlanningScene& from) {
  if (!cell) cell = std::make_unique<Cell>(model);
  try {
    requireBodiesOf(from.getCurrentState(), *first);
    requireAtRest(from.getCurrentState());
    cell->update(*from.getCollisionEnv(), from.getAllowedCollisionMatrix(), *first, group, tolerances);
  } catch (...) {
    cell.reset();
    throw;
  }
}

/// All that is proven holds for joints outside the group where waypoint 0 has them.
void ExecutionGuard::Impl::requireAtRest(const RobotState& now) const {
  using moveit::core::JointModel;
  const fcl_artic::JointTolerance& all = tolerances.joints;
  for (const JointModel* joint : model->getJointModels()) {
    if (movesWith(group, *joint)) continue;
    const auto own = tolerances.own.find(joint->getName());
    double most = options.certifier.motion.mimic_tolerance;
    if (own != tolerances.own.end()) {
      most = std::max(most, own->second);
    } else if (joint->getVariableCount() == 1) {
      most = std::max(most, joint->getType() == JointModel::PRISMATIC ? all.length : all.angle);
    }
    for (std::size_t i = 0; i < joint->getVariableCount(); ++i) {
      const auto v = static_cast<int>(joint->getFirstVariableIndex() + i);
      if (std::abs(now.getVariablePosition(v) - first->getVariablePosition(v)) <= most) continue;
      throw std::invalid_argument("joint '" + joint->getName() +
                                  "', outside the group, is not where waypoint 0 has it");
    }
  }
}

VectorXd ExecutionGuard::Impl::decelerationsOf(const KinematicTree& tree, const VectorXd& speeds) const {
  VectorXd out = VectorXd::Ones(tree.dof());  // of what stands still: any
  for (int v = 0; v < tree.dof(); ++v) {
    if (speeds[v] == 0) continue;
    const std::string& joint = tree.joint(tree.variableJoint(v)).name;
    const auto own = options.decelerations.find(joint);
    out[v] = own == options.decelerations.end() ? options.deceleration : own->second;
    if (!(out[v] > 0)) throw std::invalid_argument("joint '" + joint + "' moves and has no deceleration above 0");
  }
  return out;
}

void ExecutionGuard::Impl::addStops(const KinematicTree& tree, const VectorXd& speeds, const VectorXd& decelerations) {
  for (int v = 0; v < tree.dof(); ++v) {
    if (speeds[v] == 0) continue;
    const fcl_artic::JointId j = tree.variableJoint(v);
    const fcl_artic::Joint& joint = tree.joint(j);
    if (tree.numVariables(j) > 1) {
      throw std::invalid_argument("joint '" + joint.name +
                                  "' has several variables: executor joints is of single ones");
    }
    const fcl_artic::JointTolerance& all = tolerances.joints;
    const double of_all = joint.type == fcl_artic::JointType::prismatic ? all.length : all.angle;
    double& own = tolerances.own.emplace(joint.name, of_all).first->second;
    own = kUp * (own + speeds[v] * speeds[v] / (2 * decelerations[v]));
  }
}

void ExecutionGuard::Impl::begin(const PlanningScene& from, double seen_at,
                                 const robot_trajectory::RobotTrajectory& trajectory) {
  requireSameBodies(trajectory);
  first.emplace(trajectory.getWayPoint(0));
  group = trajectory.getGroup();
  tolerances = options.certifier.tolerances;
  takeOver(from);
  const Motion motion = toMotion(cell->robot(), trajectory, options.certifier.motion);
  if (!motion.timed) throw std::invalid_argument("the trajectory has no times, so no speeds");
  const KinematicTree& tree = *cell->robot().tree;
  const VectorXd speeds = fastest(motion.trajectory);
  fcl_artic::GuardOptions of_guard;
  of_guard.deceleration = decelerationsOf(tree, speeds);
  of_guard.period = options.period;
  of_guard.reaction = options.reaction;
  of_guard.most_age = options.most_age > 0 ? options.most_age : std::numeric_limits<double>::max();
  of_guard.added_margin = options.certifier.margin;
  of_guard.work_budget = options.certifier.budget;
  guard.emplace(cell->robot().tree, of_guard);
  if (options.executor == Executor::joints) {
    for (std::size_t k = 0; k < motion.trajectory.numPieces(); ++k) {
      motion.trajectory.piece(k).requirePolynomial("executor joints");
    }
    addStops(tree, speeds, of_guard.deceleration);
    takeOver(from);
    // lookAhead() has each place passed 1 / 2d after full speed would be there; this robot may be near it until 1 / d.
    of_guard.reaction += kUp * 0.5 * (speeds.array() / of_guard.deceleration.array()).maxCoeff();
  }
  looking_ahead.emplace(cell->robot().tree, of_guard);
  guard->follow(motion.trajectory);
  looking_ahead->follow(motion.trajectory);
  scene = std::make_unique<fcl_artic::LiveScene>(cell->manager().copy(), seen_at);
}

void ExecutionGuard::Impl::answer(double now, double path_time, double path_speed, GuardReply& reply) {
  if (!scene) throw std::logic_error("no trajectory is followed");
  const std::string why = getFailure();
  if (!why.empty()) throw std::runtime_error("the newest scene is not taken over: " + why);
  const auto seen = scene->latest();
  guard->ask(*seen, now, path_time, path_speed, reply.answer);
  looking_ahead->lookAhead(*seen, now, path_time, reply.ahead);
  const bool may_go_on = reply.answer.speed == 1 || (options.executor == Executor::path && reply.answer.speed > 0);
  reply.must_stop = stopped && options.executor == Executor::joints ? true : !reply.answer.certified || !may_go_on;
  if (reply.answer.reason == GuardReason::near) {
    reply.body1 = nameOf(reply.answer.body1);
    reply.body2 = nameOf(reply.answer.body2);
  }
  if (reply.must_stop || reply.answer.speed < 1) reply.message = reasonOf(now - seen->seen_at, reply);
}

std::string ExecutionGuard::Impl::reasonOf(double age, const GuardReply& reply) const {
  std::ostringstream out;
  if (reply.must_stop) {
    out << (reply.answer.certified ? "stop" : "stop, which only an earlier answer has proven");
  } else {
    out << "at most at " << reply.answer.speed << " of the speed";
  }
  switch (reply.answer.reason) {
    case GuardReason::none:
      out << ": it had to stop before";
      break;
    case GuardReason::near:
      out << ": " << reply.body1 << " and " << reply.body2 << " may come too near at t = " << reply.answer.near_at
          << " s of the trajectory, or as it stops";
      break;
    case GuardReason::budget:
      out << ": the budget of " << options.certifier.budget << " tests is spent";
      break;
    case GuardReason::old_scene:
      out << ": the scene was seen " << age << " s ago; most_age is " << options.most_age << " s";
      break;
  }
  return out.str();
}

ExecutionGuard::ExecutionGuard(moveit::core::RobotModelConstPtr model, ExecutionGuardOptions options)
    : impl_(std::make_unique<Impl>()) {
  if (!model) throw std::invalid_argument("the robot model is null");
  options.check();
  impl_->model = std::move(model);
  impl_->options = std::move(options);
}

ExecutionGuard::~ExecutionGuard() = default;

void ExecutionGuard::onMustStop(std::function<void(const GuardReply&)> call) {
  const std::lock_guard<std::mutex> lock(impl_->asking);
  impl_->on_must_stop = std::move(call);
}

void ExecutionGuard::follow(const PlanningScene& scene, double seen_at,
                            const robot_trajectory::RobotTrajectory& trajectory) {
  const std::scoped_lock lock(impl_->renewing, impl_->asking);
  impl_->scene.reset();
  impl_->stopped = true;
  impl_->begin(scene, seen_at, trajectory);
  impl_->setFailure({});
  impl_->stopped = false;
}

void ExecutionGuard::renew(const PlanningScene& scene, double seen_at) {
  const std::lock_guard<std::mutex> lock(impl_->renewing);
  if (!impl_->scene) return;
  try {
    impl_->takeOver(scene);
    impl_->scene->renew(
        seen_at, [&](fcl_artic::ArticulatedCollisionManager& manager) { manager = impl_->cell->manager().copy(); });
    impl_->setFailure({});
  } catch (const std::exception& error) {
    impl_->setFailure(error.what());
  }
}

GuardReply ExecutionGuard::ask(double now, double path_time, double path_speed) {
  GuardReply reply;
  std::function<void(const GuardReply&)> call;
  {
    const std::lock_guard<std::mutex> lock(impl_->asking);
    try {
      impl_->answer(now, path_time, path_speed, reply);
    } catch (const std::exception& error) {
      reply = {};
      reply.message = std::string("stop: ") + error.what();
    }
    if (reply.must_stop && !impl_->stopped) call = impl_->on_must_stop;
    impl_->stopped = reply.must_stop;
  }
  if (call) call(reply);
  return reply;
}

}  // namespace fcl_artic_moveit
