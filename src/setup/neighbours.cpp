// SPDX-License-Identifier: BSD-3-Clause
#include "setup/neighbours.h"

#include <vector>

namespace fcl_artic {
namespace {

/// Whether the joint lets its link go anywhere in the world: a planar or floating joint whose parent stands still.
bool isFree(const KinematicTree& tree, JointId joint) {
  const JointType type = tree.joint(joint).type;
  if (type != JointType::planar && type != JointType::floating) return false;
  return carrierOf(tree, tree.linkId(tree.joint(joint).parent)) < 0;
}

std::vector<LinkId> pathToRoot(const KinematicTree& tree, LinkId link) {
  std::vector<LinkId> path{link};
  while (tree.parentLink(path.back()) >= 0) path.push_back(tree.parentLink(path.back()));
  return path;
}

}  // namespace

bool areNeighbours(const KinematicTree& tree, const std::set<LinkId>& with_geometry, LinkId a, LinkId b) {
  std::vector<LinkId> x = pathToRoot(tree, a), y = pathToRoot(tree, b);
  if (x.back() != y.back()) return false;
  while (x.size() > 1 && y.size() > 1 && x[x.size() - 2] == y[y.size() - 2]) {
    x.pop_back();
    y.pop_back();
  }
  int moving = 0;
  bool bare = true;  // no link with geometry strictly between
  for (const auto* side : {&x, &y}) {
    for (std::size_t i = 0; i + 1 < side->size(); ++i) {
      const JointId joint = tree.parentJoint((*side)[i]);
      if (isFree(tree, joint)) return false;
      moving += tree.joint(joint).type != JointType::fixed;
    }
    for (std::size_t i = 1; i + 1 < side->size(); ++i) bare = bare && !with_geometry.count((*side)[i]);
  }
  const LinkId ancestor = x.back();
  if (ancestor != a && ancestor != b) bare = bare && !with_geometry.count(ancestor);
  return moving <= 1 && bare;
}

bool linkAbove(const KinematicTree& tree, LinkId above, LinkId below) {
  while (below >= 0 && below != above) below = tree.parentLink(below);
  return below == above;
}

}  // namespace fcl_artic
