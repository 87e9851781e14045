// SPDX-License-Identifier: BSD-3-Clause
//
// Motion of a body's frame in another's over eight time intervals, as a quadratic with an a-priori remainder. Symbols:
// motion/remainder.h, and
//   b_k: Bernstein points X0 - X1 + X2, X0 - X2, X0 + X1 + X2: X0 + tau X1 + tau^2 X2 lies in their hull
#pragma once

#include "motion/factors.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

using engine::Placement;

/// A point c0 + tau c1 + tau^2 c2.
struct PointLanes {
  Vec3Lanes c[3];
};

/// Entry [k]: order k, or Bernstein point k.
struct RigidLanes {
  Mat3Lanes R[3];
  Vec3Lanes c[3];
  Mat3Lanes Rb[3];  ///< Bernstein points of R
  Vec3Lanes cb[3];
  Mat3Lanes largest;            ///< of |Rb|, over the three, entry by entry
  double rem_c = 0, rem_R = 0;  ///< |error| of a point p: rem_c + rem_R |p|

  void makeBernstein() {
    const Mat3Lanes ends = R[0] + R[2];
    Rb[0] = ends - R[1];
    Rb[1] = R[0] - R[2];
    Rb[2] = ends + R[1];
    largest = max(abs(ends) + abs(R[1]), abs(Rb[1]));
    const Vec3Lanes e = c[0] + c[2];
    cb[0] = e - c[1];
    cb[1] = c[0] - c[2];
    cb[2] = e + c[1];
  }
};

/// A vector that is fixed in the frame: its value x and scaled derivatives.
FCL_ARTIC_INLINE PointLanes turned(const FrameLanes& f, const Vec3Lanes& x) {
  const Vec3Lanes x1 = cross(f.w, x);
  return {{x, x1, (cross(f.w, x1) + cross(f.al, x)) * Lanes(0.5)}};
}

/// Quadratic of the frame carried by `f` with the constant placement after it; f null: stands still.
inline void place(const FrameLanes* f, const Placement& P, RigidLanes& m) {
  const Vec3Lanes zero = spread(Vec3(0, 0, 0));
  if (!f) {
    m.R[0] = spread(Mat3(P.R));
    m.R[1] = m.R[2] = {zero, zero, zero};
    m.c[0] = spread(Vec3(P.t));
    m.c[1] = m.c[2] = zero;
    return;
  }
  const Mat3 R(P.R);
  for (int j = 0; j < 3; ++j) {
    const PointLanes axis = turned(*f, P.identity ? f->R.column(j) : f->R * R.column(j));
    for (int order = 0; order < 3; ++order) m.R[order].setColumn(j, axis.c[order]);
  }
  m.c[0] = f->o;
  m.c[1] = f->v;
  m.c[2] = f->a;
  if (P.identity) return;
  const PointLanes arm = turned(*f, f->R * Vec3(P.t));
  for (int order = 0; order < 3; ++order) m.c[order] = m.c[order] + arm.c[order];
}

/// The same motion seen from a frame in which the base frame stands at P: M <- P M.
inline void seeFrom(const Placement& P, RigidLanes& m) {
  if (P.identity) return;
  const Mat3 R(P.R);
  for (int order = 0; order < 3; ++order) {
    m.R[order] = R * m.R[order];
    m.c[order] = R * m.c[order];
  }
  m.c[0] = m.c[0] + spread(Vec3(P.t));
}

/// A seen from B where `m` is B seen from A: R^T and -R^T c, by Cauchy products of the quadratics.
inline void invert(const RigidLanes& m, RigidLanes& inverse) {
  for (int order = 0; order < 3; ++order) {
    inverse.R[order] = transposed(m.R[order]);
    Vec3Lanes sum = inverse.R[0] * m.c[order];
    for (int k = 1; k <= order; ++k) sum = sum + inverse.R[k] * m.c[order - k];
    inverse.c[order] = -sum;
  }
}

/// Bounds on rounding that go with a RigidLanes and its inverse.
struct PairPads {
  double pad;   ///< of a certificate or swept box, either way
  double pose;  ///< of a difference point at tm
};

/// The motion of a step's frame over the intervals, seen from the world or from the pair's base frame.
struct FrameMotion {
  const FrameLanes* frame;     ///< null: it stands still
  const MotionBounds& bounds;  ///< all zero where it stands still
  bool first_order;            ///< as SweepView::first_order
  double d;                    ///< half of an interval's length
};

/// Where two bodies are fixed: A in the base frame, B in the frame that moves.
struct BodiesInFrames {
  const Placement &inverse_a, &placement_b;
  double extents;  ///< largest distances of points of A and of B from their own frames' origins, summed
};

/// B seen from A: quadratic, remainders and pads. For the way back, A seen from B, the remainder only: invert() makes
/// the rest.
inline PairPads relateBodies(const FrameMotion& motion, const BodiesInFrames& bodies, double margin, RigidLanes& m,
                             RigidLanes& inverse) {
  const MotionBounds& b = motion.bounds;
  const Placement &inverse_a = bodies.inverse_a, &placement_b = bodies.placement_b;
  const double d = motion.d;
  place(motion.frame, placement_b, m);
  seeFrom(inverse_a, m);

  // Bounds of B's origin seen from A's frame: a point fixed at distance `l` in the step's frame adds B_n l.
  const Rates& r = b.rates;
  const double l = placement_b.length;
  const double D1 = b.D1 + r.first() * l, D2 = b.D2 + r.second() * l, D3 = b.D3 + r.third() * l;
  const double length = b.length + l + inverse_a.length;  // >= |c(t)|
  const double ulps = b.ulps + placement_b.ulps + inverse_a.ulps;
  const Remainder there = remainderOf(r, D1, D3, motion.first_order, ulps, d);
  m.rem_c = there.c;
  m.rem_R = there.R;
  // -R^T c: Leibniz with |R^(n)| <= B_n, |c| <= length, |c^(n)| <= Dn.
  const Remainder back =
      remainderOf(r, D1 + r.first() * length, D3 + 3 * r.first() * D2 + 3 * r.second() * D1 + r.third() * length,
                  motion.first_order, ulps, d);
  inverse.rem_c = back.c;
  inverse.rem_R = back.R;
  const double sizes = length + D1 * d + bodies.extents;
  return {roundingPart(ulps, b.rounding_rate * d) * (sizes + margin) + kLeastLength,
          kUlp * (ulps + kPoseUlps) * sizes + kLeastLength};
}

/// Centre of a ball that is fixed in a step's frame, over the intervals.
/// @param motion  of the frame, which does not stand still.
/// @param radius  with the error of p in it.
/// @return a radius about this centre that holds the ball.
inline double sweepCenter(const FrameMotion& motion, const Vec3& p, double radius, PointLanes& center) {
  const FrameLanes& f = *motion.frame;
  const MotionBounds& b = motion.bounds;
  const double d = motion.d;
  const double reach = norm(p) * (1 + 1e-15);
  const double sizes = b.length + b.D1 * d + reach + radius;
  const Remainder remainder = remainderOf(b.rates, b.D1, b.D3, motion.first_order, b.ulps, d);
  center = turned(f, f.R * p);
  center.c[0] = center.c[0] + f.o;
  center.c[1] = center.c[1] + f.v;
  center.c[2] = center.c[2] + f.a;
  return radius + remainder.c + remainder.R * reach + roundingPart(b.ulps, b.rounding_rate * d) * sizes + kLeastLength;
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
