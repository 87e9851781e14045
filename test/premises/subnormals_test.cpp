// SPDX-License-Identifier: BSD-3-Clause
//
// Bodies hardly larger than what is promised about, where the caller has the processor take subnormal numbers for 0:
// floats below 1.2e-38 are none then, and boxes of trees are floats.
#include <string>
#include <vector>

#include <fcl/geometry/shape/halfspace.h>
#include <fcl/geometry/shape/sphere.h>
#include <gtest/gtest.h>

#include "control_bits.h"
#include "fcl_artic/continuous_collision.h"
#include "fcl_artic/point_cloud.h"

namespace subnormals_test {

using namespace fcl_artic;
using Eigen::Vector3d;
using numerics_test::kFlushing;

Eigen::Isometry3d at(const Vector3d& x) {
  return Eigen::Isometry3d(Eigen::Translation3d(x));
}

/// Which pairs that touch from the start are said to, one digit a pair.
std::string contacts() {
  std::string found;
  const auto ask = [&](const fcl::CollisionGeometryd& a, const fcl::CollisionGeometryd& b, const Vector3d& place) {
    for (const ContactMode mode : {ContactMode::first, ContactMode::any}) {
      CertifiedPairRequest request;
      request.mode = mode;
      CertifiedPairResult result;
      continuousCollide(&a, at({0, 0, 0}), at({1e-39, 0, 0}), &b, at(place), at(place), fcl::CCDM_TRANS, request,
                        result);
      found += result.isFree() ? '0' : '1';
    }
  };
  // They reach 1.1e-38 m down, into what begins 1e-38 m below the origin.
  const fcl::Halfspaced ground(Vector3d(0, 0, 1), -1e-38);
  ask(fcl::Sphered(1.1e-38), ground, {0, 0, 0});
  ask(PointCloud({{0, 0, 0}, {1e-38, 0, 0}}, 1.1e-38), ground, {0, 0, 0});
  // Two rods across each other, each 2.2e-38 m thick, their middles 2e-38 m apart.
  std::vector<Vector3d> along_x, along_y;
  for (int i = -20; i <= 20; ++i) {
    along_x.emplace_back(i * 1e-38, 0, 0);
    along_y.emplace_back(0, i * 1e-38, 0);
  }
  ask(PointCloud(along_x, 1.1e-38), PointCloud(along_y, 1.1e-38), {0, 0, 2e-38});
  return found;
}

TEST(Subnormals, TinyBodiesThatTouchAreNotFreeWhereSubnormalsAreFlushed) {
  EXPECT_EQ(contacts(), "111111");
  const std::uint64_t usual = numerics_test::controlBits();
  numerics_test::setControlBits(usual | kFlushing);
  const std::string flushed = contacts();
  numerics_test::setControlBits(usual);
  EXPECT_EQ(flushed, "111111");
}

}  // namespace subnormals_test
