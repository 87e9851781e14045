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

/// A hull of all points where they are at most 160 different ones, its radius 0; else of at most 64 of them. Empty for fewer than 4 points, and for so many that the body must be a scene.
OuterHull makeOuterHull(const std::vector<Eigen::Vector3d>& points);

}  // namespace fcl_artic
