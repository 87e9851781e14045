// SPDX-License-Identifier: BSD-3-Clause
//
// Support of convex pieces. The core's support function h(u) = max p.u is positively homogeneous
// and convex, for any u; the rounding radius is added by the caller. One row here is all that a kind of geometry needs.
#pragma once

#include "narrowphase/problem.h"
#include "numerics/lanes.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

using engine::Piece;
using engine::PieceKind;
using engine::TreeView;

/// Values of p.u over a hull's vertices, for eight directions.
FCL_ARTIC_INLINE void hullRange(const double* x, int n, const Lanes* u, Lanes& lower, Lanes& upper) {
  lower = upper = mulAdd(u[2], x[2 * n], mulAdd(u[1], x[n], u[0] * Lanes(x[0])));
  for (int i = 1; i < n; ++i) {
    const Lanes value = mulAdd(u[2], x[2 * n + i], mulAdd(u[1], x[n + i], u[0] * Lanes(x[i])));
    lower = min(lower, value);
    upper = max(upper, value);
  }
}
FCL_ARTIC_INLINE Lanes hullValues(const double* x, int n, int i, const double* u) {
  const Lanes *X = reinterpret_cast<const Lanes*>(x + i), *Y = reinterpret_cast<const Lanes*>(x + n + i),
              *Z = reinterpret_cast<const Lanes*>(x + 2 * n + i);
  return mulAdd(*Z, u[2], mulAdd(*Y, u[1], *X * Lanes(u[0])));
}
/// The same for one direction: lanes go over vertices.
FCL_ARTIC_INLINE void hullRange(const double* x, int n, const double* u, double& lower, double& upper) {
  Lanes least = hullValues(x, n, 0, u), most = least;
  for (int i = kLanes; i < n; i += kLanes) {
    const Lanes value = hullValues(x, n, i, u);
    least = min(least, value);
    most = max(most, value);
  }
  lower = minLane(least);
  upper = maxLane(most);
}
/// Index of a vertex farthest along u, but for 2^-42 of its value.
inline int hullSupport(const double* x, int n, const double* u) {
  int best = 0;
  double value = -__builtin_huge_val();
  for (int begin = 0; begin < n; begin += kNumbered) {  // once, but for very fine hulls
    Lanes most = numbered(hullValues(x, n, begin, u), 0);
    for (int i = kLanes; i < min(n - begin, kNumbered); i += kLanes) {
      most = max(most, numbered(hullValues(x, n, begin + i, u), i));
    }
    const double found = maxLane(most);
    best = found > value ? begin + numberOf(found) : best;
    value = max(value, found);
  }
  return best;
}

/// Half-spaces and planes: they have one direction, and no search along any other makes sense.
FCL_ARTIC_INLINE bool unbounded(const Piece& piece) {
  return piece.kind == PieceKind::halfspace || piece.kind == PieceKind::plane;
}
constexpr double kInfinite = __builtin_huge_val();
/// Ends of n.x: known along the piece's own normal, bit for bit (a still piece), and along no other direction.
inline void unboundedRange(const Piece& piece, const double* u, double& lower, double& upper) {
  const double *n = piece.size, offset = piece.center[0];
  const bool along = u[0] == n[0] && u[1] == n[1] && u[2] == n[2];
  const bool against = u[0] == -n[0] && u[1] == -n[1] && u[2] == -n[2];
  const bool plane = piece.kind == PieceKind::plane;
  lower = along && plane ? offset : against ? -offset : -kInfinite;
  upper = against && plane ? -offset : along ? offset : kInfinite;
}
inline void unboundedRange(const Piece&, const Lanes*, Lanes& lower, Lanes& upper) {
  lower = Lanes(-kInfinite);
  upper = Lanes(kInfinite);
}

/// Values of p.u over the core: lower end -h(-u), upper end h(u). T: double, or Lanes for eight directions.
template <class T>
FCL_ARTIC_INLINE void coreRange(const TreeView& tree, const Piece& piece, const T* u, T& lower, T& upper) {
  if (piece.kind == PieceKind::vertices) {
    const double* p = tree.vertices + 3 * static_cast<std::ptrdiff_t>(piece.first_vertex);
    lower = upper = dot(u, p);
    for (int i = 1; i < piece.num_vertices; ++i) {
      const T x = dot(u, p + 3 * i);
      lower = min(lower, x);
      upper = max(upper, x);
    }
    return;
  }
  if (piece.kind == PieceKind::hull) return hullRange(tree.hulls + piece.first_vertex, piece.num_vertices, u, lower, upper);
  if (unbounded(piece)) return unboundedRange(piece, u, lower, upper);
  const T m = dot(u, piece.center);
  const double *e = piece.size;
  T h(0.0);
  switch (piece.kind) {
    case PieceKind::box:
      h = mulAdd(abs(u[0]), T(e[0]), mulAdd(abs(u[1]), T(e[1]), abs(u[2]) * T(e[2])));
      break;
    case PieceKind::segment:
      h = abs(u[2]) * T(e[2]);
      break;
    case PieceKind::cylinder:
      h = mulAdd(sqrt(mulAdd(u[0], u[0], u[1] * u[1])), T(e[0]), abs(u[2]) * T(e[2]));
      break;
    case PieceKind::ellipsoid: {
      const T x = u[0] * T(e[0]), y = u[1] * T(e[1]), z = u[2] * T(e[2]);
      h = sqrt(mulAdd(x, x, mulAdd(y, y, z * z)));
      break;
    }
    case PieceKind::cone: {  // tip at +z: h(u) = max(c uz, a r - c uz)
      const T r = sqrt(mulAdd(u[0], u[0], u[1] * u[1])) * T(e[0]), z = u[2] * T(e[2]);
      upper = m + max(z, r - z);
      lower = m - max(T(0.0) - z, r + z);
      return;
    }
    default:
      break;
  }
  lower = m - h;
  upper = m + h;
}

/// Of so few lanes each goes through a hull's vertices by itself, eight vertices at once.
constexpr int kFewLanes = 3;

/// The same where only `lanes` matter: nothing need be known of the others.
FCL_ARTIC_INLINE void coreRange(const TreeView& tree, const Piece& piece, const Lanes* u, unsigned lanes, Lanes& lower,
                                Lanes& upper) {
  if (piece.kind != PieceKind::hull || __builtin_popcount(lanes) > kFewLanes) {
    return coreRange(tree, piece, u, lower, upper);
  }
  lower = Lanes(-kInfinite);
  upper = Lanes(kInfinite);
  for (unsigned left = lanes; left; left &= left - 1) {
    const int lane = __builtin_ctz(left);
    const double along[3] = {u[0][lane], u[1][lane], u[2][lane]};
    double least, most;
    hullRange(tree.hulls + piece.first_vertex, piece.num_vertices, along, least, most);
    lower.set(lane, least);
    upper.set(lane, most);
  }
}

/// A point of the core farthest along u (unit or not); of an unbounded piece the foot of its boundary, which is right along
/// its own normal only.
inline void supportPoint(const TreeView& tree, const Piece& piece, const double* u, double* x) {
  const double* e = piece.size;
  const double* m = piece.center;
  switch (piece.kind) {
    case PieceKind::vertices: {
      const double* p = tree.vertices + 3 * static_cast<std::ptrdiff_t>(piece.first_vertex);
      int best = 0;
      double value = dot(p, u);
      for (int i = 1; i < piece.num_vertices; ++i) {
        const double v = dot(p + 3 * i, u);
        if (v > value) {
          value = v;
          best = i;
        }
      }
      for (int k = 0; k < 3; ++k) x[k] = p[3 * best + k];
      return;
    }
    case PieceKind::hull: {
      const double* p = tree.hulls + piece.first_vertex;
      const int i = hullSupport(p, piece.num_vertices, u);
      for (int k = 0; k < 3; ++k) x[k] = p[k * piece.num_vertices + i];
      return;
    }
    case PieceKind::point:
    default:
      for (int k = 0; k < 3; ++k) x[k] = m[k];
      return;
    case PieceKind::segment:
      x[0] = m[0];
      x[1] = m[1];
      x[2] = m[2] + (u[2] < 0 ? -e[2] : e[2]);
      return;
    case PieceKind::box:
      for (int k = 0; k < 3; ++k) x[k] = m[k] + (u[k] < 0 ? -e[k] : e[k]);
      return;
    case PieceKind::cylinder:
    case PieceKind::cone: {
      const double r = sqrt(u[0] * u[0] + u[1] * u[1]), f = r > 0 ? e[0] / r : 0;
      double z = u[2] < 0 ? -e[2] : e[2], rim = 1;
      if (piece.kind == PieceKind::cone) {
        const bool tip = e[2] * u[2] >= e[0] * r - e[2] * u[2];
        z = tip ? e[2] : -e[2];
        rim = tip ? 0 : 1;
      }
      x[0] = m[0] + rim * f * u[0];
      x[1] = m[1] + rim * f * u[1];
      x[2] = m[2] + z;
      return;
    }
    case PieceKind::ellipsoid: {
      const double y[3] = {e[0] * u[0], e[1] * u[1], e[2] * u[2]}, n = norm(y), f = n > 0 ? 1 / n : 0;
      for (int k = 0; k < 3; ++k) x[k] = m[k] + f * e[k] * y[k];
      return;
    }
    case PieceKind::halfspace:
    case PieceKind::plane:
      for (int k = 0; k < 3; ++k) x[k] = m[0] * e[k];
      return;
  }
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
