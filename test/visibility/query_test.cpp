// SPDX-License-Identifier: BSD-3-Clause
// Whole queries with the stage off, on and automatic: the same bits.
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <thread>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/halfspace.h>

#include <gtest/gtest.h>

#include "visibility/cpu_executor.h"
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

fcl_artic::VisibilityOptions optionsOf(fcl_artic::VisibilityRule rule, int resolution) {
  fcl_artic::VisibilityOptions options;
  options.rule = rule;
  options.resolution = resolution;
  return options;
}
const auto kIntervals = fcl_artic::VisibilityRule::intervals, kOcclusion = fcl_artic::VisibilityRule::occlusion;

TEST(VisibilityQueries, SameAnswersWithCpu) {
  const campaign::Tally all = compare(queries(), nullptr);
  EXPECT_GT(all["nodes"], queries() / 20);
  EXPECT_GT(all["repeated"], queries() / 100);
}

TEST(VisibilityQueries, SameAnswersWithTheOcclusionRule) {
  compare(queries() / 4, std::make_shared<fcl_artic::VisibilityCuller>(optionsOf(kOcclusion, 16)));
}

#ifdef FCL_ARTIC_HAS_OFFSCREEN
TEST(VisibilityQueries, SameAnswersWithOsmesaAndEgl) {
  using fcl_artic::OffscreenBackend;
  for (const auto backend : {OffscreenBackend::osmesa, OffscreenBackend::egl}) {
    for (const auto rule : {kIntervals, kOcclusion})
      compare(queries() / 8, fcl_artic::makeOffscreenCuller(backend, optionsOf(rule, 32)));
  }
}
#endif

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

/// A mesh of cubes all around the arm's way, one object: stage 1 goes into it and leaves nothing to stage 2 until a
/// cube is in the way.
TEST_F(ArmAmidBalls, MeshAllAroundIsLeftOutUntilOneOfItsCubesIsInTheWay) {
  std::vector<Eigen::Vector3d> centers;
  for (int i = 0; i < 40; ++i) {
    centers.push_back(around(0.16 * i, 1.3, 0));
    centers.push_back(around(0.16 * i, 0.7, i % 2 ? 0.3 : -0.3));
  }
  request_.visibility = VisibilityMode::on;
  add(cubes(centers), Eigen::Vector3d::Zero());
  manager_->setup();
  manager_->continuousCollide(motion(0, 0.8), request_, result_);
  EXPECT_EQ(result_.status, fcl_artic::Status::free);
  EXPECT_EQ(result_.statistics.pairs_after_culling, 0u);
  EXPECT_EQ(result_.statistics.visibility.pairs, 0u);
  centers.push_back(around(0.4, 0.7, 0));
  add(cubes(centers), Eigen::Vector3d::Zero());
  manager_->setup();
  manager_->continuousCollide(motion(0, 0.8), request_, result_);
  EXPECT_EQ(result_.status, fcl_artic::Status::contact);
  EXPECT_EQ(result_.statistics.visibility.pairs, 1u);
  EXPECT_EQ(result_.statistics.visibility.culled, 0u);
}

/// Some of its cubes lie in the line swept sphere around the arm and beside the arm: the pair stays, most nodes go, and
/// the solver looks at those left. Verdicts of both kinds are those without the stage, to the last bit.
TEST_F(ArmAmidBalls, NodesOfAMeshAreCulled) {
  std::vector<Eigen::Vector3d> centers;
  for (int i = 0; i < 60; ++i) centers.push_back(around(0.1 * i, 0.4 + 0.02 * (i % 13), 0.095 + 0.01 * (i % 7)));
  add(cubes(centers), Eigen::Vector3d::Zero());
  manager_->setup();
  std::uint64_t contacts = 0, nodes = 0, less = 0, different = 0;
  CertifiedResult off;
  for (int i = 0; i < 300; ++i) {
    const double from = 0.02 * i;
    request_.visibility = VisibilityMode::off;
    manager_->continuousCollide(motion(from, from + 0.1), request_, off);
    for (const VisibilityMode mode : {VisibilityMode::on, VisibilityMode::automatic}) {
      request_.visibility = mode;
      manager_->continuousCollide(motion(from, from + 0.1), request_, result_);
      different += !fcl_artic::test::sameBits(off, result_);
      if (mode != VisibilityMode::on || result_.statistics.visibility.culled) continue;
      const bool contact = off.status == fcl_artic::Status::contact;
      contacts += contact;
      ASSERT_EQ(result_.statistics.visibility.repeated, contact && result_.statistics.visibility.nodes) << i;
      if (contact) continue;
      nodes += result_.statistics.visibility.nodes;
      ASSERT_LE(result_.statistics.node_tests, off.statistics.node_tests) << i;
      less += result_.statistics.node_tests < off.statistics.node_tests;
    }
  }
  std::cout << contacts << " contacts, " << nodes << " nodes, less work in " << less << "\n";
  EXPECT_EQ(different, 0u);
  EXPECT_GT(contacts, 20u);
  EXPECT_GT(nodes, 300u);
  EXPECT_GT(less, 20u);
}

/// A query that its caller ends while the stage takes part is not begun again without it.
TEST_F(ArmAmidBalls, EndedIsEnded) {
  std::vector<Eigen::Vector3d> centers;
  for (int i = 0; i < 3000; ++i) centers.push_back(around(0.002 * i, 0.4 + 0.02 * (i % 13), 0.095 + 0.01 * (i % 7)));
  add(cubes(centers), Eigen::Vector3d::Zero());
  manager_->setup();
  request_.visibility = VisibilityMode::on;
  request_.ignore_initial_contact = true;  // takes long enough to be ended midway
  int repeated = 0;
  for (int i = 0; i < 60; ++i) {
    int told = 0;
    request_.progress = [&](double) { return ++told > 0; };
    manager_->continuousCollide(motion(0.1 * i, 0.1 * i + 0.7), request_, result_);
    if (!result_.statistics.visibility.repeated || told < 2) continue;
    ++repeated;
    told = 0;
    request_.progress = [&](double) { return ++told > 1; };
    manager_->continuousCollide(motion(0.1 * i, 0.1 * i + 0.7), request_, result_);
    EXPECT_EQ(result_.status, fcl_artic::Status::undecided);
    EXPECT_EQ(told, 1) << "asked again after it had said no";
    EXPECT_EQ(result_.statistics.visibility.repeated, 0u);
  }
  std::cout << repeated << " queries that were ended\n";
  EXPECT_GT(repeated, 0);
}

/// The executor cpu, but that it takes one group of a query, or all of them, for free.
struct Liar : fcl_artic::visibility::Executor {
  explicit Liar(const int& group) : lie(group) {}
  void run(const fcl_artic::visibility::Batch& batch, std::vector<std::uint8_t>& may) override {
    cpu.run(batch, may);
    for (std::size_t i = 0; i < may.size(); ++i) {
      if (lie == batch.objects[i].group || lie == kAll) may[i] = 0;
    }
  }
  static constexpr int kNone = -1, kAll = -2;
  const int& lie;
  fcl_artic::visibility::CpuExecutor cpu;
};

/// Whatever the stage takes out of a query with contact, the contact reported is the one without it; two balls as two
/// pairs, two rows of cubes as nodes of one.
TEST_F(ArmAmidBalls, WrongCullsChangeNoContact) {
  int lie = Liar::kNone;
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
    lie = Liar::kNone;
    manager_->setVisibility(std::make_shared<fcl_artic::VisibilityCuller>(
        fcl_artic::VisibilityOptions(), "liar", [&lie] { return std::make_unique<Liar>(lie); }));
    request_.visibility = VisibilityMode::off;
    CertifiedResult off;
    manager_->continuousCollide(motion(0, 2), request_, off);
    ASSERT_EQ(off.status, fcl_artic::Status::contact);
    request_.visibility = VisibilityMode::on;
    manager_->continuousCollide(motion(0, 2), request_, result_);  // made while it tells the truth
    EXPECT_TRUE(fcl_artic::test::sameBits(off, result_));
    EXPECT_EQ(result_.statistics.visibility_executor, "liar");
    for (lie = 0; lie < 2; ++lie) {
      manager_->continuousCollide(motion(0, 2), request_, result_);
      EXPECT_TRUE(fcl_artic::test::sameBits(off, result_)) << one_mesh << lie;
      EXPECT_EQ(result_.statistics.visibility.culled, one_mesh ? 0u : 1u);
      EXPECT_EQ(result_.statistics.visibility.repeated, 1u);
    }
    lie = Liar::kAll;
    manager_->continuousCollide(motion(0, 2), request_, result_);
    EXPECT_EQ(result_.status, fcl_artic::Status::free) << "what is free is the stage's own proof";
  }
}

/// What fits into a budget must not depend on the stage.
TEST_F(ArmAmidBalls, OffWithAWorkBudget) {
  for (int i = 0; i < 30; ++i) add(std::make_shared<fcl::Sphered>(0.05), around(0.05 * i, 0.7, 0.12));
  manager_->setup();
  request_.work_budget = 3;
  CertifiedResult off;
  manager_->continuousCollide(motion(0, 1.2), request_, off);
  ASSERT_EQ(off.status, fcl_artic::Status::undecided);
  request_.visibility = VisibilityMode::on;
  manager_->continuousCollide(motion(0, 1.2), request_, result_);
  EXPECT_TRUE(fcl_artic::test::sameBits(off, result_));
  EXPECT_EQ(result_.statistics.visibility.pairs, 0u);
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

/// Trials happen, take their 1 %, and change no answer.
TEST_F(ArmAmidBalls, AutomaticTriesWithinItsShare) {
  for (int i = 0; i < 200; ++i) {
    const double a = 0.7 + 0.8 * std::fmod(0.618 * i, 1), r = 0.2 + 0.8 * std::fmod(0.755 * i, 1);
    add(std::make_shared<fcl::Sphered>(0.03), {r * std::cos(a), r * std::sin(a), 0.1 * std::fmod(0.57 * i, 1) + 0.07});
  }
  manager_->setup();
  std::uint64_t trials = 0, different = 0;
  double all_us = 0, visibility_us = 0;
  CertifiedResult off;
  for (int i = 0; i < 40000 && all_us < 4e5; ++i) {
    const double from = 0.5 * std::fmod(0.618 * i, 1);
    request_.visibility = VisibilityMode::off;
    manager_->continuousCollide(motion(from, from + 0.5), request_, off);
    request_.visibility = VisibilityMode::automatic;
    request_.measure_times = true;
    manager_->continuousCollide(motion(from, from + 0.5), request_, result_);
    different += !fcl_artic::test::sameBits(off, result_);
    trials += result_.statistics.visibility.trials;
    all_us += result_.statistics.total_us;
    if (result_.statistics.visibility.trials) visibility_us += result_.statistics.visibility.us;
  }
  std::cout << trials << " trials in " << all_us << " us, the stage in them " << visibility_us << " us\n";
  EXPECT_EQ(different, 0u);
  EXPECT_GT(trials, 1u);
  EXPECT_LT(visibility_us, 0.02 * all_us + 20000);  // and a neighbour's interruption
  request_.work_budget = 1000000;                   // what fits in would depend on the clock
  for (int i = 0; i < 100; ++i) {
    manager_->continuousCollide(motion(0, 0.5), request_, result_);
    EXPECT_EQ(result_.statistics.visibility.pairs, 0u);
  }
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
