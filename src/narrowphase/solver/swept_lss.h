// SPDX-License-Identifier: BSD-3-Clause
//
// Links' line swept spheres over eight time intervals (Redon 2004, Section 4): certificates between them, and with
// boxes, along a direction per interval. Most pairs whose boxes in the world meet are separated here, before any hull
// is examined.
#pragma once

#include "model/advisor.h"
#include "model/problem.h"
#include "motion/rigid_lanes.h"
#include "narrowphase/solver/swept_box.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

using engine::Body;
using engine::CoreBox;

/// Squared length below which a difference is no direction: far above underflow.
constexpr double kLeastSquare = 1e-200;

/// A segment in the world, each end a quadratic, grown by a ball.
struct SweptLss {
  PointLanes end[2];
  Lanes per_square;   ///< one over the segment's squared length
  double radius;      ///< remainder and rounding in it
  double reach;       ///< of the ends from the frame of a link's step
  double sizes;       ///< of all numbers that the ends are made of
  double ulps, rate;  ///< what a difference with something else rounds by: roundingPart(ulps, rate)

  /// Sets per_square by the ends.
  void measureSegment() {
    const Vec3Lanes e = end[1].c[0] - end[0].c[0];
    per_square = Lanes(1.0) / max(dot(e, e), Lanes(kLeastSquare));
  }
};

/// @param motion  of the step that carries the body, seen from the world.
FCL_ARTIC_INLINE void sweepLss(const FrameMotion& motion, const Body& body, SweptLss& s) {
  const FrameLanes* const f = motion.frame;
  const MotionBounds& b = motion.bounds;
  s.radius = 0;
  double reach = 0;
  for (int end = 0; end < 2; ++end) {
    const Vec3 p(body.lss + 3 * end);
    reach = max(reach, norm(p) * (1 + 8 * kUlp));
    if (f) {
      s.radius = max(s.radius, sweepCenter(motion, p, body.lss[6], s.end[end]));
      continue;
    }
    s.radius = body.lss[6];
    s.end[end] = {{spread(p), spread(Vec3(0, 0, 0)), spread(Vec3(0, 0, 0))}};
  }
  s.measureSegment();
  s.reach = reach;
  s.sizes = (f ? b.length + b.D1 * motion.d : 0) + reach + s.radius;
  s.ulps = f ? b.ulps : 0;
  s.rate = f ? b.rounding_rate * motion.d : 0;
}

/// Box in the world, `margin` wider.
FCL_ARTIC_INLINE void boundLss(const SweptLss& s, double margin, Vec3Lanes& lo, Vec3Lanes& hi) {
  const Lanes slack((s.radius + margin) * (1 + 4 * kUlp));
  for (int end = 0; end < 2; ++end) {
    const Vec3Lanes* c = s.end[end].c;
    const Vec3Lanes sum = c[0] + c[2], middle = c[0] - c[2], reach1 = abs(c[1]);
    const Vec3Lanes low = min(sum - reach1, middle), high = max(sum + reach1, middle);
    lo = end ? min(lo, low) : low;
    hi = end ? max(hi, high) : high;
  }
  lo = lo - Vec3Lanes(slack, slack, slack);
  hi = hi + Vec3Lanes(slack, slack, slack);
}

/// The same in single precision, rounded outward.
FCL_ARTIC_INLINE void boundLss(const SweptLss& s, double margin, SweptBox& box) {
  Vec3Lanes lo, hi;
  boundLss(s, margin, lo, hi);
  for (int k = 0; k < 3; ++k) {
    box.lo[k] = narrowDown(lo[k]);
    box.hi[k] = narrowUp(hi[k]);
  }
}

/// Ends of a box that holds those of the parts. (A part may have overflowed to NaN. The least of it and others does not
/// hide that: the radius is made of bounds for all parts, and is infinite then. So the others reach to infinity.)
inline void endsOfWhole(const SweptBox& box, float* ends) {
  FloatLanes parts[6];
  __builtin_memcpy(parts, &box, sizeof parts);
  outerLanes(parts, ends);
}

/// A line swept sphere over one lane: both ends' Bernstein points.
inline void sweptOver(int lane, const PointLanes* ends, double radius, engine::SweptLink& part) {
  for (int end = 0; end < 2; ++end) {
    const PointLanes& p = ends[end];
    const Vec3 c0 = laneOf(p.c[0], lane), c1 = laneOf(p.c[1], lane), c2 = laneOf(p.c[2], lane);
    (c0 - c1 + c2).store(part.points[end]);
    (c0 + c1 + c2).store(part.points[2 + end]);
    (c0 - c2).store(part.points[4 + end]);
  }
  part.radius = radius * (1 + 4 * kUlp);
}

/// Least of the Bernstein points of g0 + tau g1 + tau^2 g2.
FCL_ARTIC_INLINE Lanes leastPoint(Lanes g0, Lanes g1, Lanes g2) {
  return min((g0 + g2) - abs(g1), g0 - g2);
}

/// Lanes with a > b sqrt(square), for b >= 0, up to 8 kUlp of either side.
FCL_ARTIC_INLINE unsigned greaterThanRoot(Lanes a, double b, Lanes square) {
  return greater(a, Lanes(0.0)) & greater(a * a, square * Lanes(b * b));
}

/// Steps by which a nearest point of a segment is looked for. Nothing rests on it. Measured: 3 separate hardly more
/// and take 5 to 10 % longer.
constexpr int kNearestSteps = 1;

/// Where a link's segment and a body's box are nearest in the middle of each lane, in the body's tree frame. Nothing is
/// proven of it.
struct NearestToBox {
  Lanes square;         ///< about the square of their distance
  Vec3Lanes point;      ///< of the segment
  Vec3Lanes direction;  ///< from the box to the segment, of any length
};

/// A node's box, as stage 1 takes boxes.
FCL_ARTIC_INLINE CoreBox boxOfNode(const Node& node) {
  CoreBox box;
  doublesOf(node.lo).store(box.lo);
  doublesOf(node.hi).store(box.hi);
  box.radius = 0;
  return box;
}

/// A line swept sphere that holds a box, along the box's longest axis. (The ends round: the radius grows by that.)
inline void lssOfBox(const CoreBox& box, double* lss) {
  const Vec3 lo(box.lo), hi(box.hi), middle = (lo + hi) * 0.5;
  Vec3 across = (hi - lo) * (0.5 * (1 + 4 * kUlp));
  const int along = across[0] > across[1] && across[0] > across[2] ? 0 : across[1] > across[2] ? 1 : 2;
  middle.store(lss);
  middle.store(lss + 3);
  lss[along] -= across[along];
  lss[3 + along] += across[along];
  across[along] = 0;
  lss[6] = (norm(across) + box.radius + 4 * kUlp * (norm(lo) + norm(hi))) * (1 + 8 * kUlp);
}

/// The world as seen from a body's tree frame.
struct WorldSeen {
  const Placement& inverse;
  Vec3Lanes see(const Vec3Lanes& x) const { return Mat3(inverse.R) * x + spread(Vec3(inverse.t)); }
  /// A direction of the tree frame in the world.
  Vec3Lanes back(const Vec3Lanes& l) const { return transposed(Mat3(inverse.R)) * l; }
  Lanes originAlong(const Vec3Lanes& l) const {
    const Vec3Lanes t = spread(Vec3(inverse.t));
    Lanes at(0.0);
    for (int k = 0; k < 3; ++k) at = mulAdd(l[k], t[k], at);
    return at;
  }
  double ulps() const { return inverse.ulps; }
  double length() const { return inverse.length; }
};
/// The tree frame itself.
struct OwnFrame {
  const Vec3Lanes& see(const Vec3Lanes& x) const { return x; }
  const Vec3Lanes& back(const Vec3Lanes& l) const { return l; }
  Lanes originAlong(const Vec3Lanes&) const { return Lanes(0.0); }
  double ulps() const { return 0; }
  double length() const { return 0; }
};

/// The same line swept sphere as seen from a body's tree frame. Its ends are turned and moved, which errs by less than
/// the radius grows (doc/NUMERICS.md, "Line swept spheres").
FCL_ARTIC_INLINE void seeFrom(const Placement& inverse, const SweptLss& s, SweptLss& seen) {
  seen = s;
  const Mat3 R(inverse.R);
  for (PointLanes& end : seen.end) {
    for (Vec3Lanes& c : end.c) c = R * c;
    end.c[0] = end.c[0] + spread(Vec3(inverse.t));
  }
  seen.ulps = s.ulps + inverse.ulps;
  const double pad = roundingPart(seen.ulps, s.rate) * (s.sizes + inverse.length) + kLeastLength;
  seen.radius = (s.radius + pad) * (1 + 4 * kUlp);
  seen.sizes = s.sizes + inverse.length + pad;
}

/// Lanes in which a link's line swept sphere is certainly more than `margin` from a body that stands still.
///
/// In each lane the direction l goes from the box to the segment as they stand in its middle, in the body's tree frame;
/// nothing is assumed of it. Points of the box have l.y <= sum_k max(l_k lo_k, l_k hi_k) = h. The ends seen from there,
/// y(tau) = R x(tau) + t, have l.y(tau) = (R^T l).x(tau) + l.t, a quadratic that lies above its least Bernstein point;
/// a point of the segment between them lies above the lesser. So all are apart by that minus h, over |l|, minus both
/// balls (doc/NUMERICS.md, "Line swept spheres").
/// @param frame  how the line swept sphere's frame is seen from the box's.
template <class Frame>
inline unsigned certainlyApart(const SweptLss& s, const CoreBox& box, const Frame& frame, double margin,
                               NearestToBox& nearest) {
  Vec3Lanes& l = nearest.direction;
  const Vec3Lanes lo = spread(Vec3(box.lo)), hi = spread(Vec3(box.hi));
  const Vec3Lanes begin = frame.see(s.end[0].c[0]), e = frame.see(s.end[1].c[0]) - begin;
  Lanes part(0.5);
  for (int step = 0;; ++step) {
    nearest.point = mulAdd(e, part, begin);
    const Vec3Lanes p = min(max(nearest.point, lo), hi);
    l = nearest.point - p;
    if (step == kNearestSteps) break;
    part = min(max(dot(p - begin, e) * s.per_square, Lanes(0.0)), Lanes(1.0));
  }
  Lanes h(0.0);
  for (int k = 0; k < 3; ++k) h = h + max(l[k] * lo[k], l[k] * hi[k]);
  const Lanes at = frame.originAlong(l);
  const Vec3Lanes u = frame.back(l);
  Lanes least[2];
  for (int end = 0; end < 2; ++end) {
    const Vec3Lanes* c = s.end[end].c;
    least[end] = leastPoint(dot(u, c[0]), dot(u, c[1]), dot(u, c[2]));
  }
  double extent = box.radius + margin;
  for (int k = 0; k < 3; ++k) extent += max(abs(box.lo[k]), abs(box.hi[k]));
  const double pad = roundingPart(s.ulps + frame.ulps(), s.rate) * (s.sizes + frame.length() + extent) + kLeastLength;
  nearest.square = dot(l, l);
  const unsigned known = greater(nearest.square, Lanes(kLeastSquare));
  return known &
         greaterThanRoot(min(least[0], least[1]) + at - h, s.radius + box.radius + margin + pad, nearest.square);
}

/// Lanes in which two links' line swept spheres are certainly more than `margin` apart. It is the same proof along the
/// direction between the segments' nearest points, with the four differences of their ends.
/// @param[out] square  about the square of the segments' distance in the middle of each lane.
inline unsigned certainlyApart(const SweptLss& a, const SweptLss& b, double margin, Lanes& square) {
  // Nearest points of the segments in the middle of each lane: of the lines, then each clamped.
  const Vec3Lanes x = a.end[1].c[0] - a.end[0].c[0], y = b.end[1].c[0] - b.end[0].c[0],
                  r = b.end[0].c[0] - a.end[0].c[0];
  const Lanes zero(0.0), one(1.0), tiny(kLeastSquare);
  const Lanes xx = max(dot(x, x), tiny), yy = max(dot(y, y), tiny), xy = dot(x, y), xr = dot(x, r), yr = dot(y, r);
  Lanes s = min(max((xr * yy - yr * xy) / max(xx * yy - xy * xy, tiny), zero), one);
  const Lanes t = min(max((s * xy - yr) / yy, zero), one);
  s = min(max(mulAdd(t, xy, xr) / xx, zero), one);
  const Vec3Lanes l = mulAdd(y, t, r) - x * s;

  Lanes projected_a[2][3], projected_b[2][3], least;
  for (int end = 0; end < 2; ++end) {
    for (int order = 0; order < 3; ++order) {
      projected_a[end][order] = dot(l, a.end[end].c[order]);
      projected_b[end][order] = dot(l, b.end[end].c[order]);
    }
  }
  for (int i = 0; i < 4; ++i) {
    const Lanes *p = projected_a[i & 1], *q = projected_b[i >> 1];
    const Lanes low = leastPoint(q[0] - p[0], q[1] - p[1], q[2] - p[2]);
    least = i ? min(least, low) : low;
  }
  const double pad = roundingPart(a.ulps + b.ulps, max(a.rate, b.rate)) * (a.sizes + b.sizes + margin) + kLeastLength;
  square = dot(l, l);
  return greaterThanRoot(least, a.radius + b.radius + margin + pad, square) & greater(square, tiny);
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
