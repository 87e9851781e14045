// SPDX-License-Identifier: BSD-3-Clause
//
// Fewer balls that hold all of many (doc/NUMERICS.md, "Thinned clouds").
#pragma once

#include <vector>

#include <Eigen/Core>

namespace fcl_artic {

struct ThinnedBalls {
  std::vector<Eigen::Vector3d> centers;
  std::vector<double> radii;
};

/// One ball for each cube of a grid in which points lie, in the order of the cubes' first points. It holds the balls
/// around all points of its cube. The answer does not depend on the number of threads.
/// @param points  finite, at most 1e9 m away.
/// @param radii   one for all, or one each; positive.
/// @param voxel   a cube's side, 1e-6 m at least.
ThinnedBalls thin(const std::vector<Eigen::Vector3d>& points, const std::vector<double>& radii, double voxel);

}  // namespace fcl_artic
