// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "fcl_artic/manager.h"
#include "query/motion_part.h"

namespace fcl_artic {

/// What queries of other kinds ask of one motion, beyond the request.
struct ArticulatedCollisionManager::Aspects {
  TimePart time;  ///< of the moving obstacles' motions, over the query's [0, 1]
  bool own_margins = true;   ///< pairs may have margins of their own; false: all have the request's
  std::vector<bool>* never_apart =
      nullptr;  ///< out: of each ignored initial contact, that it has not separated by t = 1
};

}  // namespace fcl_artic
