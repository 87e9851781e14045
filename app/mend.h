// SPDX-License-Identifier: BSD-3-Clause
//
// Detours around what a plan touches. (Needs OMPL.)
#pragma once

#include <memory>
#include <string>

#include "fcl_artic/manager.h"
#include "plans/motion.h"

namespace fcl_artic::app {

struct MendOptions {
  double seconds = 5;        ///< for one plan, at most
  double clearance = 0.005;  ///< m, that detours keep beyond the margin; less only where no way is found that does
  CertifiedRequest request;  ///< margin, scope and budget of what planners ask
};

/// A plan with detours. It goes straight between its waypoints and has no velocities. Nothing is said of it here: it is
/// to be certified as any other plan.
struct Mended {
  plans::Plan plan;
  std::size_t detours = 0;  ///< stretches that were replaced
  double kept = 0;          ///< m, that the detours are proven to keep beyond the margin
  double deviation = 0;     ///< of any joint from the plan, at the same share of a stretch's length, rad or m: the most
  std::string deviation_joint;  ///< the joint, or a value of its
  bool deviation_is_angle = true;
  double added_time = 0;    ///< s, that the plan takes longer, if it has times
  double length_ratio = 1;  ///< of the way in joint space, beside that of the plan straight between its waypoints
  double ms = 0;            ///< time that it took
};

/// Replaces what is not proven free, when every joint goes straight between the plan's waypoints: by ways between two
/// points of the plan, before and after it, that leave the plan by a little, each motion of them certified; where none
/// is found, by ways that RRTConnect with the certified validator finds, simplified by certified shortcuts and brought
/// back towards the plan; then by such ways between points farther apart. Both ends of a way and the way itself keep
/// the clearance. What is free of the plan stays as it is, however near it passes. A stretch that becomes longer takes
/// longer in proportion: its times are no law that a controller's limits went into.
/// @param manager  set up.
/// @throws std::runtime_error saying why it cannot be: the start or the goal touches, no way was found in the time,
///   joints that planners don't take; that this program was built without OMPL.
Mended mend(const std::shared_ptr<const ArticulatedCollisionManager>& manager, const plans::PlanMotion& motion,
            plans::Turns turns, const MendOptions& options);

/// @throws std::runtime_error that this program was built without OMPL.
void requireMending();

}  // namespace fcl_artic::app
