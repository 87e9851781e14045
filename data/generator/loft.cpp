// SPDX-License-Identifier: BSD-3-Clause
#include "loft.h"

#include <cmath>

namespace fcl_artic::generator {

namespace {

constexpr double kGridPerMetre = 1e5;
constexpr double kPi = 3.14159265358979323846;

Eigen::Vector3d centre(const Ring& ring) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& p : ring) sum += p;
  return sum / static_cast<double>(ring.size());
}

/// A grid coordinate in decimals, written from integers: no locale, no "-0".
void appendCoordinate(std::string& text, double metres) {
  const long long grid = std::llround(metres * kGridPerMetre);
  const std::string digits = std::to_string(std::llabs(grid) + 100000);  // at least six digits
  const auto cut = digits.size() - 5;
  text += grid < 0 ? " -" : " ";
  text += std::to_string(std::llabs(grid) / 100000) + '.' + digits.substr(cut);
}

}  // namespace

Eigen::Vector2d unitVector(int k, int n) {
  constexpr double kScale = 1 << 30;
  const double a = 2 * kPi * k / n;
  return {std::round(std::cos(a) * kScale) / kScale, std::round(std::sin(a) * kScale) / kScale};
}

std::vector<Eigen::Vector2d> unitCircle(int n) {
  std::vector<Eigen::Vector2d> circle;
  for (int i = 0; i < n; ++i) circle.push_back(unitVector(2 * i + 1, 2 * n));
  return circle;
}

void addLoft(Mesh& mesh, const std::vector<Ring>& rings, const Eigen::Vector3d& first, const Eigen::Vector3d& last) {
  const int n = static_cast<int>(rings.front().size());
  const int base = static_cast<int>(mesh.vertices.size());
  const int end = base + n * static_cast<int>(rings.size());
  for (const Ring& ring : rings) mesh.vertices.insert(mesh.vertices.end(), ring.begin(), ring.end());
  mesh.vertices.push_back(first);
  mesh.vertices.push_back(last);

  for (int i = 0; i < n; ++i) {
    const int j = (i + 1) % n;
    mesh.triangles.push_back({end, base + j, base + i});
    for (int a = base; a + n < end; a += n) {
      mesh.triangles.push_back({a + i, a + j, a + n + j});
      mesh.triangles.push_back({a + i, a + n + j, a + n + i});
    }
    mesh.triangles.push_back({end - n + i, end - n + j, end + 1});
  }
}

void addLoft(Mesh& mesh, const std::vector<Ring>& rings) {
  addLoft(mesh, rings, centre(rings.front()), centre(rings.back()));
}

std::vector<Eigen::Vector2d> hullOfCircles(const std::vector<Circle>& circles, double inset, int n) {
  // The hull's point in direction u lies on the circle with the largest support c.u + r. An advantage below 1 nm is
  // none, so that rounding can't decide between circles.
  constexpr double kTie = 1e-9;
  std::vector<Eigen::Vector2d> hull;
  for (const Eigen::Vector2d& u : unitCircle(n)) {
    const Circle* best = &circles.front();
    double best_support = -1e300;
    for (const Circle& c : circles) {
      const double support = c.x * u.x() + c.y * u.y() + c.radius;
      if (support <= best_support + kTie) continue;
      best = &c;
      best_support = support;
    }
    hull.emplace_back(best->x + (best->radius - inset) * u.x(), best->y + (best->radius - inset) * u.y());
  }
  return hull;
}

void addPlate(Mesh& mesh, const Eigen::Isometry3d& pose, const std::vector<Circle>& circles, double z0, double z1,
              double rim, int n) {
  // Quarter-round rims in two steps: 1 - sin and 1 - cos of 0, 45 and 90 degrees, rounded.
  constexpr double kInset[] = {1, 0.293, 0}, kRise[] = {0, 0.293, 1};
  std::vector<Ring> rings;
  const auto addRing = [&](double inset, double z) {
    Ring ring;
    for (const auto& p : hullOfCircles(circles, inset, n)) ring.push_back(pose * Eigen::Vector3d(p.x(), p.y(), z));
    rings.push_back(std::move(ring));
  };
  for (int k = 0; k < 3; ++k) addRing(rim * kInset[k], z0 + rim * kRise[k]);
  for (int k = 2; k >= 0; --k) addRing(rim * kInset[k], z1 - rim * kRise[k]);
  addLoft(mesh, rings);
}

void snap(Mesh& mesh) {
  // k / 1e5 is the double nearest to the decimal number, the one that reading the file gives.
  for (auto& v : mesh.vertices) {
    for (double& x : v) x = static_cast<double>(std::llround(x * kGridPerMetre)) / kGridPerMetre;
  }
}

std::string objText(const Mesh& mesh, const std::string& title) {
  std::string text = "# " + title + "\n";
  text.reserve(32 * mesh.vertices.size() + 24 * mesh.triangles.size());
  for (const auto& v : mesh.vertices) {
    text += 'v';
    for (const double x : v) appendCoordinate(text, x);
    text += '\n';
  }
  for (const auto& t : mesh.triangles) {
    text += 'f';
    for (const int i : t) text += ' ' + std::to_string(i + 1);
    text += '\n';
  }
  return text;
}

}  // namespace fcl_artic::generator
