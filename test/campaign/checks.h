// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "engine.h"
#include "harness.h"
#include "oracle.h"

namespace campaign {

/// Compares an answer with the sampled truth and with itself. Faults are
///   missed      a sampled contact, and the answer says that its pair (or the motion) is free
///   late        t_lower after the first sampled contact
///   false       the gap stays above the distance tolerance all through the bracket
///   unproven    `certain`, and no contact up to t_upper
///   wide        `certain`, and the bracket wider than both tolerances and the rounding floor
///   undecided   without a work budget
///   fields      bracket out of order or out of [0, 1], unknown or unchecked pair, ids out of range, ...
///   point       contact point away from one of the bodies, or from the named triangles
///   normal      not unit, or the named pieces are not on their sides of it
///   poses       link poses at t_lower differ from our own kinematics
std::vector<Finding> examine(const Scene& scene, const Oracle& oracle, const Truth& truth, const Answer& answer);

/// Faults put into such answers on purpose.
const std::vector<Mutant<Scene, Answer>>& mutants();

}  // namespace campaign
