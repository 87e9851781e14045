// SPDX-License-Identifier: BSD-3-Clause
//
// Bounds of a geometry hold it: boxes, line swept spheres, outer hulls.
#include "geometry/shape_tree.h"

#include <cmath>

#include <gtest/gtest.h>

#include "geometry/outer_hull.h"
#include "random.h"

#include "numerics/baseline_isa.h"

#include "convex/gjk.h"

namespace shape_tree_test {

using namespace fcl_artic;
using Eigen::Vector3d;

namespace {

/// A bumpy, stretched star around a centre that may be far from the origin.
std::vector<Vector3d> cloud(Random& random, std::size_t n, double bump) {
  const Vector3d stretch(uniform(random, 0.02, 1), uniform(random, 0.02, 1), uniform(random, 0.02, 1));
  const Vector3d centre = std::pow(10.0, uniform(random, -2, 3)) * unit(random);
  std::vector<Vector3d> points;
  for (std::size_t i = 0; i < n; ++i) {
    points.push_back(centre + stretch.cwiseProduct(unit(random)) * (1 + uniform(random, -bump, bump)));
  }
  return points;
}

std::vector<std::array<int, 3>> anyTriangles(Random& random, std::size_t vertices, std::size_t n) {
  std::vector<std::array<int, 3>> triangles;
  for (std::size_t i = 0; i < n; ++i) {
    std::array<int, 3> t;
    for (int& k : t) k = static_cast<int>(random() % vertices);
    triangles.push_back(t);
  }
  return triangles;
}

double distanceToSegment(const Vector3d& x, const Vector3d& p0, const Vector3d& p1) {
  const Vector3d d = p1 - p0;
  const double s = d.squaredNorm() > 0 ? std::min(1.0, std::max(0.0, (x - p0).dot(d) / d.squaredNorm())) : 0;
  return (x - p0 - s * d).norm();
}

}  // namespace

// A set lies in a convex one when its support function does, in every direction: 2,000 of them, and those to the
// points.
TEST(OuterHull, HoldsAllPoints) {
  Random random(1);
  int made = 0;
  for (int round = 0; round < 60; ++round) {
    const std::vector<Vector3d> points = cloud(random, 20 + random() % 1000, 0.1);
    const OuterHull hull = makeOuterHull(points);
    if (hull.vertices.empty()) continue;
    ++made;
    if (points.size() <= 160) {  // few: all of them
      ASSERT_EQ(hull.radius, 0);
    } else {
      ASSERT_LE(hull.vertices.size(), 96u);
    }
    for (int i = 0; i < 2000; ++i) {
      const Vector3d u = i % 2 ? unit(random) : (points[random() % points.size()] - hull.vertices[0]).normalized();
      if (!u.allFinite()) continue;
      double outside = -INFINITY, inside = -INFINITY;
      for (const Vector3d& p : points) outside = std::max(outside, u.dot(p - points[0]));
      for (const Vector3d& v : hull.vertices) inside = std::max(inside, u.dot(v - points[0]));
      ASSERT_LE(outside, inside + hull.radius) << "round " << round;
    }
  }
  EXPECT_GT(made, 40);  // the test is telling
}

// The same for points in the order of a mesh, and for each the one direction that tells most: from the hull straight to
// it.
TEST(OuterHull, HoldsEachPointOfAMesh) {
  Random random(11);
  int near_surface = 0, good_enough = 0;
  for (int round = 0; round < 30; ++round) {
    std::vector<Vector3d> points;
    const double waves = uniform(random, 1, 5), bump = uniform(random, 0, 0.4);
    for (int i = 0; i < 30; ++i) {
      for (int j = 0; j < 40; ++j) {
        const double a = 3.1416 * i / 29, b = 2 * 3.1416 * j / 40,
                     r = 1 + bump * std::sin(waves * a) * std::cos(waves * b);
        points.emplace_back(r * std::sin(a) * std::cos(b), 0.7 * r * std::sin(a) * std::sin(b), 0.4 * r * std::cos(a));
      }
    }
    const OuterHull hull = makeOuterHull(points);
    std::vector<double> packed;
    for (const Vector3d& v : hull.vertices) packed.insert(packed.end(), v.data(), v.data() + 3);
    engine::TreeView view;
    view.vertices = packed.data();
    engine::Piece piece, origin;
    piece.num_vertices = static_cast<std::int32_t>(hull.vertices.size());
    origin.kind = engine::PieceKind::point;
    baseline::DifferenceBody body;
    body.tree_a = body.tree_b = &view;
    body.a = &piece;
    body.b = &origin;
    body.pose.R = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    double farthest = 0;
    for (const Vector3d& p : points) {
      body.pose.c = baseline::Vec3(p.data());
      baseline::GjkResult g;
      baseline::gjk(body, body.pose.c, {1e-6, 0, 100}, g);
      const Vector3d u = Vector3d::Map(g.n.k);
      double inside = -INFINITY;
      for (const Vector3d& v : hull.vertices) inside = std::max(inside, u.dot(v));
      ASSERT_LE(u.dot(p), inside + hull.radius) << "round " << round;
      farthest = std::max(farthest, u.dot(p) - inside);
    }
    // And the radius is no larger than it needs to be, but where 1/500 of the body's size is good enough.
    if (hull.radius <= 0.002 * Vector3d(1.4, 0.98, 0.56).norm()) {
      ++good_enough;
    } else {
      near_surface += farthest > 0.998 * hull.radius;
    }
  }
  EXPECT_EQ(near_surface + good_enough, 30);
  EXPECT_GT(near_surface, 5);
}

// The farthest points first: a finely cut cylinder's circles, which are told from others by 64 vertices only where
// these are spread evenly.
TEST(OuterHull, IsNearRoundBodies) {
  std::vector<Vector3d> points;
  for (int i = 0; i < 500; ++i) {
    const double a = 2 * 3.14159265358979 * i / 500;
    for (const double z : {-0.3, -0.1, 0.1, 0.3}) points.emplace_back(0.1 * std::cos(a), 0.1 * std::sin(a), z);
  }
  const OuterHull hull = makeOuterHull(points, 0, 64);
  EXPECT_LE(hull.vertices.size(), 64u);
  EXPECT_LE(hull.radius,
            4 * 0.1 * (1 - std::cos(3.14159265358979 / 32)));  // 32 on each circle, spread evenly: a quarter
}

namespace {

/// Corners of the triangles below a node.
void pointsBelow(const engine::TreeView& view, int node, std::vector<Vector3d>& points) {
  const engine::Node& n = view.nodes[node];
  if (!n.isLeaf()) {
    pointsBelow(view, n.left(), points);
    pointsBelow(view, n.right(), points);
    return;
  }
  const double* v = view.vertices + 3 * static_cast<std::ptrdiff_t>(view.pieces[n.piece()].first_vertex);
  for (int k = 0; k < 9; k += 3) points.push_back(Vector3d::Map(v + k));
}

}  // namespace

TEST(ConvexParts, HoldWhatIsBelowTheirNodes) {
  Random random(8);
  int parts = 0;
  for (int round = 0; round < 20; ++round) {
    const std::vector<Vector3d> points = cloud(random, 300 + random() % 2000, 0.5);
    const auto tree = ShapeTree::fromTriangles(points, anyTriangles(random, points.size(), 500 + random() % 3000));
    const engine::TreeView& view = tree->viewWithParts();
    ASSERT_EQ(view.nodes, tree->view().nodes);
    ASSERT_TRUE(view.parts);
    for (int node = 0; node < view.num_nodes; ++node) {
      if (node == 1 || view.part_of_node[node] < 0) continue;
      ++parts;
      const engine::Piece& part = view.parts[view.part_of_node[node]];
      const double* x = view.hulls + part.first_vertex;
      ASSERT_EQ(reinterpret_cast<std::uintptr_t>(x) % 64, 0u);
      std::vector<Vector3d> below;
      pointsBelow(view, node, below);
      for (int i = 0; i < 300; ++i) {
        const Vector3d u = unit(random);
        double outside = -INFINITY, inside = -INFINITY, reach = 0;
        for (const Vector3d& p : below) outside = std::max(outside, u.dot(p - below[0]));
        for (int j = 0; j < part.num_vertices; ++j) {
          const Vector3d v(x[j], x[part.num_vertices + j], x[2 * part.num_vertices + j]);
          inside = std::max(inside, u.dot(v - below[0]));
          reach = std::max(reach, v.norm());
        }
        ASSERT_LE(outside, inside + part.radius) << "round " << round << ", node " << node;
        ASSERT_LE(reach, part.reach);
      }
    }
    // The whole's hull is still where it was.
    const engine::Piece& outer = *view.outer;
    for (int j = 0; j < 3 * outer.num_vertices; ++j) {
      ASSERT_EQ(view.hulls[outer.first_vertex + j], tree->view().hulls[outer.first_vertex + j]);
    }
  }
  EXPECT_GT(parts, 500);
}

TEST(ConvexParts, BodiesWithoutASurfaceHaveNone) {
  Random random(9);
  const std::vector<Vector3d> points = cloud(random, 500, 0.1);
  EXPECT_FALSE(ShapeTree::fromHull(points)->viewWithParts().parts);
  EXPECT_FALSE(ShapeTree::fromTriangle(points[0], points[1], points[2])->viewWithParts().parts);
  EXPECT_FALSE(ShapeTree::fromPieces({})->viewWithParts().parts);
}

TEST(ShapeTree, EveryNodeHoldsItsPieces) {
  Random random(3);
  for (int round = 0; round < 20; ++round) {
    const std::vector<Vector3d> points = cloud(random, 100, 0.3);
    const auto tree = ShapeTree::fromTriangles(points, anyTriangles(random, points.size(), 200));
    const engine::TreeView& view = tree->view();
    int leaves = 0;
    // Boxes are nested and a leaf's holds its piece: so every node holds all below it.
    std::vector<int> open{0};
    while (!open.empty()) {
      const engine::Node& node = view.nodes[open.back()];
      open.pop_back();
      if (!node.isLeaf()) open.insert(open.end(), {node.left(), node.right()});
      for (int k = 0; k < 3; ++k) {
        if (!node.isLeaf()) {
          for (const int child : {node.left(), node.right()}) {
            ASSERT_LE(node.lo[k], view.nodes[child].lo[k]);
            ASSERT_GE(node.hi[k], view.nodes[child].hi[k]);
          }
          continue;
        }
        const engine::Piece& piece = view.pieces[node.piece()];
        for (int j = 0; j < 3; ++j) {
          const double* p = view.vertices + 3 * (piece.first_vertex + j);
          ASSERT_LE(static_cast<double>(node.lo[k]), p[k]);
          ASSERT_GE(static_cast<double>(node.hi[k]), p[k]);
          ASSERT_LE(Vector3d::Map(p).norm(), piece.reach);
        }
      }
      leaves += node.isLeaf();
    }
    EXPECT_EQ(leaves, 200);
  }
}

TEST(ShapeTree, LineSweptSphereHoldsTheBody) {
  Random random(4);
  for (int round = 0; round < 100; ++round) {
    const std::vector<Vector3d> points = cloud(random, 50, 0.3);
    std::vector<std::array<int, 3>> triangles;
    for (int i = 0; i + 2 < 50; ++i) triangles.push_back({i, i + 1, i + 2});
    const std::array<double, 7> lss = ShapeTree::fromTriangles(points, triangles)->lineSweptSphere();
    for (const Vector3d& p : points) {
      ASSERT_LE(distanceToSegment(p, Vector3d::Map(&lss[0]), Vector3d::Map(&lss[3])), lss[6]);
    }
  }
  engine::Piece cylinder;
  cylinder.kind = engine::PieceKind::cylinder;
  cylinder.size[0] = 0.1;
  cylinder.size[2] = 1;
  const std::array<double, 7> lss = ShapeTree::fromPiece(cylinder)->lineSweptSphere();
  for (int i = 0; i < 1000; ++i) {
    const double angle = uniform(random, 0, 6.3);
    const Vector3d rim(0.1 * std::cos(angle), 0.1 * std::sin(angle), i % 2 ? 1 : -1);
    ASSERT_LE(distanceToSegment(rim, Vector3d::Map(&lss[0]), Vector3d::Map(&lss[3])), lss[6] + 1e-15);
  }
}

TEST(ShapeTree, LineSweptSphereHoldsMorePointsThanItsSearchLooksAt) {
  Random random(5);
  for (const std::size_t size : {101u, 3000u, 90000u}) {
    std::vector<Vector3d> points = cloud(random, size, 0.1);
    for (Vector3d& p : points) p = p.norm() > 0 ? Vector3d(0.1 * p.normalized() + Vector3d(0.3, 4 * p[1], 0)) : p;
    const engine::Piece ball = [] {
      engine::Piece piece;
      piece.kind = engine::PieceKind::point;
      piece.radius = 0.05;
      return piece;
    }();
    std::vector<engine::Piece> balls(points.size(), ball);
    for (std::size_t i = 0; i < points.size(); ++i) std::copy_n(points[i].data(), 3, balls[i].center);
    const LineSweptSphere lss = ShapeTree::fromPieces(balls)->lineSweptSphere();
    for (const Vector3d& p : points) {
      ASSERT_LE(distanceToSegment(p, Vector3d::Map(&lss[0]), Vector3d::Map(&lss[3])) + 0.05, lss[6]);
    }
  }
}

TEST(ShapeTree, LineSweptSphereIsSlim) {
  // A prism over a triangle with corners on a circle, most of its points near one edge: neither the principal axis nor
  // the middle of the extents is the circle's.
  Random random(6);
  std::vector<Vector3d> points;
  const auto corner = [](int i, double z) {
    const double angle = 2 * 3.14159265358979 / 3 * i;
    return Vector3d(0.1 * std::cos(angle), 0.1 * std::sin(angle), z);
  };
  for (int i = 0; i < 3; ++i) {
    for (const double z : {-0.3, 0.3}) points.push_back(corner(i, z));
  }
  for (int i = 0; i < 300; ++i) {
    const double s = uniform(random, 0, 1);
    points.push_back((1 - s) * corner(0, 0.3 * s) + s * corner(1, 0.3));
  }
  const LineSweptSphere lss = ShapeTree::fromHull(points)->lineSweptSphere();
  const double length = (Vector3d::Map(&lss[3]) - Vector3d::Map(&lss[0])).norm();
  const auto volume = [](double l, double r) { return r * r * (l + 4.0 / 3 * r); };
  EXPECT_LT(volume(length, lss[6]), 1.15 * volume(0.6, 0.1));
}

TEST(ShapeTree, RefusesWhatItCannotHold) {
  const std::vector<Vector3d> points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  EXPECT_THROW(ShapeTree::fromTriangles(points, {}), std::invalid_argument);
  EXPECT_THROW(ShapeTree::fromTriangles(points, {{{0, 1, 3}}}), std::invalid_argument);
  EXPECT_THROW(ShapeTree::fromTriangles(points, {{{0, 1, -1}}}), std::invalid_argument);
  EXPECT_THROW(ShapeTree::fromTriangles({{0, 0, 0}, {1, 0, NAN}, {0, 1, 0}}, {{{0, 1, 2}}}), std::invalid_argument);
}

TEST(ShapeTree, ManyPieces) {
  Random random(5);
  std::vector<engine::Piece> pieces;
  for (int i = 0; i < 300; ++i) {
    engine::Piece piece;
    const engine::PieceKind kinds[] = {engine::PieceKind::box, engine::PieceKind::point, engine::PieceKind::cone};
    piece.kind = kinds[i % 3];
    piece.primitive = 1000 + i;
    piece.radius = i % 3 == 1 ? 0.1 : 0;
    for (int k = 0; k < 3; ++k) {
      piece.size[k] = piece.kind == engine::PieceKind::point ? 0 : uniform(random, 0.01, 0.3);
      piece.center[k] = uniform(random, -2, 2);
    }
    pieces.push_back(piece);
  }
  const auto tree = ShapeTree::fromPieces(pieces);
  const engine::TreeView& view = tree->view();
  ASSERT_EQ(view.num_pieces, 300);
  std::vector<int> seen(300, 0), open{0};
  while (!open.empty()) {
    const engine::Node& node = view.nodes[open.back()];
    open.pop_back();
    if (!node.isLeaf()) {
      open.insert(open.end(), {node.left(), node.right()});
      for (const int child : {node.left(), node.right()}) {
        for (int k = 0; k < 3; ++k) {
          EXPECT_LE(node.lo[k], view.nodes[child].lo[k]);
          EXPECT_GE(node.hi[k], view.nodes[child].hi[k]);
        }
      }
      continue;
    }
    const engine::Piece& piece = view.pieces[node.piece()];
    ++seen[static_cast<std::size_t>(node.piece())];
    EXPECT_EQ(piece.primitive, 1000 + node.piece());
    double far = 0;
    for (int k = 0; k < 3; ++k) {
      const double half = piece.kind == engine::PieceKind::cone && k == 1 ? piece.size[0] : piece.size[k];
      EXPECT_LE(static_cast<double>(node.lo[k]), piece.center[k] - half - piece.radius);
      EXPECT_GE(static_cast<double>(node.hi[k]), piece.center[k] + half + piece.radius);
      far += std::pow(std::abs(piece.center[k]) + half, 2);
    }
    EXPECT_GE(piece.reach, std::sqrt(far));
  }
  for (const int n : seen) EXPECT_EQ(n, 1);
  // Nothing at all: whoever reads on finds a point at the origin.
  const auto empty = ShapeTree::fromPieces({});
  EXPECT_EQ(empty->view().num_pieces, 0);
  ASSERT_TRUE(empty->view().nodes[0].isLeaf());
  EXPECT_EQ(empty->view().pieces[empty->view().nodes[0].piece()].kind, engine::PieceKind::point);
  EXPECT_EQ(empty->view().outer, nullptr);
}

// Boxes are rounded outward by two floats, whatever the sign and the size.
TEST(ShapeTree, BoxesAreRoundedOutward) {
  for (const double x : {0.0, -0.0, 1e-300, 0.1, 1.0, 1 - 0x1p-25, 1 + 0x1p-25, 3e5, 1e9}) {
    for (const double y : {x, -x}) {
      const engine::Node node = buildBoxTree({{{y, y, y}, {y, y, y}}})[0];
      const auto low = static_cast<float>(y - 0x1p-125), high = static_cast<float>(y + 0x1p-125);
      EXPECT_EQ(node.lo[0], std::nextafter(std::nextafter(low, -1e30f), -1e30f)) << y;
      EXPECT_EQ(node.hi[0], std::nextafter(std::nextafter(high, 1e30f), 1e30f)) << y;
    }
  }
}

}  // namespace shape_tree_test
