// SPDX-License-Identifier: BSD-3-Clause
//
// Symbols. a_i and x_j are the vertices of A and of B, in A's frame; a'_i = a_(i+1) - a_i and x'_j are their edges, and
// D_ij = x_j - a_i. Where s vanishes, two features touch if they also meet inside themselves:
//   vertex x_j on face a     s = (a'_0 x a'_1) . D_0j,    inside: ((a'_0 x a'_1) x a'_i) . D_ij > 0 for all i
//   vertex a_i on face x     s = (x'_0 x x'_1) . -D_i0,   inside: ((x'_0 x x'_1) x x'_j) . -D_ij > 0 for all j
//   edge a'_i on edge x'_j   s = m . D_ij, m = a'_i x x'_j, U = m . (D_ij x x'_j), V = m . (D_ij x a'_i),
//                            inside: U, V, m.m - U, m.m - V > 0
// (A common point a_i + u a'_i = x_j + v x'_j of both edges has u m.m = U and v m.m = V: cross with the other edge, dot
// with m.) Differences of vertices come first, so the determinants scale with the triangles and not with their distance
// from the origin.
//
// When triangles that are apart come to touch, a vertex of one lies on the other, or two edges meet (all closed sets).
// So if each of the 15 equations is excluded over an interval of time, no first contact is in it. An equation is
// excluded if its s has no root, or if a direction keeps its two features apart. The direction stands in for the inside
// test: it decides even where s vanishes identically (coplanar, parallel and zero-length features).
#include "narrowphase/elementary.h"

#include <algorithm>
#include <cmath>

#include "narrowphase/parting_direction.h"
#include "numerics/constants.h"

namespace fcl_artic {
namespace {

using Eigen::Vector3d;

/// Upper bound of a sum of terms >= 0 that took up to 60 operations; the constant covers underflow, flushed or gradual.
double roundUp(double x) {
  return x * (1 + 0x1p-46) + 1e-300;
}

/// f(tau) = c0 + c1 tau + c2 tau^2 +- rem for tau in [-1, 1].
struct Quadratic {
  double c0 = 0, c1 = 0, c2 = 0, rem = 0;

  double size() const { return std::abs(c0) + std::abs(c1) + std::abs(c2); }
  Quadratic operator-() const { return {-c0, -c1, -c2, rem}; }
};

// One operation per coefficient: each is off by at most kUlp times itself.
Quadratic operator+(const Quadratic& f, const Quadratic& g) {
  Quadratic h{f.c0 + g.c0, f.c1 + g.c1, f.c2 + g.c2, 0};
  h.rem = roundUp(f.rem + g.rem + kUlp * h.size());
  return h;
}

Quadratic operator-(const Quadratic& f, const Quadratic& g) {
  return f + -g;
}

// |tau| <= 1 lets the coefficients of tau^3 and tau^4 go into the remainder. A product and two sums: an error of
// 3.01 kUlp times the sum of the |f_i g_j|, which is f.size() g.size() over all coefficients.
Quadratic operator*(const Quadratic& f, const Quadratic& g) {
  const double F = f.size(), G = g.size();
  Quadratic h{f.c0 * g.c0, f.c0 * g.c1 + f.c1 * g.c0, f.c0 * g.c2 + f.c1 * g.c1 + f.c2 * g.c0, 0};
  h.rem = roundUp(std::abs(f.c1 * g.c2 + f.c2 * g.c1) + std::abs(f.c2 * g.c2) + f.rem * (G + g.rem) + g.rem * F +
                  4 * kUlp * F * G);
  return h;
}

/// Remainder, and the rounding of c0 +- c1 +- c2 (two operations).
double slack(const Quadratic& f) {
  return roundUp(f.rem + 4 * kUlp * f.size());
}

/// The Bernstein points c0 - c1 + c2, c0 - c2, c0 + c1 + c2 have the quadratic in their hull.
bool certainlyPositive(const Quadratic& f) {
  return std::min(f.c0 + f.c2 - std::abs(f.c1), f.c0 - f.c2) > slack(f);
}

bool certainlyChangesSign(const Quadratic& f) {
  const double left = f.c0 + f.c2 - f.c1, right = f.c0 + f.c2 + f.c1, e = slack(f);
  return (left > e && right < -e) || (left < -e && right > e);
}

/// Smallest size of the slope c1 + tau c2; <= 0 when it may vanish.
double slope(const Quadratic& f) {
  return (std::abs(f.c1) - std::abs(f.c2)) * (1 - 4 * kUlp);
}

/// Interval Newton (18) from the middle: a root has tau = -(c0 +- rem) / (c1 + tau c2). The slope c1 + tau c2 is used
/// instead of the derivative: it needs no derivative of the remainder, and its range is half as wide.
/// @param[out] lo, hi  hold all roots in [-1, 1]
/// @return false when there is none
bool contractRoots(const Quadratic& f, double& lo, double& hi) {
  lo = -1;
  hi = 1;
  if (certainlyPositive(f) || certainlyPositive(-f)) return false;
  const double least = slope(f), most = (std::abs(f.c1) + std::abs(f.c2)) * (1 + 4 * kUlp);
  if (!(least > 0)) return true;
  const double root = f.c1 > 0 ? -f.c0 : f.c0, low = root - f.rem, high = root + f.rem;
  const double left = low / (low > 0 ? most : least), right = high / (high > 0 ? least : most);
  lo = std::max(lo, left - 8 * kUlp * std::abs(left));  // a sum, the slope's 2 operations, a quotient
  hi = std::min(hi, right + 8 * kUlp * std::abs(right));
  return lo <= hi;
}

struct Vector {
  Quadratic k[3];
};
Vector operator-(const Vector& v, const Vector& w) {
  return {{v.k[0] - w.k[0], v.k[1] - w.k[1], v.k[2] - w.k[2]}};
}
Vector operator-(const Vector& v) {
  return {{-v.k[0], -v.k[1], -v.k[2]}};
}
Quadratic dot(const Vector& v, const Vector& w) {
  return v.k[0] * w.k[0] + v.k[1] * w.k[1] + v.k[2] * w.k[2];
}
Vector cross(const Vector& v, const Vector& w) {
  return {{v.k[1] * w.k[2] - v.k[2] * w.k[1], v.k[2] * w.k[0] - v.k[0] * w.k[2], v.k[0] * w.k[1] - v.k[1] * w.k[0]}};
}
Vector constant(const Vector3d& v) {
  return {{{v[0]}, {v[1]}, {v[2]}}};
}

/// Features of an equation, as sets of vertices (bit i: vertex i).
struct Equation {
  enum { vertexFace, faceVertex, edgeEdge } kind;
  int i, j;  ///< vertex or edge of A, of B
  int a, b;  ///< vertices
};
constexpr int kFace = 7, kEdge[3] = {3, 6, 5}, kNumEquations = 15, kAll = (1 << kNumEquations) - 1;

Equation equation(int k) {
  if (k < 3) return {Equation::vertexFace, k, 0, 1 << k, kFace};
  if (k < 6) return {Equation::faceVertex, 0, k - 3, kFace, 1 << (k - 3)};
  const int i = (k - 6) / 3, j = (k - 6) % 3;
  return {Equation::edgeEdge, i, j, kEdge[i], kEdge[j]};
}

/// Removes the component along u from v, to within rounding of |v|.
void removeAlong(const Vector3d& u, Vector3d& v) {
  const double length2 = u.squaredNorm();
  if (length2 > 0) v -= v.dot(u) / length2 * u;
}

/// Closest point of a feature, and the feature's directions there (0 at an end), at right angles to the way.
struct Foot {
  Vector3d point, e = Vector3d::Zero(), f = Vector3d::Zero();
};

/// Closest points of an equation's features. No proof rests on them: they give directions to try, and places to report.
struct Nearest {
  Vector3d a, x;
  Foot foot;

  double distance() const { return (x - a).norm(); }
  /// The direction of x - a. Cancellation turns the difference by rounding / distance. Removing its components along
  /// the features mends that, so gaps below the root of the rounding error are seen.
  Vector3d direction() const {
    Vector3d n = x - a, f = foot.f;
    removeAlong(foot.e, n);
    removeAlong(foot.e, f);
    removeAlong(f, n);
    return n;
  }
};

Foot footOnEdge(const Vector3d& p, const Vector3d& from, const Vector3d& to) {
  const Vector3d e = to - from;
  const double length2 = e.squaredNorm(), along = length2 > 0 ? e.dot(p - from) / length2 : 0;
  if (!(along > 0)) return {from};
  if (!(along < 1)) return {to};
  return {from + along * e, e};
}

Foot footOnFace(const Vector3d& p, const Vector3d v[3]) {
  const Vector3d n = (v[1] - v[0]).cross(v[2] - v[1]);
  const double n2 = n.squaredNorm();
  bool inside = n2 > 0;
  Foot best{v[0]};
  for (int i = 0; i < 3; ++i) {
    const Vector3d &from = v[i], &to = v[(i + 1) % 3];
    const Foot foot = footOnEdge(p, from, to);
    if ((p - foot.point).squaredNorm() < (p - best.point).squaredNorm()) best = foot;
    inside = inside && n.cross(to - from).dot(p - from) >= 0;
  }
  if (inside) best = {p - n.dot(p - v[0]) / n2 * n, v[1] - v[0], v[2] - v[1]};
  return best;
}

/// The nearest points of two edges. The candidates are each end with its nearest point on the other edge, and the
/// crossing of the two lines where it lies on both edges. No parameter of one edge is rounded to find the other's, so
/// near-parallel edges lose nothing.
Nearest nearestOfEdges(const Vector3d& p, const Vector3d& p1, const Vector3d& q, const Vector3d& q1) {
  Nearest best{p, q, {}};
  const auto offer = [&](const Vector3d& a, const Vector3d& x, const Foot& foot) {
    if ((x - a).squaredNorm() <= (best.x - best.a).squaredNorm()) best = {a, x, foot};
  };
  for (const Vector3d* end : {&p, &p1}) {
    const Foot foot = footOnEdge(*end, q, q1);
    offer(*end, foot.point, foot);
  }
  for (const Vector3d* end : {&q, &q1}) {
    const Foot foot = footOnEdge(*end, p, p1);
    offer(foot.point, *end, foot);
  }
  const Vector3d e = p1 - p, f = q1 - q, w = q - p, m = e.cross(f);
  const double m2 = m.squaredNorm(), u = m.dot(w.cross(f)), v = m.dot(w.cross(e));
  if (m2 > 0 && u >= 0 && u <= m2 && v >= 0 && v <= m2) offer(p + u / m2 * e, q + v / m2 * f, {p, e, f});
  return best;
}

Nearest nearest(const Equation& q, const Vector3d a[3], const Vector3d x[3]) {
  if (q.kind == Equation::vertexFace) {
    const Foot foot = footOnFace(a[q.i], x);
    return {a[q.i], foot.point, foot};
  }
  if (q.kind == Equation::faceVertex) {
    const Foot foot = footOnFace(x[q.j], a);
    return {foot.point, x[q.j], foot};
  }
  return nearestOfEdges(a[q.i], a[(q.i + 1) % 3], x[q.j], x[(q.j + 1) % 3]);
}

/// Both triangles over one time interval.
struct Sweep {
  Vector edge_a[3], edge_x[3], D[3][3];
  Vector3d x[3];         ///< B's vertices at tm
  double amplitude = 0;  ///< largest way of a vertex over half of the interval
  double floor = 0;      ///< error of a vertex that no shorter interval takes away

  Sweep(const Vector3d a[3], const Vector3d b[3], const MotionAt& motion, double tm, double d) {
    ScalarMotion m;
    motion(tm, d, m);
    Vector vertex[3];
    for (int j = 0; j < 3; ++j) {
      const double left_out = m.rem_c + m.rem_R * b[j].norm(), error = left_out + m.pad;
      double way = left_out;  // all of it if the motion has no derivatives
      for (int k = 0; k < 3; ++k) {
        const int row = 3 * k;
        double c[3], size = 0;
        for (int order = 0; order < 3; ++order) {
          const double *R = m.R[order] + row, p = m.c[order][k];
          c[order] = R[0] * b[j][0] + R[1] * b[j][1] + R[2] * b[j][2] + p;
          size += std::abs(R[0] * b[j][0]) + std::abs(R[1] * b[j][1]) + std::abs(R[2] * b[j][2]) + std::abs(p);
        }
        // A product and three sums: 4.01 kUlp of the size.
        vertex[j].k[k] = {c[0], c[1], c[2], roundUp(error + 5 * kUlp * size)};
        x[j][k] = c[0];
        way += std::abs(c[1]) + std::abs(c[2]);
        floor = std::max(floor, m.pad + 16 * kUlp * (size + a[j].cwiseAbs().maxCoeff()));
      }
      amplitude = std::max(amplitude, way);
    }
    for (int i = 0; i < 3; ++i) {
      edge_a[i] = constant(a[(i + 1) % 3]) - constant(a[i]);
      edge_x[i] = vertex[(i + 1) % 3] - vertex[i];
      for (int j = 0; j < 3; ++j) D[i][j] = vertex[j] - constant(a[i]);
    }
  }

  /// s of an equation: (13) or (14).
  Quadratic s(const Equation& q) const {
    switch (q.kind) {
      case Equation::vertexFace:
        return dot(cross(edge_x[0], edge_x[1]), -D[q.i][0]);
      case Equation::faceVertex:
        return dot(cross(edge_a[0], edge_a[1]), D[0][q.j]);
      default:
        return dot(cross(edge_a[q.i], edge_x[q.j]), D[q.i][q.j]);
    }
  }

  /// Whether the features meet strictly inside themselves wherever s has a root.
  bool certainlyInside(const Equation& q) const {
    if (q.kind == Equation::edgeEdge) {
      const Vector &e = edge_a[q.i], &f = edge_x[q.j], &w = D[q.i][q.j], m = cross(e, f);
      const Quadratic m2 = dot(m, m), u = dot(m, cross(w, f)), v = dot(m, cross(w, e));
      return certainlyPositive(u) && certainlyPositive(v) && certainlyPositive(m2 - u) && certainlyPositive(m2 - v);
    }
    const Vector* edge = q.kind == Equation::vertexFace ? edge_x : edge_a;
    const Vector n = cross(edge[0], edge[1]);
    for (int k = 0; k < 3; ++k) {
      if (!certainlyPositive(dot(cross(n, edge[k]), q.kind == Equation::vertexFace ? -D[q.i][k] : D[k][q.j])))
        return false;
    }
    return true;
  }

  /// Whether the direction between the closest points at tm keeps the features apart over the whole interval.
  bool certainlyApart(const Equation& q, const Vector3d a[3]) const {
    const Vector n = constant(nearest(q, a, x).direction());
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        if ((q.a >> i & 1) && (q.b >> j & 1) && !certainlyPositive(dot(n, D[i][j]))) return false;
      }
    }
    return true;
  }
};

/// A time interval still to be searched, with its active equations.
struct Interval {
  double lo, hi;
  int active;
};

constexpr int kMaxSteps = 1000, kMaxDepth = 64;
/// An interval in which no vertex moves by more than this many floors (Sweep::floor) is not divided.
constexpr double kFloors = 4;
/// Contact points nearer than this many floors are one point: at a shallow angle it is uncertain by more than a floor.
constexpr double kSamePlace = 1e4;
/// Directions between features that touch are taken this time before the contact: they turn by 1e-6 of the motion's
/// rotation, and the gap is far above rounding.
constexpr double kStepBack = 0x1p-20;

class Refinement {
 public:
  Refinement(const Vector3d a[3], const Vector3d b[3], const MotionAt& motion) : a_(a), b_(b), motion_(motion) {}

  bool run(const ContactWindow& window, RefinedContact& out) {
    out = RefinedContact();
    out.t_lower = window.t_lower;
    out.t_upper = window.t_upper;
    Interval first;
    if (!findFirst(window.t_lower, window.t_upper, first)) return false;
    out.t_lower = first.lo;
    for (int k = 0; k < kNumEquations; ++k) {
      if (first.active >> k & 1) proveCrossing(equation(k), first, out);
    }
    nameFeatures(first.active, window.proven, out);
    return true;
  }

 private:
  Sweep sweep(double tm, double d) const { return Sweep(a_, b_, motion_, tm, d); }

  /// The simultaneous solver (Redon 2004, 5.2.2 and 5.2.4): one list of active equations per interval, the earliest
  /// interval first.
  /// @param[out] first  no contact before first.lo, and no way to exclude one in [first.lo, first.hi]
  bool findFirst(double t_lower, double t_upper, Interval& first) const {
    Interval stack[kMaxDepth] = {{t_lower, t_upper, kAll}};
    for (int n = 1, step = 1; n > 0; ++step) {
      const Interval now = stack[--n];
      const double tm = now.lo + 0.5 * (now.hi - now.lo);
      const double d = std::max(tm - now.lo, now.hi - tm) * (1 + 4 * kUlp);
      const Sweep s = sweep(tm, d);
      int active = 0;
      double lo = 1, hi = -1;
      for (int k = 0; k < kNumEquations; ++k) {
        double from, to;
        if (!(now.active >> k & 1) || !contractRoots(s.s(equation(k)), from, to) || s.certainlyApart(equation(k), a_)) {
          continue;
        }
        active |= 1 << k;
        lo = std::min(lo, from);
        hi = std::max(hi, to);
      }
      if (!active) continue;
      const double rounding = 4 * kUlp * (tm + d);  // of tm + lo d
      const Interval left{std::max(now.lo, tm + lo * d - rounding), std::min(now.hi, tm + hi * d + rounding), active};
      const bool narrow = !(s.amplitude > kFloors * s.floor) || now.hi - now.lo <= 4 * kUlp * now.hi;
      if (narrow || step >= kMaxSteps || n + 2 > kMaxDepth) {
        first = left;
        return true;
      }
      if (left.hi - left.lo < 0.7 * (now.hi - now.lo)) {
        stack[n++] = left;
      } else {
        const double middle = left.lo + 0.5 * (left.hi - left.lo);
        stack[n++] = {middle, left.hi, active};
        stack[n++] = {left.lo, middle, active};
      }
    }
    return false;
  }

  /// Existence: over a window a little wider than the root's uncertainty, s changes sign and the features cross each
  /// other. The window may start before t_lower: the root lies after t_lower all the same.
  void proveCrossing(const Equation& q, const Interval& first, RefinedContact& out) const {
    const double tm = first.lo + 0.5 * (first.hi - first.lo), half = std::max(first.hi - tm, kUlp);
    const Quadratic f = sweep(tm, half).s(q);
    if (!(slope(f) > 0)) return;
    const double width = half * (2 + 2 * f.rem / slope(f));
    for (const double factor : {1.0, 4.0}) {
      const double from = std::max(0.0, first.lo - factor * width),
                   to = std::min(out.t_upper, first.hi + factor * width);
      // As to <= 2 middle, `to - middle` is exact and tm + d = to. As rounding is monotone, tm - d >= 0.
      const double middle = 0.5 * (from + to);
      const Sweep s = sweep(middle, to - middle);
      if (!certainlyChangesSign(s.s(q)) || !s.certainlyInside(q)) continue;
      out.t_upper = to;
      out.certain = true;
      return;
    }
  }

  void verticesAt(double t, Vector3d x[3]) const {
    const Sweep s = sweep(t, 0);
    std::copy(s.x, s.x + 3, x);
  }

  /// Two triangles meet in a convex set. For each triangle the smallest feature that holds all of it is named: at one
  /// point the intersection of all equations' features, over several points the union.
  void nameFeatures(int active, bool proven, RefinedContact& out) const {
    struct Place {
      Vector3d point;
      int equation, a, b;
    };
    Place places[kNumEquations];
    int num_places = 0, a = 0, b = 0;
    const Sweep lower = sweep(out.t_lower, 0);
    const double same = kSamePlace * lower.floor;
    double least = INFINITY;
    for (int k = 0; k < kNumEquations; ++k) {
      if (active >> k & 1) least = std::min(least, nearest(equation(k), a_, lower.x).distance());
    }
    for (int k = 0; k < kNumEquations; ++k) {
      if (!(active >> k & 1)) continue;
      const Equation q = equation(k);
      const Nearest near = nearest(q, a_, lower.x);
      if (near.distance() > least + same) continue;  // only in an interval that ran out of steps
      const Vector3d point = 0.5 * (near.a + near.x);
      Place* const end = places + num_places;
      Place* const place = std::find_if(
          places, end, [&](const Place& p) { return (p.point - point).norm() <= same && (p.a & q.a) && (p.b & q.b); });
      if (place == end) {
        places[num_places++] = {point, k, q.a, q.b};
      } else {
        // Two edges of a sliver are one place along their whole length; the vertex that they share need not be near.
        if (holds(place->a & q.a, a_, point, same)) place->a &= q.a;
        if (holds(place->b & q.b, lower.x, point, same)) place->b &= q.b;
      }
    }
    if (num_places == 0) return;  // not a number somewhere

    Vector3d x[3], before[3], toward = Vector3d::Zero();
    verticesAt(out.certain || proven ? out.t_upper : out.t_lower, x);
    verticesAt(std::max(0.0, out.t_lower - kStepBack), before);
    out.point.setZero();
    double gap = INFINITY;
    for (int p = 0; p < num_places; ++p) {
      const Equation q = equation(places[p].equation);
      const Nearest now = nearest(q, a_, x), then = nearest(q, a_, before);
      out.point += 0.5 * (now.a + now.x) / num_places;
      if (then.distance() < gap) gap = then.distance(), toward = then.direction();
      a |= places[p].a;
      b |= places[p].b;
    }
    nameKind(a, b, out);
    chooseNormal(a, b, x, toward, out);
    // If the bodies slide along each other, the direction between the features before the contact does not separate
    // them.
    if (a != kFace && b != kFace && out.feature != FeatureKind::edgeEdge) {
      out.normal = partingDirection(a_, lower.x, out.normal);
    }
  }

  /// Whether a feature that is a vertex holds the point, within `near`. Edges and faces are assumed to hold it.
  static bool holds(int feature, const Vector3d v[3], const Vector3d& point, double near) {
    return (feature & (feature - 1)) != 0 || (v[feature >> 1] - point).norm() <= near;
  }

  static void nameKind(int a, int b, RefinedContact& out) {
    static constexpr int kSize[8] = {0, 1, 1, 2, 1, 2, 2, 3}, kIndex[8] = {-1, 0, 1, 0, 2, 2, 1, -1};
    static constexpr FeatureKind kKind[3][3] = {
        {FeatureKind::vertexVertex, FeatureKind::vertexEdge, FeatureKind::vertexFace},
        {FeatureKind::edgeVertex, FeatureKind::edgeEdge, FeatureKind::edgeFace},
        {FeatureKind::faceVertex, FeatureKind::faceEdge, FeatureKind::faceFace}};
    out.feature = kKind[kSize[a] - 1][kSize[b] - 1];
    out.feature_a = kIndex[a];
    out.feature_b = kIndex[b];
  }

  /// A face's normal, or the two edges' common normal, turned to point along `toward`; else `toward` itself.
  void chooseNormal(int a, int b, const Vector3d x[3], const Vector3d& toward, RefinedContact& out) const {
    const auto edge = [](const Vector3d v[3], int i) -> Vector3d { return v[(i + 1) % 3] - v[i]; };
    Vector3d e = Vector3d::Zero(), f = e;
    if (a == kFace || b == kFace) {
      const Vector3d* face = a == kFace ? a_ : x;
      e = edge(face, 0);
      f = edge(face, 1);
    } else if (out.feature == FeatureKind::edgeEdge) {
      e = edge(a_, out.feature_a);
      f = edge(x, out.feature_b);
    }
    Vector3d n = e.cross(f);
    // If the sine is below this, the computed cross product is no better a direction than `toward`.
    if (!(n.norm() > 1e-9 * e.norm() * f.norm())) n = toward;
    if (n.dot(toward) < 0) n = -n;
    if (n.norm() > 0) out.normal = n / n.norm();
  }

  const Vector3d *a_, *b_;
  const MotionAt& motion_;
};

}  // namespace

bool refineTriangleContact(const Vector3d a[3], const Vector3d b[3], const MotionAt& motion,
                           const ContactWindow& window, RefinedContact& out) {
  return Refinement(a, b, motion).run(window, out);
}

}  // namespace fcl_artic
