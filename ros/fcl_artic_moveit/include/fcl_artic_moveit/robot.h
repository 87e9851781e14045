// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <set>
#include <string>
#include <vector>

#include <Eigen/Core>

#include <fcl_artic/kinematic_tree.h>
#include <moveit/robot_model/robot_model.hpp>
#include <moveit/robot_state/robot_state.hpp>

namespace fcl_artic_moveit {

/// Links and joints of a MoveIt robot, and the way from MoveIt's variables to the tree's.
struct RobotTree {
  /// All links of the model by their names, in its order. The world of the tree is the model's frame: the parent frame
  /// of the SRDF's virtual joint, which is a link of the tree then (its root), or the root link. The virtual joint is
  /// the tree's first joint. Variables have MoveIt's names; mimic joints have none.
  std::shared_ptr<const fcl_artic::KinematicTree> tree;
  /// Index of each of the tree's variables among MoveIt's.
  std::vector<std::size_t> variables;

  /// Returns the values of a state: dof() values, rad or m.
  /// @param state  of the model that the tree was made of.
  /// @throws std::invalid_argument, naming the joint: a mimic joint that is not where its master has it (1e-6 rad or
  ///   m), a value that is not finite.
  Eigen::VectorXd configuration(const moveit::core::RobotState& state) const;

  /// MoveIt's mimic joints: they have to be where their masters have them.
  struct Follower {
    std::string name;              ///< of the joint
    std::size_t variable, master;  ///< indices among MoveIt's variables
    double factor, offset;
  };
  std::vector<Follower> followers;
};

/// Makes a tree of a MoveIt robot model.
///
/// | MoveIt's joint | here |
/// | --- | --- |
/// | revolute, continuous, prismatic | the same; limits are the model's |
/// | planar (x, y, theta, about z) | planar |
/// | floating (position, quaternion) | floating |
/// | fixed | fixed |
/// | mimic | it follows its master |
/// @param mounts  names of links that get a link more, "LINK/mount", fixed in their frame: for what they carry and may
///   not touch.
/// @throws std::invalid_argument, naming the joint: a joint of unknown type, and as KinematicTree::addJoint().
RobotTree toTree(const moveit::core::RobotModel& model, const std::set<std::string>& mounts = {});

/// Name of the link that toTree() adds to a link of `mounts`.
std::string mountName(const std::string& link);

}  // namespace fcl_artic_moveit
