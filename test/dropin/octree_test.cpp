// SPDX-License-Identifier: BSD-3-Clause
//
// Octrees that stand still. Only the cells near the other body's path are read, and only the work shows that, not the
// answers. Cells are named as FCL names them.
#include "fcl_artic/continuous_collision.h"

#include <cmath>
#include <functional>
#include <random>

#include <fcl/geometry/octree/octree.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/halfspace.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/math/motion/interp_motion.h>
#include <fcl/math/motion/translation_motion.h>
#include <gtest/gtest.h>

#include "fcl_artic/continuous_manager.h"

namespace octree_test {

namespace {

using fcl::Transform3d;
using fcl::Vector3d;
using fcl_artic::CertifiedPairResult;
using fcl_artic::CertifiedPairsResult;
using fcl_artic::CertifiedRequest;
using fcl_artic::Status;

Transform3d at(double x, double y, double z) {
  Transform3d M = Transform3d::Identity();
  M.translation() = Vector3d(x, y, z);
  return M;
}

std::shared_ptr<octomap::OcTree> mapOf(double resolution, const std::vector<Vector3d>& points) {
  auto map = std::make_shared<octomap::OcTree>(resolution);
  for (const Vector3d& p : points) map->updateNode(p[0], p[1], p[2], true);
  return map;
}

/// Whether FCL's id names a cell of the tree that holds the point, given in its frame.
testing::AssertionResult isCellAt(const fcl::OcTreed& tree, std::intptr_t id, const Vector3d& point) {
  fcl::AABBd box;
  bool found = false;  // ids may be negative
  // FCL finds the node by its id from the root's box on, as fcl::Contact's users do.
  using Node = fcl::OcTreed::OcTreeNode;
  const std::function<void(const Node*, const fcl::AABBd&)> visit = [&](const Node* node, const fcl::AABBd& bv) {
    if (node - tree.getRoot() == id) box = bv, found = true;
    if (!tree.nodeHasChildren(node)) return;
    for (unsigned i = 0; i < 8; ++i) {
      if (!tree.nodeChildExists(node, i)) continue;
      fcl::AABBd child;
      fcl::computeChildBV(bv, i, child);
      visit(tree.getNodeChild(node, i), child);
    }
  };
  visit(tree.getRoot(), tree.getRootBV());
  if (!found) return testing::AssertionFailure() << "no node has the id " << id;
  const Vector3d out = (box.center() - point).cwiseAbs() - 0.5 * (box.max_ - box.min_);
  if (out.maxCoeff() < 1e-5) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "the cell is " << out.maxCoeff() << " away";
}

// A wall of cells of 1/8 from x = 1 on; a ball of 1/4 that goes from x = 0 to x = 2 touches at x = 3/4, t = 3/8. The
// map holds a cell behind and one far to the side, so that the one met is not the first.
TEST(DropInOcTree, CellsAreNamedAsFclNamesThem) {
  const double h = 1.0 / 16;
  const auto map = mapOf(0.125, {{-3 + h, h, h}, {1 + h, h, h}, {h, 2 + h, h}});
  const auto tree = std::make_shared<fcl::OcTreed>(map);
  const auto ball = std::make_shared<fcl::Sphered>(0.25);
  const fcl::TranslationMotiond rest(at(5, 0, 0), at(5, 0, 0)), path(at(5, h, h), at(7, h, h));
  const fcl::TranslationMotiond comes(at(0, 0, 0), at(-2, 0, 0)), waits(at(0, h, h), at(0, h, h));
  CertifiedPairResult r;
  for (const bool tree_moves : {false, true}) {
    const fcl::MotionBased* of_tree = tree_moves ? &comes : &rest;
    const fcl::MotionBased* of_ball = tree_moves ? &waits : &path;
    for (const bool tree_first : {true, false}) {
      if (tree_first) {
        fcl_artic::continuousCollide(tree.get(), of_tree, ball.get(), of_ball, CertifiedRequest(), r);
      } else {
        fcl_artic::continuousCollide(ball.get(), of_ball, tree.get(), of_tree, CertifiedRequest(), r);
      }
      ASSERT_EQ(r.status, Status::contact);
      EXPECT_LE(r.t_lower, 0.375 + 1e-11);
      EXPECT_GE(r.t_upper, 0.375 - 1e-11);
      ASSERT_EQ(r.contacts.size(), 1u);
      const fcl_artic::CertifiedContact& c = r.contacts[0];
      EXPECT_TRUE(isCellAt(*tree, tree_first ? c.b1 : c.b2, Vector3d(1, h, h)));
      EXPECT_EQ(tree_first ? c.b2 : c.b1, -1);
    }
  }
}

// A room whose walls are cells: a ball that stays inside meets none, and none is looked at.
TEST(DropInOcTree, CellsFarFromThePathAreNotRead) {
  std::vector<Vector3d> walls;
  for (double x = -1.95; x < 2; x += 0.1) {
    for (double y = -1.95; y < 2; y += 0.1) {
      for (int k = 0; k < 3; ++k) {
        for (const double side : {-1.95, 1.95}) {
          Vector3d p;
          p[k] = side;
          p[(k + 1) % 3] = x;
          p[(k + 2) % 3] = y;
          walls.push_back(p);
        }
      }
    }
  }
  const fcl::OcTreed room(mapOf(0.1, walls));
  const fcl::Sphered ball(0.2);
  const fcl::TranslationMotiond rest(at(0, 0, 7), at(0, 0, 7)), path(at(-1.6, 0, 7), at(1.6, 0, 7));
  CertifiedPairResult r;
  EXPECT_EQ(fcl_artic::continuousCollide(&room, &rest, &ball, &path, CertifiedRequest(), r), Status::free);
  EXPECT_EQ(r.statistics.node_tests, 0u);
  EXPECT_TRUE(r.tf2_at_lower.isApprox(at(1.6, 0, 7)));
  // A margin reaches farther: walls begin at x = 1.9, so that with 0.15 the ball counts as touching from x = 1.55 on.
  CertifiedRequest request;
  request.margin = 0.15;
  ASSERT_EQ(fcl_artic::continuousCollide(&room, &rest, &ball, &path, request, r), Status::contact);
  EXPECT_EQ(r.t_lower, 0);  // and from -1.6 as well
  const fcl::TranslationMotiond half(at(0, 0, 7), at(1.6, 0, 7));
  ASSERT_EQ(fcl_artic::continuousCollide(&room, &rest, &ball, &half, request, r), Status::contact);
  EXPECT_NEAR(r.t_lower, 1.55 / 1.6, 1e-5);
  request.margin = 0.05;
  request.added_margin = 0.1;
  ASSERT_EQ(fcl_artic::continuousCollide(&room, &rest, &ball, &half, request, r), Status::contact);
  EXPECT_NEAR(r.t_lower, 1.55 / 1.6, 1e-5);
  // An unbounded body comes everywhere.
  const fcl::Halfspaced floor(Vector3d::UnitX(), -1.95);
  EXPECT_EQ(fcl_artic::continuousCollide(&room, &rest, &floor, &rest, CertifiedRequest(), r), Status::contact);
}

// The continuous manager reads whole octrees: a hundred random maps, turned, and boxes that turn and go through them
// give the same verdicts and times.
TEST(DropInOcTree, AnswersAreThoseOfAllCells) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> u(-1, 1);
  const auto pose = [&](double size) {
    Transform3d M = Transform3d::Identity();
    M.linear() = Eigen::Quaterniond(u(random), u(random), u(random), u(random)).normalized().toRotationMatrix();
    M.translation() = size * Vector3d(u(random), u(random), u(random));
    return M;
  };
  int hits = 0;
  for (int i = 0; i < 100; ++i) {
    std::vector<Vector3d> points;
    for (int k = 0; k < 60; ++k) points.push_back(2 * Vector3d(u(random), u(random), u(random)));
    const auto map = std::make_shared<fcl::OcTreed>(mapOf(0.1, points));
    const auto box = std::make_shared<fcl::Boxd>(0.6, 0.4, 0.2);
    const Transform3d M = pose(30), begin = M * pose(1.5), end = M * pose(1.5);
    const auto rest = std::make_shared<fcl::TranslationMotiond>(M, M);
    const auto path = std::make_shared<fcl::InterpMotion<double>>(begin.linear(), begin.translation(), end.linear(),
                                                                  end.translation(), Vector3d(0, 0, 0));
    fcl::ContinuousCollisionObjectd a(map, rest), b(box, path);
    CertifiedRequest request;
    request.margin = i % 2 ? 0 : 0.02;
    CertifiedPairResult r;
    fcl_artic::collide(&a, &b, request, r);
    fcl_artic::ContinuousCollisionManager manager;
    manager.registerObject(&a);
    manager.registerObject(&b);
    manager.setup();
    CertifiedPairsResult all;
    manager.continuousCollide(request, all);
    ASSERT_EQ(r.status, all.status) << i;
    EXPECT_NEAR(r.t_lower, all.t_lower, 2e-6) << i;
    if (r.isFree()) continue;
    ++hits;
    ASSERT_EQ(r.contacts.size(), 1u);
    if (!r.contacts[0].certain || request.margin > 0 || r.t_lower == 0) continue;
    EXPECT_TRUE(isCellAt(*map, r.contacts[0].b1, M.inverse() * r.contacts[0].point)) << i;
  }
  EXPECT_GT(hits, 30);
  EXPECT_LT(hits, 95);
}

}  // namespace

}  // namespace octree_test
