// SPDX-License-Identifier: BSD-3-Clause
#include "carried.h"

#include <map>
#include <stdexcept>
#include <string>

#include <geometric_shapes/shapes.h>
#include <moveit/robot_state/attached_body.hpp>

namespace fcl_artic_moveit {
namespace {

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

/// Whether they are one body, maybe made of a message twice, each time with shapes of its own.
bool likeBody(const AttachedBody& a, const AttachedBody& b) {
  if (a.getAttachedLinkName() != b.getAttachedLinkName() || a.getShapes().size() != b.getShapes().size()) return false;
  for (std::size_t i = 0; i < a.getShapes().size(); ++i) {
    if (a.getShapes()[i]->type != b.getShapes()[i]->type) return false;
    if (!a.getShapePosesInLinkFrame()[i].isApprox(b.getShapePosesInLinkFrame()[i])) return false;
  }
  return true;
}

}  // namespace

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

}  // namespace fcl_artic_moveit
