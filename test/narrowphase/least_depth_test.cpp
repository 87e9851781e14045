// SPDX-License-Identifier: BSD-3-Clause
//
// The direction of least depth against all candidates. For two polytopes in each other these are the directions across
// a face of their difference, and each face goes through three of its corners.
#include "narrowphase/least_depth.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace fcl_artic {
namespace least_depth_test {
namespace {

using Eigen::Vector3d;

class Random {
 public:
  Vector3d vector() { return {number_(engine_), number_(engine_), number_(engine_)}; }

 private:
  std::mt19937_64 engine_{1};
  std::uniform_real_distribution<double> number_{-1, 1};
};

/// Corners of B - A.
std::vector<Vector3d> difference(const std::vector<Vector3d>& a, const std::vector<Vector3d>& b) {
  std::vector<Vector3d> w;
  for (const Vector3d& x : a) {
    for (const Vector3d& y : b) w.push_back(y - x);
  }
  return w;
}
Vector3d lowestOf(const std::vector<Vector3d>& w, const Vector3d& n) {
  return *std::min_element(w.begin(), w.end(),
                           [&](const Vector3d& x, const Vector3d& y) { return n.dot(x) < n.dot(y); });
}
double gapAlong(const std::vector<Vector3d>& w, const Vector3d& n) {
  return n.dot(lowestOf(w, n));
}
/// The largest gap, by all planes through three corners.
double largestGap(const std::vector<Vector3d>& w) {
  double most = -1e300;
  for (std::size_t i = 0; i < w.size(); ++i) {
    for (std::size_t j = i + 1; j < w.size(); ++j) {
      for (std::size_t k = j + 1; k < w.size(); ++k) {
        const Vector3d n = (w[j] - w[i]).cross(w[k] - w[i]);
        if (n.norm() < 1e-12) continue;
        for (const double sign : {1.0, -1.0}) most = std::max(most, gapAlong(w, sign * n.normalized()));
      }
    }
  }
  return most;
}
Vector3d directionOf(const std::vector<Vector3d>& w, const Vector3d& given, const Vector3d& towards) {
  const auto lowest = [&](const Vector3d& n) { return lowestOf(w, n); };
  return LeastDepth(lowest, given, towards).direction();
}

TEST(LeastDepth, NoDirectionIsBetterForPolytopes) {
  Random random;
  int deep = 0;
  for (int k = 0; k < 60; ++k) {
    std::vector<Vector3d> a, b;
    for (int i = 0; i < 3 + k % 3; ++i) a.push_back(random.vector());
    for (int i = 0; i < 4; ++i) b.push_back((k % 4 ? 1 : 1e-4) * random.vector());
    const std::vector<Vector3d> w = difference(a, b);
    const Vector3d given = random.vector().normalized(), n = directionOf(w, given, given);
    const double most = largestGap(w);
    if (most >= 0) continue;  // apart
    ++deep;
    EXPECT_NEAR(n.norm(), 1, 1e-12);
    EXPECT_NEAR(gapAlong(w, n), most, 1e-8) << k;
  }
  EXPECT_GT(deep, 15);
}

TEST(LeastDepth, OfABallInABallIsTheWayBetweenTheirMiddles) {
  Random random;
  for (int k = 0; k < 20; ++k) {
    const Vector3d d = 0.9 * random.vector().normalized();
    const auto lowest = [&](const Vector3d& n) -> Vector3d { return d - n.normalized(); };  // a ball of radius 1
    const Vector3d given = random.vector().normalized(), n = LeastDepth(lowest, given, given).direction();
    // The best is d / |d| with a gap of |d| - 1; a polytope's normals err by some hundredths, the gap by their square.
    EXPECT_NEAR(n.dot(lowest(n)), d.norm() - 1, 5e-3);
  }
}

// A ball's middle on a triangle's face: out across the face, and of its two sides to the one that is asked for.
TEST(LeastDepth, OfWhatIsFlatIsAcross) {
  const std::vector<Vector3d> face{{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
  const Vector3d up = Vector3d::UnitZ();
  for (const double side : {1.0, -1.0}) {
    const Vector3d towards(0.3, -0.2, 0.1 * side);
    EXPECT_NEAR(directionOf(face, -Vector3d::UnitY(), towards).dot(side * up), 1, 1e-12);
  }
  const Vector3d across = directionOf({{-1, 0, 0}, {1, 0, 0}}, Vector3d::UnitX(), up);
  EXPECT_NEAR(across.x(), 0, 1e-12);
  EXPECT_EQ(directionOf({{0, 0, 0}}, up, up), up);
}

}  // namespace
}  // namespace least_depth_test
}  // namespace fcl_artic
