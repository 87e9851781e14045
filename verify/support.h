// SPDX-License-Identifier: BSD-3-Clause
// Geometries as lists of pieces, and how far their points reach along a direction that changes with time.
#pragma once

#include <cstdint>
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

struct Point {
  Fix x[3];
};
struct Box {
  Fix low[3], high[3];
  void add(const Fix x[3]);
  void add(const Box& other);
};

/// A convex piece with a round part: the points p + y, y in the ellipsoid around 0 with these semi-axes (0 is allowed).
struct Round {
  double centre[3], axes[3];
  bool ball;  // all three are equal
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
  std::vector<Point> points;    // within 1 ulp
  std::vector<Round> rounds;    // of round shapes: the one piece is their hull
  std::vector<Box> cell_boxes;  // of boxes and box, each end within 2 ulp

  /// Of a mesh, after joinSurfaces(): a part that hangs together per triangle.
  std::vector<std::uint32_t> part;
  /// @return whether the surface is closed and consistently oriented: each edge is passed by triangles as often in one
  /// direction as in the other. Of every `mesh solid` of a World it is: readWorld() refuses the others.
  bool joinSurfaces();

  /// Upper bounds of f(p) over all points p of the pieces [i, j), for f(p) = v.p + d: of the three Bernstein
  /// coefficients, remainder included, and at s = 0.
  struct Reach {
    Fix b[3], centre;
    Fix slack;  // how much of each is there only because of the remainder
  };
  /// @param length  an upper bound of |v| for all s, where v is a rotated direction.
  Reach reach(std::uint32_t i, std::uint32_t j, const Vec& v, const Tm& d, Fix length, Budget& budget) const;

 private:
  struct Node {
    std::uint32_t from, to;     // pieces
    std::uint32_t right;        // the second child; the first follows its parent; 0: a leaf
    std::uint32_t first, last;  // of a leaf of triangles: its corners in leaf_points_
    Box box;
  };
  std::uint32_t build(std::uint32_t i, std::uint32_t j);
  Box boxOf(std::uint32_t piece) const;
  void rangeBox(std::uint32_t i, std::uint32_t j, Box& box) const;
  Fix farthest(std::uint32_t i, std::uint32_t j, const Fix w[3], Budget& budget) const;

  std::uint32_t pieces_ = 0, items_ = 0;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> leaf_points_;
};

}  // namespace verify
