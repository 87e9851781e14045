// SPDX-License-Identifier: BSD-3-Clause
//
// All that queries know of a kind of convex piece: one struct a kind, with one answer to each question. Every geometry
// is made of pieces, and no pair of kinds has code of its own. So this file and the reader of FCL's geometries
// (fcl/fcl_geometry.cpp) are all that queries of a new kind need. Certificates need three things more:
// - its text in certificate/world.cpp,
// - its inside in certificate/witness.cpp,
// - in verify/, which shares no code with the library, a Geometry::Kind (support.h) with its own reader
//   (statement.cpp), support bound (support.cpp) and inside (contact.cpp).
//
// doc/ARCHITECTURE.md, "Where to extend", also lists what pictures, Python and adapters need.
//
// A new kind: its value in PieceKind (model/piece.h), a struct here, a case in withKind(). A case or an answer that is
// missing does not compile; where a kind has no simple answer `Unknown` has one that is always right.
//
// The questions. `tree` is the body's, `p` the piece; all is in the tree's frame. The core is the piece without its
// rounding radius (Piece).
//   kBounded         false: half-spaces and planes, which are one direction each
//   kSurface         the piece is a part of a surface: a point next to it is not within the body
//   range            ends of x.u over the core, for one direction or for eight (exact but for rounding; NUMERICS, 4);
//                    of kinds about a centre m only `reach`: the ends are m.u - down and m.u + up
//   support          a point of the core farthest along u, of any length
//   halfSizes        of the core's box about Piece::center; false: it is the hull of points, or unbounded
//   certainlyWithin  whether x is in the solid, farther inside than x can be off by, and as much again for rounding.
//                    With certainlyTouching() (contact_proof.h) what `certain` rests on. `false`: not known
//   distance         from a point to the solid, up to 8 kUlp of the numbers that go in; 0 inside. Infinite: not known
//   nearest          the point of the core's solid that is nearest to d, both from the centre; asked where distance is
//   rodWidth         half the width of a rod, the second smallest half size of a box; infinite: it has no long chord
//   chord            a chord along the longest axis through the point next to x; false: not known
//   pointWithin      a point of the core at this part of its half sizes
//   cover            calls add(x, y, z), from the centre, with points whose hull holds the core
#pragma once

#include "model/tree_view.h"
#include "numerics/vec3.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

using engine::Piece;
using engine::PieceKind;
using engine::TreeView;

/// For a lambda that a switch calls: it is a part of the switch.
#define FCL_ARTIC_INLINE_CALL __attribute__((always_inline))

constexpr double kInfinite = __builtin_huge_val();

// ---- hulls of points, with lanes over directions or over points

/// Values of p.u over a hull's vertices, for eight directions.
FCL_ARTIC_INLINE void hullRange(const double* x, int n, const Vec3Lanes& u, Lanes& lower, Lanes& upper) {
  lower = upper = mulAdd(u[2], x[2 * n], mulAdd(u[1], x[n], u[0] * Lanes(x[0])));
  for (int i = 1; i < n; ++i) {
    const Lanes value = mulAdd(u[2], x[2 * n + i], mulAdd(u[1], x[n + i], u[0] * Lanes(x[i])));
    lower = min(lower, value);
    upper = max(upper, value);
  }
}
FCL_ARTIC_INLINE Lanes hullValues(const double* x, int n, int i, const Vec3& u) {
  const Lanes *X = reinterpret_cast<const Lanes*>(x + i), *Y = reinterpret_cast<const Lanes*>(x + n + i),
              *Z = reinterpret_cast<const Lanes*>(x + 2 * n + i);
  return mulAdd(*Z, u[2], mulAdd(*Y, u[1], *X * Lanes(u[0])));
}
/// The same for one direction: lanes go over vertices.
FCL_ARTIC_INLINE void hullRange(const double* x, int n, const Vec3& u, double& lower, double& upper) {
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
inline int hullSupport(const double* x, int n, const Vec3& u) {
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

FCL_ARTIC_INLINE Vec3 sizeOf(const Piece& p) {
  return Vec3(p.size);
}
FCL_ARTIC_INLINE Vec3 centerOf(const Piece& p) {
  return Vec3(p.center);
}

// ---- answers for kinds that have none of their own

/// Nothing is known: every answer is right for all kinds.
struct Unknown {
  static constexpr bool kBounded = true, kSurface = false, kCentred = false;
  static bool halfSizes(const Piece&, Vec3&) { return false; }
  static bool certainlyWithin(const Piece&, const Vec3&, double) { return false; }
  static FCL_ARTIC_INLINE Lanes distance(const Piece&, const Vec3Lanes&) { return Lanes(kInfinite); }
  static Vec3 nearest(const Piece&, const Vec3&) { return {0, 0, 0}; }
  static double rodWidth(const Piece&) { return kInfinite; }
  static bool chord(const Piece&, const Vec3&, Vec3*) { return false; }
};

/// Cores that lie about Piece::center.
struct Centred : Unknown {
  static constexpr bool kCentred = true;
  /// The ends of a chord through `through`, along the third axis or another one.
  static void setChord(const Piece& p, const Vec3& through, int along, Vec3* ends) {
    for (int end = 0; end < 2; ++end) {
      ends[end] = through;
      ends[end][along] = p.center[along] + (end ? p.size[along] : -p.size[along]);
    }
  }
  /// Distance from a point of the solid whose core is at d from x on each axis.
  static FCL_ARTIC_INLINE Lanes ofBall(const Piece& p, const Vec3Lanes& d) {
    return max(norm(d) - Lanes(p.radius), Lanes(0.0));
  }
};

// ---- the kinds

/// A triangle of a mesh, or any few points.
struct VerticesKind : Unknown {
  static constexpr bool kSurface = true;
  static const double* points(const TreeView& tree, const Piece& p) {
    return tree.vertices + 3 * static_cast<std::ptrdiff_t>(p.first_vertex);
  }
  template <class T>
  static FCL_ARTIC_INLINE void range(const TreeView& tree, const Piece& piece, const Vec3Of<T>& u, T& lower, T& upper) {
    const double* p = points(tree, piece);
    lower = upper = dot(u, Vec3(p));
    for (int i = 1; i < piece.num_vertices; ++i) {
      const T x = dot(u, Vec3(p + 3 * i));
      lower = min(lower, x);
      upper = max(upper, x);
    }
  }
  static Vec3 support(const TreeView& tree, const Piece& piece, const Vec3& u) {
    const double* p = points(tree, piece);
    int best = 0;
    double value = dot(Vec3(p), u);
    for (int i = 1; i < piece.num_vertices; ++i) {
      const double v = dot(Vec3(p + 3 * i), u);
      if (v > value) {
        value = v;
        best = i;
      }
    }
    return Vec3(p + 3 * best);
  }
  static Vec3 pointWithin(const TreeView& tree, const Piece& piece, const Vec3&) { return Vec3(points(tree, piece)); }
  template <class Add>
  static void cover(const TreeView& tree, const Piece& piece, const Add& add) {
    const double* p = points(tree, piece);
    for (int i = 0; i < piece.num_vertices; ++i) add(p[3 * i], p[3 * i + 1], p[3 * i + 2]);
  }
};

/// The hull of points that lie x, then y, then z (PieceKind).
struct HullKind : Unknown {
  template <class T>
  static FCL_ARTIC_INLINE void range(const TreeView& tree, const Piece& p, const Vec3Of<T>& u, T& lower, T& upper) {
    hullRange(tree.hulls + p.first_vertex, p.num_vertices, u, lower, upper);
  }
  static Vec3 vertex(const TreeView& tree, const Piece& piece, int i) {
    const double* p = tree.hulls + piece.first_vertex + i;
    const int n = piece.num_vertices;
    return {p[0], p[n], p[2 * n]};
  }
  static Vec3 support(const TreeView& tree, const Piece& piece, const Vec3& u) {
    return vertex(tree, piece, hullSupport(tree.hulls + piece.first_vertex, piece.num_vertices, u));
  }
  static Vec3 pointWithin(const TreeView& tree, const Piece& piece, const Vec3&) { return vertex(tree, piece, 0); }
  template <class Add>
  static void cover(const TreeView& tree, const Piece& piece, const Add& add) {
    const double* p = tree.hulls + piece.first_vertex;
    const int n = piece.num_vertices;
    for (int i = 0; i < n; ++i) add(p[i], p[n + i], p[2 * n + i]);
  }
};

/// A ball's core.
struct PointKind : Centred {
  template <class T>
  static FCL_ARTIC_INLINE void reach(const Piece&, const Vec3Of<T>&, T& down, T& up) {
    down = up = T(0.0);
  }
  static Vec3 support(const TreeView&, const Piece& p, const Vec3&) { return centerOf(p); }
  static bool halfSizes(const Piece&, Vec3& half) {
    half = {0, 0, 0};
    return true;
  }
  static bool certainlyWithin(const Piece& p, const Vec3& d, double least) { return p.radius - norm(d) > least; }
  static FCL_ARTIC_INLINE Lanes distance(const Piece& p, const Vec3Lanes& d) { return ofBall(p, d); }
  static Vec3 pointWithin(const TreeView&, const Piece& p, const Vec3&) { return centerOf(p); }
  template <class Add>
  static void cover(const TreeView&, const Piece&, const Add& add) {
    add(0, 0, 0);
  }
};

/// A capsule's core, along z.
struct SegmentKind : Centred {
  template <class T>
  static FCL_ARTIC_INLINE void reach(const Piece& p, const Vec3Of<T>& u, T& down, T& up) {
    down = up = abs(u[2]) * T(p.size[2]);
  }
  static Vec3 support(const TreeView&, const Piece& p, const Vec3& u) {
    return {p.center[0], p.center[1], p.center[2] + (u[2] < 0 ? -p.size[2] : p.size[2])};
  }
  static bool halfSizes(const Piece& p, Vec3& half) {
    half = {0, 0, p.size[2]};
    return true;
  }
  static bool certainlyWithin(const Piece& p, const Vec3& d, double least) {
    return p.radius - norm(Vec3(d[0], d[1], max(0.0, d[2] - p.size[2]))) > least;
  }
  static FCL_ARTIC_INLINE Lanes distance(const Piece& p, const Vec3Lanes& d) {
    return ofBall(p, {d[0], d[1], max(d[2] - Lanes(p.size[2]), Lanes(0.0))});
  }
  static Vec3 nearest(const Piece& p, const Vec3& d) { return {0, 0, max(-p.size[2], min(d[2], p.size[2]))}; }
  static double rodWidth(const Piece& p) { return p.radius; }
  static bool chord(const Piece& p, const Vec3&, Vec3* ends) {
    setChord(p, centerOf(p), 2, ends);
    return true;
  }
  static Vec3 pointWithin(const TreeView&, const Piece& p, const Vec3& part) {
    return {p.center[0], p.center[1], p.center[2] + part[2] * p.size[2]};
  }
  template <class Add>
  static void cover(const TreeView&, const Piece& p, const Add& add) {
    add(0, 0, p.size[2]);
    add(0, 0, -p.size[2]);
  }
};

struct BoxKind : Centred {
  template <class T>
  static FCL_ARTIC_INLINE void reach(const Piece& p, const Vec3Of<T>& u, T& down, T& up) {
    const double* e = p.size;
    down = up = mulAdd(abs(u[0]), T(e[0]), mulAdd(abs(u[1]), T(e[1]), abs(u[2]) * T(e[2])));
  }
  static Vec3 support(const TreeView&, const Piece& p, const Vec3& u) {
    Vec3 x = centerOf(p);
    for (int k = 0; k < 3; ++k) x[k] = x[k] + (u[k] < 0 ? -p.size[k] : p.size[k]);
    return x;
  }
  static bool halfSizes(const Piece& p, Vec3& half) {
    half = sizeOf(p);
    return true;
  }
  static bool certainlyWithin(const Piece& p, const Vec3& d, double least) {
    return p.size[0] - d[0] > least && p.size[1] - d[1] > least && p.size[2] - d[2] > least;
  }
  static FCL_ARTIC_INLINE Lanes distance(const Piece& p, const Vec3Lanes& d) {
    return norm(max(d - spread(sizeOf(p)), spread(Vec3(0, 0, 0))));
  }
  static Vec3 nearest(const Piece& p, const Vec3& d) { return max(-sizeOf(p), min(d, sizeOf(p))); }
  static double rodWidth(const Piece& p) {
    const double* e = p.size;
    return max(min(e[0], e[1]), min(max(e[0], e[1]), e[2]));
  }
  static bool chord(const Piece& p, const Vec3& x, Vec3* ends) {
    const Vec3 m = centerOf(p), e = sizeOf(p);
    int along = 2;
    for (int k = 0; k < 3; ++k) along = e[k] > e[along] ? k : along;
    setChord(p, min(max(x, m - e), m + e), along, ends);
    return true;
  }
  static Vec3 pointWithin(const TreeView&, const Piece& p, const Vec3& part) {
    return {p.center[0] + part[0] * p.size[0], p.center[1] + part[1] * p.size[1], p.center[2] + part[2] * p.size[2]};
  }
  template <class Add>
  static void cover(const TreeView&, const Piece& p, const Add& add) {
    const double* e = p.size;
    for (int c = 0; c < 8; ++c) add(c & 1 ? e[0] : -e[0], c & 2 ? e[1] : -e[1], c & 4 ? e[2] : -e[2]);
  }
};

/// The common part of a cylinder and a cone: an axis, z, and a circle about it.
struct Round : Centred {
  /// Corners of a regular octagon around the unit circle, (1, tan 22.5 degrees) and so on, a little outside.
  static constexpr double kLong = 1.0000000000001, kShort = 0.41421356237313;
  static bool halfSizes(const Piece& p, Vec3& half) {
    half = {p.size[0], p.size[0], p.size[2]};
    return true;
  }
  static Vec3 pointWithin(const TreeView&, const Piece& p, const Vec3& part) {
    return {p.center[0] + part[0] * p.size[0], p.center[1] + part[1] * p.size[0], p.center[2] + part[2] * p.size[2]};
  }
  template <class Add>
  static void octagon(double radius, const Add& add) {
    const double a = kLong * radius, b = kShort * radius;
    const double corners[8][2] = {{a, b}, {b, a}, {-b, a}, {-a, b}, {-a, -b}, {-b, -a}, {b, -a}, {a, -b}};
    for (const double* c : corners) add(c[0], c[1]);
  }
  template <class T>
  static FCL_ARTIC_INLINE T across(const Vec3Of<T>& u) {
    return sqrt(mulAdd(u[0], u[0], u[1] * u[1]));
  }
};

struct CylinderKind : Round {
  template <class T>
  static FCL_ARTIC_INLINE void reach(const Piece& p, const Vec3Of<T>& u, T& down, T& up) {
    down = up = mulAdd(across(u), T(p.size[0]), abs(u[2]) * T(p.size[2]));
  }
  static Vec3 support(const TreeView&, const Piece& p, const Vec3& u) {
    const double r = sqrt(u[0] * u[0] + u[1] * u[1]), f = r > 0 ? p.size[0] / r : 0;
    return {p.center[0] + f * u[0], p.center[1] + f * u[1], p.center[2] + (u[2] < 0 ? -p.size[2] : p.size[2])};
  }
  static bool certainlyWithin(const Piece& p, const Vec3& d, double least) {
    return p.size[0] - sqrt(d[0] * d[0] + d[1] * d[1]) > least && p.size[2] - d[2] > least;
  }
  static FCL_ARTIC_INLINE Lanes distance(const Piece& p, const Vec3Lanes& d) {
    const Lanes out = max(sqrt(mulAdd(d[0], d[0], d[1] * d[1])) - Lanes(p.size[0]), Lanes(0.0));
    const Lanes up = max(d[2] - Lanes(p.size[2]), Lanes(0.0));
    return sqrt(mulAdd(out, out, up * up));
  }
  static Vec3 nearest(const Piece& p, const Vec3& d) {
    const double from_axis = sqrt(d[0] * d[0] + d[1] * d[1]), part = from_axis > p.size[0] ? p.size[0] / from_axis : 1;
    return {part * d[0], part * d[1], max(-p.size[2], min(d[2], p.size[2]))};
  }
  static double rodWidth(const Piece& p) { return p.size[0]; }
  static bool chord(const Piece& p, const Vec3& x, Vec3* ends) {
    const Vec3 m = centerOf(p), d = x - m;
    const double r = sqrt(d[0] * d[0] + d[1] * d[1]), part = r > p.size[0] ? p.size[0] / r : 1;
    setChord(p, {m[0] + part * d[0], m[1] + part * d[1], m[2]}, 2, ends);
    return true;
  }
  template <class Add>
  static void cover(const TreeView&, const Piece& p, const Add& add) {
    octagon(p.size[0], [&](double x, double y) {
      add(x, y, p.size[2]);
      add(x, y, -p.size[2]);
    });
  }
};

/// Its tip is at +z: h(u) = max(c uz, a r - c uz).
struct ConeKind : Round {
  template <class T>
  static FCL_ARTIC_INLINE void reach(const Piece& p, const Vec3Of<T>& u, T& down, T& up) {
    const T r = across(u) * T(p.size[0]), z = u[2] * T(p.size[2]);
    up = max(z, r - z);
    down = max(T(0.0) - z, r + z);
  }
  static Vec3 support(const TreeView&, const Piece& p, const Vec3& u) {
    const double* e = p.size;
    const double r = sqrt(u[0] * u[0] + u[1] * u[1]), f = r > 0 ? e[0] / r : 0;
    const bool tip = e[2] * u[2] >= e[0] * r - e[2] * u[2];
    const double rim = tip ? 0 : 1;
    return {p.center[0] + rim * f * u[0], p.center[1] + rim * f * u[1], p.center[2] + (tip ? e[2] : -e[2])};
  }
  static bool chord(const Piece& p, const Vec3&, Vec3* ends) {
    setChord(p, centerOf(p), 2, ends);
    return true;
  }
  template <class Add>
  static void cover(const TreeView&, const Piece& p, const Add& add) {
    add(0, 0, p.size[2]);
    octagon(p.size[0], [&](double x, double y) { add(x, y, -p.size[2]); });
  }
};

struct EllipsoidKind : Centred {
  template <class T>
  static FCL_ARTIC_INLINE void reach(const Piece& p, const Vec3Of<T>& u, T& down, T& up) {
    const T x = u[0] * T(p.size[0]), y = u[1] * T(p.size[1]), z = u[2] * T(p.size[2]);
    down = up = sqrt(mulAdd(x, x, mulAdd(y, y, z * z)));
  }
  static Vec3 support(const TreeView&, const Piece& p, const Vec3& u) {
    const double* e = p.size;
    const Vec3 y(e[0] * u[0], e[1] * u[1], e[2] * u[2]);
    const double n = norm(y), f = n > 0 ? 1 / n : 0;
    return {p.center[0] + f * e[0] * y[0], p.center[1] + f * e[1] * y[1], p.center[2] + f * e[2] * y[2]};
  }
  static bool halfSizes(const Piece& p, Vec3& half) { return BoxKind::halfSizes(p, half); }
  static Vec3 pointWithin(const TreeView& tree, const Piece& p, const Vec3& part) {
    return BoxKind::pointWithin(tree, p, part);
  }
  /// An icosahedron around the unit ball, stretched: corners (0, +-a, +-b) and its cyclic shifts, b / a the golden
  /// section phi. Its faces are at a phi^2 / sqrt(3), a little more than 1, from the middle.
  template <class Add>
  static void cover(const TreeView&, const Piece& p, const Add& add) {
    constexpr double kA = 0.66158453886, kB = 1.07046626935;
    const double* e = p.size;
    for (int i = 0; i < 4; ++i) {
      const double a = i & 1 ? kA : -kA, b = i & 2 ? kB : -kB;
      add(0, a * e[1], b * e[2]);
      add(a * e[0], b * e[1], 0);
      add(b * e[0], 0, a * e[2]);
    }
  }
};

/// {n.x <= offset}, n in `size`, offset in `center[0]`. There is one direction; no search along any other makes sense.
struct HalfspaceKind : Unknown {
  static constexpr bool kBounded = false;
  /// Ends of n.x: known along the piece's own normal, bit for bit (a still piece), and along no other direction.
  static void range(const TreeView&, const Piece& p, const Vec3& u, double& lower, double& upper) {
    lower = isAlong(p, u, -1) ? -p.center[0] : -kInfinite;
    upper = isAlong(p, u, 1) ? p.center[0] : kInfinite;
  }
  static FCL_ARTIC_INLINE void range(const TreeView&, const Piece&, const Vec3Lanes&, Lanes& lower, Lanes& upper) {
    lower = Lanes(-kInfinite);
    upper = Lanes(kInfinite);
  }
  /// The foot of its boundary, which is right along its own normal only.
  static Vec3 support(const TreeView&, const Piece& p, const Vec3&) { return sizeOf(p) * p.center[0]; }
  static Vec3 pointWithin(const TreeView& tree, const Piece& p, const Vec3& part) { return support(tree, p, part); }
  template <class Add>
  static void cover(const TreeView&, const Piece&, const Add&) {}  // no points hold it

  static bool isAlong(const Piece& p, const Vec3& u, double sign) {
    return u[0] == sign * p.size[0] && u[1] == sign * p.size[1] && u[2] == sign * p.size[2];
  }
};

/// {n.x = offset}.
struct PlaneKind : HalfspaceKind {
  static constexpr bool kSurface = true;
  using HalfspaceKind::range;
  static void range(const TreeView&, const Piece& p, const Vec3& u, double& lower, double& upper) {
    const bool along = isAlong(p, u, 1), against = isAlong(p, u, -1);
    lower = along ? p.center[0] : against ? -p.center[0] : -kInfinite;
    upper = against ? -p.center[0] : along ? p.center[0] : kInfinite;
  }
};

// ---- the only switch over kinds

/// f(Kind()) for the kind's struct.
template <class F>
FCL_ARTIC_INLINE auto withKind(PieceKind kind, const F& f) {
  switch (kind) {
    case PieceKind::vertices:
      return f(VerticesKind());
    case PieceKind::hull:
      return f(HullKind());
    case PieceKind::point:
      return f(PointKind());
    case PieceKind::segment:
      return f(SegmentKind());
    case PieceKind::box:
      return f(BoxKind());
    case PieceKind::cylinder:
      return f(CylinderKind());
    case PieceKind::cone:
      return f(ConeKind());
    case PieceKind::ellipsoid:
      return f(EllipsoidKind());
    case PieceKind::halfspace:
      return f(HalfspaceKind());
    case PieceKind::plane:
      return f(PlaneKind());
  }
  __builtin_unreachable();  // kinds are our own: no caller can make another one
}

// ---- the questions

/// Half-spaces and planes.
FCL_ARTIC_INLINE bool unbounded(const Piece& piece) {
  return withKind(piece.kind, [](auto kind) FCL_ARTIC_INLINE_CALL { return !decltype(kind)::kBounded; });
}
/// A body that is one bounded convex piece and no surface: what is within its boundary is within it.
FCL_ARTIC_INLINE bool isSolid(const TreeView& tree) {
  if (tree.num_pieces != 1) return false;
  return withKind(tree.pieces[0].kind, [](auto kind) FCL_ARTIC_INLINE_CALL {
    return decltype(kind)::kBounded && !decltype(kind)::kSurface;
  });
}

/// Values of p.u over the core: lower end -h(-u), upper end h(u). T: double, or Lanes for eight directions.
template <class T>
FCL_ARTIC_INLINE void coreRange(const TreeView& tree, const Piece& piece, const Vec3Of<T>& u, T& lower, T& upper) {
  // Most pieces are triangles or hulls: predicted, while the switch jumps.
  if (piece.kind == PieceKind::vertices) return VerticesKind::range(tree, piece, u, lower, upper);
  if (piece.kind == PieceKind::hull) return HullKind::range(tree, piece, u, lower, upper);
  T down, up;
  const bool centred = withKind(piece.kind, [&](auto kind) FCL_ARTIC_INLINE_CALL {
    using Kind = decltype(kind);
    if constexpr (Kind::kCentred) {
      Kind::reach(piece, u, down, up);
    } else {
      Kind::range(tree, piece, u, lower, upper);
    }
    return Kind::kCentred;
  });
  if (!centred) return;
  const T m = dot(u, centerOf(piece));
  lower = m - down;
  upper = m + up;
}

/// Up to this number of lanes, each goes through a hull's vertices by itself, eight vertices at once.
constexpr int kFewLanes = 3;

/// The same where only `lanes` matter: nothing need be known of the others.
FCL_ARTIC_INLINE void coreRange(const TreeView& tree, const Piece& piece, const Vec3Lanes& u, unsigned lanes,
                                Lanes& lower, Lanes& upper) {
  if (piece.kind != PieceKind::hull || __builtin_popcount(lanes) > kFewLanes) {
    return coreRange(tree, piece, u, lower, upper);
  }
  lower = Lanes(-kInfinite);
  upper = Lanes(kInfinite);
  for (unsigned left = lanes; left; left &= left - 1) {
    const int lane = __builtin_ctz(left);
    double least, most;
    hullRange(tree.hulls + piece.first_vertex, piece.num_vertices, laneOf(u, lane), least, most);
    lower.set(lane, least);
    upper.set(lane, most);
  }
}

/// A point of the core farthest along u (unit or not); of an unbounded piece the foot of its boundary.
inline Vec3 supportPoint(const TreeView& tree, const Piece& piece, const Vec3& u) {
  return withKind(piece.kind, [&](auto kind) FCL_ARTIC_INLINE_CALL { return decltype(kind)::support(tree, piece, u); });
}

/// Half sizes of the core's box about Piece::center; false where it has none of its own.
inline bool coreHalfSizes(const Piece& piece, Vec3& half) {
  return withKind(piece.kind, [&](auto kind) FCL_ARTIC_INLINE_CALL { return decltype(kind)::halfSizes(piece, half); });
}

/// The point x is certainly within the solid: farther inside than x can be off by, and as much again for rounding.
/// False where that is not known.
/// @param eps  bound on x's error.
inline bool certainlyWithin(const Piece& solid, const Vec3& x, double eps) {
  const Vec3 d = abs(x - centerOf(solid));
  return withKind(solid.kind,
                  [&](auto kind) FCL_ARTIC_INLINE_CALL { return decltype(kind)::certainlyWithin(solid, d, 2 * eps); });
}

/// Distance of points from a solid, up to 8 kUlp of the numbers that go in; 0 inside. Infinite where it is not known.
FCL_ARTIC_INLINE Lanes distanceFrom(const Piece& solid, const Vec3Lanes& x) {
  const Vec3Lanes d = abs(x - spread(centerOf(solid)));
  return withKind(solid.kind, [&](auto kind) FCL_ARTIC_INLINE_CALL { return decltype(kind)::distance(solid, d); });
}

/// The point of a solid of which the distance is known that is nearest to x.
inline Vec3 nearestPoint(const Piece& solid, const Vec3& x) {
  const Vec3 d = x - centerOf(solid);
  const Vec3 core =
      withKind(solid.kind, [&](auto kind) FCL_ARTIC_INLINE_CALL { return decltype(kind)::nearest(solid, d); });
  const Vec3 rest = d - core;
  const double length = norm(rest), within = length > solid.radius ? solid.radius / length : 1;
  return centerOf(solid) + core + rest * within;
}

/// Half the width of a rod, the second smallest half size of a box; infinite for what has no long chord.
inline double widthOfRod(const Piece& solid) {
  return withKind(solid.kind, [&](auto kind) FCL_ARTIC_INLINE_CALL { return decltype(kind)::rodWidth(solid); });
}

/// A chord of a solid: along its longest axis, a cylinder's or a cone's own, through the solid's point next to x. Its
/// ends err by less than supportPoint()'s. False where none is known.
inline bool longChord(const Piece& solid, const Vec3& x, Vec3* ends) {
  return withKind(solid.kind, [&](auto kind) FCL_ARTIC_INLINE_CALL { return decltype(kind)::chord(solid, x, ends); });
}

/// A point of the piece, radius included.
/// @param part  of its half sizes, from its middle; |part| <= 1.
inline Vec3 pointWithin(const TreeView& tree, const Piece& piece, const Vec3& part) {
  const Vec3 x = withKind(
      piece.kind, [&](auto kind) FCL_ARTIC_INLINE_CALL { return decltype(kind)::pointWithin(tree, piece, part); });
  return x + part * piece.radius;
}

/// Calls add(x, y, z), from Piece::center, with points whose hull holds the core; of unbounded pieces with none.
template <class Add>
inline void coverCore(const TreeView& tree, const Piece& piece, const Add& add) {
  withKind(piece.kind, [&](auto kind) FCL_ARTIC_INLINE_CALL { decltype(kind)::cover(tree, piece, add); });
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
