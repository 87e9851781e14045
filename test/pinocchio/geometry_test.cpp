// SPDX-License-Identifier: BSD-3-Clause
//
// coal's geometries, number by number.
#include <coal/shape/convex.h>
#include <fcl/geometry/bvh/BVH_model.h>
#include <gtest/gtest.h>

#include "fcl_artic/pinocchio/coal_geometry.h"

namespace fcl_artic {
namespace geometry_test {
namespace {

TEST(CoalGeometry, MeshesAreCopiedTriangleByTriangle) {
  coal::BVHModel<coal::RSS> mesh;
  mesh.beginModel();
  for (int i = 0; i < 5; ++i) mesh.addTriangle({i + 0.1, 0, 0}, {i + 0.1, 1, 0}, {i + 0.1, 0, 0.3 * i + 1});
  mesh.endModel();
  const CoalGeometry copy = fromCoal(mesh);
  const auto& made = dynamic_cast<const fcl::BVHModel<fcl::OBBRSSd>&>(*copy.geometry);
  ASSERT_EQ(made.num_tris, 5);
  for (int i = 0; i < 5; ++i) {
    for (int k = 0; k < 3; ++k) {
      const std::size_t theirs = (*mesh.tri_indices)[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)];
      EXPECT_EQ(made.vertices[made.tri_indices[i][k]], (*mesh.vertices)[theirs]);
    }
  }
  (*mesh.tri_indices)[2].set(0, 1, 99);
  EXPECT_THROW(fromCoal(mesh), std::invalid_argument);
}

TEST(CoalGeometry, SweptRadii) {
  coal::Sphere ball(0.5);
  ball.setSweptSphereRadius(0.25);
  EXPECT_EQ(fromCoal(ball).swept_radius, 0);
  EXPECT_GE(dynamic_cast<const fcl::Sphered&>(*fromCoal(ball).geometry).radius, 0.75);
  EXPECT_LT(dynamic_cast<const fcl::Sphered&>(*fromCoal(ball).geometry).radius, 0.75 + 1e-15);
  coal::Box box(1, 2, 3);
  EXPECT_EQ(dynamic_cast<const fcl::Boxd&>(*fromCoal(box).geometry).side, fcl::Vector3d(1, 2, 3));
  box.setSweptSphereRadius(0.25);
  EXPECT_EQ(fromCoal(box).swept_radius, 0.25);
  EXPECT_EQ(dynamic_cast<const fcl::Boxd&>(*fromCoal(box).geometry).side, fcl::Vector3d(1, 2, 3));
}

}  // namespace
}  // namespace geometry_test
}  // namespace fcl_artic
