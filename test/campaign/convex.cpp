// SPDX-License-Identifier: BSD-3-Clause
#include "convex.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

namespace campaign {
namespace {

Vec3 support(const Piece& p, const Vec3& u) {
  switch (p.kind) {
    case Piece::triangle: {
      const double d0 = p.corners[0].dot(u), d1 = p.corners[1].dot(u), d2 = p.corners[2].dot(u);
      return d0 >= d1 ? (d0 >= d2 ? p.corners[0] : p.corners[2]) : (d1 >= d2 ? p.corners[1] : p.corners[2]);
    }
    case Piece::box: {
      const Vec3 l = p.R.transpose() * u;
      return p.centre + p.R * Vec3(std::copysign(p.half.x(), l.x()), std::copysign(p.half.y(), l.y()),
                                   std::copysign(p.half.z(), l.z()));
    }
    case Piece::cylinder: {
      const Vec3 l = p.R.transpose() * u;
      const double xy = std::hypot(l.x(), l.y());
      const double s = xy > 0 ? p.half.x() / xy : 0;
      return p.centre + p.R * Vec3(s * l.x(), s * l.y(), std::copysign(p.half.z(), l.z()));
    }
    case Piece::sphere:
      break;
  }
  return p.centre;
}

double coreRadius(const Piece& p) {
  return p.kind == Piece::sphere ? p.half.x() : 0;
}

Vec3 anyPoint(const Piece& p) {
  return p.kind == Piece::triangle ? p.corners[0] : p.centre;
}

/// Up to four points of A - B, with the points of A and B that they come from.
struct Simplex {
  int size = 0;
  Vec3 w[4], a[4], b[4];
  double weight[4];
};

/// Weights of the point nearest to the origin among three points of the simplex (Ericson 2005, Section 5.1.5), written
/// to out[0..2]; returns the squared distance.
double nearestOnTriangle(const Vec3& a, const Vec3& b, const Vec3& c, double* out) {
  const auto result = [&](double x, double y, double z) {
    out[0] = x, out[1] = y, out[2] = z;
    return (x * a + y * b + z * c).squaredNorm();
  };
  const Vec3 ab = b - a, ac = c - a;
  const double d1 = -ab.dot(a), d2 = -ac.dot(a);
  if (d1 <= 0 && d2 <= 0) return result(1, 0, 0);
  const double d3 = -ab.dot(b), d4 = -ac.dot(b);
  if (d3 >= 0 && d4 <= d3) return result(0, 1, 0);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return result(1 - d1 / (d1 - d3), d1 / (d1 - d3), 0);
  const double d5 = -ab.dot(c), d6 = -ac.dot(c);
  if (d6 >= 0 && d5 <= d6) return result(0, 0, 1);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return result(1 - d2 / (d2 - d6), 0, d2 / (d2 - d6));
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) {
    const double s = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return result(0, 1 - s, s);
  }
  const double sum = va + vb + vc;
  if (!(sum > 0)) return result(1, 0, 0);
  return result(va / sum, vb / sum, vc / sum);
}

/// Sets the weights of the point of the simplex nearest to the origin.
void nearest(Simplex& s) {
  if (s.size == 1) {
    s.weight[0] = 1;
  } else if (s.size == 2) {
    const Vec3 d = s.w[1] - s.w[0];
    const double dd = d.squaredNorm();
    const double x = dd > 0 ? std::clamp(-s.w[0].dot(d) / dd, 0.0, 1.0) : 0;
    s.weight[0] = 1 - x, s.weight[1] = x;
  } else if (s.size == 3) {
    nearestOnTriangle(s.w[0], s.w[1], s.w[2], s.weight);
  } else {
    static constexpr int kFace[4][4] = {{0, 1, 2, 3}, {0, 1, 3, 2}, {0, 2, 3, 1}, {1, 2, 3, 0}};
    double best = std::numeric_limits<double>::infinity();
    double inside[4];
    bool contains = true;
    for (const auto& f : kFace) {
      const Vec3 n = (s.w[f[1]] - s.w[f[0]]).cross(s.w[f[2]] - s.w[f[0]]);
      const double origin = -n.dot(s.w[f[0]]), opposite = n.dot(s.w[f[3]] - s.w[f[0]]);
      inside[f[3]] = opposite != 0 ? origin / opposite : -1;
      if (origin * opposite > 0) continue;
      contains = false;
      double x[3];
      const double d = nearestOnTriangle(s.w[f[0]], s.w[f[1]], s.w[f[2]], x);
      if (d < best) {
        best = d;
        for (int k = 0; k < 3; ++k) s.weight[f[k]] = x[k];
        s.weight[f[3]] = 0;
      }
    }
    if (contains) {
      const double sum = inside[0] + inside[1] + inside[2] + inside[3];
      for (int k = 0; k < 4; ++k) s.weight[k] = inside[k] / sum;
    }
  }
}

/// Drops what has no weight.
void reduce(Simplex& s) {
  int n = 0;
  for (int k = 0; k < s.size; ++k) {
    if (s.weight[k] <= 0) continue;
    s.w[n] = s.w[k], s.a[n] = s.a[k], s.b[n] = s.b[k], s.weight[n] = s.weight[k];
    ++n;
  }
  s.size = n;
}

/// Distance of the cores, by the algorithm of Gilbert, Johnson and Keerthi, to a share of what it exceeds `skin` by.
Separation coreSeparation(const Piece& A, const Piece& B, double wanted, double skin) {
  constexpr int kMaxIterations = 80;
  const Vec3 a0 = anyPoint(A), b0 = anyPoint(B);
  Vec3 v = a0 - b0;
  Separation r{0, v.norm(), a0, b0, Vec3::Zero()};
  Simplex s;
  for (int i = 0; i < kMaxIterations; ++i) {
    const double length = v.norm();
    if (length < 1e-15) break;
    const Vec3 a = support(A, -v), b = support(B, v), w = a - b;
    const double lower = v.dot(w) / length;
    if (lower > r.lower || r.direction.isZero()) {
      r.direction = -v / length;
      r.lower = std::max(lower, 0.0);
    }
    if (r.upper - r.lower <= std::max(wanted * (r.upper - skin), 1e-14)) break;
    for (int k = 0; k < s.size; ++k)
      if (s.w[k] == w) return r;  // nothing new in this direction
    s.w[s.size] = w, s.a[s.size] = a, s.b[s.size] = b;
    ++s.size;
    nearest(s);
    reduce(s);
    Vec3 pa = Vec3::Zero(), pb = Vec3::Zero();
    for (int k = 0; k < s.size; ++k) pa += s.weight[k] * s.a[k], pb += s.weight[k] * s.b[k];
    v = pa - pb;
    if (v.norm() < r.upper) r.upper = v.norm(), r.a = pa, r.b = pb;
    if (s.size == 4) break;  // the simplex holds the origin
  }
  return r;
}

Piece shrunk(Piece p, double by) {
  p.half.array() -= by;
  return p;
}

bool isSolid(const Piece& p) {
  return p.kind != Piece::triangle;
}

}  // namespace

Separation separation(const Piece& A, const Piece& B, double wanted, double margin) {
  const double radii = coreRadius(A) + coreRadius(B);
  Separation r = coreSeparation(A, B, wanted, radii + margin);
  r.lower -= radii;
  r.upper -= radii;
  return r;
}

double gapAlong(const Piece& A, const Piece& B, const Vec3& n) {
  return n.dot(support(B, -n) - support(A, n)) - coreRadius(A) - coreRadius(B);
}

double depthInside(const Piece& solid, const Vec3& x) {
  const Vec3 l = (solid.R.transpose() * (x - solid.centre)).cwiseAbs();
  switch (solid.kind) {
    case Piece::box:
      return (solid.half - l).minCoeff();
    case Piece::cylinder:
      return std::min(solid.half.x() - std::hypot(l.x(), l.y()), solid.half.z() - l.z());
    case Piece::sphere:
      return solid.half.x() - (x - solid.centre).norm();
    case Piece::triangle:
      break;
  }
  return -std::numeric_limits<double>::infinity();
}

bool clearlyOverlap(const Piece& A, const Piece& B, double margin) {
  const Piece &solid = isSolid(A) ? A : B, &other = isSolid(A) ? B : A;
  if (!isSolid(solid)) return false;
  // A point of `other` near the shrunk solid lies well inside the solid itself.
  const Separation s = coreSeparation(shrunk(solid, 2 * margin), other, 0, 0);
  Vec3 x = s.b;
  if (other.kind == Piece::sphere) {
    // s.b is the centre: go from there towards the solid, at most to the sphere's surface.
    const Vec3 d = s.a - s.b;
    const double reach = solid.kind == Piece::sphere ? d.norm() : s.upper;
    if (reach > 0) x += d / d.norm() * std::min(reach, other.half.x());
  }
  return depthInside(solid, x) >= margin;
}

}  // namespace campaign
