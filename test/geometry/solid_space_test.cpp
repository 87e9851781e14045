// SPDX-License-Identifier: BSD-3-Clause
//
// Where points lie in meshes that are solids, among winding numbers by the triangles' solid angles.
#include "geometry/solid_space.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <string>

#include <Eigen/Geometry>

#include "geometry/closed_parts.h"
#include "geometry/shape_tree.h"

namespace solid_space_test {

using namespace fcl_artic;
using Eigen::Vector3d;

namespace {

struct Soup {
  std::vector<Vector3d> vertices;
  std::vector<std::array<int, 3>> triangles;
  void add(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
    const int n = static_cast<int>(vertices.size());
    vertices.insert(vertices.end(), {a, b, c});
    triangles.push_back({n, n + 1, n + 2});
  }
  /// @param inward  its triangles face inward.
  void addBox(const Vector3d& center, const Vector3d& half, bool inward = false) {
    const auto corner = [&](int i) {
      return Vector3d(center + half.cwiseProduct(Vector3d(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1)));
    };
    const int sides[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    for (const auto& s : sides) {
      for (const int k : {1, 2}) {
        const Vector3d a = corner(s[0]), b = corner(s[k]), c = corner(s[k + 1]);
        inward ? add(a, c, b) : add(a, b, c);
      }
    }
  }
  std::shared_ptr<const ShapeTree> tree(bool solid = true) const {
    return ShapeTree::fromTriangles(vertices, triangles, solid);
  }
  long double winding(const Vector3d& x) const {
    using V = Eigen::Matrix<long double, 3, 1>;
    long double sum = 0;
    for (const auto& t : triangles) {
      V p[3];
      for (std::size_t k = 0; k < 3; ++k) p[k] = (vertices[static_cast<std::size_t>(t[k])] - x).cast<long double>();
      const long double a = p[0].norm(), b = p[1].norm(), c = p[2].norm();
      sum += 2 * std::atan2(p[0].dot(p[1].cross(p[2])),
                            a * b * c + p[0].dot(p[1]) * c + p[1].dot(p[2]) * a + p[2].dot(p[0]) * b);
    }
    return sum / (4 * std::acos(-1.0L));
  }
};

using Side = SolidSpace::Side;

Side sideOf(const ShapeTree& tree, const Vector3d& x, double error = 1e-12) {
  Vector3d nearest;
  return tree.space()->sideOf(x, error, nearest);
}

std::string reasonAgainst(const Soup& soup) {
  return whyNoSolid(soup.tree(false)->view());
}

}  // namespace

// In line with edges and diagonals, where any line along an axis meets one.
TEST(SolidSpace, PointsInLineWithEdges) {
  Soup soup;
  soup.addBox({0, 0, 0}, {1, 1, 1});
  const auto tree = soup.tree();
  EXPECT_EQ(sideOf(*tree, {0, 0, 0}), Side::inside);
  EXPECT_EQ(sideOf(*tree, {0.5, 0.5, 0.5}), Side::inside);
  EXPECT_EQ(sideOf(*tree, {0, 0, 0.999999}), Side::inside);
  EXPECT_EQ(sideOf(*tree, {0, 0, 1.000001}), Side::outside);
  EXPECT_EQ(sideOf(*tree, {1.5, 1, 1}), Side::outside);
  EXPECT_EQ(sideOf(*tree, {1, 1, 1}), Side::unknown);
  EXPECT_EQ(sideOf(*tree, {0.3, 0.2, 1}), Side::unknown);
  EXPECT_EQ(sideOf(*tree, {0.3, 0.2, 1 - 1e-9}), Side::inside);
  EXPECT_EQ(sideOf(*tree, {0.3, 0.2, 1 - 1e-9}, 1e-8), Side::unknown) << "what it stands for may be outside";
  EXPECT_EQ(sideOf(*tree, {0.3, 0.2, 1 + 1e-9}, 1e-8), Side::unknown);
  Vector3d nearest;
  ASSERT_EQ(tree->space()->sideOf({0.1, 0.9, 0}, 0, nearest), Side::inside);
  EXPECT_LT((nearest - Vector3d(0.1, 1, 0)).norm(), 1e-12);
}

TEST(SolidSpace, WindingNumbersCount) {
  Soup soup;
  soup.addBox({0, 0, 0}, {3, 3, 3});
  soup.addBox({0, 0, 0}, {2, 2, 2}, true);        // a cavity
  soup.addBox({0, 0, 0}, {1, 1, 1});              // and a solid in it
  soup.addBox({5, 0, 0}, {1, 1, 1}, true);        // beside: its inside is inside all the same
  soup.addBox({5, 0, 0}, {0.5, 0.5, 0.5}, true);  // faces the same way: nothing new
  const auto tree = soup.tree();
  EXPECT_EQ(sideOf(*tree, {2.5, 0, 0}), Side::inside);
  EXPECT_EQ(sideOf(*tree, {1.5, 0, 0}), Side::outside);
  EXPECT_EQ(sideOf(*tree, {0.5, 0, 0}), Side::inside);
  EXPECT_EQ(sideOf(*tree, {5.7, 0, 0}), Side::inside);
  EXPECT_EQ(sideOf(*tree, {5, 0, 0}), Side::inside);
  EXPECT_EQ(sideOf(*tree, {3.5, 0, 0}), Side::outside);
  EXPECT_EQ(tree->space()->winding({0.31, 0.22, 0.13}, 0).number, 1);
  EXPECT_EQ(tree->space()->winding({5.01, 0.02, 0.13}, 1).number, -2);
  EXPECT_EQ(tree->surfacePoints()->parts().size(), 5u);
}

// Boxes through each other, turned, far away, with slivers: as the solid angles say, and hardly ever unknown.
TEST(SolidSpace, AgreesWithSolidAngles) {
  std::mt19937 random(5);
  const auto in = [&](double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(random); };
  int inside = 0, unknown = 0, near = 0, n = 0;
  for (int body = 0; body < 60; ++body) {
    Soup soup;
    for (int box = 0; box < 1 + body % 4; ++box) {
      Soup one;
      one.addBox({in(-1, 1), in(-1, 1), in(-1, 1)}, {in(0.1, 1), in(0.1, 1), body % 5 ? in(0.1, 1) : 1e-7},
                 in(0, 1) < 0.3);
      const Eigen::Quaterniond turn = Eigen::Quaterniond(in(-1, 1), in(-1, 1), in(-1, 1), in(-1, 1)).normalized();
      for (const auto& t : one.triangles) {
        const auto x = [&](std::size_t k) { return Vector3d(turn * one.vertices[static_cast<std::size_t>(t[k])]); };
        const Vector3d far = body % 7 ? Vector3d(0, 0, 0) : Vector3d(1e6, -1e6, 3e5);
        soup.add(far + x(0), far + x(1), far + x(2));
      }
    }
    const auto tree = soup.tree();
    for (int i = 0; i < 60; ++i, ++n) {
      Vector3d x = soup.vertices[static_cast<std::size_t>(random()) % soup.vertices.size()];
      x += i % 3 ? Vector3d(in(-1, 1), in(-1, 1), in(-1, 1))
                 : Vector3d(1e-9 * in(-1, 1), 1e-9 * in(-1, 1), 1e-9 * in(-1, 1));
      const Side side = sideOf(*tree, x, 0);
      near += i % 3 == 0;
      unknown += side == Side::unknown && i % 3;
      if (side == Side::unknown) continue;
      const long double w = soup.winding(x);
      if (i % 3) ASSERT_NEAR(static_cast<double>(w - std::round(w)), 0, 1e-4);
      if (std::abs(static_cast<double>(w - std::round(w))) > 1e-3) continue;  // the judge can't tell
      EXPECT_EQ(side == Side::inside, std::lround(w) != 0)
          << "body " << body << ", winding number " << static_cast<double>(w);
      inside += side == Side::inside;
    }
  }
  EXPECT_GT(inside, n / 20);
  EXPECT_LT(unknown, n / 100);
}

// Triangles without area: corners in a line, or in one place.
TEST(SolidSpace, TrianglesWithoutArea) {
  Soup soup;
  soup.addBox({0, 0, 0}, {1, 1, 1});
  // An edge of the first triangle cut in two, on one side only; what closes it lies in a line.
  const Vector3d a = soup.vertices[0], b = soup.vertices[1], c = soup.vertices[2], m = 0.5 * (a + b);
  soup.vertices[1] = m;
  soup.add(m, b, c);
  EXPECT_NE(reasonAgainst(soup).find("not closed: 3 edges"), std::string::npos) << reasonAgainst(soup);
  soup.add(a, b, m);
  soup.add({7, 7, 7}, {7, 7, 7}, {7, 7, 8});  // a segment by itself, no edges
  EXPECT_EQ(reasonAgainst(soup), "");
  const auto tree = soup.tree();
  EXPECT_EQ(sideOf(*tree, {0, 0, 0}), Side::inside);
  EXPECT_EQ(sideOf(*tree, m + Vector3d(0.01, 0.01, 0.01)), Side::inside);
  EXPECT_EQ(sideOf(*tree, m - Vector3d(0.01, 0.01, 0.01)), Side::outside);
  EXPECT_EQ(sideOf(*tree, {7, 7, 7.5}), Side::unknown);
  EXPECT_EQ(sideOf(*tree, {6.9, 7, 7.5}), Side::outside);
  EXPECT_EQ(tree->surfacePoints()->parts().size(), 2u);
}

TEST(SolidSpace, WhatIsNoSolid) {
  Soup soup;
  soup.addBox({0, 0, 0}, {1, 1, 1});
  EXPECT_EQ(reasonAgainst(soup), "");
  Soup open = soup;
  open.triangles.erase(open.triangles.begin() + 4);
  EXPECT_NE(reasonAgainst(open).find("not closed: 3 edges belong to an odd number"), std::string::npos);
  Soup turned = soup;
  std::swap(turned.triangles[4][0], turned.triangles[4][1]);
  EXPECT_NE(reasonAgainst(turned).find("not consistently oriented: 3 edges"), std::string::npos);
  Soup apart = soup;  // a vertex moved by its last digit
  apart.vertices[0].x() = std::nextafter(apart.vertices[0].x(), 2);
  EXPECT_NE(reasonAgainst(apart).find("not closed"), std::string::npos);
  Soup zeros;  // -0 is 0
  zeros.addBox({1, 1, 1}, {1, 1, 1});
  for (std::size_t i = 0; i < zeros.vertices.size(); i += 2) {
    for (double& x : zeros.vertices[i]) x = x == 0 ? -0.0 : x;
  }
  EXPECT_EQ(reasonAgainst(zeros), "");
  EXPECT_THROW(open.tree(), std::invalid_argument);
  EXPECT_EQ(open.tree(false)->space(), nullptr);
}

// For a body that is no mesh: points of each piece, all of them within it.
TEST(SolidSpace, PointsOfShapes) {
  engine::Piece piece;
  piece.kind = engine::PieceKind::cone;
  piece.size[0] = 0.3;
  piece.size[2] = 0.5;
  const auto cone = ShapeTree::fromPiece(piece);
  ASSERT_EQ(cone->surfacePoints()->parts().size(), 1u);
  for (const Vector3d& x : cone->surfacePoints()->parts()[0].points) {
    EXPECT_LE(std::abs(x.z()), 0.5);
    EXPECT_LE(x.head<2>().norm(), 0.3 * 0.5 * (1 - x.z() / 0.5));
  }
  const auto hull = ShapeTree::fromHull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  for (const Vector3d& x : hull->surfacePoints()->parts()[0].points) {
    EXPECT_GE(x.minCoeff(), 0);
    EXPECT_LE(x.sum(), 1);
  }
  piece = {};
  piece.kind = engine::PieceKind::halfspace;
  piece.size[2] = 1;
  EXPECT_TRUE(ShapeTree::fromPiece(piece)->surfacePoints()->parts().empty());
}

}  // namespace solid_space_test
