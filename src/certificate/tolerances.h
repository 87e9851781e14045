// SPDX-License-Identifier: BSD-3-Clause
//
// How far the real robot and its scene may be from what a world states, as plain data (doc/TUBES.md).
#pragma once

#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace fcl_artic::certificate {

/// Tolerances of joints, the base and objects. All numbers are finite and at least 0.
struct WorldTolerances {
  struct OfJoint {
    double angle = 0;   ///< rad: of what turns; of a spherical joint and of a floating one's turn the rotation's angle
    double length = 0;  ///< m: of what slides; of planar and floating joints the length of the vector
  };
  struct OfPose {
    double length = 0, angle = 0;                     ///< m, rad
    Eigen::Vector3d pivot = Eigen::Vector3d::Zero();  ///< about which it turns, then it is moved by `length`
    bool any() const { return length > 0 || angle > 0; }
  };
  std::vector<OfJoint> of_joint;  ///< by the tree's joints; those of joints that mimic are not read; empty: none
  OfPose of_base;                 ///< of all of the robot; the pivot is a point of the world
  std::map<std::string, OfPose> of_object;  ///< by name; the pivot is a point in the object's own frame
};

}  // namespace fcl_artic::certificate
