// SPDX-License-Identifier: BSD-3-Clause
#include "fcl_artic_moveit/certifier.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "carried.h"
#include "numbers.h"

namespace fcl_artic_moveit {
namespace {

using fcl_artic::Status;

/// A contact's pair, and what became of it.
void tell(std::ostream& out, const Verdict& verdict, const Verdict::Contact& contact) {
  out << contact.body1 << " and " << contact.body2;
  if (contact.padding + verdict.margin == 0) {
    out << (contact.certain ? " touch" : " come so near that contact can't be excluded");
    if (!verdict.tolerances.empty()) out << " within the tolerances (" << verdict.tolerances << ')';
    return;
  }
  out << (contact.certain ? " come nearer than " : " come so near that it can't be excluded that they are nearer than ")
      << contact.padding + verdict.margin << " m";
  if (contact.padding > 0) out << " (padding " << contact.padding << " m";
  if (verdict.margin > 0) out << (contact.padding > 0 ? ", margin " : " (margin ") << verdict.margin << " m";
  if (!verdict.tolerances.empty()) out << "; tolerances: " << verdict.tolerances;
  out << ')';
}

/// As plain numbers; what is below any accuracy is 0.
std::string shown(const Eigen::Vector3d& v) {
  constexpr double kNothing = 1e-12;  // m, or of a unit vector: what rounding makes of 1 km
  std::ostringstream out;
  for (int i = 0; i < 3; ++i) out << (i ? " " : "") << (std::abs(v[i]) < kNothing ? 0 : v[i]);
  return out.str();
}

std::string messageOf(const Verdict& verdict, const std::string& frame) {
  std::ostringstream out;
  out.precision(6);
  const char* unit = verdict.timed ? " s" : " (numbers of waypoints)";
  switch (verdict.status) {
    case Status::free:
      out << "free: proven for " << verdict.pairs << " pairs of bodies until t = " << verdict.t_lower << unit << " ("
          << toString(verdict.interpolation) << " between " << verdict.waypoints << " waypoints)";
      if (!verdict.tolerances.empty()) out << ", for every path within " << verdict.tolerances;
      if (verdict.pairs == 0) out << "; no pair of bodies was to be checked";
      break;
    case Status::contact: {
      const Verdict::Contact& contact = verdict.contacts.at(0);
      tell(out, verdict, contact);
      out << " at t = " << verdict.t_lower << unit << ", after waypoint " << verdict.waypoint << " of "
          << verdict.waypoints << " (counted from 0; " << toString(verdict.interpolation) << " between them), at "
          << shown(contact.point) << " in '" << frame << "', normal " << shown(contact.normal) << ", with";
      for (const auto& [name, value] : verdict.joints) out << ' ' << name << " = " << value;
      out << ". The motion is proven free before.";
      for (std::size_t i = 1; i < verdict.contacts.size(); ++i) {
        out << (i == 1 ? " Until the next waypoint also: " : "; ");
        tell(out, verdict, verdict.contacts[i]);
        out << " at t = " << verdict.contacts[i].t;
        if (i + 1 == verdict.contacts.size()) out << '.';
      }
      out << " Waypoints that are valid exclude no contact between them: plan again with a finer "
          << "longest_valid_segment_fraction or with padding, or allow the pair in the allowed collision matrix if it "
          << "may touch.";
      break;
    }
    case Status::undecided:
      out << "undecided: " << (verdict.out_of_time ? "the time" : "the budget")
          << " ran out; the motion is proven free until t = " << verdict.t_lower << unit << ". "
          << (verdict.out_of_time ? "Raise `allowed_planning_time` or the parameter `time_limit`."
                                  : "Raise the parameter `budget`; 0 is no limit.");
      break;
  }
  return out.str();
}

Verdict::Contact contactOf(const Cell& cell, const fcl_artic::CertifiedContact& from, double t, bool certain) {
  Verdict::Contact out;
  out.body1 = cell.nameOf(from.body1);
  out.body2 = cell.nameOf(from.body2);
  out.t = t;
  out.certain = certain;
  out.point = from.point;
  out.normal = from.normal;
  out.padding = cell.paddingBetween(from.body1, from.body2);
  return out;
}

bool sameBodies(const Verdict::Contact& a, const Verdict::Contact& b) {
  const auto is = [](const BodyName& one, const BodyName& other) {
    return one.kind == other.kind && one.id == other.id;
  };
  return (is(a.body1, b.body1) && is(a.body2, b.body2)) || (is(a.body1, b.body2) && is(a.body2, b.body1));
}

/// The first contacts of the other pairs that touch between the two waypoints of the first one.
void addOthers(const Cell& cell, const Motion& motion, fcl_artic::CertifiedRequest request, Verdict& verdict) {
  constexpr std::size_t kMax = 1000;
  request.mode = fcl_artic::ContactMode::firstOfEveryPair;
  request.max_contacts = kMax;
  const std::size_t before = std::min(verdict.waypoint, motion.times.size() - 2);
  const std::vector<double>& times = motion.trajectory.times();  // blends have more pieces than waypoints
  for (std::size_t k = 0; k < motion.trajectory.numPieces(); ++k) {
    if (times[k + 1] <= motion.times[before] || times[k] >= motion.times[before + 1]) continue;
    const fcl_artic::CertifiedResult result = cell.manager().continuousCollide(motion.trajectory.piece(k), request);
    for (const fcl_artic::CertifiedContact& one : result.contacts) {
      const double t = times[k] + one.t_lower * (times[k + 1] - times[k]);
      Verdict::Contact contact = contactOf(cell, one, t, one.certain);
      const auto known = [&](const Verdict::Contact& other) { return sameBodies(contact, other); };
      if (std::none_of(verdict.contacts.begin(), verdict.contacts.end(), known)) {
        verdict.contacts.push_back(std::move(contact));
      }
    }
  }
}

Verdict answer(const Cell& cell, const robot_trajectory::RobotTrajectory& trajectory, const CertifierOptions& options) {
  using Clock = std::chrono::steady_clock;
  const Motion motion = toMotion(cell.robot(), trajectory, options.motion);
  Verdict verdict;
  fcl_artic::CertifiedRequest request;
  request.added_margin = options.margin;
  request.work_budget = options.budget;
  const Clock::time_point begin = Clock::now();
  if (options.time_limit > 0) {
    request.progress = [&](double) {
      if (Clock::now() - begin <= std::chrono::duration<double>(options.time_limit)) return true;
      verdict.out_of_time = true;
      return false;
    };
  }
  const fcl_artic::CertifiedResult result = cell.manager().continuousCollide(motion.trajectory, request);
  static_cast<fcl_artic::Bracket&>(verdict) = result;
  verdict.interpolation = motion.interpolation;
  verdict.timed = motion.timed;
  verdict.waypoints = trajectory.getWayPointCount();
  verdict.pairs = result.statistics.pairs;
  verdict.notes = motion.notes;
  for (std::string& note : cell.manager().notes()) verdict.notes.push_back(std::move(note));
  verdict.margin = options.margin;
  verdict.tolerances = cell.tolerances();
  if (const fcl_artic::CertifiedContact* first = result.first()) {
    verdict.waypoint = motion.waypointBefore(result.t_lower);
    verdict.contacts.push_back(contactOf(cell, *first, result.t_lower, result.certain));
    const fcl_artic::KinematicTree& tree = *cell.robot().tree;
    const bool witness = first->q_witness.size() > 0;
    const Eigen::VectorXd q = witness ? first->q_witness : motion.trajectory.configuration(result.t_lower);
    for (int v = 0; v < tree.dof(); ++v) {
      const std::string& joint = tree.joint(tree.variableJoint(v)).name;
      if (!movesWith(trajectory.getGroup(), *trajectory.getRobotModel()->getJointModel(joint))) continue;
      verdict.joints.emplace_back(tree.variableName(v), q[v]);
    }
    addOthers(cell, motion, request, verdict);
  }
  verdict.message = messageOf(verdict, trajectory.getRobotModel()->getModelFrame());
  return verdict;
}

}  // namespace

void CertifierOptions::check() const {
  requireAtLeast0("the margin", margin, " m");
  requireAtLeast0("joint_tolerance_angle", tolerances.joints.angle, " rad");
  requireAtLeast0("joint_tolerance_length", tolerances.joints.length, " m");
  for (const auto& [joint, value] : tolerances.own) requireAtLeast0("joint_tolerances: " + joint, value);
  requireAtLeast0("base_tolerance_length", tolerances.base.length, " m");
  requireAtLeast0("base_tolerance_angle", tolerances.base.angle, " rad");
  requireAtLeast0("object_tolerance", tolerances.objects, " m");
  requireAtLeast0("the mimic tolerance", motion.mimic_tolerance);
  requireAtLeast0("the time limit", time_limit, " s");
  requireAtLeast0("the blend", motion.blend, " s");
  if (motion.interpolation == Interpolation::blends && motion.blend == 0) {
    throw std::invalid_argument("interpolation blends needs a blend above 0 s");
  }
  (void)fcl_artic::turnsOf(motion.interpolation, motion.turns);
}

Certifier::Certifier() = default;
Certifier::~Certifier() = default;

Verdict Certifier::certify(const planning_scene::PlanningScene& scene,
                           const robot_trajectory::RobotTrajectory& trajectory, const CertifierOptions& options) const {
  return certify(*scene.getCollisionEnv(), scene.getAllowedCollisionMatrix(), trajectory, &scene.getCurrentState(),
                 options);
}

Verdict Certifier::certify(const collision_detection::CollisionEnv& env,
                           const collision_detection::AllowedCollisionMatrix& acm,
                           const robot_trajectory::RobotTrajectory& trajectory, const moveit::core::RobotState* start,
                           const CertifierOptions& options) const {
  options.check();
  requireSameBodies(trajectory);
  if (start) requireBodiesOf(*start, trajectory.getWayPoint(0));
  std::unique_ptr<Cell> cell = idleCell(trajectory.getRobotModel());
  // If this throws, the cell goes.
  cell->update(env, acm, trajectory.getWayPoint(0), trajectory.getGroup(), options.tolerances);
  try {
    Verdict verdict = answer(*cell, trajectory, options);
    giveBack(std::move(cell));
    return verdict;
  } catch (...) {
    giveBack(std::move(cell));
    throw;
  }
}

std::unique_ptr<Cell> Certifier::idleCell(const moveit::core::RobotModelConstPtr& model) const {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    while (!idle_.empty()) {
      std::unique_ptr<Cell> cell = std::move(idle_.back());
      idle_.pop_back();
      if (cell->model() == model) return cell;  // models change rarely, and then for all
    }
  }
  return std::make_unique<Cell>(model);
}

void Certifier::giveBack(std::unique_ptr<Cell> cell) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  idle_.push_back(std::move(cell));
}

}  // namespace fcl_artic_moveit
