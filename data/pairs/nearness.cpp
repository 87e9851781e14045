// SPDX-License-Identifier: BSD-3-Clause
// Distances by the algorithm of Gilbert, Johnson and Keerthi: in doubles where the bodies are apart, in long doubles
// where they may touch. A direction or points show each claim, never the fact that the algorithm has stopped.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "pairs/constants.h"
#include "pairs/judge.h"

namespace pairs {
namespace {

/// One convex piece in the world.
template <class R>
struct Placed {
  const Body& body;
  int piece;
  PoseOf<R> M;

  const Vec3& corner(int k) const {
    return body.vertices[static_cast<std::size_t>(
        body.triangles[static_cast<std::size_t>(piece)][static_cast<std::size_t>(k)])];
  }

  /// A point of the core that lies farthest along u.
  Vec<R> support(const Vec<R>& u) const { return M * local(M.rotation.transpose() * u); }
  Vec<R> anyPoint() const { return support(Vec<R>::UnitX()); }

  Vec<R> local(const Vec<R>& u) const {
    const Vec<R> h = body.half.template cast<R>();
    const auto end = [&](int k) { return u[k] > 0 ? h[k] : -h[k]; };
    switch (body.kind) {
      case Kind::box:
        return {end(0), end(1), end(2)};
      case Kind::sphere:
        return Vec<R>::Zero();
      case Kind::capsule:
        return {0, 0, end(2)};
      case Kind::cylinder:
      case Kind::cone: {
        const R side = std::sqrt(u.x() * u.x() + u.y() * u.y()), s = side > 0 ? h.x() / side : 0;
        if (body.kind == Kind::cone && h.z() * u.z() >= h.x() * side - h.z() * u.z()) return {0, 0, h.z()};
        return {s * u.x(), s * u.y(), body.kind == Kind::cone ? -h.z() : end(2)};
      }
      case Kind::ellipsoid: {
        const Vec<R> w = h.cwiseProduct(u);
        const R length = w.norm();
        return length > 0 ? Vec<R>(h.cwiseProduct(w) / length) : Vec<R>(0, 0, h.z());
      }
      case Kind::mesh: {
        Vec<R> best = corner(0).template cast<R>();
        for (int k = 1; k < 3; ++k) {
          const Vec<R> x = corner(k).template cast<R>();
          if (x.dot(u) > best.dot(u)) best = x;
        }
        return best;
      }
      case Kind::convex:
      case Kind::triangle: {
        Vec<R> best = body.vertices[0].template cast<R>();
        for (const Vec3& v : body.vertices) {
          // NOLINTNEXTLINE(performance-unnecessary-copy-initialization): of long doubles none
          const Vec<R> x = v.template cast<R>();
          if (x.dot(u) > best.dot(u)) best = x;
        }
        return best;
      }
      case Kind::halfspace:
      case Kind::plane:
        break;
    }
    throw std::logic_error("an unbounded body has no support point");
  }
};

/// Up to four points of A - B, with weights.
template <class R>
struct Simplex {
  int size = 0;
  Vec<R> w[4];
  R weight[4];
};

/// Weights of the point nearest to the origin in a triangle (Ericson 2005, Section 5.1.5); returns its squared
/// distance.
template <class R>
R nearestOnTriangle(const Vec<R>& a, const Vec<R>& b, const Vec<R>& c, R* out) {
  const auto result = [&](R x, R y, R z) {
    out[0] = x, out[1] = y, out[2] = z;
    return (x * a + y * b + z * c).squaredNorm();
  };
  const Vec<R> ab = b - a, ac = c - a;
  const R d1 = -ab.dot(a), d2 = -ac.dot(a);
  if (d1 <= 0 && d2 <= 0) return result(1, 0, 0);
  const R d3 = -ab.dot(b), d4 = -ac.dot(b);
  if (d3 >= 0 && d4 <= d3) return result(0, 1, 0);
  const R vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return result(1 - d1 / (d1 - d3), d1 / (d1 - d3), 0);
  const R d5 = -ab.dot(c), d6 = -ac.dot(c);
  if (d6 >= 0 && d5 <= d6) return result(0, 0, 1);
  const R vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return result(1 - d2 / (d2 - d6), 0, d2 / (d2 - d6));
  const R va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) {
    const R s = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return result(0, 1 - s, s);
  }
  const R sum = va + vb + vc;
  if (!(sum > 0)) return result(1, 0, 0);
  return result(va / sum, vb / sum, vc / sum);
}

/// Sets the weights of the simplex's point nearest to the origin, and drops what has none.
template <class R>
void reduce(Simplex<R>& s) {
  if (s.size == 1) {
    s.weight[0] = 1;
  } else if (s.size == 2) {
    const Vec<R> d = s.w[1] - s.w[0];
    const R square = d.squaredNorm();
    const R x = square > 0 ? std::clamp(-s.w[0].dot(d) / square, R(0), R(1)) : R(0);
    s.weight[0] = 1 - x, s.weight[1] = x;
  } else if (s.size == 3) {
    nearestOnTriangle(s.w[0], s.w[1], s.w[2], s.weight);
  } else {
    static constexpr int kFace[4][4] = {{0, 1, 2, 3}, {0, 1, 3, 2}, {0, 2, 3, 1}, {1, 2, 3, 0}};
    R best = std::numeric_limits<R>::infinity(), inside[4];
    bool contains = true;
    for (const auto& f : kFace) {
      const Vec<R> n = (s.w[f[1]] - s.w[f[0]]).cross(s.w[f[2]] - s.w[f[0]]);
      const R origin = -n.dot(s.w[f[0]]), opposite = n.dot(s.w[f[3]] - s.w[f[0]]);
      inside[f[3]] = opposite != 0 ? origin / opposite : -1;
      if (origin * opposite > 0) continue;
      contains = false;
      R x[3];
      const R d = nearestOnTriangle(s.w[f[0]], s.w[f[1]], s.w[f[2]], x);
      if (d >= best) continue;
      best = d;
      for (int k = 0; k < 3; ++k) s.weight[f[k]] = x[k];
      s.weight[f[3]] = 0;
    }
    if (contains) {
      const R sum = inside[0] + inside[1] + inside[2] + inside[3];
      for (int k = 0; k < 4; ++k) s.weight[k] = inside[k] / sum;
    }
  }
  int n = 0;
  for (int k = 0; k < s.size; ++k) {
    if (s.weight[k] <= 0) continue;
    s.w[n] = s.w[k], s.weight[n] = s.weight[k];
    ++n;
  }
  s.size = n;
}

template <class R>
struct Distance {
  R lower = 0, upper = 0;
  Vec<R> direction = Vec<R>::Zero();  ///< unit, from A to B
};

/// Bounds on the distance of the point `p` from A - B (cores).
/// @param wanted  stop when they differ by at most this share of what the distance exceeds `skin` by
/// @param enough  stop when the distance is known to be above this
/// @param near    stop when it is known to be at most this
template <class R>
Distance<R> distance(const Placed<R>& A, const Placed<R>& B, const Vec<R>& p, double wanted, R skin,
                     R enough = std::numeric_limits<R>::infinity(), R near = 0) {
  constexpr int kMaxIterations = 200;
  constexpr bool kLong = sizeof(R) > sizeof(double);
  const R tiny = kLong ? R(1e-17) : R(1e-14);
  Vec<R> v = A.anyPoint() - B.anyPoint() - p;
  Distance<R> r;
  r.upper = v.norm();
  Simplex<R> s;
  for (int i = 0; i < kMaxIterations; ++i) {
    const R length = v.norm();
    if (length < tiny) break;
    const Vec<R> w = A.support(-v) - B.support(v) - p;
    const R lower = v.dot(w) / length;
    if (lower > r.lower || i == 0) r.lower = std::max(lower, R(0)), r.direction = -v / length;
    if (r.lower > enough || r.upper <= near || r.upper - r.lower <= std::max(R(wanted) * (r.upper - skin), tiny)) break;
    for (int k = 0; k < s.size; ++k)
      if (s.w[k] == w) return r;  // nothing new in this direction
    s.w[s.size++] = w;
    reduce(s);
    v.setZero();
    for (int k = 0; k < s.size; ++k) v += s.weight[k] * s.w[k];
    r.upper = std::min(r.upper, v.norm());
    if (s.size == 4) break;  // the simplex holds the origin
  }
  return r;
}

/// Shows that the difference of two bodies without radii holds a ball of radius 0.9 depth about the origin. For this it
/// has points within depth / 10 of the four corners of a regular tetrahedron of inradius depth.
bool holdsBall(const Placed<Real>& A, const Placed<Real>& B, Real depth) {
  const Real q = 3 * depth / std::sqrt(Real(3));
  for (const Vec<Real>& corner :
       {Vec<Real>(q, q, q), Vec<Real>(q, -q, -q), Vec<Real>(-q, q, -q), Vec<Real>(-q, -q, q)}) {
    if (!(distance<Real>(A, B, corner, 0, 0, depth / 10, depth / 10).upper <= depth / 10)) return false;
  }
  return true;
}

/// The largest balls first: between curved bodies the search closes in slowly, and a large one is soon shown.
bool deeperThan(const Placed<Real>& A, const Placed<Real>& B, Real depth) {
  for (Real ball = 1e-4; ball > depth; ball /= 10) {
    if (holdsBall(A, B, ball)) return true;
  }
  return holdsBall(A, B, depth);
}

struct Leaf {
  double gap, upper;
  bool clear;
  Vec3 direction;
};

Leaf compare(const Body& a, int i, const Pose& M_a, const PoseOf<double>& near_a, const Body& b, int j, const Pose& M_b,
             const PoseOf<double>& near_b, double wanted, double enough) {
  const double radii = a.radius + b.radius;
  const auto rough = distance<double>({a, i, near_a}, {b, j, near_b}, Vec3::Zero(), wanted, radii, enough + radii);
  if (rough.lower - radii > 1e-9) return {rough.lower - radii, rough.upper - radii, false, rough.direction};
  const Placed<Real> A{a, i, M_a}, B{b, j, M_b};
  const auto fine = distance<Real>(A, B, Vec<Real>::Zero(), std::min(wanted, 1e-3), Real(a.radius) + Real(b.radius));
  const Real lower = fine.lower - Real(a.radius) - Real(b.radius), upper = fine.upper - Real(a.radius) - Real(b.radius);
  // With a radius, points of the cores nearer than that show the depth.
  const bool clear = radii > 0 ? upper <= -Real(kClear) : !(lower > 0) && deeperThan(A, B, kClear);
  return {static_cast<double>(clear ? std::min(lower, Real(0)) : lower), static_cast<double>(upper), clear,
          fine.direction.cast<double>()};
}

/// A bounded piece and a half-space or plane: the signed distances of its nearest and farthest point.
Nearness nearUnbounded(const Body& wall, const Pose& M_wall, const Body& b, const Pose& M_b) {
  const Vec<Real> n = M_wall.rotation * wall.normal.cast<Real>();
  const Real offset = Real(wall.offset) + n.dot(M_wall.position);
  Nearness best;
  best.gap = kInfinity;
  for (int j = 0; j < b.numPieces(); ++j) {
    const Placed<Real> B{b, j, M_b};
    const Real low = n.dot(B.support(-n)) - Real(b.radius) - offset;
    const Real high = offset - n.dot(B.support(n)) - Real(b.radius);
    const bool behind = wall.kind == Kind::plane && high > low;
    const Real gap = behind ? high : low;
    if (gap >= Real(best.gap)) continue;
    best.gap = best.upper = static_cast<double>(gap);
    best.clear = gap <= -Real(kClear);
    best.piece2 = j;
    best.direction = (behind ? -1 : 1) * n.cast<double>();
  }
  return best;
}

}  // namespace

Nearness nearness(const Body& a, const Pose& M_a, const Body& b, const Pose& M_b, double wanted, const Nearness& hint) {
  if (a.unbounded()) return nearUnbounded(a, M_a, b, M_b);
  if (b.unbounded()) {
    Nearness r = nearUnbounded(b, M_b, a, M_a);
    std::swap(r.piece1, r.piece2);
    r.direction = -r.direction;
    return r;
  }
  const PoseOf<double> near_a = M_a.cast<double>(), near_b = M_b.cast<double>();
  const double balls = (near_b.position - near_a.position).norm() - a.reach - b.reach;
  if (wanted > 0.01 && balls > 0.5 * (a.reach + b.reach)) {  // far apart, the balls tell enough
    Nearness far = hint;
    far.gap = balls;
    far.upper = balls + 2 * (a.reach + b.reach);
    far.clear = false;
    return far;
  }

  Nearness best;
  best.gap = best.upper = kInfinity;
  const auto visit = [&](int i, int j) {
    const Leaf leaf = compare(a, i, M_a, near_a, b, j, M_b, near_b, 0.5 * wanted, best.upper);
    best.gap = std::min(best.gap, leaf.gap);
    if (best.clear || (!leaf.clear && leaf.upper >= best.upper)) return;
    best.upper = leaf.upper, best.clear = leaf.clear, best.direction = leaf.direction;
    best.piece1 = i, best.piece2 = j;
  };
  visit(std::min(hint.piece1, a.numPieces() - 1), std::min(hint.piece2, b.numPieces() - 1));
  if (a.nodes.empty() && b.nodes.empty()) return best;

  // For a mesh the tree, for a shape one box around all of it.
  const Body::Node whole_a{Vec3::Zero(), Vec3::Constant(a.reach), -1, 0},
      whole_b{Vec3::Zero(), Vec3::Constant(b.reach), -1, 0};
  const auto node = [](const Body& body, const Body::Node& whole, int k) -> const Body::Node& {
    return body.nodes.empty() ? whole : body.nodes[static_cast<std::size_t>(k)];
  };
  const Mat<double> R = near_a.rotation.transpose() * near_b.rotation, magnitude = R.cwiseAbs();
  const Vec3 p = near_a.rotation.transpose() * (near_b.position - near_a.position);
  const auto gapOf = [&](const Body::Node& s, const Body::Node& t) {
    const Vec3 d = R * t.centre + p - s.centre;
    const Vec3 in_a = (d.cwiseAbs() - s.half - magnitude * t.half).cwiseMax(0);
    const Vec3 in_b = ((R.transpose() * d).cwiseAbs() - t.half - magnitude.transpose() * s.half).cwiseMax(0);
    return std::sqrt(std::max(in_a.squaredNorm(), in_b.squaredNorm()));
  };
  struct Entry {
    int a, b;
    double gap;
  };
  std::array<Entry, 256> stack;
  int top = 0;
  stack[top++] = {0, 0, gapOf(node(a, whole_a, 0), node(b, whole_b, 0))};
  double pruned = kInfinity;  // least gap of what was left out
  while (top > 0 && !best.clear) {
    const Entry e = stack[--top];
    if (e.gap > std::max(best.upper, 0.0) * (1 - wanted) + 1e-13) {
      pruned = std::min(pruned, e.gap);
      continue;
    }
    const Body::Node &s = node(a, whole_a, e.a), &t = node(b, whole_b, e.b);
    if (s.left < 0 && t.left < 0) {
      visit(s.piece, t.piece);
      continue;
    }
    const bool split_a = t.left < 0 || (s.left >= 0 && s.half.squaredNorm() >= t.half.squaredNorm());
    Entry x = split_a ? Entry{s.left, e.b, 0} : Entry{e.a, t.left, 0};
    Entry y = split_a ? Entry{s.left + 1, e.b, 0} : Entry{e.a, t.left + 1, 0};
    x.gap = gapOf(node(a, whole_a, x.a), node(b, whole_b, x.b));
    y.gap = gapOf(node(a, whole_a, y.a), node(b, whole_b, y.b));
    if (x.gap < y.gap) std::swap(x, y);  // the nearer one is looked at first
    stack[top++] = x;
    stack[top++] = y;
  }
  best.gap = std::min(best.gap, pruned);
  return best;
}

double distanceTo(const Body& body, int piece, const Pose& M, const Vec3& point) {
  Body dot;
  dot.kind = Kind::sphere;
  Pose at;
  at.position = point.cast<Real>();
  if (body.unbounded() || piece < 0) return std::max(0.0, nearness(body, M, dot, at, 1e-6).upper);
  const auto d = distance<Real>({body, piece, M}, {dot, 0, at}, Vec<Real>::Zero(), 1e-9, 0);
  return std::max(0.0, static_cast<double>(d.upper) - body.radius);
}

double gapAlong(const Body& a, int i, const Pose& M_a, const Body& b, int j, const Pose& M_b, const Vec3& n) {
  const Vec<Real> u = n.cast<Real>();
  return static_cast<double>(u.dot(Placed<Real>{b, j, M_b}.support(-u) - Placed<Real>{a, i, M_a}.support(u))) -
         a.radius - b.radius;
}

}  // namespace pairs
