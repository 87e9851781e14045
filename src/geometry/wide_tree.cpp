// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/wide_tree.h"

namespace fcl_artic {
namespace {

using engine::Node;
using engine::WideNode;

constexpr std::size_t kChildren = 8;

/// The nodes below `top`, eight at most. As long as there is room, the largest node with children is replaced by its
/// children. (Nodes that a dynamic program chooses for the fewest expected visits are visited no less often.)
std::vector<const Node*> childrenOf(const std::vector<Node>& tree, const Node& top) {
  std::vector<const Node*> children = {&top};
  while (children.size() < kChildren) {
    const Node** largest = nullptr;
    for (const Node*& node : children) {
      if (!node->isLeaf() && (!largest || node->radius > (*largest)->radius)) largest = &node;
    }
    if (!largest) break;
    const Node& node = **largest;
    *largest = &tree[static_cast<std::size_t>(node.left())];
    children.push_back(&tree[static_cast<std::size_t>(node.right())]);
  }
  return children;
}

}  // namespace

std::vector<WideNode> widen(const std::vector<Node>& tree) {
  std::vector<WideNode> wide;
  if (tree.empty()) return wide;
  std::vector<const Node*> tops = {&tree[0]};  // of wide[i], the node that it stands for
  for (std::size_t i = 0; i < tops.size(); ++i) {
    WideNode node = {};
    for (const Node* child : childrenOf(tree, *tops[i])) {
      const std::int32_t lane = node.num_children++;
      for (int k = 0; k < 3; ++k) {
        node.boxes.lo[k][lane] = child->lo[k];
        node.boxes.hi[k][lane] = child->hi[k];
      }
      node.child[lane] = child->isLeaf() ? child->child : static_cast<std::int32_t>(tops.size());
      if (!child->isLeaf()) tops.push_back(child);
    }
    wide.push_back(node);
  }
  return wide;
}

}  // namespace fcl_artic
