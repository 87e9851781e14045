// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>

#include "detail.h"
#include "fcl_artic/urdf/urdf.h"

namespace fcl_artic {
namespace detail {

double slideUpper(const KinematicTree& tree, JointId j) {
  const Joint& joint = tree.joint(j);
  switch (joint.type) {
    case JointType::fixed:
    case JointType::revolute:
    case JointType::continuous:
    case JointType::spherical:
      return 0;
    case JointType::planar:
    case JointType::floating:
      return std::numeric_limits<double>::infinity();
    case JointType::prismatic:
      break;
  }
  const Joint& driver = tree.joint(tree.variableJoint(tree.jointVariable(j)));
  if (!hasLimits(driver)) return std::numeric_limits<double>::infinity();
  const double most = std::max(std::abs(driver.lower), std::abs(driver.upper));
  return joint.mimics ? std::abs(joint.mimic.multiplier) * most + std::abs(joint.mimic.offset) : most;
}

}  // namespace detail

namespace {

/// The same, with joints without limits at rest at 0, as planar and floating ones are.
double limitedSlide(const KinematicTree& tree, JointId j) {
  const double slide = detail::slideUpper(tree, j);
  return std::isfinite(slide) ? slide : 0;
}

/// Whether the joint says where in the world the robot stands, if its parent is a root that carries nothing else.
bool isMount(const Joint& joint) {
  return joint.type == JointType::fixed || joint.type == JointType::planar || joint.type == JointType::floating;
}

}  // namespace

double reachUpper(const KinematicTree& tree, const std::vector<LinkGeometry>& geometry) {
  std::vector<double> reach(static_cast<std::size_t>(tree.numLinks()), 0);  // from the link's own origin
  const auto of = [&](LinkId link) -> double& { return reach.at(static_cast<std::size_t>(link)); };
  std::vector<bool> carries(reach.size());
  for (const LinkGeometry& g : geometry) {
    const fcl::CollisionGeometryd& shape = *g.object->collisionGeometry();
    of(g.link) = std::max(of(g.link), (g.offset * shape.aabb_center).norm() + shape.aabb_radius);
    carries[static_cast<std::size_t>(g.link)] = true;
  }
  std::vector<std::vector<LinkId>> children(reach.size());
  const std::vector<LinkId>& order = tree.topologicalOrder();
  for (auto link = order.rbegin(); link != order.rend(); ++link) {
    const JointId j = tree.parentJoint(*link);
    if (j < 0) continue;
    const LinkId parent = tree.parentLink(*link);
    children[static_cast<std::size_t>(parent)].push_back(*link);
    of(parent) = std::max(of(parent), tree.joint(j).origin.translation().norm() + limitedSlide(tree, j) + of(*link));
  }
  double all = 0;
  for (const LinkId root : order) {
    if (tree.parentJoint(root) >= 0) continue;
    const std::vector<LinkId>& below = children[static_cast<std::size_t>(root)];
    LinkId from = root;
    if (below.size() == 1 && !carries[static_cast<std::size_t>(root)] &&
        isMount(tree.joint(tree.parentJoint(below[0])))) {
      from = below[0];
    }
    all = std::max(all, of(from));
  }
  return all;
}

}  // namespace fcl_artic
