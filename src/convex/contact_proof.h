// SPDX-License-Identifier: BSD-3-Clause
//
// The proof of contact at one pose (doc/NUMERICS.md, section 8): with solver/ball_proofs.h the only code that `certain`
// rests on. A point w = b - a, computed from support points, lies within eps of a true point of B - A.
#pragma once

#include "convex/gjk.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

/// Lemma 1: the tetrahedron w0..w3 holds the origin so far inside that moving each corner by eps cannot bring it out.
/// The determinants of its consistently oriented faces with the origin have one sign, each larger than what eps and
/// rounding can make of it.
inline bool tetrahedronHoldsOrigin(const DifferencePoint* v, double eps) {
  static const int kFaces[4][3] = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
  double sign = 0;
  for (const int* f : kFaces) {
    const Vec3 &a = v[f[0]].w, &b = v[f[1]].w, &c = v[f[2]].w;
    const Vec3 ab = cross(a, b), bc = cross(b, c), ca = cross(c, a);
    const double determinant = dot(a, bc);
    const double na = norm(a), nb = norm(b), nc = norm(c);
    // 1.25 instead of 1: the cross products' own rounding, which eps >= 40 kUlp |w| covers.
    const double error =
        1.25 * (eps * (norm(ab) + norm(bc) + norm(ca)) + eps * eps * (na + nb + nc) + eps * eps * eps) +
        2e-15 * na * nb * nc;
    if (!(abs(determinant) > error)) return false;
    const double s = determinant > 0 ? 1 : -1;
    if (sign == 0) sign = s;
    if (s != sign) return false;
  }
  return true;
}

/// A segment certainly meets a triangle. The differences of their points are a prism, which is cut into three
/// tetrahedra: one of them certainly holds the origin (doc/NUMERICS.md, Lemma 5).
/// @param a, b  the segment's ends and the triangle's corners in one frame; their differences are off by eps at most.
/// @param weights  of the corners, about where they meet, and `part` of the segment: they choose the tetrahedron.
inline bool certainlyPierces(const Vec3* a, const Vec3* b, double eps, const Vec3& weights, double part) {
  static const int kTetrahedra[3][4][2] = {
      {{0, 0}, {1, 0}, {2, 0}, {2, 1}}, {{0, 0}, {1, 0}, {1, 1}, {2, 1}}, {{0, 0}, {0, 1}, {1, 1}, {2, 1}}};
  const auto& corners = kTetrahedra[part < weights[2] ? 0 : part < weights[1] + weights[2] ? 1 : 2];
  DifferencePoint w[4];
  for (int i = 0; i < 4; ++i) w[i].w = b[corners[i][0]] - a[corners[i][1]];
  return tetrahedronHoldsOrigin(w, eps);
}

/// Weights (>= 0, sum 1) that bring a tetrahedron's combination near the origin. They are barycentric ones, or those
/// of a face where these come nearer, as in a flat tetrahedron, whose volumes are mostly rounding. False when there is
/// nothing to weigh by.
inline bool originWeights(Simplex& s) {
  if (s.n != 4) return true;
  double best = 1e300, weights[4] = {0, 0, 0, 0};
  const auto offer = [&](const double* l) {
    Vec3 w(0, 0, 0);
    for (int i = 0; i < 4; ++i) w = w + s.v[i].w * l[i];
    const double distance = norm(w);
    if (!(distance < best)) return;
    best = distance;
    for (int i = 0; i < 4; ++i) weights[i] = l[i];
  };
  double volume[4], sum = 0;
  for (int i = 0; i < 4; ++i) {
    volume[i] = abs(dot(s.v[(i + 1) & 3].w, cross(s.v[(i + 2) & 3].w, s.v[(i + 3) & 3].w)));
    sum += volume[i];
  }
  if (sum > 0) {
    for (double& x : volume) x /= sum;
    offer(volume);
  }
  for (int out = 0; out < 4; ++out) {
    const int i = (out + 1) & 3, j = (out + 2) & 3, k = (out + 3) & 3;
    double face[4] = {0, 0, 0, 0};
    const Vec3 l = nearestOnTriangle(s.v[i].w, s.v[j].w, s.v[k].w);
    face[i] = max(0.0, l[0]);
    face[j] = max(0.0, l[1]);
    face[k] = max(0.0, l[2]);
    offer(face);
  }
  for (int i = 0; i < 4; ++i) s.weight[i] = weights[i];
  return best < 1e300;
}

/// The points of both pieces, in A's frame, that belong to the weights.
inline void combine(const DifferenceBody& body, const Simplex& s, Vec3& a, Vec3& b) {
  Vec3 x(0, 0, 0);
  a = {0, 0, 0};
  for (int i = 0; i < s.n; ++i) {
    a = a + s.v[i].a * s.weight[i];
    x = x + s.v[i].b * s.weight[i];
  }
  b = body.place(x);
}

/// A half-space holds a point of the other piece, or a plane lies between two of its points: known from support points
/// alone. Each is off by eps at most, and its distance from the boundary, n.x - offset, is the difference point's n.w.
inline bool certainlyTouchesUnbounded(const DifferenceBody& body, double radii, double eps, Vec3& point) {
  const bool unbounded_a = unbounded(*body.a);
  const Piece &piece = unbounded_a ? *body.a : *body.b, &other = unbounded_a ? *body.b : *body.a;
  const Vec3 n = unboundedNormal(body);
  DifferencePoint lowest, highest;
  body.support(n, lowest);
  const double low = dot(n, lowest.w);
  if (!(low + 2 * eps < radii)) return false;
  double part = 0;                                  // of the way from the lowest to the highest point
  double reach = min(other.radius, max(0.0, low));  // of the other's ball, from there towards the boundary
  highest = lowest;
  if (piece.kind == PieceKind::plane) {
    body.support(-n, highest);
    const double high = dot(n, highest.w);  // along n again, of the other's far end
    if (!(high > 2 * eps - radii)) return false;
    if (low < 0 && high > 0) {
      part = low / (low - high);
    } else if (low < 0) {  // all of the core is behind the plane
      part = 1;
      reach = -min(other.radius, -high);
    }
  }
  const Vec3 x = unbounded_a ? body.place(lowest.b) : lowest.a, y = unbounded_a ? body.place(highest.b) : highest.a;
  point = x + (y - x) * part - n * (unbounded_a ? reach : -reach);
  return true;
}

/// Proves that the pieces, grown by their radii and the margin, meet at this pose.
/// @param eps  bound on the error of a computed difference point.
/// @param start  as in gjk().
/// @param[out] point  in A's frame, about midway between points of both that are in contact.
inline bool certainlyTouching(const DifferenceBody& body, double margin, double eps, const Vec3& guess, Vec3& point,
                              const Simplex* start = nullptr) {
  const double radii = body.a->radius + body.b->radius + margin;
  if (unbounded(*body.a) || unbounded(*body.b)) return certainlyTouchesUnbounded(body, radii, eps, point);
  GjkResult g;
  gjk(body, guess, {1e-12, 0.0, 64}, g, start);
  const auto witness = [&](const Simplex& s) {
    Vec3 a, b;
    combine(body, s, a, b);
    point = a + (b - a) * ((body.a->radius + 0.5 * margin) / (radii > 0 ? radii : 1));
  };
  if (!originWeights(g.simplex)) return false;
  witness(g.simplex);
  if (radii > 0) {
    // A convex combination of difference points is one itself: |w| + eps <= radii proves two points near enough.
    // Weights are >= 0 and sum to 1 within 4 ulp; 1e-14 of the sizes covers that and the sums.
    double size = 0, sum = 0;
    const Simplex& s = g.simplex;
    for (int i = 0; i < s.n; ++i) {
      if (!(s.weight[i] >= 0)) return false;
      sum += s.weight[i];
      size = max(size, norm(s.v[i].w));
    }
    if (abs(sum - 1) <= 1e-14 && norm(combined(s)) + eps + 1e-13 * size < radii) return true;
  }
  if (!g.overlap) return false;
  // Complete the simplex to a tetrahedron with support points of its own missing directions.
  Simplex s = g.simplex;
  static const Vec3 kAxes[6] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
  for (int i = 0; i < 6 && s.n < 4; ++i) {
    DifferencePoint p;
    body.support(kAxes[i], p);
    Vec3 e[3], m;
    for (int j = 0; j < s.n; ++j) e[j] = p.w - s.v[j].w;
    bool independent = norm(e[0]) > 0;
    if (s.n >= 2) {
      m = cross(e[0], e[1]);
      independent = norm(m) > 1e-12 * norm(e[0]) * norm(e[1]);
    }
    if (s.n == 3) independent = abs(dot(e[2], m)) > 1e-12 * norm(m) * norm(e[2]);
    if (independent) s.v[s.n++] = p;
  }
  if (s.n == 4 && tetrahedronHoldsOrigin(s.v, eps)) {
    originWeights(s);
    witness(s);
    return true;
  }
  // Lemma 2, for aligned and symmetric poses where the origin lies on a face of every tetrahedron of extreme points.
  // The corners p_k of a tiny regular tetrahedron (circumradius rho) are each a convex combination of difference
  // points, up to a residual r_k. When eps + |r_k| < rho / 3, its inradius, no plane separates the origin from the
  // difference.
  const double rho = 24 * eps, q = rho / sqrt(3.0);
  const Vec3 corners[4] = {{q, q, q}, {q, -q, -q}, {-q, q, -q}, {-q, -q, q}};
  DifferenceBody shifted = body;
  for (const Vec3& corner : corners) {
    shifted.shift = corner;
    GjkResult h;
    gjk(shifted, guess, {1e-12, 0.0, 64}, h, &g.simplex);
    if (h.lower > 0 || !originWeights(h.simplex)) return false;
    double sum = 0, size = 0;
    for (int i = 0; i < h.simplex.n; ++i) {
      if (!(h.simplex.weight[i] >= 0)) return false;
      sum += h.simplex.weight[i];
      size = max(size, norm(h.simplex.v[i].w));
    }
    // A sum of weights that is off by 1e-15 moves the combination by that part of its size. That is less than eps, a
    // multiple of the sizes of both bodies. The rounding of the sum itself stays below 1e-15 size as well.
    if (!(abs(sum - 1) <= 1e-15 && eps + norm(combined(h.simplex)) + 2e-15 * size < rho / 3)) return false;
    witness(h.simplex);  // its combination is the one near the origin, whatever a flat simplex above claimed
  }
  return true;
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
