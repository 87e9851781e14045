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

/// Makes the hull of all points, of radius 0, if at most `most_exact` of them differ. Else it makes the hull of at
/// most `most` of them, with a radius that makes up for the others. Empty for fewer than 4 points, and for more than
/// any single body has (kMaxPoints, kMaxDifferent): those are whole scenes.
OuterHull makeOuterHull(const std::vector<Eigen::Vector3d>& points, std::size_t most_exact = 160,
                        std::size_t most = 96);

}  // namespace fcl_artic
