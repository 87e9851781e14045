// SPDX-License-Identifier: BSD-3-Clause
#include "plans/motion.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "kinematics/angles.h"
#include "plans/refuse.h"
#include "plans/variables.h"
#include "text/counted.h"

namespace fcl_artic::plans {
namespace {

using Eigen::VectorXd;

// Cosine of half the angle between two quaternions, below which no sense of rotation is sure. There the rounding of a
// file, 1e-6 with the six digits that OMPL and ROS print, decides between two senses.
constexpr double kNearHalfTurn = 2e-6;

/// Columns of a plan as variables of the tree.
struct PlanColumns {
  std::vector<std::string> names;
  std::vector<int> variables;
  std::vector<int> column;  ///< of each of the tree's variables; -1: the plan has none

  bool has(int v) const { return column[static_cast<std::size_t>(v)] >= 0; }
};

PlanColumns columnsOf(const KinematicTree& tree, const Plan& plan, const MotionOptions& options) {
  PlanColumns out;
  if (!plan.joints.empty() && !plan.joints_counted && !options.joints.empty() && options.joints != plan.joints) {
    refuse(fmt::format("--joints (Python: joints) is {}, and the plan names its joints itself: {}; leave --joints out",
                       fmt::join(options.joints, ", "), fmt::join(plan.joints, ", ")));
  }
  out.names = plan.joints.empty() ? options.joints : plan.joints;
  if (out.names.empty()) {
    for (int v = 0; v < tree.dof(); ++v) out.names.push_back(tree.variableName(v));
    const std::size_t values = plan.positions[0].size();
    if (values != out.names.size()) {  // those that the caller gives stay
      std::vector<std::string> others = unnamedColumns(tree, options);
      if (values == others.size()) out.names = std::move(others);
    }
    if (values != out.names.size()) {
      refuse(fmt::format("waypoint 0 has {} and no names; robot '{}' has {}: {}; name those of the plan by --joints",
                         text::counted(values, "value"), tree.name(), text::counted(out.names.size(), "joint"),
                         variableNames(tree)));
    }
  }
  out.column.assign(static_cast<std::size_t>(tree.dof()), -1);
  for (const std::string& name : out.names) {
    const int variable = variableOf(tree, name, "the plan");
    if (out.has(variable)) refuse(fmt::format("the plan names joint '{}' twice", name));
    out.column[static_cast<std::size_t>(variable)] = static_cast<int>(out.variables.size());
    out.variables.push_back(variable);
  }
  return out;
}

/// The values of all variables that the plan does not name.
VectorXd restOf(const KinematicTree& tree, const Plan& plan, const MotionOptions& options, const PlanColumns& columns,
                std::vector<std::string>& notes) {
  VectorXd q = tree.neutralConfiguration();
  std::vector<bool> known(static_cast<std::size_t>(tree.dof()), false);
  for (const int v : columns.variables) known[static_cast<std::size_t>(v)] = true;
  for (const auto* state : {&options.state, &plan.state}) {
    for (const auto& [name, value] : *state) {
      const auto v = static_cast<std::size_t>(variableOf(tree, name, "the state of the other joints"));
      if (columns.column[v] >= 0) {
        const auto column = static_cast<std::size_t>(columns.column[v]);
        for (std::size_t k = 0; state == &options.state && k < plan.positions.size(); ++k) {
          requireGiven(name, value, plan.positions[k].at(column), fmt::format("waypoint {}", k));
        }
        continue;
      }
      if (!std::isfinite(value)) refuse(fmt::format("the state of joint '{}' is {}", name, value));
      const auto asked = options.state.find(name);
      if (asked != options.state.end() && std::abs(asked->second - value) > kSameValue) {
        notes.push_back(fmt::format("joint '{}' is at {:g}, as asked for; the plan's own start state has it at {:g}",
                                    name, asked->second, value));
      }
      if (known[v]) continue;  // by what the caller says
      q[static_cast<Eigen::Index>(v)] = value;
      known[v] = true;
    }
  }
  std::vector<std::string> unnamed;
  for (int v = 0; v < tree.dof(); ++v) {
    if (!known[static_cast<std::size_t>(v)]) unnamed.push_back(tree.variableName(v));
  }
  if (!unnamed.empty()) refuseUnnamed(unnamed, "the plan");
  // A joint that the plan does not name may stand beyond its limits: a note says so.
  for (int v = 0; v < tree.dof(); ++v) {
    const Joint& joint = tree.joint(tree.variableJoint(v));
    if (columns.has(v) || !hasLimits(joint) || (q[v] >= joint.lower && q[v] <= joint.upper)) continue;
    notes.push_back(fmt::format("joint '{}' stays at {:g}, beyond its limits [{:g}, {:g}]", joint.name, q[v],
                                joint.lower, joint.upper));
  }
  return q;
}

void requireRows(const Plan::Rows& rows, const char* what, std::size_t waypoints, const PlanColumns& columns) {
  if (rows.size() != waypoints)
    refuse(fmt::format("{} {} for {}", rows.size(), what, text::counted(waypoints, "waypoint")));
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (rows[k].size() != columns.names.size()) {
      refuse(fmt::format("waypoint {} has {} {} for {}", k, rows[k].size(), what,
                         text::counted(columns.names.size(), "joint")));
    }
    for (std::size_t j = 0; j < rows[k].size(); ++j) {
      if (std::isfinite(rows[k][j])) continue;
      refuse(fmt::format("waypoint {}, joint '{}': {} of its {} is not a finite number", k, columns.names[j],
                         rows[k][j], what));
    }
  }
}

void requireTimes(const std::vector<double>& times, std::size_t waypoints) {
  if (times.size() != waypoints)
    refuse(fmt::format("{} for {}", text::counted(times.size(), "time"), text::counted(waypoints, "waypoint")));
  for (std::size_t k = 0; k < times.size(); ++k) {
    if (!std::isfinite(times[k])) refuse(fmt::format("waypoint {}: its time {} is not a finite number", k, times[k]));
    if (k > 0 && !(times[k] > times[k - 1])) {
      refuse(fmt::format("waypoint {}: its time {} is not later than that of waypoint {}, {}", k, times[k], k - 1,
                         times[k - 1]));
    }
  }
}

constexpr double kLengthTolerance = 0.1;  // m for a rad, of a tolerance of limits

/// How far a value is beyond a joint's limits; 0 within them.
double beyondLimits(const Joint& joint, double value) {
  return hasLimits(joint) ? std::max({joint.lower - value, value - joint.upper, 0.0}) : 0;
}

/// Whether all would be within their limits if angles were in degrees.
bool areDegrees(const KinematicTree& tree, const Plan& plan, const PlanColumns& columns) {
  for (const std::vector<double>& row : plan.positions) {
    for (std::size_t j = 0; j < row.size(); ++j) {
      const int v = columns.variables[j];
      const double value = tree.isAngle(v) ? row[j] * kRadiansPerDegree : row[j];
      if (beyondLimits(tree.joint(tree.variableJoint(v)), value) > 0) return false;
    }
  }
  return true;
}

/// Adds one note for each joint that is beyond its limits: by how much, and from which waypoint to which.
void judgeLimits(const KinematicTree& tree, const Plan& plan, const PlanColumns& columns, const MotionOptions& options,
                 std::vector<std::string>& notes) {
  for (std::size_t j = 0; j < columns.names.size(); ++j) {
    const int v = columns.variables[j];
    const Joint& joint = tree.joint(tree.variableJoint(v));
    const bool angle = tree.isAngle(v);
    LimitJudge judge(tree, options.limit_tolerance, options.ignore_limits);
    std::size_t first = 0, last = 0, count = 0;
    double most = 0;
    for (std::size_t k = 0; k < plan.positions.size(); ++k) {
      const double value = plan.positions[k][j], beyond = beyondLimits(joint, value);
      if (beyond == 0) continue;
      if (const std::string why = judge.refusal(v, value); !why.empty()) {
        // More than a turn is seldom an angle in rad.
        const bool degrees = angle && !options.degrees && std::abs(value) > kTwoPi && areDegrees(tree, plan, columns);
        refuse(fmt::format("waypoint {}: {}; {}--ignore-limits has it certified all the same", k, why,
                           degrees ? "are these degrees? --degrees says so; " : ""));
      }
      if (count++ == 0) first = k;
      last = k;
      most = std::max(most, beyond);
    }
    if (count == 0) continue;
    const std::string where = count == 1 ? fmt::format("waypoint {} is", first)
                              : count == last - first + 1
                                  ? fmt::format("waypoints {} to {} are", first, last)
                                  : fmt::format("{} waypoints from {} to {} are", count, first, last);
    notes.push_back(fmt::format("joint '{}': {} beyond its limits [{}, {}], by at most {:.2g} {}", joint.name, where,
                                joint.lower, joint.upper, most, angle ? "rad" : "m"));
  }
}

/// Notes a start state that is not the first waypoint: the controller goes from one to the other, and this way is not
/// checked.
void noteStart(const Plan& plan, const PlanColumns& columns, std::vector<std::string>& notes) {
  for (std::size_t j = 0; j < columns.names.size(); ++j) {
    const auto start = plan.state.find(columns.names[j]);
    if (start == plan.state.end() || std::abs(start->second - plan.positions[0][j]) <= kSameValue) continue;
    notes.push_back(
        fmt::format("joint '{}' begins at {:g}, the start state has it at {:g}: the way there is no part of "
                    "the plan",
                    columns.names[j], plan.positions[0][j], start->second));
  }
}

JointTrajectory::Unwrap judgeTurns(const KinematicTree& tree, const Plan& plan, const PlanColumns& columns,
                                   Turns turns) {
  if (turns == Turns::shortest) return JointTrajectory::Unwrap::yes;
  if (turns == Turns::given) return JointTrajectory::Unwrap::no;
  for (std::size_t j = 0; j < columns.names.size(); ++j) {
    const int v = columns.variables[j];
    const Joint& joint = tree.joint(tree.variableJoint(v));
    const bool forever = joint.type == JointType::continuous || (joint.type == JointType::planar && tree.isAngle(v));
    for (std::size_t k = 1; forever && k < plan.positions.size(); ++k) {
      const double step = plan.positions[k][j] - plan.positions[k - 1][j];
      if (std::abs(step) < kPi) continue;
      refuse(
          fmt::format("joint '{}' turns forever and goes by {:g} rad from waypoint {} to {}: --turns given takes it "
                      "at its word, --turns shortest goes the shorter way round",
                      columns.names[j], step, k - 1, k));
    }
  }
  return JointTrajectory::Unwrap::no;
}

/// Refuses steps of half a turn: both ways are as long, and planners and controllers differ in the one that they take.
void requireSenses(const KinematicTree& tree, const std::vector<VectorXd>& q) {
  for (JointId j = 0; j < tree.numJoints(); ++j) {
    const int v = tree.quaternionVariable(j);
    for (std::size_t k = 1; v >= 0 && k < q.size(); ++k) {
      const Eigen::Vector4d from = q[k - 1].segment<4>(v), to = q[k].segment<4>(v);
      if (!(std::abs(from.dot(to)) <= kNearHalfTurn * from.norm() * to.norm())) continue;
      if (from.isZero(0) || to.isZero(0)) continue;  // refused as no rotation
      refuse(
          fmt::format("waypoint {}: joint '{}' turns by half a turn from waypoint {}, which says not which way round: "
                      "a waypoint between them says it",
                      k, tree.joint(j).name, k - 1));
    }
  }
}

/// joint_trajectory_controller runs single values.
void requireNoQuaternions(const KinematicTree& tree, const std::vector<VectorXd>& q, Interpolation kind) {
  for (const JointId j : tree.quaternionJoints()) {
    const int v = tree.quaternionVariable(j);
    for (const VectorXd& one : q) {
      if (one.segment<4>(v) == q[0].segment<4>(v)) continue;
      refuse(fmt::format("joint '{}' has a quaternion, and {} runs none", tree.joint(j).name, toString(kind)));
    }
  }
}

/// Rows of some columns as vectors of all variables.
std::vector<VectorXd> spread(const Plan::Rows& rows, const PlanColumns& columns, const VectorXd& rest) {
  std::vector<VectorXd> out;
  for (const std::vector<double>& row : rows) {
    VectorXd& q = out.emplace_back(rest);
    for (std::size_t j = 0; j < row.size(); ++j) q[columns.variables[j]] = row[j];
  }
  return out;
}

}  // namespace

LimitJudge::LimitJudge(const KinematicTree& tree, double tolerance, bool ignore)
    : tree_(tree), tolerance_(tolerance), ignore_(ignore), most_(static_cast<std::size_t>(tree.dof()), 0) {}

std::string LimitJudge::refusal(int v, double value) {
  const Joint& joint = tree_.joint(tree_.variableJoint(v));
  const double beyond = beyondLimits(joint, value);
  const double tolerance = tolerance_ * (tree_.isAngle(v) ? 1 : kLengthTolerance);
  if (beyond > tolerance && !ignore_) {
    return fmt::format("joint '{}' at {} is beyond its limits [{}, {}]", joint.name, value, joint.lower, joint.upper);
  }
  double& most = most_[static_cast<std::size_t>(v)];
  most = std::max(most, beyond);
  return {};
}

std::vector<std::string> LimitJudge::notes() const {
  std::vector<std::string> notes;
  for (int v = 0; v < tree_.dof(); ++v) {
    const double most = most_[static_cast<std::size_t>(v)];
    if (most == 0) continue;
    const Joint& joint = tree_.joint(tree_.variableJoint(v));
    notes.push_back(fmt::format("joint '{}': some values are beyond its limits [{}, {}], by at most {:.2g} {}",
                                joint.name, joint.lower, joint.upper, most, tree_.isAngle(v) ? "rad" : "m"));
  }
  return notes;
}

Plan inRadians(const KinematicTree& tree, const Plan& plan) {
  if (plan.has_degrees) refuse("values end with deg, and --degrees says that all angles are in degrees: leave one out");
  Plan out = plan;
  double most = 0;
  std::vector<bool> angles;
  for (const std::string& joint : plan.joints) angles.push_back(tree.isAngle(variableOf(tree, joint, "the plan")));
  for (Plan::Rows* rows : {&out.positions, &out.velocities, &out.accelerations}) {
    for (std::vector<double>& row : *rows) {
      for (std::size_t j = 0; j < std::min(row.size(), angles.size()); ++j) {
        if (angles[j] && rows == &out.positions) most = std::max(most, std::abs(row[j]));
        if (angles[j]) row[j] *= kRadiansPerDegree;
      }
    }
  }
  for (auto& [name, value] : out.state) {
    if (tree.isAngle(variableOf(tree, name, "the state of the other joints"))) value *= kRadiansPerDegree;
  }
  if (most <= kTwoPi) out.notes.push_back(fmt::format("no angle is beyond {:.3g} deg: are these radians?", most));
  return out;
}

std::vector<std::string> unnamedColumns(const KinematicTree& tree, const MotionOptions& options) {
  if (!options.joints.empty()) return options.joints;
  std::vector<std::string> names;
  for (int v = 0; v < tree.dof(); ++v) {
    if (options.state.count(tree.variableName(v)) == 0) names.push_back(tree.variableName(v));
  }
  return names;
}

std::size_t PlanMotion::waypointBefore(double t) const {
  const auto after = std::upper_bound(times.begin(), times.end(), t);
  return after == times.begin() ? 0 : static_cast<std::size_t>(after - times.begin()) - 1;
}

PlanMotion toMotion(const KinematicTree& tree, const Plan& given, const MotionOptions& options) {
  if (!given.error.empty()) refuse(given.error);
  const std::size_t waypoints = given.positions.size();
  if (waypoints < 2) refuse(fmt::format("it has {}, a plan needs two", text::counted(waypoints, "waypoint")));
  const PlanColumns columns = columnsOf(tree, given, options);
  Plan plan = given;
  if (options.degrees) {
    plan.joints = columns.names;
    plan = inRadians(tree, plan);
    plan.joints = given.joints;
  }
  std::vector<std::string> notes = notesOf(plan, options.degrees);
  requireRows(plan.positions, "positions", waypoints, columns);
  const VectorXd rest = restOf(tree, plan, options, columns, notes);
  if (!plan.velocities.empty()) requireRows(plan.velocities, "velocities", waypoints, columns);
  if (!plan.accelerations.empty()) requireRows(plan.accelerations, "accelerations", waypoints, columns);
  const bool timed = !plan.times.empty();
  std::vector<double> times = plan.times;
  for (std::size_t k = 0; !timed && k < waypoints; ++k) times.push_back(static_cast<double>(k));
  requireTimes(times, waypoints);
  judgeLimits(tree, plan, columns, options, notes);
  const JointTrajectory::Unwrap unwrap = judgeTurns(tree, plan, columns, turnsOf(options.interpolation, options.turns));
  const Interpolation kind =
      curveOf(options.interpolation, {timed, !plan.velocities.empty(), !plan.accelerations.empty()});
  if (timed && times.front() > 0) {
    notes.push_back(
        fmt::format("the first waypoint is at t = {:g}: the way to it is no part of the plan", times.front()));
  }

  noteStart(plan, columns, notes);

  std::vector<VectorXd> q = spread(plan.positions, columns, rest);
  requireSenses(tree, q);
  if (isController(options.interpolation)) requireNoQuaternions(tree, q, options.interpolation);
  if (kind == Interpolation::jtcNone) {
    notes.emplace_back(
        "the controller jumps from waypoint to waypoint, and does not say how the joints get there: certified is that "
        "all of them go straight, together");
  }
  if (kind == Interpolation::jtcUpsampled && !timed) {
    notes.emplace_back("it has no times: its waypoints follow each other at equal times, as by policy_frequency");
  }
  const VectorXd zero = VectorXd::Zero(tree.dof());
  const Waypoints through{times, q, spread(plan.velocities, columns, zero), spread(plan.accelerations, columns, zero)};
  std::map<std::string, double> others;
  for (int v = 0; v < tree.dof(); ++v) {
    if (!columns.has(v)) others[tree.variableName(v)] = rest[v];
  }
  JointTrajectory motion = makeTrajectory(tree, kind, through, options.blend, unwrap);
  return {kind,         columns.names,     !plan.joints.empty() && !plan.joints_counted,
          plan.foreign, std::move(others), std::move(times),
          std::move(q), std::move(motion), timed,
          plan.part,    std::move(notes)};
}

void requireClock(const PlanMotion& motion) {
  if (!motion.timed) {
    throw std::invalid_argument(
        "the plan has no times, and an object moves by itself meanwhile, nobody knows how far: give the plan times, or "
        "the object no speed");
  }
  if (motion.part) {
    throw std::invalid_argument(
        "the plan is a part of a message, carried out after or before others, and an object moves by itself all the "
        "while: join the parts to one plan, or give the object no speed");
  }
}

}  // namespace fcl_artic::plans
