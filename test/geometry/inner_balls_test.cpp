// SPDX-License-Identifier: BSD-3-Clause
//
// Balls inside closed meshes lie inside: judged by the solid angle that the mesh spans, point by point.
#include "geometry/inner_balls.h"

#include <array>
#include <cmath>
#include <functional>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "geometry/shape_tree.h"
#include "random.h"

namespace inner_balls_test {

using namespace fcl_artic;
using Eigen::Vector3d;

namespace {

struct Surface {
  std::vector<Vector3d> vertices;
  std::vector<std::array<int, 3>> triangles;

  /// n x m quadrilaterals, closed both ways: place(i / n, j / m).
  static Surface ring(int n, int m, const std::function<Vector3d(double, double)>& place) {
    Surface s;
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < m; ++j) s.vertices.push_back(place(i / static_cast<double>(n), j / static_cast<double>(m)));
    }
    const auto at = [&](int i, int j) { return (i % n) * m + j % m; };
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < m; ++j) {
        s.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
        s.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
      }
    }
    return s;
  }
  static Surface torus(double large, double small, int n = 24, int m = 14) {
    return ring(n, m, [&](double u, double v) {
      const double a = 2 * M_PI * u, b = 2 * M_PI * v, r = large + small * std::cos(b);
      return Vector3d(r * std::cos(a), r * std::sin(a), small * std::sin(b));
    });
  }
  /// A ring around two poles, given as radius by direction.
  static Surface star(int n, int m, const std::function<double(int, int)>& radius) {
    Surface s;
    for (int j = 0; j <= m; ++j) {
      for (int i = 0; i < (j % m ? n : 1); ++i) {
        const double a = 2 * M_PI * i / n, b = M_PI * j / m;
        s.vertices.push_back(radius(i, j) *
                             Vector3d(std::sin(b) * std::cos(a), std::sin(b) * std::sin(a), std::cos(b)));
      }
    }
    const auto at = [&](int i, int j) { return j == 0 ? 0 : j == m ? 1 + (m - 1) * n : 1 + (j - 1) * n + i % n; };
    for (int j = 0; j < m; ++j) {
      for (int i = 0; i < n; ++i) {
        if (j > 0) s.triangles.push_back({at(i, j), at(i, j + 1), at(i + 1, j)});
        if (j + 1 < m) s.triangles.push_back({at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)});
      }
    }
    return s;
  }
  static Surface sphere(double radius) {
    return star(16, 10, [&](int, int) { return radius; });
  }
  /// An L of square bars, 3 long and 1 wide.
  static Surface bent() {
    const double outline[6][2] = {{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}};
    Surface s;
    for (const double z : {0.0, 1.0}) {
      for (const auto& p : outline) s.vertices.emplace_back(p[0], p[1], z);
    }
    for (const auto& t : std::array<std::array<int, 3>, 4>{{{0, 1, 3}, {1, 2, 3}, {0, 3, 5}, {3, 4, 5}}}) {
      s.triangles.push_back({t[0], t[2], t[1]});
      s.triangles.push_back({6 + t[0], 6 + t[1], 6 + t[2]});
    }
    for (int i = 0; i < 6; ++i) {
      const int j = (i + 1) % 6;
      s.triangles.push_back({i, j, 6 + j});
      s.triangles.push_back({i, 6 + j, 6 + i});
    }
    return s;
  }
  void add(const Surface& other) {
    const int first = static_cast<int>(vertices.size());
    vertices.insert(vertices.end(), other.vertices.begin(), other.vertices.end());
    for (const auto& t : other.triangles) triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
  Surface& move(const Eigen::Isometry3d& M) {
    for (Vector3d& x : vertices) x = M * x;
    return *this;
  }
  /// How many times it goes around x (van Oosterom and Strackee's solid angles).
  double windings(const Vector3d& x) const {
    double sum = 0;
    for (const auto& t : triangles) {
      const Vector3d a = vertices[static_cast<std::size_t>(t[0])] - x, b = vertices[static_cast<std::size_t>(t[1])] - x,
                     c = vertices[static_cast<std::size_t>(t[2])] - x;
      const double na = a.norm(), nb = b.norm(), nc = c.norm();
      sum += 2 * std::atan2(a.dot(b.cross(c)), na * nb * nc + a.dot(b) * nc + b.dot(c) * na + c.dot(a) * nb);
    }
    return sum / (4 * M_PI);
  }
  bool encloses(const Vector3d& x) const { return std::lround(windings(x)) % 2 != 0; }
  std::shared_ptr<const ShapeTree> tree() const { return ShapeTree::fromTriangles(vertices, triangles); }
};

Eigen::Isometry3d anywhere(Random& random, double far) {
  return Eigen::Translation3d(far * unit(random)) * Eigen::AngleAxisd(uniform(random, -3, 3), unit(random));
}

Vector3d centerOf(const engine::InnerBalls& balls, int i) {
  return {balls.center[0][i], balls.center[1][i], balls.center[2][i]};
}

/// All points just within each ball are enclosed.
void expectInside(const Surface& surface, Random& random, const std::string& what) {
  const auto tree = surface.tree();
  const engine::InnerBalls* balls = tree->innerBalls();
  ASSERT_TRUE(balls) << what;
  for (int i = 0; i < balls->count; ++i) {
    const double radius = balls->radius[i];
    ASSERT_GT(radius, 0) << what;
    for (int k = 0; k < 60; ++k) {
      const Vector3d x = centerOf(*balls, i) + radius * (1 - 1e-9) * unit(random);
      ASSERT_TRUE(surface.encloses(x)) << what << ", ball " << i << " of radius " << radius;
    }
  }
}

}  // namespace

TEST(InnerBalls, LieInsideClosedMeshes) {
  Random random(3);
  for (int i = 0; i < 40; ++i) {
    const std::string number = std::to_string(i);
    const double far = std::pow(10.0, uniform(random, -2, 2));
    expectInside(Surface::torus(1, uniform(random, 0.1, 0.8)).move(anywhere(random, far)), random, "torus " + number);
    expectInside(Surface::bent().move(anywhere(random, far)), random, "bent " + number);
    const Surface star = Surface::star(9, 6, [&](int, int) { return uniform(random, 0.2, 1); });
    expectInside(Surface(star).move(anywhere(random, far)), random, "star " + number);
  }
}

/// The radius is the distance to the surface, but for rounding: touching balls are as large as they can be.
TEST(InnerBalls, AreAsLargeAsTheirPlaceLetsThem) {
  const auto tree = Surface::bent().tree();
  const engine::InnerBalls* balls = tree->innerBalls();
  ASSERT_TRUE(balls);
  EXPECT_GT(balls->count, 8);
  double largest = 0;
  for (int i = 0; i < balls->count; ++i) {
    const Vector3d x = centerOf(*balls, i);
    // From the sides of the L, worked out by hand.
    const double wall = std::min({x[0], x[1], x[2], 1 - x[2], 3 - x[0], 3 - x[1]});
    const Vector3d corner(std::max(0.0, 1 - x[0]), std::max(0.0, 1 - x[1]), 0);
    const double inner = x[0] <= 1 && x[1] <= 1 ? corner.norm() : x[0] > 1 ? 1 - x[1] : 1 - x[0];
    EXPECT_NEAR(balls->radius[i], std::min(wall, inner), 1e-12) << i;
    largest = std::max(largest, balls->radius[i]);
  }
  EXPECT_GT(largest, 0.4);  // half a bar is 0.5
}

TEST(InnerBalls, OpenMeshesGetNone) {
  Surface open = Surface::torus(1, 0.4);
  open.triangles.pop_back();
  EXPECT_FALSE(open.tree()->innerBalls());
  Surface thrice = Surface::torus(1, 0.4);  // its edges are in three triangles
  thrice.triangles.push_back(thrice.triangles[5]);
  EXPECT_FALSE(thrice.tree()->innerBalls());
  Surface twice = Surface::torus(1, 0.4);  // goes around everything twice: closed, and encloses nothing
  twice.add(Surface::torus(1, 0.4));
  EXPECT_FALSE(twice.tree()->innerBalls());
  // An open part leaves the closed one as it is.
  Surface both = Surface::torus(1, 0.4);
  const Surface alone = both;
  both.vertices.insert(both.vertices.end(), {Vector3d(3, 0, 0), Vector3d(3, 1, 0), Vector3d(3, 0, 1)});
  const int n = static_cast<int>(both.vertices.size());
  both.triangles.push_back({n - 3, n - 2, n - 1});
  const auto tree = both.tree();
  const engine::InnerBalls* balls = tree->innerBalls();
  ASSERT_TRUE(balls);
  for (int i = 0; i < balls->count; ++i) EXPECT_TRUE(alone.encloses(centerOf(*balls, i)));
}

/// Balls in a mesh of one piece go by the parity of all of it: a cavity is not inside.
TEST(InnerBalls, CavityOfOnePieceIsNotInside) {
  Random random(5);
  for (int i = 0; i < 10; ++i) {
    Surface hollow = Surface::sphere(1), inner = Surface::sphere(0.6);
    for (auto& t : inner.triangles) std::swap(t[0], t[1]);
    inner.vertices[0] = hollow.vertices[0];  // they share their pole
    hollow.add(inner);
    const Eigen::Isometry3d M = anywhere(random, 1);
    hollow.move(M);
    ASSERT_FALSE(hollow.encloses(M * Vector3d::Zero()));
    expectInside(hollow, random, "hollow " + std::to_string(i));
  }
}

/// Two shells are two parts, each of which encloses what it goes around.
TEST(InnerBalls, ShellsAreParts) {
  const Surface outer = Surface::sphere(1), inner = Surface::sphere(0.3);
  Surface both = outer;
  both.add(inner);
  const auto tree = both.tree();
  const engine::InnerBalls* balls = tree->innerBalls();
  ASSERT_TRUE(balls);
  bool seen[2] = {false, false};
  for (int i = 0; i < balls->count; ++i) {
    const engine::ClosedPart& part = balls->parts[balls->part[i]];
    const bool large = part.hi[2] > 0.5;
    seen[large] = true;
    EXPECT_TRUE((large ? outer : inner).encloses(centerOf(*balls, i))) << i;
    EXPECT_LE(centerOf(*balls, i).norm() + balls->radius[i], large ? 1 : 0.3) << i;
    for (int p = 0; p < 8; ++p) {
      const Vector3d x(part.points[0][p], part.points[1][p], part.points[2][p]);
      EXPECT_NEAR(x.norm(), large ? 1 : 0.3, 1e-12);
    }
  }
  EXPECT_TRUE(seen[0] && seen[1]);
}

TEST(InnerBalls, TrianglesWithoutAreaDoNotMatter) {
  Surface surface = Surface::torus(1, 0.4);
  surface.triangles.push_back({0, 0, 7});
  surface.triangles.push_back({3, 3, 3});
  EXPECT_TRUE(surface.tree()->innerBalls());
}

/// A point's parity, asked for directly: never said to be enclosed where it is not, and mostly where it is.
TEST(EnclosedSpace, ParityIsCertain) {
  Random random(8);
  int inside = 0, said = 0;
  for (int i = 0; i < 30; ++i) {
    Surface surface = Surface::bent();
    surface.add(Surface::torus(1.5, 0.4));  // through it
    const bool turned = i % 2;              // else along the axes, where lines run in sides and edges
    if (turned) surface.move(anywhere(random, 1));
    const auto tree = surface.tree();
    const EnclosedSpace space(tree->view());
    ASSERT_EQ(space.parts().count, 2);
    for (int k = 0; k < 300; ++k) {
      Vector3d x = surface.vertices[random() % surface.vertices.size()] + 1.5 * uniform(random, 0, 1) * unit(random);
      if (!turned && k % 2) {
        for (double& c : x) c = std::round(4 * c) / 4;
      }
      for (std::int32_t part = 0; part < 2; ++part) {
        Surface alone = surface;
        alone.triangles.clear();
        for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
          if (space.parts().part_of_piece[t] == part) alone.triangles.push_back(surface.triangles[t]);
        }
        Vector3d nearest;
        if (space.clearance(part, x, nearest) < 1e-9) continue;  // in the surface
        const bool is_inside = alone.encloses(x), certainly = space.certainlyEncloses(part, x);
        EXPECT_TRUE(is_inside || !certainly) << i << " " << x.transpose();
        inside += is_inside;
        said += certainly;
      }
    }
  }
  EXPECT_GT(inside, 1000);
  EXPECT_GT(said, 0.9 * inside);
}

}  // namespace inner_balls_test
