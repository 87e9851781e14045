// SPDX-License-Identifier: BSD-3-Clause
//
// Eight boxes that are compared with one at once: stage 1's. Plain data.
#pragma once

#include <cstdint>

namespace fcl_artic {
namespace engine {

/// Axis-aligned boxes in the world, one per lane, single precision, rounded outward.
struct alignas(32) EightBoxes {
  float lo[3][8], hi[3][8];
};

/// Node of a tree over boxes: its children's boxes. Unused lanes come last. Node 0 is the root.
struct alignas(64) WideNode {
  EightBoxes boxes;
  std::int32_t child[8];  ///< an inner node; a leaf has ~piece, which is < 0
  std::int32_t num_children = 0;
};

/// One mover and eight that follow each other, from 8 `group` on, with the link pairs that they make.
struct MoverRow {
  std::int32_t mover = -1, group = -1;
  std::int32_t pair[8] = {-1, -1, -1, -1, -1, -1, -1, -1};  ///< -1: none
  std::uint32_t lanes = 0;                                  ///< those with a pair
};

}  // namespace engine
}  // namespace fcl_artic
