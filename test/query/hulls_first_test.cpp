// SPDX-License-Identifier: BSD-3-Clause
//
// Hulls of two bodies that move little are followed to where they meet before triangles are looked at. Bodies that are
// convex meet there. In a channel the hull of the channel is met first, then its bottom or nothing.
#include <cstdio>
#include <memory>
#include <random>
#include <vector>

#include <fcl/geometry/geometric_shape_to_BVH_model.h>
#include <gtest/gtest.h>

#include "crossing_links.h"
#include "expect_time.h"

namespace hulls_first_test {

using namespace fcl_artic;
using namespace fcl_artic::test;
using Eigen::Isometry3d;
using Eigen::Vector3d;

namespace {

constexpr double kHalf = 0.6;  ///< of a channel, across

/// Boxes' surfaces, each at its place.
std::shared_ptr<Mesh> merged(const std::vector<std::pair<Vector3d, Vector3d>>& boxes) {
  std::vector<Vector3d> v;
  std::vector<fcl::Triangle> t;
  for (const auto& [middle, half] : boxes) {
    const std::shared_ptr<Mesh> box = fineBoxMesh(half, 4);
    const std::size_t first = v.size();
    for (int i = 0; i < box->num_vertices; ++i) v.push_back(middle + box->vertices[i]);
    for (int i = 0; i < box->num_tris; ++i) {
      const fcl::Triangle& triangle = box->tri_indices[i];
      t.emplace_back(first + triangle[0], first + triangle[1], first + triangle[2]);
    }
  }
  return meshOf(v, t);
}

/// Opens towards -x. Its walls begin at x = 0, its bottom at x = depth.
std::shared_ptr<Mesh> channel(double depth) {
  const double wall = 0.05;
  const Vector3d half(0.5 * (depth + 0.1), wall, 0.5);
  return merged({{{half.x(), kHalf + wall, 0}, half},
                 {{half.x(), -kHalf - wall, 0}, half},
                 {{depth + wall, 0, 0}, {wall, kHalf, 0.5}}});
}

Isometry3d behind(double x) {
  Isometry3d at = Isometry3d::Identity();
  at.translation().x() = x;
  return at;
}

/// A ball of triangles in general position.
std::shared_ptr<Mesh> ball(double radius, double angle) {
  auto mesh = std::make_shared<Mesh>();
  Isometry3d pose = Isometry3d::Identity();
  pose.linear() = Eigen::AngleAxisd(angle, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  fcl::generateBVHModel(*mesh, fcl::Sphered(radius), pose, 12, 12);
  return mesh;
}

}  // namespace

/// Without following hulls hundreds of nodes and triangles are looked at.
TEST(HullsFirst, ConvexBodiesMeetWithoutASearchForTriangles) {
  const CrossingLinks balls(ball(0.5, 0.7), ball(0.4, -1.1), behind(-1));
  const double way = 0.3;
  const CertifiedResult r = balls.run(0, way, ContactMode::first);
  ASSERT_EQ(r.status, Status::contact);
  EXPECT_TRUE(r.certain);
  EXPECT_LE(r.t_upper - r.t_lower, 1e-6);
  EXPECT_TRUE(balls.run(0, way * r.t_lower - 1e-12).isFree());
  EXPECT_EQ(balls.run(way * r.t_upper + 1e-12, way * r.t_upper + 1e-12).status, Status::contact);
  std::printf("%d nodes, %d leaves\n", static_cast<int>(r.statistics.node_tests),
              static_cast<int>(r.statistics.leaf_tests));
  EXPECT_LT(r.statistics.node_tests + r.statistics.leaf_tests, 60u);
}

/// A box enters a channel without touching its walls. Mostly it meets the channel's hull in an earlier eighth of the
/// motion than its bottom, often in the same.
TEST(HullsFirst, WhatEntersAHullMeetsWhatIsWithin) {
  std::mt19937 random(5);
  const auto in = [&](double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(random); };
  int hit = 0, same_eighth = 0, free = 0;
  for (int i = 0; i < 200; ++i) {
    const double depth = in(0.01, 0.15), gap = in(0.05, 0.3), way = in(0.15, 0.6), half = 0.4;
    const CrossingLinks box(channel(depth), fineBoxMesh({half, in(0.3, kHalf - 0.02), 0.3}, 5), behind(-half - gap));
    const double t = (gap + depth) / way;
    if (std::abs(t - 1) < 1e-6) continue;
    const CertifiedResult first = box.run(0, way, ContactMode::first), any = box.run(0, way, ContactMode::any);
    if (t > 1) {
      EXPECT_TRUE(first.isFree() && any.isFree()) << i;
      free += gap < way;  // within the hull
      continue;
    }
    EXPECT_TRUE(touchesAt(first, t)) << i << ": hulls meet at " << gap / way;
    EXPECT_EQ(any.status, Status::contact) << i;
    EXPECT_GE(any.t_upper, t - 1e-9) << i;
    ++hit;
    same_eighth += static_cast<int>(8 * t) == static_cast<int>(8 * gap / way);
  }
  std::printf("%d in contact, %d of these in the eighth in which the hulls meet; %d free within the hull\n", hit,
              same_eighth, free);
  EXPECT_GT(hit, 50);
  EXPECT_GT(same_eighth, 8);
  EXPECT_GT(free, 20);
}

}  // namespace hulls_first_test
