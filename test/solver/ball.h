// SPDX-License-Identifier: BSD-3-Clause
//
// A ball as the engine sees it: a tree of one node over one piece.
#pragma once

#include <cmath>
#include <limits>

#include "numerics/baseline_isa.h"

#include "narrowphase/solver.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

/// A body that is a ball around its frame's origin.
struct Ball {
  Piece piece;
  Node node;
  TreeView tree;

  /// @param radius  of the ball; its box is rounded outward.
  /// @param[out] body  refers to this.
  void make(double radius, Body& body) {
    float side = static_cast<float>(radius);
    if (static_cast<double>(side) < radius) side = std::nextafter(side, std::numeric_limits<float>::infinity());
    piece.kind = PieceKind::point;
    piece.radius = radius;
    node = {{-side, -side, -side}, {side, side, side}, static_cast<float>(radius * 1.7320509), ~0};
    tree.nodes = &node;
    tree.pieces = &piece;
    tree.num_nodes = tree.num_pieces = 1;
    tree.extent = radius;
    body.tree = &tree;
    body.lss[6] = radius;
  }
};

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
