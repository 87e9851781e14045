// SPDX-License-Identifier: BSD-3-Clause
//
// The kinematics of judges: of trees whose joints each turn or slide, without the library's.
#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "fcl_artic/kinematic_tree.h"

namespace fcl_artic::test {

/// Poses of links in the base's frame. Link 0 is the base; joint i carries link i + 1.
/// @param parents  of joint i, its parent link.
/// @param q  of joint i, rad or m.
inline std::vector<Eigen::Isometry3d> linkPoses(const std::vector<Joint>& joints, const std::vector<int>& parents,
                                                const Eigen::VectorXd& q) {
  std::vector<Eigen::Isometry3d> all = {Eigen::Isometry3d::Identity()};
  for (std::size_t i = 0; i < joints.size(); ++i) {
    Eigen::Isometry3d moved = Eigen::Isometry3d::Identity();
    const double x = q[static_cast<Eigen::Index>(i)];
    if (joints[i].type == JointType::prismatic) {
      moved.translation() = x * joints[i].axis;
    } else {
      moved.linear() = Eigen::AngleAxisd(x, joints[i].axis).toRotationMatrix();
    }
    all.push_back(all[static_cast<std::size_t>(parents[i])] * joints[i].origin * moved);
  }
  return all;
}

}  // namespace fcl_artic::test
