// SPDX-License-Identifier: BSD-3-Clause
// Whole queries with the stage off and on: the same bits.
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <thread>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/halfspace.h>

#include <gtest/gtest.h>

#include "recorder.h"
#include "with_and_without.h"
#ifdef FCL_ARTIC_HAS_OFFSCREEN
#include "fcl_artic/visibility/offscreen.h"
#endif

namespace query_test {

namespace {

using fcl_artic::CertifiedResult;
using fcl_artic::VisibilityMode;

/// FCL_ARTIC_VISIBILITY_QUERIES=20000 in the environment makes it a campaign.
std::uint64_t queries() {
  return campaign::fromEnvironment("FCL_ARTIC_VISIBILITY_QUERIES", 320);
}

/// Asks `n` of the campaign's questions without the stage and with it.
campaign::Tally compare(std::uint64_t n, const std::shared_ptr<const fcl_artic::VisibilityCuller>& culler) {
  campaign::Options o;
  o.cases = n;
  o.seed = 7;
  o.threads = 1;
  const campaign::Tally all = runWithoutFaults(campaignOf(fcl_artic::test::withAndWithoutStage(culler)), o).total;
  EXPECT_GT(all["culled"], n / 20);
  return all;
}

TEST(VisibilityQueries, SameAnswersWithCpu) {
  const campaign::Tally all = compare(queries(), nullptr);
  EXPECT_GT(all["repeated"], queries() / 100);
}

#ifdef FCL_ARTIC_HAS_OFFSCREEN
TEST(VisibilityQueries, SameAnswersWithOsmesaAndEgl) {
  using fcl_artic::OffscreenBackend;
  for (const auto backend : {OffscreenBackend::osmesa, OffscreenBackend::egl})
    compare(queries() / 2, fcl_artic::makeOffscreenCuller(backend));
}
#endif

/// Nothing checks what the stage proves of free motions: what it culls wrongly is missed, and the test above sees it.
TEST(VisibilityQueries, WrongCullsAreSeen) {
  campaign::Options o;
  o.cases = 320;
  o.seed = 7;
  o.threads = 1;
  o.folder.clear();
  const auto careless = fcl_artic::test::changedBy(nullptr, [](std::vector<std::uint8_t>& may) {
    for (std::size_t group = 0; group < may.size(); group += 2) may[group] = 0;
  });
  const std::uint64_t different =
      run(campaignOf(fcl_artic::test::withAndWithoutStage(careless)), o).total.faults("different");
  std::cout << "half of the groups culled wrongly: " << different << " of " << o.cases << " answers differ\n";
  EXPECT_GT(different, 5u);
}

/// A ball on a turning arm amid a wall of little balls: many pairs, each meeting for a short while.
class ArmAmidBalls : public testing::Test {
 protected:
  ArmAmidBalls() {
    auto tree = std::make_shared<fcl_artic::KinematicTree>("arm");
    tree->addLink("base");
    tree->addLink("arm");
    fcl_artic::Joint joint;
    joint.name = "turn";
    joint.type = fcl_artic::JointType::revolute;
    joint.parent = "base";
    joint.child = "arm";
    joint.axis = Eigen::Vector3d::UnitZ();
    tree->addJoint(joint);
    tree_ = tree;
    manager_ = std::make_unique<fcl_artic::ArticulatedCollisionManager>(tree_);
    arm_ = std::make_unique<fcl::CollisionObjectd>(std::make_shared<fcl::Boxd>(1, 0.1, 0.1));
    manager_->bind("arm", arm_.get(), Eigen::Isometry3d(Eigen::Translation3d(0.5, 0, 0)));
  }
  void add(const std::shared_ptr<fcl::CollisionGeometryd>& geometry, const Eigen::Vector3d& at) {
    objects_.push_back(std::make_unique<fcl::CollisionObjectd>(geometry, Eigen::Isometry3d(Eigen::Translation3d(at))));
    manager_->registerObject(objects_.back().get());
  }
  fcl_artic::JointMotion motion(double from, double to) const {
    return fcl_artic::JointMotion::linear(*tree_, Eigen::VectorXd::Constant(1, from), Eigen::VectorXd::Constant(1, to));
  }
  std::shared_ptr<const fcl_artic::KinematicTree> tree_;
  std::unique_ptr<fcl_artic::ArticulatedCollisionManager> manager_;
  std::unique_ptr<fcl::CollisionObjectd> arm_;
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> objects_;
  fcl_artic::CertifiedRequest request_;
  fcl_artic::CertifiedResult result_;
};

TEST_F(ArmAmidBalls, LinkInsideASolidIsFound) {
  add(std::make_shared<fcl::Boxd>(10, 10, 10), {1, 2, 3});
  manager_->setup();
  request_.visibility = VisibilityMode::on;
  manager_->continuousCollide(motion(0, 0.5), request_, result_);
  EXPECT_EQ(result_.status, fcl_artic::Status::contact);
  EXPECT_EQ(result_.t_lower, 0);
  EXPECT_EQ(result_.statistics.visibility.pairs, 1u);
  EXPECT_EQ(result_.statistics.visibility.culled, 0u);
}

TEST_F(ArmAmidBalls, UnboundedObstacleStays) {
  add(std::make_shared<fcl::Halfspaced>(Eigen::Vector3d::UnitX(), -5), Eigen::Vector3d::Zero());
  manager_->setup();
  request_.visibility = VisibilityMode::on;
  manager_->continuousCollide(motion(0, 0.5), request_, result_);
  EXPECT_EQ(result_.status, fcl_artic::Status::free);
  EXPECT_EQ(result_.statistics.visibility.culled, 0u);
}

/// Cubes of 0.1 m in one mesh.
std::shared_ptr<fcl::CollisionGeometryd> cubes(const std::vector<Eigen::Vector3d>& centers) {
  auto mesh = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
  mesh->beginModel();
  for (const Eigen::Vector3d& at : centers) {
    for (int face = 0; face < 6; ++face) {
      const int k = face / 2;
      const Eigen::Vector3d n = 0.05 * (face % 2 ? 1 : -1) * Eigen::Vector3d::Unit(k),
                            u = 0.05 * Eigen::Vector3d::Unit((k + 1) % 3),
                            v = 0.05 * Eigen::Vector3d::Unit((k + 2) % 3);
      mesh->addTriangle(at + n + u + v, at + n - u + v, at + n - u - v);
      mesh->addTriangle(at + n + u + v, at + n - u - v, at + n + u - v);
    }
  }
  mesh->endModel();
  return mesh;
}

Eigen::Vector3d around(double angle, double radius, double z) {
  return {radius * std::cos(angle), radius * std::sin(angle), z};
}

/// Slivers run past the arm at an angle: their boxes meet its line swept sphere, they do not. One more lies in the
/// sphere, and in the arm or not: the pair stays, the other nodes go, and the solver looks at what is left.
TEST_F(ArmAmidBalls, NodesOfAMeshAreCulled) {
  for (const double z : {0.06, 0.04}) {  // the arm reaches up to 0.05, its sphere to 0.07
    auto mesh = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
    mesh->beginModel();
    for (int i = 0; i < 100; ++i) {  // more than twice as long as the arm: a large body
      const Eigen::Vector3d at(0.03 * i - 1, 0.09, 0.09), along(0, 0.08, -0.08);
      mesh->addTriangle(at - along, at + along, at + Eigen::Vector3d(0.004, 0, 0));
    }
    mesh->addTriangle({0.5, 0, z}, {0.51, 0, z}, {0.5, 0.01, z});
    mesh->endModel();
    manager_->clear();
    manager_->bind("arm", arm_.get(), Eigen::Isometry3d(Eigen::Translation3d(0.5, 0, 0)));
    add(mesh, Eigen::Vector3d::Zero());
    manager_->setup();
    CertifiedResult off;
    request_.visibility = VisibilityMode::off;
    manager_->continuousCollide(motion(0, 0.01), request_, off);
    request_.visibility = VisibilityMode::on;
    manager_->continuousCollide(motion(0, 0.01), request_, result_);
    EXPECT_TRUE(fcl_artic::test::sameBits(off, result_));
    EXPECT_EQ(off.status, z > 0.05 ? fcl_artic::Status::free : fcl_artic::Status::contact);
    const auto& s = result_.statistics;
    EXPECT_EQ(s.visibility.culled, 0u);
    EXPECT_GT(s.visibility.nodes, 0u) << s.visibility.pairs << ' ' << s.visibility.pieces << ' '
                                      << s.pairs_after_culling;
    EXPECT_EQ(s.visibility.repeated, z > 0.05 ? 0u : 1u);
    if (z > 0.05) {
      EXPECT_LT(s.node_tests, off.statistics.node_tests);
    }
  }
}

/// Whatever the stage takes out of a query with contact, the contact reported is the one without it; two balls as two
/// pairs, two rows of cubes as nodes of one.
TEST_F(ArmAmidBalls, WrongCullsChangeNoContact) {
  constexpr int kAll = -1, kNone = 2;
  int lie = kNone;  // the group that is taken for free
  manager_->setVisibility(fcl_artic::test::changedBy(nullptr, [&lie](std::vector<std::uint8_t>& may) {
    for (std::size_t group = 0; group < may.size(); ++group) {
      if (lie == kAll || lie == static_cast<int>(group)) may[group] = 0;
    }
  }));
  for (const bool one_mesh : {false, true}) {
    manager_->clear();
    manager_->bind("arm", arm_.get(), Eigen::Isometry3d(Eigen::Translation3d(0.5, 0, 0)));
    const Eigen::Vector3d early = around(0.3, 0.9, 0.02), late = around(1.7, 0.9, 0.03);
    if (one_mesh) {
      std::vector<Eigen::Vector3d> rows;  // two rows outward from there, so that they make two groups
      for (const Eigen::Vector3d& at : {early, late}) {
        for (int i = 0; i < 8; ++i) rows.push_back((1 + i / 3.0) * at);
      }
      add(cubes(rows), Eigen::Vector3d::Zero());
    } else {
      add(std::make_shared<fcl::Sphered>(0.05), early);
      add(std::make_shared<fcl::Sphered>(0.05), late);
    }
    manager_->setup();
    request_.visibility = VisibilityMode::off;
    CertifiedResult off;
    manager_->continuousCollide(motion(0, 2), request_, off);
    ASSERT_EQ(off.status, fcl_artic::Status::contact);
    request_.visibility = VisibilityMode::on;
    for (lie = 0; lie <= kNone; ++lie) {
      manager_->continuousCollide(motion(0, 2), request_, result_);
      EXPECT_TRUE(fcl_artic::test::sameBits(off, result_)) << one_mesh << lie;
      EXPECT_EQ(result_.statistics.visibility_executor, "changed");
      if (lie == kNone) continue;
      EXPECT_EQ(result_.statistics.visibility.culled, one_mesh ? 0u : 1u);
      EXPECT_EQ(result_.statistics.visibility.repeated, 1u);
    }
    lie = kAll;
    manager_->continuousCollide(motion(0, 2), request_, result_);
    EXPECT_EQ(result_.status, fcl_artic::Status::free) << "what is free is the stage's own proof";
  }
}

/// A margin brings a ball near that is culled without.
TEST_F(ArmAmidBalls, MarginCounts) {
  add(std::make_shared<fcl::Sphered>(0.05), {0.6, 0.0, 0.2});
  manager_->setup();
  request_.visibility = VisibilityMode::on;
  request_.margin = 0.11;
  manager_->continuousCollide(motion(-0.5, 0.5), request_, result_);
  EXPECT_EQ(result_.status, fcl_artic::Status::contact);
  request_.margin = 0.05;
  manager_->continuousCollide(motion(-0.5, 0.5), request_, result_);
  EXPECT_EQ(result_.status, fcl_artic::Status::free);
}

TEST_F(ArmAmidBalls, FourThreadsGetTheSameAnswers) {
  for (int i = 0; i < 60; ++i)
    add(std::make_shared<fcl::Sphered>(0.04), {0.7 * std::cos(0.1 * i), 0.7 * std::sin(0.1 * i), 0.1});
  manager_->setup();
  std::vector<fcl_artic::JointMotion> motions;
  for (int i = 0; i < 64; ++i) motions.push_back(motion(0.05 * i, 0.05 * i + 0.4));
  std::vector<CertifiedResult> off, on;
  manager_->continuousCollide(motions, request_, off);
  request_.visibility = VisibilityMode::on;
#ifdef FCL_ARTIC_HAS_OFFSCREEN
  manager_->setVisibility(fcl_artic::makeOffscreenCuller(fcl_artic::OffscreenBackend::egl));
#endif
  manager_->continuousCollide(motions, request_, on, 4);
  std::uint64_t pairs = 0;
  for (std::size_t i = 0; i < motions.size(); ++i) {
    EXPECT_TRUE(fcl_artic::test::sameBits(off[i], on[i])) << i;
    pairs += on[i].statistics.visibility.pairs;
  }
  EXPECT_GT(pairs, 64u);
}

}  // namespace

}  // namespace query_test
