// SPDX-License-Identifier: BSD-3-Clause
//
// Links that are meshes, where any contact will do: it is proven at a pose at which the bodies' bounds are deep in each
// other, and a mesh deep within another one touches nothing.
#include <array>
#include <cmath>
#include <cstdio>
#include <random>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/OBBRSS.h>
#include <gtest/gtest.h>

#include "fcl_artic/manager.h"

using namespace fcl_artic;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

using Mesh = fcl::BVHModel<fcl::OBBRSSd>;

/// The surface of a box whose sides are cut into n x n squares.
std::shared_ptr<Mesh> surface(const Vector3d& half, int n) {
  std::vector<Vector3d> v;
  std::vector<fcl::Triangle> t;
  for (int side = 0; side < 6; ++side) {
    const int x = side / 2, y = (x + 1) % 3, z = (x + 2) % 3;
    const std::size_t first = v.size(), row = static_cast<std::size_t>(n) + 1;
    for (int i = 0; i <= n; ++i) {
      for (int j = 0; j <= n; ++j) {
        Vector3d p;
        p[x] = side % 2 ? half[x] : -half[x];
        p[y] = half[y] * (2.0 * i / n - 1);
        p[z] = half[z] * (2.0 * j / n - 1);
        v.push_back(p);
      }
    }
    for (std::size_t i = 0; i + 1 < row; ++i) {
      for (std::size_t j = 0; j + 1 < row; ++j) {
        const std::size_t at = first + i * row + j;
        t.emplace_back(at, at + row, at + row + 1);
        t.emplace_back(at, at + row + 1, at + 1);
      }
    }
  }
  auto mesh = std::make_shared<Mesh>();
  mesh->beginModel();
  mesh->addSubModel(v, t);
  mesh->endModel();
  return mesh;
}

/// One mesh on the base, the other on two sliders along x.
struct Slider {
  std::shared_ptr<KinematicTree> tree = std::make_shared<KinematicTree>("slider");
  fcl::CollisionObjectd still, moving;
  ArticulatedCollisionManager manager;

  Slider(std::shared_ptr<Mesh> a, std::shared_ptr<Mesh> b, const Isometry3d& at)
      : still(std::move(a)), moving(std::move(b)), manager(withSlider()) {
    manager.bind("base", &still);
    manager.bind("cart", &moving, at);
    manager.setup();
  }
  std::shared_ptr<const KinematicTree> withSlider() {
    tree->addLink("base");
    tree->addLink("between");
    tree->addLink("cart");
    const std::array<const char*, 3> links = {"base", "between", "cart"};
    for (std::size_t i = 0; i < 2; ++i) {  // links with one joint between them are not checked
      Joint slide;
      slide.name = links[i + 1];
      slide.type = JointType::prismatic;
      slide.parent = links[i];
      slide.child = links[i + 1];
      tree->addJoint(slide);
    }
    return tree;
  }
  CertifiedResult run(double from, double to, ContactMode mode) const {
    CertifiedRequest request;
    request.mode = mode;
    CertifiedResult result;
    manager.continuousCollide(
        JointMotion::linear(*tree, VectorXd::Constant(2, 0.5 * from), VectorXd::Constant(2, 0.5 * to)), request,
        result);
    return result;
  }
};

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
    const auto a = surface(half, 1 + i % 5), b = surface(other, 1 + i % 4);
    const Slider slider(a, b, at);
    const double from = in(-reach, reach), to = in(-reach, reach);
    const CertifiedResult any = slider.run(from, to, ContactMode::any);
    ASSERT_EQ(any.status, slider.run(from, to, ContactMode::first).status) << i;
    free += any.isFree();
    free_within += any.isFree() && small;
    if (any.isFree() || !any.certain) continue;
    ASSERT_EQ(any.contacts.size(), 1u) << i;
    const CertifiedContact& contact = any.contacts[0];
    EXPECT_NEAR(contact.normal.norm(), 1, 1e-9) << i;
    if (contact.feature != FeatureKind::edgeFace && contact.feature != FeatureKind::faceEdge) continue;
    ++at_poses;
    const bool swapped = contact.body1.name != "base";
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
