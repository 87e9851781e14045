// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

#include "narrowphase/problem.h"

namespace fcl_artic {

/// How far a point of a body goes at most, seen from the base of its sweep, per unit of one joint variable while the
/// others stand still: an upper bound, for all values of the variables within `size` (Lemma 2 of doc/NUMERICS.md for n
/// = 1, with that variable in the place of time).
/// @param sweep, step  that carry the body; the path there turns about and slides along axes only.
/// @param size  per variable: its largest absolute value.
/// @return m per rad or m.
double reachPerUnit(const engine::SweepView& sweep, int step, const engine::Placement& placement,
                    const engine::TreeView& body, int variable, const std::function<double(int)>& size);

}  // namespace fcl_artic
