// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/wide_tree.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "numerics/baseline_isa.h"

#include "convex/cloud.h"

namespace fcl_artic {
namespace {

using engine::Node;
using engine::WideNode;

constexpr std::size_t kChildren = 8;
/// Boxes at most of a small scene. (Measured: free motions of a Panda amid 65 boxes take a tenth longer with full
/// nodes, amid 10,000 a seventh longer without; from 100 to 3,000 they differ by 3 % at most.)
constexpr std::size_t kMostOfSmall = 128;

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

/// The tree over given boxes, one at least, from the root down.
class WideBuilder {
 public:
  explicit WideBuilder(const std::vector<BoxBounds>& boxes) : leaves_(boxes.size()) {
    for (std::size_t i = 0; i < boxes.size(); ++i)
      leaves_[i] = baseline::makeLeaf(boxes[i], static_cast<std::int32_t>(i));
  }
  std::vector<WideNode> run() {
    wide_.emplace_back();
    build(0, {0, leaves_.size()});
    return std::move(wide_);
  }

 private:
  /// Leaves from `begin` to `end`.
  struct Range {
    std::size_t begin, end;
    std::size_t size() const { return end - begin; }
  };

  /// Sets wide_[me] and all nodes below it.
  void build(std::size_t me, const Range& leaves) {
    const std::vector<Range> children = leaves_.size() > kMostOfSmall ? fullNodes(leaves) : smallNodes(leaves);
    WideNode node = {};
    const std::size_t first = wide_.size();
    std::size_t next = first;
    for (std::size_t i = 0; i < children.size(); ++i) {
      const bool leaf = children[i].size() == 1;
      setBox(boxAround(children[i]), i, node.boxes);
      node.child[i] = leaf ? leaves_[children[i].begin].child : static_cast<std::int32_t>(next++);
    }
    node.num_children = static_cast<std::int32_t>(children.size());
    wide_[me] = node;
    wide_.resize(next);
    next = first;
    for (const Range& child : children) {
      if (child.size() > 1) build(next++, child);
    }
  }
  /// In a small scene: as long as there is room the largest child is halved. (Full nodes would fill the scene: each
  /// link would meet them all.)
  std::vector<Range> smallNodes(const Range& leaves) {
    std::vector<Range> children = {leaves};
    for (const std::size_t count = std::min(kChildren, leaves.size()); children.size() < count;) {
      const auto largest = std::max_element(children.begin(), children.end(),
                                            [this](const Range& a, const Range& b) { return order(a) < order(b); });
      children.push_back(cut(*largest, largest->size() / 2));
    }
    return children;
  }
  /// A range's size; a leaf comes last.
  float order(const Range& leaves) const { return leaves.size() > 1 ? boxAround(leaves).radius : -1; }

  /// In a large scene all nodes are full but for one at each level. (In a tree that is halved at the median the last
  /// nodes have two or three leaves each: twice as many nodes are looked at.)
  std::vector<Range> fullNodes(Range leaves) {
    std::size_t below = 1;  // leaves of a child
    while (below * kChildren < leaves.size()) below *= kChildren;
    std::vector<Range> children;
    const std::size_t needed = (leaves.size() + below - 1) / below;
    if (below > 1) takeLargest(kChildren - needed, leaves, children);
    divide(leaves, below, children);
    return children;
  }
  /// Makes the largest leaves children by themselves: they would only blow up nodes below.
  void takeLargest(std::size_t count, Range& leaves, std::vector<Range>& children) {
    std::partial_sort(at(leaves.begin), at(leaves.begin + count), at(leaves.end), [](const Node& a, const Node& b) {
      return a.radius > b.radius || (a.radius == b.radius && a.piece() < b.piece());
    });
    for (; count > 0; --count, ++leaves.begin) children.push_back({leaves.begin, leaves.begin + 1});
  }
  /// Adds children of `below` leaves each, the last one of those that are left.
  void divide(Range leaves, std::size_t below, std::vector<Range>& children) {
    if (leaves.size() <= below) return children.push_back(leaves);
    const Range upper = cut(leaves, (leaves.size() + below - 1) / below / 2 * below);
    divide(leaves, below, children);
    divide(upper, below, children);
  }
  /// Cuts a range across its longest side.
  /// @param[in,out] leaves  its lower `count` afterwards.
  /// @return the others.
  Range cut(Range& leaves, std::size_t count) {
    const Node box = boxAround(leaves);
    const auto side = [&box](int k) { return box.hi[k] - box.lo[k]; };
    const int longer = side(1) > side(0) ? 1 : 0, axis = side(2) > side(longer) ? 2 : longer;
    const std::size_t middle = leaves.begin + count;
    // By the boxes' middles, then by the index: the same tree on every machine.
    std::nth_element(at(leaves.begin), at(middle), at(leaves.end), [axis](const Node& a, const Node& b) {
      const float middle_a = a.lo[axis] + a.hi[axis], middle_b = b.lo[axis] + b.hi[axis];
      return middle_a < middle_b || (middle_a == middle_b && a.piece() < b.piece());
    });
    const Range upper = {middle, leaves.end};
    leaves.end = middle;
    return upper;
  }
  Node boxAround(const Range& leaves) const {
    Node box = leaves_[leaves.begin];
    for (std::size_t i = leaves.begin + 1; i < leaves.end; ++i) baseline::enclose(box, leaves_[i], box);
    return box;
  }
  std::vector<Node>::iterator at(std::size_t i) { return leaves_.begin() + static_cast<std::ptrdiff_t>(i); }

  std::vector<Node> leaves_;
  std::vector<WideNode> wide_;
};

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

std::vector<WideNode> wideTree(const std::vector<BoxBounds>& boxes) {
  return boxes.empty() ? std::vector<WideNode>() : WideBuilder(boxes).run();
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
