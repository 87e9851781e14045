// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

#include "model/sweep.h"
#include "model/tree_view.h"

namespace fcl_artic {

/// How far a point of a body goes at most, seen from the base of its sweep, per unit of one joint variable while the
/// others stand still. It is an upper bound (Lemma 2 of doc/NUMERICS.md for n = 1, with that variable in the place of
/// time). It holds where every variable that drives a slide, the moved one included, stays within its `size`, and
/// nowhere else: a turn's lever grows with the slides after it (section 10).
/// @param sweep, step  that carry the body; the path there turns about and slides along axes only.
/// @param size  per variable: the largest absolute value that it has wherever the bound is used.
/// @return m per rad or m.
double reachPerUnit(const engine::SweepView& sweep, int step, const engine::Placement& placement,
                    const engine::TreeView& body, int variable, const std::function<double(int)>& size);

/// The same seen from what the sweep carries, of a point of the body that stands in its base frame. It is for a
/// variable that moves the path's first step and no other. The step's axis is fixed in both, and what matters is how
/// far the points are from it (doc/NUMERICS.md, Lemma 7).
/// @param first  step of the path, revolute or prismatic.
/// @param inverse  base frame in the body's tree frame.
double reachOfBase(const engine::SweepStep& first, const engine::Placement& inverse, const engine::TreeView& body);

}  // namespace fcl_artic
