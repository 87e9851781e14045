// SPDX-License-Identifier: BSD-3-Clause
//
// Boxes of a tree's nodes: in single precision, rounded outward.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "geometry/shape_tree.h"
#include "model/tree_view.h"

namespace fcl_artic {

/// Two floats above the nearest to x: surely not below x, whatever the rounding mode.
inline float roundUpToFloat(double x) {
  const float f = static_cast<float>(x);
  std::int32_t bits;
  std::memcpy(&bits, &f, sizeof bits);
  // Floats in the order of integers, both zeros in one place, and back.
  constexpr std::int32_t kLeast = std::numeric_limits<std::int32_t>::min();
  const std::int32_t order = (bits < 0 ? kLeast - bits : bits) + 2;
  bits = order < 0 ? kLeast - order : order;
  float up;
  std::memcpy(&up, &bits, sizeof up);
  return up;
}
inline float roundDown(double x) {
  return -roundUpToFloat(-x);
}

inline void setRadius(engine::Node& node) {
  double radius = 0;
  for (int k = 0; k < 3; ++k) {
    const double half = 0.5 * (static_cast<double>(node.hi[k]) - static_cast<double>(node.lo[k]));
    radius += half * half;
  }
  node.radius = roundUpToFloat(std::sqrt(radius));
}

inline engine::Node makeLeaf(const BoxBounds& box, std::int32_t piece) {
  engine::Node node;
  for (int k = 0; k < 3; ++k) {
    node.lo[k] = roundDown(box.lo[k]);
    node.hi[k] = roundUpToFloat(box.hi[k]);
  }
  setRadius(node);
  node.child = ~piece;
  return node;
}

/// Gives a node the box around its children's.
inline void enclose(const engine::Node& left, const engine::Node& right, engine::Node& node) {
  for (int k = 0; k < 3; ++k) {
    node.lo[k] = std::min(left.lo[k], right.lo[k]);
    node.hi[k] = std::max(left.hi[k], right.hi[k]);
  }
  setRadius(node);
}

}  // namespace fcl_artic
