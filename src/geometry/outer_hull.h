// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <Eigen/Core>

namespace fcl_artic {

/// A few of a body's points and a radius: the hull of these, grown by the radius, holds all points of the body.
struct OuterHull {
  std::vector<Eigen::Vector3d> vertices;
  double radius = 0;
};

/// A hull of all points where they are at most `most_exact` different ones, its radius 0; else of at most `most` of
/// them. Empty for fewer than 4 points, and for so many that the body must be a scene.
OuterHull makeOuterHull(const std::vector<Eigen::Vector3d>& points, std::size_t most_exact = 160,
                        std::size_t most = 96);

}  // namespace fcl_artic
