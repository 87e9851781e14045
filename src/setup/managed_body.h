// SPDX-License-Identifier: BSD-3-Clause
//
// One body of the manager, geometry that a link carries or an obstacle, still or moving: the caller's object and what
// was read of it.
#pragma once

#include <memory>
#include <set>
#include <string>

#include <fcl/narrowphase/collision_object.h>
#include <fcl/narrowphase/continuous_collision_object.h>

#include "fcl_artic/kinematic_tree.h"
#include "fcl_artic/result.h"
#include "geometry/shape_tree.h"
#include "model/sweep.h"
#include "motion/body_motion.h"

namespace fcl_artic {

class GeometryContent;

struct ManagedBody {
  const fcl::CollisionObjectd* object = nullptr;
  const fcl::ContinuousCollisionObjectd* moving = nullptr;  ///< instead of it, of an obstacle that moves
  std::shared_ptr<const void> owner;                        ///< of the one or the other; null: the caller is
  std::string name;
  LinkId link = -1;                                             ///< -1: obstacle
  RigidTransform offset;                                        ///< in the link's frame; of an obstacle: in the world
  Eigen::Isometry3d transform = Eigen::Isometry3d::Identity();  ///< of an obstacle: the object's own, as read
  std::shared_ptr<const fcl::CollisionGeometryd> geometry;
  std::shared_ptr<const ShapeTree> shape;
  std::shared_ptr<const GeometryContent> content;  ///< that the shape was made of: the caller may change it in place
  bool attached = false;                           ///< an obstacle that the link carries
  std::set<LinkId> touch_links;                    ///< that it may touch then
  BodyMotion motion;                               ///< of an obstacle that moves
  Eigen::Vector3d path_lower, path_upper;          ///< its box in the world over all of the motion

  /// Whether what the caller has is what was read: the geometry by its content, of an obstacle its transform too. (For
  /// a motion nobody knows.)
  bool isAsRead() const;
  /// Reads it again: the geometry, where its content is another one, and an obstacle's transform or motion.
  /// @throws std::invalid_argument naming it; it is not to be used then.
  void readAgain();
  /// Reads the object's geometry, where its content is another one than was read before.
  /// @throws std::invalid_argument beginning with `what`.
  void readShape(const std::string& what);
  /// Reads what a link carries.
  /// @throws std::invalid_argument beginning with `what`, also for what is unbounded.
  void readCarried(const std::string& what);
  /// Refuses what no link carries.
  /// @throws std::invalid_argument beginning with `what`.
  void requireBounded(const std::string& what) const;
  /// Reads an obstacle: its geometry, and its transform or its motion.
  /// @throws std::invalid_argument naming it.
  void readObstacle();

  /// Nothing touches an empty tree (an OcTree without an occupied cell).
  bool empty() const { return shape->view().num_pieces == 0; }
  double size() const { return shape->view().nodes[0].radius; }  ///< half its box's diagonal
  bool isObstacle() const { return link < 0 || attached; }  ///< registered as one, whether or not a link carries it now
  bool mayTouchLink(const ManagedBody& other) const { return !other.attached && touch_links.count(other.link); }
  Eigen::Isometry3d pose(double t) const { return moving ? motion.pose(t) : offset.isometry(); }  ///< of an obstacle
  BodyRef reference() const { return {link, object, name, moving}; }
  /// Its box where the geometry's frame stands at M.
  /// @param placement  the same.
  void worldBox(const Eigen::Isometry3d& M, const engine::Placement& placement, double* lo, double* hi) const;
};

}  // namespace fcl_artic
