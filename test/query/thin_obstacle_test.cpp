// SPDX-License-Identifier: BSD-3-Clause
//
// Thin solids and meshes where any contact will do: a mesh is a surface, so what is wholly within it or passes through
// its openings does not touch it.
#include <cmath>
#include <cstdio>
#include <random>

#include <fcl/geometry/geometric_shape_to_BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>
#include <gtest/gtest.h>

#include "arms.h"
#include "meshes.h"

namespace thin_obstacle_test {

using namespace fcl_artic;
using namespace fcl_artic::test;
using Eigen::Isometry3d;
using Eigen::Vector3d;

namespace {

/// A tube of square section along z, half width 0.1, half length 0.2; closed at its ends or not.
std::shared_ptr<Mesh> tube(bool closed) {
  return boxMesh({0.1, 0.1, 0.2}, closed);
}

/// The tube on a slider along x, and an obstacle.
struct Scene {
  Cart cart;
  std::shared_ptr<fcl::CollisionObjectd> obstacle;

  Scene(const std::shared_ptr<Mesh>& link, const std::shared_ptr<fcl::CollisionGeometryd>& solid, const Isometry3d& at)
      : cart(link), obstacle(object(solid, at)) {
    cart.manager->registerObject(obstacle.get(), "solid");
    cart.manager->setup();
  }
  CertifiedResult run(double from, double to, ContactMode mode) const {
    CertifiedRequest request;
    request.mode = mode;
    return cart.run(from, to, request);
  }
};

Isometry3d turned(const Vector3d& at, const Vector3d& axis = Vector3d::UnitZ()) {
  Isometry3d M = Isometry3d::Identity();
  M.linear() = Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), axis).toRotationMatrix();
  M.translation() = at;
  return M;
}

}  // namespace

TEST(ThinObstacle, WithinAClosedMeshItTouchesNothing) {
  const Scene short_rod(tube(true), std::make_shared<fcl::Cylinderd>(0.005, 0.1), turned({0, 0, 0}));
  EXPECT_EQ(short_rod.run(-0.05, 0.05, ContactMode::any).status, Status::free);
  const Scene long_rod(tube(true), std::make_shared<fcl::Cylinderd>(0.005, 1.0), turned({0, 0, 0}));
  const CertifiedResult r = long_rod.run(-0.05, 0.05, ContactMode::any);
  ASSERT_EQ(r.status, Status::contact);
  EXPECT_TRUE(r.certain);
  ASSERT_EQ(r.contacts.size(), 1u);
  // Within both, as far as the tube's surface goes around it.
  const Vector3d& x = r.contacts[0].point;
  EXPECT_LE(std::max({std::abs(x.x()) - 0.1, std::abs(x.y()) - 0.1, std::abs(x.z()) - 0.2}), 0);
  EXPECT_NEAR(r.contacts[0].normal.norm(), 1, 1e-12);
}

TEST(ThinObstacle, ThroughAnOpeningItTouchesNothing) {
  for (const double length : {0.1, 1.0}) {
    const Scene open(tube(false), std::make_shared<fcl::Cylinderd>(0.005, length), turned({0, 0, 0}));
    EXPECT_EQ(open.run(-0.05, 0.05, ContactMode::any).status, Status::free);
    EXPECT_EQ(open.run(-0.2, 0.2, ContactMode::any).status, Status::contact);
  }
}

/// Rods, boards and capsules anywhere, through and beside the tube. Both modes give the same verdict. The proof of any
/// contact is a point of the solid and of the named triangle, or else a point within the closed tube.
TEST(ThinObstacle, AnyContactIsOneOfBothBodies) {
  std::mt19937 random(5);
  const auto in = [&](double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(random); };
  const auto direction = [&] { return Vector3d(in(-1, 1), in(-1, 1), in(-1, 1)).normalized(); };
  int contacts = 0, free = 0, within = 0;
  for (int i = 0; i < 3000; ++i) {
    std::shared_ptr<fcl::CollisionGeometryd> solid;
    const double r = in(0.001, 0.02), half = in(0.02, 0.5);
    if (i % 3 == 0) solid = std::make_shared<fcl::Cylinderd>(r, 2 * half);
    if (i % 3 == 1) solid = std::make_shared<fcl::Boxd>(2 * r, in(0.01, 0.5), 2 * half);
    if (i % 3 == 2) solid = std::make_shared<fcl::Capsuled>(r, 2 * half);
    const bool closed = i % 2 == 0;
    const Isometry3d M = turned({in(-0.3, 0.3), in(-0.3, 0.3), in(-0.3, 0.3)}, direction());
    const Scene scene(tube(closed), solid, M);
    const double from = in(-0.3, 0.3), to = in(-0.3, 0.3);
    const CertifiedResult any = scene.run(from, to, ContactMode::any);
    EXPECT_EQ(any.status, scene.run(from, to, ContactMode::first).status) << i;
    free += any.isFree();
    if (any.isFree() || !any.certain) continue;
    ++contacts;
    ASSERT_EQ(any.contacts.size(), 1u) << i;
    const CertifiedContact& contact = any.contacts[0];
    ASSERT_EQ(contact.body1.name, "cart");
    const Vector3d x = M.inverse() * contact.point;
    double outside = 0;  // of the solid
    if (i % 3 == 0) outside = std::max(std::hypot(x.x(), x.y()) - r, std::abs(x.z()) - half);
    if (i % 3 == 1) outside = (x.cwiseAbs() - 0.5 * static_cast<const fcl::Boxd&>(*solid).side).maxCoeff();
    if (i % 3 == 2) outside = (x - Vector3d(0, 0, std::clamp(x.z(), -half, half))).norm() - r;
    EXPECT_LT(outside, 1e-9) << i;
    // The named triangle lies in a wall of the tube, where it stands then: the point is at that wall too.
    const Vector3d y = contact.point - Vector3d(from + contact.t_upper * (to - from), 0, 0);
    EXPECT_LT(std::max({std::abs(y.x()) - 0.1, std::abs(y.y()) - 0.1, std::abs(y.z()) - 0.2}), 1e-9) << i;
    if (contact.b1 < 0) {
      EXPECT_TRUE(closed) << i;
      ++within;
      continue;
    }
    const int wall = contact.b1 / 2;
    const int axis = wall < 2 ? 1 : wall < 4 ? 0 : 2;
    EXPECT_LT(std::abs(std::abs(y[axis]) - (axis == 2 ? 0.2 : 0.1)), 1e-9) << i << " wall " << wall;
  }
  std::printf("%d contacts, %d of them by what the tube encloses, %d free\n", contacts, within, free);
  EXPECT_GT(contacts - within, 500);
  EXPECT_GT(within, 50);
  EXPECT_GT(free, 500);
}

/// A body well within a large mesh's hull is looked at piece by piece at once: its hull would be followed in vain. (Two
/// balls apart: where their hull's rounding reaches, it is still deep.)
TEST(ThinObstacle, WithinALargeMeshHullsAreNotFollowed) {
  auto shells = std::make_shared<Mesh>();
  shells->beginModel();
  for (const double side : {-1.0, 1.0}) {
    Mesh shell;
    fcl::generateBVHModel(shell, fcl::Sphered(0.5), turned({0, side, 0}), 40, 40);
    std::vector<Vector3d> v(shell.vertices, shell.vertices + shell.num_vertices);
    std::vector<fcl::Triangle> t(shell.tri_indices, shell.tri_indices + shell.num_tris);
    shells->addSubModel(v, t);
  }
  shells->endModel();
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-0.25, 0.25);
  std::uint64_t batches = 0;
  constexpr int kMotions = 50;
  for (int n = 0; n < kMotions; ++n) {
    const Scene scene(cubeMesh(0.05), shells, turned({place(random), place(random), place(random)}));
    const CertifiedResult r = scene.run(-0.25, 0.25, ContactMode::first);
    ASSERT_TRUE(r.isFree());
    batches += r.statistics.batches;
  }
  std::printf("batches: %.2f a motion\n", static_cast<double>(batches) / kMotions);
  EXPECT_LT(batches, 1.1 * kMotions);
}

/// A base that is a mesh rests on a table, and an arm slides over the table, or in it. All of it is tilted, so that
/// rounding leaves open whether the base touches.
class Press {
 public:
  /// @param height  of the arm's middle over the table.
  explicit Press(double height) : manager_(tree()) {
    auto round = std::make_shared<Mesh>();  // its hull has fewer corners, and is rounded for it
    fcl::generateBVHModel(*round, fcl::Cylinderd(0.1, 0.2), Isometry3d::Identity(), 200, 4);
    base_ = object(round, turned({0, 0, 0}));
    arm_ = object(fineBoxMesh({0.1, 0.1, 0.1}, 12), turned({0, 0, 0}));
    table_ = object(std::make_shared<fcl::Boxd>(4, 4, 1), tilt() * turned({0, 0, -0.5}));
    manager_.bind("base", base_.get(), tilt() * turned({0, 0, 0.1}));
    manager_.bind("arm", arm_.get(), tilt() * turned({1, 0, height}));
    manager_.registerObject(table_.get(), "table");
    manager_.disallow("base", "table");  // which no motion parts
    manager_.setup();
  }
  CertifiedResult slide(double way, ContactMode mode) const {
    CertifiedRequest request;
    request.mode = mode;
    return ask(manager_, Eigen::VectorXd::Zero(1), Eigen::VectorXd::Constant(1, way), request);
  }

 private:
  static Isometry3d tilt() { return Isometry3d(Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized())); }
  static std::shared_ptr<KinematicTree> tree() {
    auto tree = std::make_shared<KinematicTree>("press");
    tree->addLink("base");
    tree->addLink("arm");
    tree->addJoint(Joint::prismatic("slide", "base", "arm", tilt() * Vector3d::UnitX()));
    return tree;
  }

  ArticulatedCollisionManager manager_;
  std::shared_ptr<fcl::CollisionObjectd> base_, arm_, table_;
};

/// A base rests on a table in which a link is deep from the start on. The base ends the search at once; then not all
/// triangles of the link must be asked.
TEST(Resting, WhatIsDeepBesideItAtTheStartIsCheap) {
  const Press press(-0.02);
  for (const double way : {0.01, 0.1, 1.0}) {
    const CertifiedResult r = press.slide(way, ContactMode::first);
    ASSERT_EQ(r.status, Status::contact);
    EXPECT_EQ(r.t_lower, 0);
    std::printf("%g m: %d calls of GJK, %d leaves\n", way, static_cast<int>(r.statistics.gjk),
                static_cast<int>(r.statistics.leaf_tests));
    EXPECT_LT(r.statistics.gjk, 500u);
  }
}

/// Where any contact will do, a proof is not hunted for at all poses of what rests.
TEST(Resting, AnyContactOfWhatRestsIsCheap) {
  const CertifiedResult r = Press(0.3).slide(0.1, ContactMode::any);
  ASSERT_EQ(r.status, Status::contact);
  EXPECT_EQ(r.t_lower, 0);
  std::printf("%d leaves, %d calls of GJK, %d proofs\n", static_cast<int>(r.statistics.leaf_tests),
              static_cast<int>(r.statistics.gjk), static_cast<int>(r.statistics.contact_proofs));
  EXPECT_LT(r.statistics.gjk, 40u);
}

}  // namespace thin_obstacle_test
