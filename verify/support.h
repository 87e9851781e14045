// SPDX-License-Identifier: BSD-3-Clause
// Geometries as lists of pieces, and how far their points reach along a direction that changes with time.
#pragma once

#include <vector>

#include "taylor.h"

namespace verify {

/// How much a record may still cost, in steps of roughly 20 ns.
struct Budget {
  std::uint64_t left;
  void spend(std::uint64_t steps) {
    if (steps > left) throw NotProven("the limit of work is reached (--work)");
    left -= steps;
  }
};

using Point = std::array<Fix, 3>;
struct Box {
  Point low, high;
  void add(const Box& other);
};

/// A convex piece with a round part: the points (0, 0, z) + y, y in the ellipsoid around 0 with these semi-axes (0 is
/// allowed).
struct Round {
  double z, axes[3];
};

/// The function w.p + the most that a remainder r adds, sum r_k |p_k|: what is farther out along w + r where p_k >= 0,
/// along w - r where it is not.
struct Direction {
  Fix up[3], down[3];  // w + r, w - r
  Fix along(std::size_t k, Fix x) const { return (x.v < 0 ? down : up)[k] * x; }
  /// Less than 3 ulp too small.
  Fix of(const Point& p) const { return along(0, p[0]) + along(1, p[1]) + along(2, p[2]); }
  /// The most of a box: the function is convex in each coordinate, so an end is farthest. Less than 3 ulp too small.
  Fix most(const Box& box) const;
};

struct Geometry {
  enum Kind { mesh, boxes, box, sphere, ellipsoid, capsule, cylinder, cone, hull, halfspace, plane } kind = mesh;
  bool solid = false;            // mesh: with what is inside
  std::vector<double> numbers;   // of the shape, as stated
  std::vector<double> vertices;  // as stated, three each
  std::vector<std::uint32_t> triangles;
  std::vector<double> cells;  // as stated: centre, half sizes

  std::uint32_t pieces() const { return pieces_; }
  bool unbounded() const { return kind == halfspace || kind == plane; }
  /// Called once when all of the above is set.
  void prepare();

  // Derived:
  std::vector<Point> points;  // within 1 ulp
  std::vector<Round> rounds;  // of round shapes: the one piece is their hull

  /// For a mesh, after joinSurfaces(): the number of the connected part to which each triangle belongs.
  std::vector<std::uint32_t> part;
  /// @return whether the surface is closed and consistently oriented: each edge is passed by triangles as often in one
  /// direction as in the other. Every `mesh solid` of a World is: readWorld() refuses the others.
  bool joinSurfaces();

  /// Upper bounds of f(p) over all points p of the pieces [i, j), for f(p) = v.p + d: of the three Bernstein
  /// coefficients, remainder included.
  /// @param length  an upper bound of |v| for all s, where v is a rotated direction.
  std::array<Fix, 3> reach(std::uint32_t i, std::uint32_t j, const Vec& v, const Tm& d, Fix length,
                           Budget& budget) const;
  /// Upper bounds of |W p + o| over all points p of the pieces [i, j): of the three Bernstein coefficients, remainder
  /// included.
  /// @param W, o  W p + o is a point at distance |W p + o| from an axis or a centre, for all s: moving p by some
  ///   length changes it by no more.
  std::array<Fix, 3> distance(std::uint32_t i, std::uint32_t j, const Mat& W, const Vec& o, Budget& budget) const;

 private:
  struct Node {
    std::uint32_t from, to;  // items: triangles of a mesh, cells, points of a hull
    std::uint32_t right;     // the second child; the first follows its parent; 0: a leaf
    Box box;
  };
  struct Search;
  struct FarSearch;
  std::uint32_t build(std::uint32_t i, std::uint32_t j);
  Box boxOf(std::uint32_t item) const;

  std::uint32_t pieces_ = 1;
  std::vector<Box> cells_;  // of boxes, box and hull; each end within 2 ulp
  std::vector<Node> nodes_;
};

}  // namespace verify
