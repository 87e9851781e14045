// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "generator.h"

namespace fcl_artic::generator {

/// (cos, sin) of the k-th of n equal steps round the circle. Rounded to 2^-30, which hides what mathematical
/// libraries differ in; all that follows is exact or rounded as IEEE 754 says.
Eigen::Vector2d unitVector(int k, int n);
/// n of them, the first half a step from the x axis.
std::vector<Eigen::Vector2d> unitCircle(int n);

/// Points round a closed curve, counter-clockwise seen against the direction in which rings follow one another.
using Ring = std::vector<Eigen::Vector3d>;

/// Adds the closed surface through rings of equal size, closed by fans round `first` and `last`.
void addLoft(Mesh& mesh, const std::vector<Ring>& rings, const Eigen::Vector3d& first, const Eigen::Vector3d& last);
/// The same with flat ends.
void addLoft(Mesh& mesh, const std::vector<Ring>& rings);

struct Circle {
  double x, y, radius;
};
/// `n` points on the convex hull of circles, shrunk by `inset`.
std::vector<Eigen::Vector2d> hullOfCircles(const std::vector<Circle>& circles, double inset, int n);

/// Adds a plate with rounded rims: the hull of circles in the local xy plane, from z0 to z1.
/// @param pose  local to mesh coordinates.
void addPlate(Mesh& mesh, const Eigen::Isometry3d& pose, const std::vector<Circle>& circles, double z0, double z1,
              double rim, int n = 32);

/// Puts the vertices on the grid of 10 µm.
void snap(Mesh& mesh);

/// The mesh, snapped, as OBJ. `title` becomes a comment.
std::string objText(const Mesh& mesh, const std::string& title);

}  // namespace fcl_artic::generator
