// SPDX-License-Identifier: BSD-3-Clause
//
// One geometry of each of FCL's 19 kinds, half a metre or less to each side. Each has a point of its surface where the
// x axis leaves it on the right. In the direction x it reaches just as far, however it is turned about x.
#pragma once

#include <memory>
#include <vector>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/octree/octree.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cone.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/ellipsoid.h>
#include <fcl/geometry/shape/halfspace.h>
#include <fcl/geometry/shape/plane.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/geometry/shape/triangle_p.h>

namespace dropin {

/// Surface of a box around the origin.
template <class BV>
std::shared_ptr<fcl::BVHModel<BV>> boxMesh(typename BV::S x, typename BV::S y, typename BV::S z) {
  using Vector = fcl::Vector3<typename BV::S>;
  std::vector<Vector> v;
  for (int i = 0; i < 8; ++i)
    v.emplace_back((i & 1) ? x / 2 : -x / 2, (i & 2) ? y / 2 : -y / 2, (i & 4) ? z / 2 : -z / 2);
  const std::size_t faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  std::vector<fcl::Triangle> t;
  for (const auto& f : faces) {
    t.emplace_back(f[0], f[1], f[2]);
    t.emplace_back(f[0], f[2], f[3]);
  }
  auto mesh = std::make_shared<fcl::BVHModel<BV>>();
  mesh->beginModel();
  mesh->addSubModel(v, t);
  mesh->endModel();
  return mesh;
}

/// Corners on the axes.
template <class S>
std::shared_ptr<fcl::Convex<S>> octahedron(S x, S y, S z) {
  using Vector = fcl::Vector3<S>;
  auto vertices = std::make_shared<std::vector<Vector>>(
      std::vector<Vector>{{x, 0, 0}, {-x, 0, 0}, {0, y, 0}, {0, -y, 0}, {0, 0, z}, {0, 0, -z}});
  auto faces = std::make_shared<std::vector<int>>();
  for (const auto& f :
       {std::vector<int>{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}) {
    faces->push_back(3);
    faces->insert(faces->end(), f.begin(), f.end());
  }
  return std::make_shared<fcl::Convex<S>>(vertices, 8, faces);
}

/// Two by two by two cells around the origin.
template <class S>
std::shared_ptr<fcl::OcTree<S>> cells(double size) {
  auto tree = std::make_shared<octomap::OcTree>(size);
  for (int i = 0; i < 8; ++i) {
    const auto at = [&](int bit) { return static_cast<float>((i & bit) ? size / 2 : -size / 2); };
    tree->updateNode(octomap::point3d(at(1), at(2), at(4)), true);
  }
  return std::make_shared<fcl::OcTree<S>>(tree);
}

template <class S>
struct Geometry {
  const char* name;
  std::shared_ptr<fcl::CollisionGeometry<S>> geometry;
  fcl::Matrix3<S> turn = fcl::Matrix3<S>::Identity();  ///< puts it as said above
  S reach = 0;                                         ///< along x
  bool unbounded = false;
};

template <class S = double>
std::vector<Geometry<S>> allGeometries() {
  using Matrix = fcl::Matrix3<S>;
  using Vector = fcl::Vector3<S>;
  const Matrix up_to_x = (Matrix() << 0, 0, 1, 0, 1, 0, -1, 0, 0).finished();  // z to x
  const S half = S(0.5);
  return {
      {"Box", std::make_shared<fcl::Box<S>>(S(0.8), S(0.6), S(1)), Matrix::Identity(), S(0.4)},
      {"Sphere", std::make_shared<fcl::Sphere<S>>(S(0.4)), Matrix::Identity(), S(0.4)},
      {"Ellipsoid", std::make_shared<fcl::Ellipsoid<S>>(S(0.5), S(0.3), S(0.4)), Matrix::Identity(), S(0.5)},
      {"Capsule", std::make_shared<fcl::Capsule<S>>(S(0.25), S(0.5)), Matrix::Identity(), S(0.25)},
      {"Cone", std::make_shared<fcl::Cone<S>>(S(0.4), S(1)), up_to_x, half},
      {"Cylinder", std::make_shared<fcl::Cylinder<S>>(S(0.3), S(0.8)), Matrix::Identity(), S(0.3)},
      {"Convex", octahedron<S>(S(0.5), S(0.4), S(0.3)), Matrix::Identity(), half},
      {"Halfspace", std::make_shared<fcl::Halfspace<S>>(Vector(0, 0, 1), S(0.25)), up_to_x, S(0.25), true},
      {"Plane", std::make_shared<fcl::Plane<S>>(Vector(0, 0, 1), S(0.25)), up_to_x, S(0.25), true},
      {"TriangleP",
       std::make_shared<fcl::TriangleP<S>>(Vector(half, 0, 0), Vector(-half, half, 0), Vector(-half, -half, 0)),
       Matrix::Identity(), half},
      {"OcTree", cells<S>(0.25), Matrix::Identity(), S(0.25)},
      {"BVHModel<AABB>", boxMesh<fcl::AABB<S>>(1, 0.8, 0.6), Matrix::Identity(), half},
      {"BVHModel<OBB>", boxMesh<fcl::OBB<S>>(1, 0.8, 0.6), Matrix::Identity(), half},
      {"BVHModel<RSS>", boxMesh<fcl::RSS<S>>(1, 0.8, 0.6), Matrix::Identity(), half},
      {"BVHModel<OBBRSS>", boxMesh<fcl::OBBRSS<S>>(1, 0.8, 0.6), Matrix::Identity(), half},
      {"BVHModel<kIOS>", boxMesh<fcl::kIOS<S>>(1, 0.8, 0.6), Matrix::Identity(), half},
      {"BVHModel<KDOP16>", boxMesh<fcl::KDOP<S, 16>>(1, 0.8, 0.6), Matrix::Identity(), half},
      {"BVHModel<KDOP18>", boxMesh<fcl::KDOP<S, 18>>(1, 0.8, 0.6), Matrix::Identity(), half},
      {"BVHModel<KDOP24>", boxMesh<fcl::KDOP<S, 24>>(1, 0.8, 0.6), Matrix::Identity(), half},
  };
}

}  // namespace dropin
