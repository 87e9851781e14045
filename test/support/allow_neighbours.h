// SPDX-License-Identifier: BSD-3-Clause
//
// For judges that watch all pairs of links but neighbours.
#pragma once

#include "fcl_artic/manager.h"

namespace fcl_artic::test {

/// Sets the manager up with all neighbours allowed of which it would find out by itself what they do.
inline void setUpWithoutNeighbours(ArticulatedCollisionManager& manager) {
  manager.setup();
  for (const LinkPairFinding& found : manager.neighbours()) manager.allow(found.link1, found.link2);
  manager.setup();
}

}  // namespace fcl_artic::test
