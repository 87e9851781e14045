// SPDX-License-Identifier: BSD-3-Clause
//
// Two points at the ends of a chain of joints, brought as near each other as the joints let them. Nothing is proven
// here: this finds the configurations in which links come near each other, or touch.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "model/sweep.h"
#include "tables/value_range.h"

namespace fcl_artic {

/// Moves one variable after the other to where the points are nearest, from the last step to the first, again and again
/// (cyclic coordinate descent; Wang and Chen, "A combined optimization method for solving the inverse kinematics
/// problem", 1991). It ends in a place that no single variable can better, by much.
/// @param path  turns about and slides along an axis, one after the other; SweepStep::variable counts in `within`.
/// @param within  values to stay in, of each variable; finite.
/// @param a  in the frame before the first step.
/// @param b  in the last step's frame.
/// @param sweeps  at most.
/// @param[in,out] values  of each variable.
/// @return the points' distance, m.
double bringTogether(const std::vector<engine::SweepStep>& path, const std::vector<ValueRange>& within,
                     const Eigen::Vector3d& a, const Eigen::Vector3d& b, int sweeps, std::vector<double>& values);

}  // namespace fcl_artic
