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

/// A hull of at most 64 of the points. Empty where it would be a poor picture of the body: too many points to be a part of
/// anything, or most of them far inside (a room, a rack, ten spheres in one mesh).
OuterHull makeOuterHull(const std::vector<Eigen::Vector3d>& points);

}  // namespace fcl_artic
