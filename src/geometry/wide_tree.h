// SPDX-License-Identifier: BSD-3-Clause
//
// A tree of boxes with eight children a node, for whoever compares eight boxes at once.
#pragma once

#include <vector>

#include "geometry/shape_tree.h"
#include "model/eight_boxes.h"
#include "model/tree_view.h"

namespace fcl_artic {

/// A tree over boxes.
/// @return node 0 is the root; leaf ~i has box i, rounded outward. Empty for no boxes.
std::vector<engine::WideNode> wideTree(const std::vector<BoxBounds>& boxes);

/// The upper levels of a large body's tree, down to small nodes of few pieces.
/// @return node 0 is the root's; empty for a body of few pieces, and for an unbounded one.
std::vector<engine::UpperNode> upperNodes(const engine::TreeView& tree);

}  // namespace fcl_artic
