// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>

#include "fcl_artic/urdf/urdf.h"

namespace fcl_artic::planning_data {

/// An object that a link carries, checked as ArticulatedCollisionManager::attach() has it checked: against all links,
/// neighbours too, except the one that carries it and `touch_links`.
struct CarriedObject {
  std::string name;  ///< for allowed pairs
  std::shared_ptr<const fcl::CollisionObjectd> object;
  LinkId link = -1;                                          ///< that carries it
  Eigen::Isometry3d offset = Eigen::Isometry3d::Identity();  ///< pose of the geometry's frame in the link's frame
  std::vector<std::string> touch_links;                      ///< names of further links that it may touch
};

/// Whether one state collides, as a planner over FCL asks: links against the scene through FCL's dynamic AABB tree,
/// then the pairs of links that may not touch. Knows nothing of this library's queries. One thread at a time.
class FclStateCheck {
 public:
  /// Copies what it moves; geometry is shared.
  FclStateCheck(const Robot& robot, const Scene& scene, const std::vector<CarriedObject>& carried = {});

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
