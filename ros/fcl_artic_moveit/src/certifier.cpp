// SPDX-License-Identifier: BSD-3-Clause
#include "fcl_artic_moveit/certifier.h"

#include <cmath>
#include <map>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace fcl_artic_moveit {
namespace {

using fcl_artic::Status;
using moveit::core::AttachedBody;
using moveit::core::RobotState;

bool sameBody(const AttachedBody& a, const AttachedBody& b) {
  if (a.getAttachedLinkName() != b.getAttachedLinkName() || a.getShapes() != b.getShapes() ||
      a.getTouchLinks() != b.getTouchLinks()) {
    return false;
  }
  for (std::size_t i = 0; i < a.getShapePosesInLinkFrame().size(); ++i) {
    if (!a.getShapePosesInLinkFrame()[i].isApprox(b.getShapePosesInLinkFrame()[i])) return false;
  }
  return true;
}

/// A trajectory along which bodies come and go is none that a manager is asked about.
void requireSameBodies(const robot_trajectory::RobotTrajectory& trajectory) {
  if (trajectory.getWayPointCount() == 0) throw std::invalid_argument("the trajectory has no waypoint");
  std::map<std::string, const AttachedBody*> first, here;
  trajectory.getWayPoint(0).getAttachedBodies(first);
  for (std::size_t k = 1; k < trajectory.getWayPointCount(); ++k) {
    here.clear();
    trajectory.getWayPoint(k).getAttachedBodies(here);
    for (const auto* all : {&first, &here}) {
      for (const auto& [name, body] : *all) {
        const auto a = first.find(name), b = here.find(name);
        if (a != first.end() && b != here.end() && sameBody(*a->second, *b->second)) continue;
        throw std::invalid_argument("waypoint " + std::to_string(k) + " does not carry '" + name +
                                    "' as waypoint 0 does");
      }
    }
  }
}

/// Whether they are one body, maybe made of a message twice, each time with shapes of its own.
bool likeBody(const AttachedBody& a, const AttachedBody& b) {
  if (a.getAttachedLinkName() != b.getAttachedLinkName() || a.getShapes().size() != b.getShapes().size()) return false;
  for (std::size_t i = 0; i < a.getShapes().size(); ++i) {
    if (a.getShapes()[i]->type != b.getShapes()[i]->type) return false;
    if (!a.getShapePosesInLinkFrame()[i].isApprox(b.getShapePosesInLinkFrame()[i])) return false;
  }
  return true;
}

/// A planner whose waypoints have lost what the robot carries leaves a trajectory of another robot.
void requireBodiesOf(const RobotState& start, const RobotState& first) {
  std::map<std::string, const AttachedBody*> carried, here;
  start.getAttachedBodies(carried);
  first.getAttachedBodies(here);
  for (const auto& [name, body] : carried) {
    const auto found = here.find(name);
    if (found != here.end() && likeBody(*body, *found->second)) continue;
    throw std::invalid_argument("the robot starts with '" + name + "' on link '" + body->getAttachedLinkName() +
                                "', and waypoint 0 " +
                                (found == here.end() ? "does not carry it" : "carries it otherwise"));
  }
}

std::ostream& operator<<(std::ostream& out, const BodyName& body) {
  const char* kind[] = {"link", "attached body", "object"};
  return out << kind[body.kind] << " '" << body.id << '\'';
}

std::string messageOf(const Verdict& verdict, const std::string& frame) {
  std::ostringstream out;
  out.precision(6);
  const char* unit = verdict.timed ? " s" : " (numbers of waypoints)";
  switch (verdict.status) {
    case Status::free:
      out << "free: proven for " << verdict.pairs << " pairs of bodies until t = " << verdict.t_lower << unit << " ("
          << toString(verdict.interpolation) << " between " << verdict.waypoints << " waypoints)";
      if (verdict.pairs == 0) out << "; no pair of bodies was to be checked";
      break;
    case Status::contact: {
      const Verdict::Contact& contact = verdict.contact;
      out << contact.body1 << " and " << contact.body2;
      if (verdict.certain) {
        out << " touch";
      } else {
        out << " come so near that contact can't be excluded";
      }
      out << " at t = " << verdict.t_lower << unit << ", after waypoint " << contact.waypoint << " of "
          << verdict.waypoints << " (counted from 0; " << toString(verdict.interpolation) << " between them), at "
          << contact.point.transpose() << " in '" << frame << "', normal " << contact.normal.transpose()
          << ". The motion is proven free before. Waypoints that are valid exclude no "
          << "contact between them: plan again with a finer longest_valid_segment_fraction or with padding, or allow "
          << "the pair in the allowed collision matrix if it may touch.";
      break;
    }
    case Status::undecided:
      out << "undecided: the budget ran out; the motion is proven free until t = " << verdict.t_lower << unit
          << ". Raise the parameter `budget`; 0 is no limit.";
      break;
  }
  return out.str();
}

}  // namespace

Certifier::Certifier(CertifierOptions options) : options_(std::move(options)) {
  if (!std::isfinite(options_.margin) || options_.margin < 0) {
    throw std::invalid_argument("the margin " + std::to_string(options_.margin) + " m is not 0 or more");
  }
}

Certifier::~Certifier() = default;

Verdict Certifier::certify(const collision_detection::CollisionEnv& env,
                           const collision_detection::AllowedCollisionMatrix& acm,
                           const robot_trajectory::RobotTrajectory& trajectory,
                           const moveit::core::RobotState* start) const {
  requireSameBodies(trajectory);
  if (start) requireBodiesOf(*start, trajectory.getWayPoint(0));
  std::unique_ptr<Cell> cell = idleCell(trajectory.getRobotModel());
  cell->update(env, acm, trajectory.getWayPoint(0), trajectory.getGroup());  // if this throws, the cell goes
  try {
    Verdict verdict = answer(*cell, trajectory);
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

Verdict Certifier::answer(const Cell& cell, const robot_trajectory::RobotTrajectory& trajectory) const {
  const Motion motion = toMotion(cell.robot(), trajectory, options_.motion);

  fcl_artic::CertifiedRequest request;
  request.added_margin = options_.margin;
  request.work_budget = options_.budget;
  const fcl_artic::CertifiedResult result = cell.manager().continuousCollide(motion.trajectory, request);

  Verdict verdict;
  static_cast<fcl_artic::Bracket&>(verdict) = result;
  verdict.interpolation = motion.interpolation;
  verdict.timed = motion.timed;
  verdict.waypoints = trajectory.getWayPointCount();
  verdict.pairs = result.statistics.pairs;
  verdict.notes = motion.notes;
  if (const fcl_artic::CertifiedContact* first = result.first()) {
    verdict.contact.body1 = cell.nameOf(first->body1);
    verdict.contact.body2 = cell.nameOf(first->body2);
    verdict.contact.waypoint = motion.waypointBefore(result.t_lower);
    verdict.contact.point = first->point;
    verdict.contact.normal = first->normal;
  }
  verdict.message = messageOf(verdict, trajectory.getRobotModel()->getModelFrame());
  return verdict;
}

}  // namespace fcl_artic_moveit
