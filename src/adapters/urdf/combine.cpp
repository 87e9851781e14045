// SPDX-License-Identifier: BSD-3-Clause
#include <stdexcept>

#include "fcl_artic/urdf/urdf.h"

namespace fcl_artic {

Robot combineRobots(const std::vector<PlacedRobot>& parts, const std::string& name) {
  auto tree = std::make_shared<KinematicTree>(name);
  Robot all;
  for (const PlacedRobot& part : parts) {
    if (!part.robot || !part.robot->tree) throw std::invalid_argument("combineRobots: a robot is null");
    const KinematicTree& own = *part.robot->tree;
    const auto named = [&](const std::string& own_name) { return part.prefix + own_name; };
    // A root of its own for each: robots that stand side by side are no neighbours of each other.
    tree->addLink(named("mount"));
    std::vector<LinkId> link(static_cast<std::size_t>(own.numLinks()));
    for (LinkId l = 0; l < own.numLinks(); ++l) {
      link[static_cast<std::size_t>(l)] = tree->addLink(named(own.linkName(l)));
    }
    for (LinkId l = 0; l < own.numLinks(); ++l) {
      if (own.parentJoint(l) >= 0) continue;
      Joint joint;
      joint.name = named("mount_to_" + own.linkName(l));
      joint.parent = named("mount");
      joint.child = named(own.linkName(l));
      joint.origin = part.base;
      tree->addJoint(joint);
    }
    // In their own order: masters come before those that mimic them, and variables stay in order.
    for (JointId j = 0; j < own.numJoints(); ++j) {
      Joint joint = own.joint(j);
      joint.name = named(joint.name);
      joint.parent = named(joint.parent);
      joint.child = named(joint.child);
      if (joint.mimics) joint.mimic.master = named(joint.mimic.master);
      tree->addJoint(joint);
    }
    for (LinkGeometry geometry : part.robot->geometry) {
      geometry.link = link[static_cast<std::size_t>(geometry.link)];
      // An object for each, as one robot may be there twice; what they show is shared.
      const fcl::CollisionObjectd& object = *geometry.object;
      geometry.object = std::make_shared<fcl::CollisionObjectd>(
          std::const_pointer_cast<fcl::CollisionGeometryd>(object.collisionGeometry()), object.getTransform());
      all.geometry.push_back(std::move(geometry));
    }
    for (const auto& [a, b] : part.robot->allowed.pairs()) all.allowed.allow(named(a), named(b));
    for (const std::string& note : part.robot->notes) all.notes.push_back(note);
  }
  all.tree = std::move(tree);
  return all;
}

}  // namespace fcl_artic
