// SPDX-License-Identifier: BSD-3-Clause
//
// Component `tesseract`: a scene graph as a manager that certifies motions in joint space.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <tesseract/common/collision_margin_data.h>
#include <tesseract/common/joint_state.h>
#include <tesseract/scene_graph/graph.h>

#include "fcl_artic/manager.h"

namespace fcl_artic {

/// A scene graph of tesseract's as fromTesseract() makes it.
struct TesseractScene {
  /// All links and joints, with their names. Geometry that moves has links of its own, named "LINK/0", "LINK/1", ...
  /// or is attached under that name (where it is checked against a neighbour); still geometry is an obstacle "LINK/0".
  std::shared_ptr<const KinematicTree> tree;
  /// The manager, set up, with the graph's allowed pairs and the margins.
  std::shared_ptr<ArticulatedCollisionManager> manager;
  /// Pairs of links that are not allowed to touch and are not checked, as no joint moves them against each other.
  std::vector<std::string> notes;
  /// Whether the manager has tesseract's margins, which replace CertifiedRequest::margin (added_margin is added).
  bool has_margins = false;

  /// Returns a trajectory of tesseract's as one of the tree's joints. Between states all joints go straight.
  ///
  /// The times are those of the states where they increase strictly, else the states' numbers 0, 1, 2 ...
  /// @param others  dof() joint values, rad or m, at which joints that no state names stay, floating and planar ones
  ///   among them, which no state can name; empty: all joints are named.
  /// @throws std::invalid_argument, naming the state, for
  ///   - fewer than two states,
  ///   - a joint that is unknown, fixed, a mimic, of more than one variable or named twice, or is named by some states
  ///     only,
  ///   - another number of positions than names, a value that is not finite,
  ///   - a joint that no state names, where `others` is empty.
  FCL_ARTIC_EXPORT JointTrajectory trajectory(const ::tesseract::common::JointTrajectory& trajectory,
                                              const Eigen::VectorXd& others = {}) const;

  /// Finds the first contact of a trajectory of tesseract's, in the time that trajectory() gives it, or proves that
  /// there is none.
  /// @param others  as for trajectory().
  /// @throws std::invalid_argument as trajectory() and ArticulatedCollisionManager::continuousCollide(); for a request
  ///   with a margin, where the manager has tesseract's.
  FCL_ARTIC_EXPORT CertifiedResult certify(const ::tesseract::common::JointTrajectory& trajectory,
                                           const CertifiedRequest& request = {},
                                           const Eigen::VectorXd& others = {}) const;
};

/// Makes a manager of a scene graph: links, joints, collision geometry (as TesseractContactManager takes it), allowed
/// pairs. All pairs that are not allowed are checked, links with one joint between them too, except those that no joint
/// moves against each other (TesseractScene::notes). Links whose collision is disabled have no geometry.
/// @param graph    a tree; copied.
/// @param margins  m; below 0 they count as 0. They replace CertifiedRequest::margin if any is above 0
///   (TesseractScene::has_margins).
/// @throws std::invalid_argument naming link or joint: a graph that is no tree, a joint of unknown type, a geometry
///   that is not supported or empty, a plane that moves.
FCL_ARTIC_EXPORT TesseractScene fromTesseract(const ::tesseract::scene_graph::SceneGraph& graph,
                                              const ::tesseract::common::CollisionMarginData& margins = {});

}  // namespace fcl_artic
