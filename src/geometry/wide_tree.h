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

}  // namespace fcl_artic
