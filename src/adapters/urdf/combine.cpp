// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <set>
#include <stdexcept>

#include "fcl_artic/urdf/urdf.h"

namespace fcl_artic {
namespace {

/// Adds the pairs of a part's matrix to the matrix of all robots, under the names that the links have there.
/// @param spelt_out  whether a complete matrix's rule for neighbours must be written pair by pair, as the matrix of all
///   robots is not complete.
void addAllowed(const PlacedRobot& part, bool spelt_out, AllowedCollisionMatrix& all) {
  const AllowedCollisionMatrix& own = part.robot->allowed;
  if (spelt_out && own.complete()) {
    std::set<std::string> names;
    for (const LinkGeometry& g : part.robot->geometry) names.insert(part.robot->tree->linkName(g.link));
    for (auto a = names.begin(); a != names.end(); ++a) {
      for (auto b = std::next(a); b != names.end(); ++b) all.disallow(part.prefix + *a, part.prefix + *b);
    }
  }
  for (const auto& [a, b] : own.disallowedPairs()) all.disallow(part.prefix + a, part.prefix + b);
  for (const auto& [a, b] : own.pairs()) all.allow(part.prefix + a, part.prefix + b);
}

}  // namespace

Robot combineRobots(const std::vector<PlacedRobot>& parts, const std::string& name) {
  auto tree = std::make_shared<KinematicTree>(name);
  std::vector<Joint> joints;  // of all parts
  Robot all;
  const bool complete = !parts.empty() && std::all_of(parts.begin(), parts.end(), [](const PlacedRobot& part) {
    return part.robot && part.robot->allowed.complete();
  });
  all.allowed.setComplete(complete);
  for (const PlacedRobot& part : parts) {
    if (!part.robot || !part.robot->tree) throw std::invalid_argument("combineRobots: a robot is null");
    const KinematicTree& own = *part.robot->tree;
    const auto named = [&](const std::string& own_name) { return part.prefix + own_name; };
    // Each root gets a mount of its own: robots that stand side by side, also those that were combined before, are no
    // neighbours of each other.
    std::vector<LinkId> roots;
    for (LinkId l = 0; l < own.numLinks(); ++l) {
      if (own.parentJoint(l) < 0) roots.push_back(l);
    }
    const auto mountOf = [&](LinkId root) {
      return roots.size() == 1 ? named("mount") : named("mount_of_" + own.linkName(root));
    };
    for (const LinkId root : roots) tree->addLink(mountOf(root));
    std::vector<LinkId> link(static_cast<std::size_t>(own.numLinks()));
    for (LinkId l = 0; l < own.numLinks(); ++l) {
      link[static_cast<std::size_t>(l)] = tree->addLink(named(own.linkName(l)));
    }
    for (const LinkId l : roots) {
      Joint& joint = joints.emplace_back();
      joint.name = named("mount_to_" + own.linkName(l));
      joint.parent = mountOf(l);
      joint.child = named(own.linkName(l));
      joint.origin = part.base;
    }
    // In their own order: masters come before those that mimic them, and variables stay in order.
    for (JointId j = 0; j < own.numJoints(); ++j) {
      Joint joint = own.joint(j);
      joint.name = named(joint.name);
      joint.parent = named(joint.parent);
      joint.child = named(joint.child);
      if (joint.mimics) joint.mimic.master = named(joint.mimic.master);
      joints.push_back(std::move(joint));
    }
    for (LinkGeometry geometry : part.robot->geometry) {
      geometry.link = link[static_cast<std::size_t>(geometry.link)];
      // Each gets an object of its own, as one robot may be there twice; the geometry is shared.
      const fcl::CollisionObjectd& object = *geometry.object;
      geometry.object = std::make_shared<fcl::CollisionObjectd>(
          std::const_pointer_cast<fcl::CollisionGeometryd>(object.collisionGeometry()), object.getTransform());
      all.geometry.push_back(std::move(geometry));
    }
    addAllowed(part, !complete, all.allowed);
    for (const std::string& note : part.robot->notes) all.notes.push_back(note);
  }
  tree->addJoints(joints);
  all.tree = std::move(tree);
  return all;
}

}  // namespace fcl_artic
