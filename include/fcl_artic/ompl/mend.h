// SPDX-License-Identifier: BSD-3-Clause
//
// Detours around what a way touches.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "fcl_artic/export.h"
#include "fcl_artic/interpolation.h"
#include "fcl_artic/manager.h"

namespace fcl_artic::planning {

/// Options of mend().
struct MendOptions {
  double seconds = 5;        ///< It takes no longer than this, about; above 0.
  double clearance = 0.005;  ///< m, that detours keep beyond the margin; less only where no way is found that does
  CertifiedRequest request;  ///< margin, scope and budget of what is asked of the manager
};

/// A way with detours. It goes straight between its waypoints. Nothing is said of it here: it is to be certified as any
/// other.
struct Mended {
  Waypoints waypoints;      ///< times and positions of all variables
  std::size_t detours = 0;  ///< stretches that were replaced
  double kept = 0;          ///< m, that the detours are proven to keep beyond the margin
  double deviation = 0;     ///< of any joint from the way, at the same share of a stretch's length, rad or m: the most
  std::string deviation_joint;  ///< the joint, or a value of its
  bool deviation_is_angle = true;
  double added_time = 0;    ///< in the unit of the times: that the way takes longer
  double length_ratio = 1;  ///< of the way in joint space, beside that of the one given
  double ms = 0;            ///< time that it took
};

/// Replaces the stretches of a way that are not proven free when every joint goes straight between the waypoints:
/// - by a way that leaves the given one by a little, between a point before the stretch and one after it, each motion
///   of it certified;
/// - if there is none, by a way that RRTConnect finds with the certified validator, simplified by certified shortcuts
///   and brought back towards the given way;
/// - if there is none, by such ways between points farther apart.
///
/// Both ends of a detour and the detour itself keep the clearance. A stretch that is proven free stays as it is,
/// however near it passes. A stretch that becomes longer takes longer in proportion: its times are no law that a
/// controller's limits went into.
/// @param manager    set up.
/// @param given      times and positions.
/// @param variables  that detours may move; the others stay where the first waypoint has them.
/// @param unwrap     of the given way (JointTrajectory::linear()).
/// @throws std::invalid_argument
///   - for a null manager;
///   - for times and positions that JointTrajectory::linear() does not take;
///   - for `variables` that are empty, repeated or not the tree's;
///   - for another variable that is not at the same value at all waypoints;
///   - for seconds that are not above 0, and a clearance below 0.
/// @throws std::runtime_error saying why it cannot be: the start or the goal touches, no way was found in the time,
///   joints that planners don't take, variables that are some of a joint's.
FCL_ARTIC_EXPORT Mended mend(const std::shared_ptr<const ArticulatedCollisionManager>& manager, const Waypoints& given,
                             const std::vector<int>& variables, JointTrajectory::Unwrap unwrap,
                             const MendOptions& options = {});

}  // namespace fcl_artic::planning
