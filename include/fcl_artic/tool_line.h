// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include <Eigen/Geometry>

#include "fcl_artic/export.h"
#include "fcl_artic/joint_motion.h"
#include "fcl_artic/kinematic_tree.h"
#include "fcl_artic/references.h"
#include "fcl_artic/trajectory.h"

namespace fcl_artic {

/// Request of toolDeviation(): the path that a tool is to follow, and how well it is to be known. All defaults are
/// safe: nothing has to be tuned.
struct ToolLineRequest {
  /// The tool's frame in the link's: the origin is to follow the path, the axes are to keep their orientation against
  /// it.
  Eigen::Isometry3d tool = Eigen::Isometry3d::Identity();
  /// Wanted widths of the brackets of the largest distance, m, and of the largest angle, rad; both above 0.
  double tolerance_distance = 1e-6, tolerance_angle = 1e-4;
  /// Maximum number of poses that are looked at, for both brackets together; after it the search ends with what is
  /// proven so far; 0: no limit.
  std::uint64_t work_budget = 0;
  /// A point in the world, m. With it the path is an arc of a circle: from the tool's origin at the motion's begin
  /// through this point to the origin at the end. It may be more than half a circle. Without it the path is the
  /// straight line.
  std::optional<Eigen::Vector3d> via;
};

/// How far a tool leaves its path, the straight line or the arc between its poses at a motion's begin and end. All
/// numbers are proven, rounding included: lower <= largest deviation over the whole motion <= upper.
///
/// The distance is that of the tool's origin from the nearest point of the path. The angle is that between the tool's
/// orientation and the one that it should have there. The latter is measured against the path, as a torch is set
/// against a seam. Along an arc all directions turn with the tangent, about the circle's axis. Seen so, the tool should
/// go from its first orientation to its last one by the shortest rotation, as far as the nearest point of the path has
/// gone. Along a straight line no direction turns. So a tool that turns with its arc has the angle 0, and so has one
/// that keeps its orientation in the world along an arc of less than 2.5 rad. If the ends are turned by more than 2.5
/// rad against each other, seen so, the angle is left open: it is from 0 to pi. Far from an arc the nearest point may
/// jump, and the angle is not bracketed narrowly. Far is 0.9 times the arc's radius, or, if the arc is more than half a
/// circle, 0.9 times half of the distance between its ends.
struct ToolDeviation {
  double distance_lower = 0, distance_upper = 0;  ///< m
  double distance_time = 0;                       ///< when the tool is at least distance_lower away
  double angle_lower = 0, angle_upper = 0;        ///< rad; angles above 2.5 are not told from pi
  double angle_time = 0;                          ///< when the tool is turned by at least angle_lower
  double length = 0;                              ///< of the path, m, as computed in doubles
  /// Whether both brackets are as narrow as was asked for. False if the work budget ran out.
  bool within_tolerance = false;

  /// Whether the tool certainly keeps as near as that, in m and rad, at all times.
  bool certainlyKeeps(double distance, double angle) const {
    return distance_upper <= distance && angle_upper <= angle;
  }
  /// Whether the tool certainly is farther away, or turned farther, than that at some time.
  bool certainlyLeaves(double distance, double angle) const { return distance_lower > distance || angle_lower > angle; }
};

/// Finds how far a tool leaves the straight line, or an arc, between its poses at a motion's ends. Use it for welding,
/// gluing and cutting along that path while the joints go by splines. Says nothing of contacts.
/// @param link  that carries the tool.
/// @throws std::out_of_range for a link that the tree lacks.
/// @throws std::invalid_argument
///   - for a motion of another tree, and one by tangents of half angles;
///   - for a tool frame that is not rigid to 1e-9, and values outside the ranges given in ToolLineRequest;
///   - for ends less than 1e-6 m apart;
///   - for `via` not finite, beyond 1e9 m, or less than 1e-6 m from an end;
///   - for `via` nearly on a straight line with both ends: the circle's radius is above 1000 times their largest
///     distance;
///   - for points whose rounding is above a thousandth of an arc so small.
FCL_ARTIC_EXPORT ToolDeviation toolDeviation(const KinematicTree& tree, const JointMotion& motion, const LinkRef& link,
                                             const ToolLineRequest& request = {});
/// The same over all of a trajectory; times are the trajectory's own.
/// @throws as toolDeviation() of a JointMotion.
FCL_ARTIC_EXPORT ToolDeviation toolDeviation(const KinematicTree& tree, const JointTrajectory& trajectory,
                                             const LinkRef& link, const ToolLineRequest& request = {});

}  // namespace fcl_artic
