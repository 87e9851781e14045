// SPDX-License-Identifier: BSD-3-Clause
//
// Gilbert, Johnson, Keerthi: nearest points of two cores at one pose. A heuristic: its direction is checked by the
// certificate, its simplex by the contact proof; nothing rests on it.
#pragma once

#include "convex/piece_kinds.h"
#include "numerics/assertion.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

/// Pose of B in A's frame at one time.
struct PoseAt {
  Mat3 R;
  Vec3 c;
  /// The direction opposite to n (A's frame), in B's frame.
  Vec3 opposite(const Vec3& n) const { return -transposedTimes(R, n); }
};

/// A point w of the difference B - A (A's frame), and where it came from: a in A's frame, b in B's.
struct DifferencePoint {
  Vec3 w, a, b;
};

struct Simplex {
  DifferencePoint v[4];
  double weight[4];
  int n = 0;
};

/// The two cores at a pose; `shift` moves the origin of the difference (contact proof, Lemma 2).
struct DifferenceBody {
  const TreeView* tree_a;
  const Piece* a;
  const TreeView* tree_b;
  const Piece* b;
  PoseAt pose;
  Vec3 shift = {0, 0, 0};

  /// The direction opposite to n (A's frame), in B's frame; bit for bit B's own where B is unbounded and has no other.
  Vec3 opposite(const Vec3& n) const {
    const Vec3 m = pose.opposite(n);
    if (!unbounded(*b)) return m;
    return sizeOf(*b) * (dot(m, sizeOf(*b)) < 0 ? -1.0 : 1.0);
  }

  /// A point of B's frame, in A's.
  Vec3 place(const Vec3& x) const { return pose.R * x + pose.c; }
  /// w of a point whose a and b are known.
  void subtract(DifferencePoint& p) const { p.w = place(p.b) - p.a - shift; }
  /// The difference's point that is least along n.
  void support(const Vec3& n, DifferencePoint& p) const {
    p.a = supportPoint(*tree_a, *a, n);
    p.b = supportPoint(*tree_b, *b, opposite(n));
    subtract(p);
  }
};

struct GjkResult {
  bool overlap = false;   ///< claims that the cores meet (unproven)
  double distance = 0;    ///< of the cores, from above
  double lower = -1e300;  ///< gap of the cores along n
  Vec3 n = {1, 0, 0};     ///< unit, from A to B, the best seen
  Simplex simplex;
  int iterations = 0;
};

/// Barycentric weights of the point of the triangle a, b, c that is nearest to the origin.
inline Vec3 nearestOnTriangle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a;
  // Voronoi regions of vertices, edges and face, by signs of the projections.
  const double d1 = -dot(ab, a), d2 = -dot(ac, a);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  const double d3 = -dot(ab, b), d4 = -dot(ac, b);
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    const double t = d1 / (d1 - d3);
    return {1 - t, t, 0};
  }
  const double d5 = -dot(ab, c), d6 = -dot(ac, c);
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    const double t = d2 / (d2 - d6);
    return {1 - t, 0, t};
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0, 1 - t, t};
  }
  const double f = 1 / (va + vb + vc);
  return {1 - vb * f - vc * f, vb * f, vc * f};
}

/// The combination of the simplex' vertices by its weights.
inline Vec3 combined(const Simplex& s) {
  Vec3 w(0, 0, 0);
  for (int i = 0; i < s.n; ++i) w = w + s.v[i].w * s.weight[i];
  return w;
}

/// How deep the origin lies within a simplex: bodies whose difference holds it overlap by as much along all directions.
inline double depthWithin(const Simplex& s) {
  if (s.n < 4) return 0;
  double depth = 1e300;
  for (int out = 0; out < 4; ++out) {
    const Vec3 &x = s.v[(out + 1) & 3].w, &y = s.v[(out + 2) & 3].w, &z = s.v[(out + 3) & 3].w;
    const Vec3 n = cross(y - x, z - x);
    depth = min(depth, abs(dot(n, x)) / norm(n));
  }
  return depth;
}

/// Reduces the simplex to the face nearest to the origin and gives the nearest point; false when the origin is inside.
inline bool reduceSimplex(Simplex& s, Vec3& v) {
  FCL_ARTIC_ASSERT(s.n >= 1 && s.n <= 4);
  const auto keep = [&](const int* index, const double* l, int n) {
    int kept = 0;  // indices ascend, so nothing is overwritten that is still needed
    for (int i = 0; i < n; ++i) {
      if (!(l[i] > 0)) continue;
      if (kept != index[i]) s.v[kept] = s.v[index[i]];
      s.weight[kept++] = l[i];
    }
    s.n = kept;
    v = combined(s);
    if (s.n == 3) {
      // On a face the sum above is off along it by what rounding makes of the weights, and next to a tiny gap that
      // would turn the direction. The foot of the perpendicular has the face's normal whatever the gap.
      const Vec3 m = cross(s.v[1].w - s.v[0].w, s.v[2].w - s.v[0].w);
      const double mm = dot(m, m);
      if (mm > 0) v = m * (dot(m, s.v[0].w) / mm);
    }
  };
  if (s.n == 1) {
    const int index[1] = {0};
    const double l[1] = {1};
    keep(index, l, 1);
    return true;
  }
  if (s.n == 2) {
    const Vec3 ab = s.v[1].w - s.v[0].w;
    const double q = dot(ab, ab);
    const double t = q > 0 ? min(1.0, max(0.0, -dot(s.v[0].w, ab) / q)) : 0;
    const int index[2] = {0, 1};
    const double l[2] = {1 - t, t};
    keep(index, l, 2);
    return true;
  }
  if (s.n == 3) {
    const int index[3] = {0, 1, 2};
    keep(index, nearestOnTriangle(s.v[0].w, s.v[1].w, s.v[2].w).k, 3);
    return true;
  }
  static const int kFaces[4][4] = {{0, 1, 2, 3}, {0, 1, 3, 2}, {0, 2, 3, 1}, {1, 2, 3, 0}};  // indices ascend
  double best = 1e300;
  Vec3 best_l(0, 0, 0);
  int best_face = -1;
  for (int f = 0; f < 4; ++f) {
    const Vec3 &a = s.v[kFaces[f][0]].w, &b = s.v[kFaces[f][1]].w, &c = s.v[kFaces[f][2]].w, &e = s.v[kFaces[f][3]].w;
    const Vec3 m = cross(b - a, c - a);
    if (-dot(m, a) * dot(m, e - a) > 0) continue;  // the origin is on the inner side of this face
    const Vec3 l = nearestOnTriangle(a, b, c), x = a * l[0] + b * l[1] + c * l[2];
    const double q = dot(x, x);
    if (q < best) {
      best = q;
      best_face = f;
      best_l = l;
    }
  }
  if (best_face < 0) return false;
  keep(kFaces[best_face], best_l.k, 3);
  return true;
}

/// The normal of the unbounded one of two pieces in A's frame, from A to B.
inline Vec3 unboundedNormal(const DifferenceBody& body) {
  return unbounded(*body.a) ? sizeOf(*body.a) : -(body.pose.R * sizeOf(*body.b));
}

/// An unbounded piece against a bounded one: there is one direction, or two for a plane, and no search.
inline void unboundedGap(const DifferenceBody& body, double radii, GjkResult& out) {
  const Piece& piece = unbounded(*body.a) ? *body.a : *body.b;
  Vec3 n = unboundedNormal(body);
  out.lower = -1e300;
  for (int side = 0; side < (piece.kind == PieceKind::plane ? 2 : 1); ++side) {
    DifferencePoint p;
    body.support(n, p);
    const double gap = dot(n, p.w);
    if (gap > out.lower) {
      out.lower = gap;
      out.simplex.v[0] = p;
      out.n = n;
    }
    n = -n;
  }
  out.simplex.weight[0] = 1;
  out.simplex.n = 1;
  out.iterations = 1;
  out.overlap = out.lower <= radii;
  out.distance = max(0.0, out.lower);
}

/// The accuracy of a search, and the conditions that end it.
struct GjkOptions {
  double accuracy;            ///< the distance is known to this part of the gap beyond `radii`
  double radii;               ///< rounding radii and margin: cores nearer than this overlap
  int max_iterations;         ///< support points that are asked for, at most
  double enough = kInfinite;  ///< a direction is found along which the gap is larger
};

/// Whether a support point is one of the simplex: then it can't be brought nearer.
inline bool holdsPoint(const Simplex& s, const DifferencePoint& p) {
  bool known = false;
  for (int i = 0; i < s.n; ++i) {
    const bool x = s.v[i].w[0] == p.w[0], y = s.v[i].w[1] == p.w[1], z = s.v[i].w[2] == p.w[2];
    known |= x & y & z;
  }
  return known;
}

/// Makes an answer that contradicts itself, by rounding, one that does not.
inline void reconcile(double radii, GjkResult& out) {
  // A flat simplex may claim 'inside' although a separating plane was seen: believe the plane.
  if (out.overlap && out.lower > radii) {
    out.overlap = false;
    out.distance = max(out.lower, radii);
  }
  if (!out.overlap && out.distance <= radii && out.lower <= radii) out.overlap = true;
}

/// The search itself, in any bounded convex body with a function for its support points.
/// @tparam kKeepNearest  the simplex is that of the distance, also where the last step made none that is nearer.
///   (Rounding can make of a flat simplex one that is far off.) For reports, at the expense of a copy each step.
/// The parameters are gjk()'s.
template <bool kKeepNearest = false, class ConvexBody>
inline void searchNearest(const ConvexBody& body, const Vec3& guess, const GjkOptions& options, GjkResult& out,
                          const Simplex* start = nullptr) {
  const double radii = options.radii;
  out.overlap = false;
  out.lower = -1e300;
  const double given = norm(guess);
  const bool usable = given > 1e-100;  // far from underflow
  double best_length = usable ? given : 1;
  Vec3 best = usable ? guess : Vec3(1, 0, 0);  // the direction with the largest lower bound so far
  Vec3 v;
  double size2 = 0;  // the largest |w|^2 seen
  Simplex& s = out.simplex;
  out.iterations = 0;
  bool inside = false;
  if (start && start->n) {
    s.n = start->n;
    for (int i = 0; i < s.n; ++i) {
      s.v[i] = start->v[i];
      body.subtract(s.v[i]);
      size2 = max(size2, dot(s.v[i].w, s.v[i].w));
    }
    inside = !reduceSimplex(s, v);
  } else {
    const DifferencePoint& p = s.v[0];
    body.support(best, s.v[0]);
    out.iterations = 1;
    out.lower = dot(best, p.w) / best_length;
    s.weight[0] = 1;
    s.n = 1;
    size2 = dot(p.w, p.w);
    v = p.w;
  }
  while (!inside && out.iterations < options.max_iterations && !(out.lower > options.enough)) {
    const double vv = dot(v, v);
    // The origin within rounding of a face of the simplex is as good as inside (aligned faces bring that about).
    if (vv <= 1e-30 * size2 || vv < radii * radii * (1 - 1e-13)) {
      out.overlap = true;
      out.distance = sqrt(vv);
      break;
    }
    const double length = sqrt(vv);
    out.distance = length;
    const DifferencePoint& p = s.v[s.n];
    body.support(v, s.v[s.n]);
    ++out.iterations;
    size2 = max(size2, dot(p.w, p.w));
    const double lower = dot(v, p.w) / length;
    if (lower > out.lower) {
      out.lower = lower;
      best_length = length;
      best = v;
    }
    // Relative to the gap, not to the core distance.
    if (length - out.lower <= options.accuracy * max(0.0, length - radii) + 1e-15 * length) break;
    if (holdsPoint(s, p)) break;
    Simplex nearest;
    if constexpr (kKeepNearest) nearest = s;
    ++s.n;
    Vec3 next;
    inside = !reduceSimplex(s, next);  // it stays a tetrahedron then
    if (inside) break;
    if (dot(next, next) >= vv * (1 - 1e-15)) {
      if constexpr (kKeepNearest) s = nearest;
      break;
    }
    v = next;
  }
  out.n = best / best_length;
  if (inside) {
    out.overlap = true;
    out.distance = 0;
  }
  reconcile(radii, out);
}

/// @param guess  direction from A to B to start with, any length but 0.
/// @param start  the simplex that was found for these pieces at another pose, to begin with instead; null or empty:
/// none.
template <bool kKeepNearest = false>
inline void gjk(const DifferenceBody& body, const Vec3& guess, const GjkOptions& options, GjkResult& out,
                const Simplex* start = nullptr) {
  if (unbounded(*body.a) || unbounded(*body.b)) return unboundedGap(body, options.radii, out);
  searchNearest<kKeepNearest>(body, guess, options, out, start);
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
