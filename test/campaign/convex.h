// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "predicates.h"

namespace campaign {

using Mat3 = Eigen::Matrix3d;

/// A convex piece in the world: a triangle, or a solid box, cylinder (axis z) or sphere.
struct Piece {
  enum Kind { triangle, box, cylinder, sphere } kind;
  Triangle corners;  ///< triangle only
  Mat3 R = Mat3::Identity();
  Vec3 centre = Vec3::Zero();
  Vec3 half = Vec3::Zero();  ///< box: half sizes; cylinder: radius, radius, half length; sphere: radius in x
};

/// Bounds on the distance of two pieces, with points that show the upper one. Both hold up to the rounding of the
/// coordinates, whether or not the search behind them converged: `lower` is the gap along a direction, `upper` the
/// distance of a point of A and a point of B. Spheres that overlap a body by less than their radius have negative
/// values.
struct Separation {
  double lower, upper;
  Vec3 a, b;       ///< of the cores (a sphere's core is its centre)
  Vec3 direction;  ///< unit, from A to B; zero when none was found
};

/// @param wanted  stop when upper - lower is at most this share of upper - margin (or 1e-14 m)
Separation separation(const Piece& A, const Piece& B, double wanted, double margin = 0);

/// Gap between the pieces along the unit direction n: least n.b over B less the largest n.a over A.
double gapAlong(const Piece& A, const Piece& B, const Vec3& n);

/// Depth of point x inside a solid piece (distance to its surface), negative outside; -infinity for a triangle.
double depthInside(const Piece& solid, const Vec3& x);

/// Shows a point common to both, at least `margin` (m) inside one of them, a solid. False when none was found.
bool clearlyOverlap(const Piece& A, const Piece& B, double margin);

}  // namespace campaign
