// SPDX-License-Identifier: BSD-3-Clause
//
// Brings two points at the ends of a chain of joints near each other. Nothing is proven here: it finds configurations
// in which links come near each other, or touch.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "model/sweep.h"
#include "tables/value_range.h"

namespace fcl_artic {

/// Moves one variable after the other to where the points are nearest, from the last step to the first, again and again
/// (cyclic coordinate descent; Wang and Chen, "A combined optimization method for solving the inverse kinematics
/// problem", 1991). It ends where a round over all variables gains little, or after `sweeps` rounds.
/// @param path  turns about and slides along an axis, one after the other; SweepStep::variable is an index into
/// `within`.
/// @param within  the range in which each variable stays; finite.
/// @param a  in the frame before the first step.
/// @param b  in the last step's frame.
/// @param sweeps  maximum number of rounds.
/// @param[in,out] values  of each variable.
/// @return the points' distance, m.
double bringTogether(const std::vector<engine::SweepStep>& path, const std::vector<ValueRange>& within,
                     const Eigen::Vector3d& a, const Eigen::Vector3d& b, int sweeps, std::vector<double>& values);

}  // namespace fcl_artic
