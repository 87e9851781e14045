// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/wide_tree.h"

#include <algorithm>
#include <limits>

#include "numerics/baseline_isa.h"

#include "convex/cloud.h"

namespace fcl_artic {
namespace {

using engine::Node;
using engine::WideNode;

constexpr std::size_t kChildren = 8;

/// Bodies of fewer pieces have no upper nodes.
constexpr std::int32_t kFewestPieces = 64;
/// Upper nodes end where a node has this number of pieces at most and is smaller than this part of the body. (Where
/// slivers lie side by side a node is no smaller than one of them: there they go down to single pieces.)
struct SmallNode {
  std::int32_t pieces;
  float part;
};
constexpr SmallNode kSmallNode = {8, 1.0f / 256};
/// The same in a cloud. (Measured, 10^5 and 10^6 points: with the numbers above any contact takes 1.1 to 1.4 times as
/// long, and upper nodes 8 bytes a point, not 2. Whatever their size, clouds of 1,000 points take 1.2 times as long.)
constexpr SmallNode kSmallNodeOfCloud = {64, 1.0f / 32};

/// Up to eight nodes below `top`. As long as there is room, the largest node that can be divided is replaced by its
/// children. (Nodes that a dynamic program chooses for the fewest expected visits are visited no less often.)
template <class CanDivide>
std::vector<std::int32_t> childrenOf(const Node* tree, std::int32_t top, const CanDivide& canDivide) {
  std::vector<std::int32_t> children = {top};
  while (children.size() < kChildren) {
    std::int32_t* largest = nullptr;
    for (std::int32_t& node : children) {
      if (canDivide(node) && (!largest || tree[node].radius > tree[*largest].radius)) largest = &node;
    }
    if (!largest) break;
    const Node& node = tree[*largest];
    *largest = node.left();
    children.push_back(node.right());
  }
  return children;
}

void setBox(const Node& node, std::size_t lane, engine::EightBoxes& boxes) {
  for (int k = 0; k < 3; ++k) {
    boxes.lo[k][lane] = node.lo[k];
    boxes.hi[k][lane] = node.hi[k];
  }
}

/// Eight boxes that meet nothing.
engine::EightBoxes emptyBoxes() {
  engine::EightBoxes boxes;
  std::fill_n(&boxes.lo[0][0], 3 * kChildren, std::numeric_limits<float>::infinity());
  std::fill_n(&boxes.hi[0][0], 3 * kChildren, -std::numeric_limits<float>::infinity());
  return boxes;
}

/// The number of pieces below each node that is stored. (Children come after their parents.)
std::vector<std::int32_t> countPieces(const engine::TreeView& tree) {
  std::vector<std::int32_t> count(static_cast<std::size_t>(tree.num_nodes), 1);
  for (std::int32_t i = tree.num_nodes; i-- > 0;) {
    const Node& node = tree.nodes[i];
    if (i == 1 || node.isLeaf()) continue;
    if (baseline::isCluster(tree, node)) {
      count[static_cast<std::size_t>(i)] = tree.balls[(node.child - tree.num_nodes) / 2].cluster_size;
      continue;
    }
    count[static_cast<std::size_t>(i)] =
        count[static_cast<std::size_t>(node.left())] + count[static_cast<std::size_t>(node.right())];
  }
  return count;
}

}  // namespace

std::vector<WideNode> widen(const std::vector<Node>& tree) {
  std::vector<WideNode> wide;
  if (tree.empty()) return wide;
  const auto canDivide = [&](std::int32_t node) { return !tree[static_cast<std::size_t>(node)].isLeaf(); };
  std::vector<std::int32_t> tops = {0};  // of wide[i], the node that it stands for
  for (std::size_t i = 0; i < tops.size(); ++i) {
    WideNode node = {};
    for (const std::int32_t index : childrenOf(tree.data(), tops[i], canDivide)) {
      const Node& child = tree[static_cast<std::size_t>(index)];
      const std::int32_t lane = node.num_children++;
      setBox(child, static_cast<std::size_t>(lane), node.boxes);
      node.child[lane] = child.isLeaf() ? child.child : static_cast<std::int32_t>(tops.size());
      if (!child.isLeaf()) tops.push_back(index);
    }
    wide.push_back(node);
  }
  return wide;
}

std::vector<engine::UpperNode> upperNodes(const engine::TreeView& tree) {
  std::vector<engine::UpperNode> upper_nodes;
  if (tree.num_pieces < kFewestPieces || !(tree.nodes[0].radius < engine::kUnbounded)) return upper_nodes;
  const std::vector<std::int32_t> pieces = countPieces(tree);
  const SmallNode& ends = tree.balls ? kSmallNodeOfCloud : kSmallNode;
  const float small = ends.part * tree.nodes[0].radius;
  const auto canDivide = [&](std::int32_t node) {
    if (baseline::isCluster(tree, tree.nodes[node])) return false;
    const std::int32_t below = pieces[static_cast<std::size_t>(node)];
    return below > ends.pieces || (below > 1 && !(tree.nodes[node].radius < small));
  };
  std::vector<std::int32_t> tops = {0};  // of upper_nodes[i], the node that it stands for
  for (std::size_t i = 0; i < tops.size(); ++i) {
    const std::vector<std::int32_t> children = childrenOf(tree.nodes, tops[i], canDivide);
    engine::UpperNode upper;
    upper.boxes = emptyBoxes();
    std::fill_n(upper.node, kChildren, -1);
    std::fill_n(upper.upper, kChildren, -1);
    for (std::size_t lane = 0; lane < children.size(); ++lane) {
      upper.node[lane] = children[lane];
      setBox(tree.nodes[children[lane]], lane, upper.boxes);
      if (!canDivide(children[lane])) continue;
      upper.upper[lane] = static_cast<std::int32_t>(tops.size());
      tops.push_back(children[lane]);
    }
    upper_nodes.push_back(upper);
  }
  return upper_nodes;
}

}  // namespace fcl_artic
