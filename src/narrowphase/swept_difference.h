// SPDX-License-Identifier: BSD-3-Clause
//
// Directions for a whole time interval. A direction n that is fixed in the still body's frame certifies an interval
// (certificate.h) if all points of the moving piece, at the three Bernstein poses R_k p + c_k, lie far enough along n.
// Any n that separates the still piece from the convex hull of these three placed pieces does so, and GJK between the
// two finds one where there is one. The witness at the interval's middle is such an n only where the bodies move little
// (doc/NUMERICS.md, section 4). A heuristic, as gjk.h: the certificate checks what it finds.
#pragma once

#include "convex/gjk.h"
#include "narrowphase/certificate.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

/// The difference of the hull of a moving piece's Bernstein poses in one lane and a still piece: both bounded.
class SweptDifference {
 public:
  SweptDifference(const Side& side, const Piece& still, const Piece& moving, int lane)
      : side_(side), still_(still), moving_(moving) {
    for (int k = 0; k < 3; ++k) {
      R_[k] = laneOf(side.m.Rb[k], lane);
      c_[k] = laneOf(side.m.cb[k], lane);
    }
  }
  /// The difference's point that is least along n.
  void support(const Vec3& n, DifferencePoint& p) const {
    Vec3 x, u[3];
    double origin[3];
    for (int k = 0; k < 3; ++k) {
      u[k] = -transposedTimes(R_[k], n);
      origin[k] = -dot(n, c_[k]);
    }
    const int pose = farthest(u, origin, x);
    p.w = R_[pose] * x + c_[pose] - supportPoint(*side_.still, still_, n);
  }
  /// A point's w is all there is: no simplex of another pose is begun with.
  void subtract(DifferencePoint&) const {}

 private:
  /// The pose k, and the moving core's point x, for which u_k.x + origin_k is largest.
  int farthest(const Vec3* u, const double* origin, Vec3& x) const {
    constexpr int kStride = kNumbered / 4;
    if (moving_.kind == PieceKind::hull && moving_.num_vertices <= kStride) {  // all poses in one pass
      const double* p = side_.moving->hulls + moving_.first_vertex;
      const int n = moving_.num_vertices;
      Lanes most(-kInfinite);
      for (int i = 0; i < n; i += kLanes) {
        for (int k = 0; k < 3; ++k) {
          most = max(most, numbered(hullValues(p, n, i, u[k]) + Lanes(origin[k]), kStride * k + i));
        }
      }
      const int found = numberOf(maxLane(most)), i = found % kStride;
      for (int k = 0; k < 3; ++k) x[k] = p[k * n + i];
      return found / kStride;
    }
    int pose = 0;
    double most = -kInfinite;
    for (int k = 0; k < 3; ++k) {
      const Vec3 y = supportPoint(*side_.moving, moving_, u[k]);
      const double value = dot(u[k], y) + origin[k];
      if (!(value > most)) continue;
      most = value;
      pose = k;
      x = y;
    }
    return pose;
  }

  const Side& side_;
  const Piece &still_, &moving_;
  Mat3 R_[3];
  Vec3 c_[3];
};

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
