// SPDX-License-Identifier: BSD-3-Clause
//
// A tree of boxes with eight children a node, for whoever compares eight boxes at once.
#pragma once

#include <vector>

#include "model/eight_boxes.h"
#include "model/tree_view.h"

namespace fcl_artic {

/// The same leaves under nodes of up to eight children.
/// @param tree  buildBoxTree().
/// @return node 0 is the root; empty where `tree` is.
std::vector<engine::WideNode> widen(const std::vector<engine::Node>& tree);

/// The upper levels of a large body's tree, down to small nodes of few pieces.
/// @return node 0 is the root's; empty for a body of few pieces, and for an unbounded one.
std::vector<engine::UpperNode> upperNodes(const engine::TreeView& tree);

}  // namespace fcl_artic
