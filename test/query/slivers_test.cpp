// SPDX-License-Identifier: BSD-3-Clause
//
// Meshes of triangles that are many times as long as they are wide.
#include <cmath>

#include <fcl/math/motion/interp_motion.h>
#include <gtest/gtest.h>

#include "fcl_artic/continuous_collision.h"

#include "meshes.h"

namespace slivers_test {

using namespace fcl_artic;
using namespace fcl_artic::test;
using Eigen::Vector3d;

namespace {

/// A tube along z of 566 triangles as long as it is.
std::shared_ptr<Mesh> tubeOfSlivers() {
  constexpr double kPi = 3.14159265358979323846;
  constexpr std::size_t kSides = 283;
  std::vector<Vector3d> vertices;
  std::vector<fcl::Triangle> triangles;
  for (std::size_t i = 0; i <= kSides; ++i) {
    const double a = 2 * kPi * static_cast<double>(i) / kSides;
    for (const double z : {-0.7, 0.7}) vertices.emplace_back(0.1 * std::cos(a), 0.1 * std::sin(a), z);
  }
  for (std::size_t i = 0; i < kSides; ++i) {
    triangles.emplace_back(2 * i, 2 * i + 2, 2 * i + 3);
    triangles.emplace_back(2 * i, 2 * i + 3, 2 * i + 1);
  }
  return meshOf(vertices, triangles);
}

fcl::Transform3d pose(const Vector3d& at, const Vector3d& turn) {
  fcl::Transform3d M = fcl::Transform3d::Identity();
  M.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  M.translation() = at;
  return M;
}

}  // namespace

// The boxes of two slivers that pass each other askew meet until they are as near as they are long.
TEST(Slivers, ThatPassEachOtherAskewAreApartAcrossBoth) {
  const std::shared_ptr<Mesh> tube = tubeOfSlivers();
  const fcl::Transform3d still = fcl::Transform3d::Identity();
  // FCL's shorter constructors leave the reference point uninitialised.
  const auto motion = [](const fcl::Transform3d& from, const fcl::Transform3d& to) {
    return fcl::InterpMotion<double>(from.linear(), from.translation(), to.linear(), to.translation(),
                                     Vector3d::Zero());
  };
  const fcl::InterpMotion<double> stays = motion(still, still);
  int touching = 0;
  for (int i = 0; i < 12; ++i) {
    // Side by side, 3 cm apart, they tilt into each other; or, where i is odd, to where they stay apart.
    const double more = 0.004 * i, away = i % 2 ? 0.3 : 0;
    const fcl::InterpMotion<double> comes =
        motion(pose(Vector3d(0.07 + away, -0.22 - more, 0.19), Vector3d(0.07, -0.42 + more, 0.02)),
               pose(Vector3d(more + away, -0.22, 0.13), Vector3d(0.075, 0.2 - more, 0.03)));
    CertifiedPairResult result;
    continuousCollide(tube.get(), &stays, tube.get(), &comes, CertifiedPairRequest(), result);
    touching += result.status == Status::contact;
    EXPECT_LT(result.statistics.leaf_tests, 3000u) << i;
    EXPECT_LT(result.statistics.node_tests, 20000u) << i;
    std::printf("%d: %s, %zu node tests, %zu leaf tests\n", i, result.status == Status::free ? "free" : "contact",
                static_cast<std::size_t>(result.statistics.node_tests),
                static_cast<std::size_t>(result.statistics.leaf_tests));
  }
  EXPECT_EQ(touching, 6);
}

}  // namespace slivers_test
