// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include <Eigen/Geometry>

#include "fcl_artic/export.h"
#include "fcl_artic/joint_motion.h"
#include "fcl_artic/kinematic_tree.h"
#include "fcl_artic/references.h"
#include "fcl_artic/trajectory.h"

namespace fcl_artic {

/// Request of toolDeviation(). All defaults are safe: nothing has to be tuned.
struct ToolLineRequest {
  /// The tool's frame in the link's: the origin is to follow the line, the axes are to keep their orientation.
  Eigen::Isometry3d tool = Eigen::Isometry3d::Identity();
  /// Wanted widths of the brackets of the largest distance, m, and of the largest angle, rad; both above 0.
  double tolerance_distance = 1e-6, tolerance_angle = 1e-4;
  /// Maximum number of poses that are looked at; after it the search ends with what is proven so far; 0: no limit.
  std::uint64_t work_budget = 0;
};

/// How far a tool leaves the straight line between its poses at a motion's begin and end. All numbers are proven,
/// rounding included: lower <= largest deviation over the whole motion <= upper.
///
/// The distance is that of the tool's origin from the segment between its origins at the ends. The angle is that
/// between the tool's orientation and the one that it should have where its origin is: the shortest rotation from the
/// first orientation to the last one goes as far as the nearest point of the segment has gone.
/// Of ends that are turned by more than 2.5 rad against each other nothing is said of the angle: it is from 0 to pi.
struct ToolDeviation {
  double distance_lower = 0, distance_upper = 0;  ///< m
  double distance_time = 0;                       ///< when the tool is at least distance_lower away
  double angle_lower = 0, angle_upper = 0;        ///< rad; angles above 2.5 are not told from pi
  double angle_time = 0;                          ///< when the tool is turned by at least angle_lower
  double length = 0;                              ///< of the segment, m, as computed in doubles
  /// Whether both brackets are as narrow as was asked for. False if the work budget ran out.
  bool within_tolerance = false;

  /// Whether the tool certainly keeps as near as that, in m and rad, at all times.
  bool certainlyKeeps(double distance, double angle) const {
    return distance_upper <= distance && angle_upper <= angle;
  }
  /// Whether the tool certainly is farther away, or turned farther, than that at some time.
  bool certainlyLeaves(double distance, double angle) const { return distance_lower > distance || angle_lower > angle; }
};

/// Finds how far a tool leaves the straight line between its poses at a motion's ends: for welding, gluing and cutting
/// along a line while the joints go by splines. Says nothing of contacts.
/// @param link  that carries the tool.
/// @throws std::out_of_range for a link that the tree lacks; std::invalid_argument for a motion of another tree, a
///   motion by tangents of half angles, a tool frame that is not rigid to 1e-9, values outside the ranges given in
///   ToolLineRequest, and ends less than 1e-6 m apart.
FCL_ARTIC_EXPORT ToolDeviation toolDeviation(const KinematicTree& tree, const JointMotion& motion, const LinkRef& link,
                                             const ToolLineRequest& request = {});
/// The same over all of a trajectory; times are the trajectory's own.
/// @throws as toolDeviation() of a JointMotion.
FCL_ARTIC_EXPORT ToolDeviation toolDeviation(const KinematicTree& tree, const JointTrajectory& trajectory,
                                             const LinkRef& link, const ToolLineRequest& request = {});

}  // namespace fcl_artic
