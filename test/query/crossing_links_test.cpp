// SPDX-License-Identifier: BSD-3-Clause
//
// Links that are meshes, where any contact will do. It is proven at a pose at which the bodies' bounds are deep in each
// other. A mesh deep within another one touches nothing.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <fcl/geometry/geometric_shape_to_BVH_model.h>
#include <gtest/gtest.h>

#include "crossing_links.h"

namespace crossing_links_test {

using namespace fcl_artic;
using namespace fcl_artic::test;
using Eigen::Isometry3d;
using Eigen::Vector3d;

namespace {

/// One triangle drawn twice: no longer closed, so that nothing is known of its inside (inner_balls_test.cpp).
std::shared_ptr<Mesh> withTriangleTwice(const Mesh& mesh) {
  std::vector<fcl::Triangle> t(mesh.tri_indices, mesh.tri_indices + mesh.num_tris);
  t.push_back(t.front());
  return meshOf({mesh.vertices, mesh.vertices + mesh.num_vertices}, t);
}

/// How far x is from a triangle's plane, and how far beyond its edges in it, in all.
double outsideTriangle(const Mesh& mesh, std::intptr_t triangle, const Vector3d& x) {
  const fcl::Triangle& t = mesh.tri_indices[triangle];
  const Vector3d a = mesh.vertices[t[0]], b = mesh.vertices[t[1]], c = mesh.vertices[t[2]];
  const Vector3d n = (b - a).cross(c - a).normalized();
  double most = std::abs(n.dot(x - a));
  for (const auto& [p, q] : {std::array<Vector3d, 2>{a, b}, {b, c}, {c, a}}) {
    most = std::max(most, -n.cross(q - p).normalized().dot(x - p));
  }
  return most;
}

}  // namespace

/// Boxes' surfaces anywhere, through, beside and within each other: both modes say the same, and the point of any
/// contact lies on both triangles that are named.
TEST(CrossingLinks, AnyContactLiesOnBothTriangles) {
  std::mt19937 random(11);
  const auto in = [&](double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(random); };
  int at_poses = 0, free = 0, free_within = 0;
  for (int i = 0; i < 600; ++i) {
    const Vector3d half(in(0.05, 0.4), in(0.05, 0.4), in(0.05, 0.4));
    const bool small = i % 3 == 0;  // and often within the other
    const Vector3d any_size(in(0.05, 0.4), in(0.05, 0.4), in(0.05, 0.4));
    const Vector3d other = small ? Vector3d(half * in(0.1, 0.4)) : any_size;
    Isometry3d at = Isometry3d::Identity();
    at.linear() = Eigen::Quaterniond(in(-1, 1), in(-1, 1), in(-1, 1), in(-1, 1)).normalized().toRotationMatrix();
    const double reach = small ? 0.05 : 0.5;
    at.translation() = Vector3d(in(-reach, reach), in(-reach, reach), in(-reach, reach));
    const auto a = withTriangleTwice(*fineBoxMesh(half, 1 + i % 5)), b = fineBoxMesh(other, 1 + i % 4);
    const CrossingLinks crossing(a, b, at);
    const double from = in(-reach, reach), to = in(-reach, reach);
    const CertifiedResult any = crossing.run(from, to, ContactMode::any);
    ASSERT_EQ(any.status, crossing.run(from, to, ContactMode::first).status) << i;
    free += any.isFree();
    free_within += any.isFree() && small;
    if (any.isFree() || !any.certain) continue;
    ASSERT_EQ(any.contacts.size(), 1u) << i;
    const CertifiedContact& contact = any.contacts[0];
    EXPECT_NEAR(contact.normal.norm(), 1, 1e-9) << i;
    if (contact.feature != FeatureKind::edgeFace && contact.feature != FeatureKind::faceEdge) continue;
    ++at_poses;
    const bool swapped = contact.body1.name != "still";
    Isometry3d M = at;
    M.translation().x() += from + contact.t_upper * (to - from);
    EXPECT_LT(outsideTriangle(*a, swapped ? contact.b2 : contact.b1, contact.point), 1e-9) << i;
    EXPECT_LT(outsideTriangle(*b, swapped ? contact.b1 : contact.b2, M.inverse() * contact.point), 1e-9) << i;
    // The face that is pierced gives the normal.
    const bool of_a = (contact.feature == FeatureKind::faceEdge) != swapped;
    const Vector3d normal = of_a ? contact.normal : Vector3d(M.linear().transpose() * contact.normal);
    EXPECT_NEAR(normal.cwiseAbs().maxCoeff(), 1, 1e-9) << i;
  }
  std::printf("%d contacts at poses, %d free, %d of them small and within\n", at_poses, free, free_within);
  EXPECT_GT(at_poses, 200);
  EXPECT_GT(free_within, 20);
}

/// Plates over each other, all of them askew in their frames, so that the boxes around any two meet and only their
/// hulls part them. They are deep in each other's line swept spheres. None touches.
class Plates {
 public:
  /// @param with_crossing  one more link crosses the last plate: that pair is the deepest.
  Plates(int count, double step, bool with_crossing) : manager_(sliderTree(links(count + with_crossing))) {
    const auto plate = plateOf({0.2, 0.2, 0.1 * step}), crossing = plateOf({0.005, 0.15, 0.4 * step});
    for (int i = 0; i < count + with_crossing; ++i) {
      objects_.push_back(std::make_unique<fcl::CollisionObjectd>(i < count ? plate : crossing));
      const Vector3d at = askew() * Vector3d(0, 0, step * std::min(i, count - 1));
      manager_.bind(name(i), objects_.back().get(), Isometry3d(Eigen::Translation3d(at)));
    }
    manager_.setup();
  }
  CertifiedResult run(ContactMode mode) const {
    CertifiedRequest request;
    request.mode = mode;
    const Eigen::Index n = manager_.tree().dof();
    return ask(manager_, Eigen::VectorXd::Zero(n), Eigen::VectorXd::Constant(n, 1e-4), request);
  }

 private:
  static Eigen::AngleAxisd askew() { return Eigen::AngleAxisd(0.7, Vector3d(1, 1, 0).normalized()); }
  static std::string name(int i) { return "plate" + std::to_string(i); }
  static std::vector<std::string> links(int count) {
    std::vector<std::string> names;
    for (int i = 0; i < count; ++i) {
      if (i) names.push_back("between" + std::to_string(i));
      names.push_back(name(i));
    }
    return names;
  }
  static std::shared_ptr<Mesh> plateOf(const Vector3d& half) {
    const auto box = fineBoxMesh(half, 2);
    for (int i = 0; i < box->num_vertices; ++i) box->vertices[i] = askew() * box->vertices[i];
    return withTriangleTwice(*box);
  }

  ArticulatedCollisionManager manager_;
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> objects_;
};

/// Triangles of the deepest pair are tried before other pairs' hulls.
TEST(CrossingLinks, TheDeepestAreTriedBeforeOthersHulls) {
  const Plates plates(8, 0.05, true);
  const auto gjkOf = [&](ContactMode mode) {
    const CertifiedResult result = plates.run(mode);
    EXPECT_EQ(result.status, Status::contact);
    EXPECT_TRUE(result.certain);
    return result.statistics.gjk;
  };
  EXPECT_GT(gjkOf(ContactMode::first), 20u);  // many pairs of plates are left to their hulls
  EXPECT_LE(gjkOf(ContactMode::any), 12u);
}

/// Thousands of pairs that are deep in each other's line swept spheres are put in order at once. (By insertion, looking
/// each up among all, a query of 400 plates took minutes.)
TEST(CrossingLinks, ManyDeepOnesAreCheap) {
  const Plates plates(120, 0.01, false);
  const auto secondsOf = [&](ContactMode mode) {
    const auto begin = std::chrono::steady_clock::now();
    const CertifiedResult result = plates.run(mode);
    EXPECT_TRUE(result.isFree());
    EXPECT_GT(result.statistics.pairs_after_culling, 1000u);
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  };
  const double first = secondsOf(ContactMode::first), any = secondsOf(ContactMode::any);
  std::printf("first contact %g s, any %g s\n", first, any);
  EXPECT_LT(any, 30 * first);
}

/// A body that begins as its own copy shares all faces, edges and vertices with it, and none of these can be proven to
/// touch. Right after the start both cross, along a line. That is found without dividing time down to the finest.
TEST(CrossingLinks, ACopyAtTheStartIsCheapAndCertain) {
  auto ball = std::make_shared<Mesh>();
  fcl::generateBVHModel(*ball, fcl::Sphered(0.2), Isometry3d::Identity(), 24, 24);
  // Off by less than rounding lets tell, and somewhat more.
  for (const double off : {0.0, 1e-15, 1e-12}) {
    Isometry3d at = Isometry3d::Identity();
    at.translation().z() = off;
    const CertifiedResult r = CrossingLinks(ball, ball, at).run(0, 0.1, ContactMode::first);
    ASSERT_EQ(r.status, Status::contact);
    EXPECT_TRUE(r.certain);
    EXPECT_EQ(r.t_lower, 0);
    std::printf("%g m: contact until %g, %d leaves, %d calls of GJK\n", off, r.t_upper,
                static_cast<int>(r.statistics.leaf_tests), static_cast<int>(r.statistics.gjk));
    EXPECT_LT(r.statistics.gjk, 5000u);
  }
}

}  // namespace crossing_links_test
