// SPDX-License-Identifier: BSD-3-Clause
//
// Boxes of a tree's nodes: in single precision, rounded outward.
#pragma once

#include "model/tree_view.h"
#include "numerics/vec3.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

using engine::Node;

/// The ends of a box along three axes; the fourth number is 0.
typedef double FourDoubles __attribute__((vector_size(32)));
typedef float FourFloats __attribute__((vector_size(16)));
typedef std::int32_t FourIntegers __attribute__((vector_size(16)));

FCL_ARTIC_INLINE float nearestFloat(double x) {
  return static_cast<float>(x);
}
FCL_ARTIC_INLINE FourFloats nearestFloat(const FourDoubles& x) {
  return __builtin_convertvector(x, FourFloats);
}

/// Two floats above the nearest to x + 2^-125: surely not below x, whatever the rounding mode. That holds also where
/// floats below 2^-126 are written, or read, as 0. For one number or for four.
template <class Integers = std::int32_t, class Doubles>
FCL_ARTIC_INLINE auto roundUpToFloat(const Doubles& x) {
  auto f = nearestFloat(x + 0x1p-125);
  Integers bits;
  __builtin_memcpy(&bits, &f, sizeof bits);
  // Floats in the order of integers, both zeros in one place, and back.
  constexpr std::int32_t kAllButSign = 0x7fffffff;
  Integers negative = bits >> 31;  // all bits, or none
  const Integers order = (bits ^ (negative & kAllButSign)) - negative + 2;
  negative = order >> 31;
  bits = (order + negative) ^ (negative & kAllButSign);
  __builtin_memcpy(&f, &bits, sizeof f);
  return f;
}

/// Sets a node's radius by its box.
FCL_ARTIC_INLINE void setRadius(Node& node) {
  double square = 0;
  for (int k = 0; k < 3; ++k) {
    const double half = 0.5 * (static_cast<double>(node.hi[k]) - static_cast<double>(node.lo[k]));
    square += half * half;
  }
  node.radius = roundUpToFloat(sqrt(square));
}

/// Gives a node a box, rounded outward; its radius stays.
FCL_ARTIC_INLINE void setBox(const FourDoubles& lower, const FourDoubles& upper, Node& node) {
  const FourFloats lo = -roundUpToFloat<FourIntegers>(-lower), hi = roundUpToFloat<FourIntegers>(upper);
  __builtin_memcpy(node.lo, &lo, sizeof node.lo);
  __builtin_memcpy(node.hi, &hi, sizeof node.hi);
}
FCL_ARTIC_INLINE void setBox(const engine::BoxBounds& box, Node& node) {
  const FourDoubles lower = {box.lo[0], box.lo[1], box.lo[2], 0}, upper = {box.hi[0], box.hi[1], box.hi[2], 0};
  setBox(lower, upper, node);
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
  setRadius(node);
  node.child = ~piece;
  return node;
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
