// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>

#include "fcl_artic/urdf/urdf.h"

namespace fcl_artic::planning_data {

/// Whether one state collides, as a planner over FCL asks: links against the scene through FCL's dynamic AABB tree,
/// then the pairs of links that may not touch. Knows nothing of this library's queries. One thread at a time.
class FclStateCheck {
 public:
  /// Copies what it moves; geometry is shared.
  FclStateCheck(const Robot& robot, const Scene& scene);

  /// @param q  all variables of the robot's tree.
  bool collides(const Eigen::VectorXd& q);

 private:
  struct Link {
    LinkId link;
    Eigen::Isometry3d offset;
    std::unique_ptr<fcl::CollisionObjectd> object;
  };
  std::shared_ptr<const KinematicTree> tree_;
  std::vector<Link> links_;
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> obstacles_;
  std::vector<std::pair<std::size_t, std::size_t>> pairs_;
  fcl::DynamicAABBTreeCollisionManagerd scene_;
  std::vector<Eigen::Isometry3d> M_0_;
};

}  // namespace fcl_artic::planning_data
