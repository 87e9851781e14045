// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include <fcl_artic/kinematic_tree.h>
#include <moveit/robot_model/robot_model.hpp>
#include <moveit/robot_state/robot_state.hpp>

namespace fcl_artic_moveit {

/// Links and joints of a MoveIt robot, and the way from MoveIt's variables to the tree's.
struct RobotTree {
  /// All links of the model by their names, in its order. The world of the tree is the model's frame. If the SRDF has a
  /// virtual joint, that is the joint's parent frame, which is then the tree's root link; else it is the root link. The
  /// virtual joint is the tree's first joint. Variables have MoveIt's names; mimic joints have none, but for those that
  /// stand.
  std::shared_ptr<const fcl_artic::KinematicTree> tree;
  /// Index of each of the tree's variables among MoveIt's.
  std::vector<std::size_t> variables;

  /// MoveIt's mimic joints, without those that stand: they have to be where their masters have them.
  struct Follower {
    std::string name;              ///< of the joint
    std::size_t variable, master;  ///< indices among MoveIt's variables
    double factor, offset;
  };
  std::vector<Follower> followers;

  /// Returns the values of a state: dof() values, rad or m.
  /// @param state  of the model that the tree was made of.
  /// @param mimic_tolerance  rad or m, by which followers may be off from where their masters have them.
  /// @throws std::invalid_argument, naming the joint: a mimic joint that is not where its master has it, a value that
  ///   is not finite.
  Eigen::VectorXd configuration(const moveit::core::RobotState& state, double mimic_tolerance = kFollows) const;
  /// The follower that is farthest from where its master has it, rad or m, and by how much; null: there is none.
  std::pair<const Follower*, double> farthestFollower(const moveit::core::RobotState& state) const;

  /// rad or m, within which a mimic joint counts as being where its master has it: states come by way of messages and
  /// of floats.
  static constexpr double kFollows = 1e-6;
};

/// Makes a tree of a MoveIt robot model.
///
/// | MoveIt's joint | here |
/// | --- | --- |
/// | revolute, continuous, prismatic | the same; limits are the model's |
/// | planar (x, y, theta, about z) | planar |
/// | floating (position, quaternion) | floating |
/// | fixed | fixed |
/// | mimic | it follows its master, unless it is one of `standing` |
/// @param mounts  names of links that get a link more, "LINK/mount", fixed in their frame: for what they carry and may
///   not touch.
/// @param standing  names of mimic joints that stand where a state has them, whatever their masters do: they have
///   variables, as joints that mimic none.
/// @throws std::invalid_argument, naming the joint: a joint of unknown type, and as KinematicTree::addJoint().
RobotTree toTree(const moveit::core::RobotModel& model, const std::set<std::string>& mounts = {},
                 const std::set<std::string>& standing = {});

/// Name of the link that toTree() adds to a link of `mounts`.
std::string mountName(const std::string& link);

}  // namespace fcl_artic_moveit
