// SPDX-License-Identifier: BSD-3-Clause
//
// Boxes of a tree's nodes: in single precision, rounded outward.
#pragma once

#include "model/tree_view.h"
#include "numerics/vec3.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

using engine::Node;

/// Two floats above the nearest to x: surely not below x, whatever the rounding mode.
FCL_ARTIC_INLINE float roundUpToFloat(double x) {
  const float f = static_cast<float>(x);
  std::int32_t bits;
  __builtin_memcpy(&bits, &f, sizeof bits);
  // Floats in the order of integers, both zeros in one place, and back.
  constexpr std::int32_t kLeast = -0x7fffffff - 1;
  const std::int32_t order = (bits < 0 ? kLeast - bits : bits) + 2;
  bits = order < 0 ? kLeast - order : order;
  float up;
  __builtin_memcpy(&up, &bits, sizeof up);
  return up;
}
FCL_ARTIC_INLINE float roundDownToFloat(double x) {
  return -roundUpToFloat(-x);
}

/// Sets a node's radius by its box.
FCL_ARTIC_INLINE void setRadius(Node& node) {
  double radius = 0;
  for (int k = 0; k < 3; ++k) {
    const double half = 0.5 * (static_cast<double>(node.hi[k]) - static_cast<double>(node.lo[k]));
    radius += half * half;
  }
  node.radius = roundUpToFloat(sqrt(radius));
}

/// Gives a node a box that holds this one.
FCL_ARTIC_INLINE void setBox(const engine::BoxBounds& box, Node& node) {
  for (int k = 0; k < 3; ++k) {
    node.lo[k] = roundDownToFloat(box.lo[k]);
    node.hi[k] = roundUpToFloat(box.hi[k]);
  }
  setRadius(node);
}

/// Gives a node the box around its children's.
FCL_ARTIC_INLINE void enclose(const Node& left, const Node& right, Node& node) {
  for (int k = 0; k < 3; ++k) {
    node.lo[k] = left.lo[k] < right.lo[k] ? left.lo[k] : right.lo[k];
    node.hi[k] = left.hi[k] > right.hi[k] ? left.hi[k] : right.hi[k];
  }
  setRadius(node);
}

/// A leaf around a box.
FCL_ARTIC_INLINE Node makeLeaf(const engine::BoxBounds& box, std::int32_t piece) {
  Node node;
  setBox(box, node);
  node.child = ~piece;
  return node;
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
