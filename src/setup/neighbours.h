// SPDX-License-Identifier: BSD-3-Clause
//
// Which links of a tree are neighbours, and which of two carries the other.
#pragma once

#include <set>

#include "fcl_artic/kinematic_tree.h"

namespace fcl_artic {

/// The link that moves this one: the nearest at or above it with a joint that is not fixed. It is -1 for the world,
/// where roots and what is fixed to them stand, and obstacles (link -1).
inline LinkId carrierOf(const KinematicTree& tree, LinkId link) {
  while (link >= 0) {
    const JointId joint = tree.parentJoint(link);
    if (joint >= 0 && tree.joint(joint).type != JointType::fixed) return link;
    link = tree.parentLink(link);
  }
  return link;
}

/// Joined by one moving joint at most, which leaves none of them free, over links without geometry only.
bool areNeighbours(const KinematicTree& tree, const std::set<LinkId>& with_geometry, LinkId a, LinkId b);

/// Whether `below` is the link itself or a descendant of it.
bool linkAbove(const KinematicTree& tree, LinkId above, LinkId below);

}  // namespace fcl_artic
