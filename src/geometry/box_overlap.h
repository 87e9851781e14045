// SPDX-License-Identifier: BSD-3-Clause
//
// Which boxes of a tree meet a box.
#pragma once

#include <array>
#include <vector>

#include "geometry/shape_tree.h"

namespace fcl_artic {

/// Boxes that share a point. Sides are compared as they are: whoever computed them saw to rounding. A side that is not
/// a number compares false, hence meets everything.
inline bool meet(const BoxBounds& a, const BoxBounds& b) {
  for (int k = 0; k < 3; ++k) {
    if (a.hi[k] < b.lo[k] || b.hi[k] < a.lo[k]) return false;
  }
  return true;
}

/// Appends the indices, in any order, of all boxes that meet `box`.
/// @param tree  buildBoxTree(boxes): its nodes are the boxes rounded outward.
inline void appendOverlaps(const std::vector<engine::Node>& tree, const std::vector<BoxBounds>& boxes,
                           const BoxBounds& box, std::vector<int>& found) {
  if (tree.empty()) return;
  std::array<int, 64> stack;  // the tree is balanced: one sibling waits per level, of at most 32
  std::size_t waiting = 0;
  int i = 0;
  for (;;) {
    const engine::Node& node = tree[static_cast<std::size_t>(i)];
    bool meets = true;
    for (int k = 0; k < 3; ++k) {
      meets = meets && !(box.hi[k] < static_cast<double>(node.lo[k]) || static_cast<double>(node.hi[k]) < box.lo[k]);
    }
    if (meets && !node.isLeaf()) {
      stack[waiting++] = node.right();
      i = node.left();
      continue;
    }
    if (meets && meet(box, boxes[static_cast<std::size_t>(node.piece())])) found.push_back(node.piece());
    if (waiting == 0) return;
    i = stack[--waiting];
  }
}

}  // namespace fcl_artic
