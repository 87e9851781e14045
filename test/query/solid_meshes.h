// SPDX-License-Identifier: BSD-3-Clause
//
// Closed meshes whose inside is known.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "fcl_artic/solid_mesh.h"
#include "meshes.h"

namespace fcl_artic {
namespace test {

using Solid = SolidMesh<fcl::OBBRSSd>;

/// Vertices and triangles, put together piece by piece.
struct Soup {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<fcl::Triangle> triangles;

  /// Two triangles; seen from where the corners go around counterclockwise, that is outside.
  void addQuad(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c, const Eigen::Vector3d& d) {
    const std::size_t n = vertices.size();
    for (const Eigen::Vector3d* x : {&a, &b, &c, &d}) vertices.push_back(*x);
    triangles.emplace_back(n, n + 1, n + 2);
    triangles.emplace_back(n, n + 2, n + 3);
  }
  /// @param inward  its triangles face inward: the border of a cavity.
  void addBox(const Eigen::Vector3d& half, const Eigen::Vector3d& center = Eigen::Vector3d::Zero(),
              bool inward = false) {
    const auto corner = [&](int x, int y, int z) {
      return Eigen::Vector3d(center + half.cwiseProduct(Eigen::Vector3d(x, y, z)));
    };
    const std::size_t first = triangles.size();
    for (const int s : {-1, 1}) {
      addQuad(corner(s, -s, -1), corner(s, s, -1), corner(s, s, 1), corner(s, -s, 1));
      addQuad(corner(-1, s, -s), corner(-1, s, s), corner(1, s, s), corner(1, s, -s));
      addQuad(corner(-s, -1, s), corner(s, -1, s), corner(s, 1, s), corner(-s, 1, s));
    }
    if (inward) flip(first);
  }
  /// A square tube along z: the hole reaches through.
  void addTube(double outer, double inner, double half_length) {
    const double o = outer, i = inner, h = half_length;
    const auto side = [&](int k, double r, double z) {  // corners of the square, counterclockwise from above
      const int x[4] = {-1, 1, 1, -1}, y[4] = {-1, -1, 1, 1};
      return Eigen::Vector3d(r * x[k % 4], r * y[k % 4], z);
    };
    for (int k = 0; k < 4; ++k) {
      addQuad(side(k, o, -h), side(k + 1, o, -h), side(k + 1, o, h), side(k, o, h));
      addQuad(side(k + 1, i, -h), side(k, i, -h), side(k, i, h), side(k + 1, i, h));
      addQuad(side(k, o, h), side(k + 1, o, h), side(k + 1, i, h), side(k, i, h));
      addQuad(side(k, i, -h), side(k + 1, i, -h), side(k + 1, o, -h), side(k, o, -h));
    }
  }
  void flip(std::size_t first = 0) {
    for (std::size_t t = first; t < triangles.size(); ++t) {
      triangles[t] = fcl::Triangle(triangles[t][0], triangles[t][2], triangles[t][1]);
    }
  }
  std::shared_ptr<Mesh> surface() const { return meshOf(vertices, triangles); }
  std::shared_ptr<Solid> solid() const { return std::make_shared<Solid>(*surface()); }
};

inline std::shared_ptr<Solid> solidBox(const Eigen::Vector3d& half) {
  Soup soup;
  soup.addBox(half);
  return soup.solid();
}
inline std::shared_ptr<Solid> solidCube(double half) {
  return solidBox(Eigen::Vector3d::Constant(half));
}
inline std::shared_ptr<Solid> solidTube(double outer, double inner, double half_length) {
  Soup soup;
  soup.addTube(outer, inner, half_length);
  return soup.solid();
}
/// A cube of half size 1 with a cavity of half size 0.5.
inline std::shared_ptr<Solid> hollowCube() {
  Soup soup;
  soup.addBox(Eigen::Vector3d::Constant(1));
  soup.addBox(Eigen::Vector3d::Constant(0.5), Eigen::Vector3d::Zero(), true);
  return soup.solid();
}

}  // namespace test
}  // namespace fcl_artic
