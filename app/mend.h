// SPDX-License-Identifier: BSD-3-Clause
//
// Detours around what a plan touches. (Needs OMPL.)
#pragma once

#include <memory>

#include "fcl_artic/ompl/mend.h"
#include "plans/motion.h"

namespace fcl_artic::app {

using planning::MendOptions;

/// A way with detours as a plan, without velocities.
struct Mended : planning::Mended {
  plans::Plan plan;
};

/// Mends a plan (planning::mend()), with the same detours each time.
/// @throws std::runtime_error as planning::mend(); that this program was built without OMPL.
Mended mend(const std::shared_ptr<const ArticulatedCollisionManager>& manager, const plans::PlanMotion& motion,
            plans::Turns turns, const MendOptions& options);

/// @throws std::runtime_error that this program was built without OMPL.
void requireMending();

}  // namespace fcl_artic::app
