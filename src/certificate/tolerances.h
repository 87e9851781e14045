// SPDX-License-Identifier: BSD-3-Clause
//
// How far the real robot and its scene may be from what a world states, as plain data (doc/TUBES.md).
#pragma once

#include <map>
#include <string>
#include <vector>

#include "fcl_artic/tube.h"

namespace fcl_artic::certificate {

struct WorldTolerances {
  std::vector<JointTolerance> of_joint;  ///< by the tree's joints; those of joints that mimic are not read; empty: none
  PoseTolerance of_base;                 ///< of all of the robot; the pivot is a point of the world
  std::map<std::string, PoseTolerance> of_object;  ///< by name; the pivot is a point in the object's own frame
  std::map<std::string, ObjectSpeed> speeds;       ///< by name; in the unit of the motion's time
};

}  // namespace fcl_artic::certificate
