// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

namespace fcl_artic {

/// All points within r of the segment from p0 to p1: p0, p1, r.
using LineSweptSphere = std::array<double, 7>;

/// A line swept sphere of little volume that holds balls of one radius about points, at least one: the best that a
/// short search from the points' principal axes finds. The same for the same points.
LineSweptSphere encloseInLineSweptSphere(const std::vector<Eigen::Vector3d>& points, double radius);

}  // namespace fcl_artic
