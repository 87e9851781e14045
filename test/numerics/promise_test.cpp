// SPDX-License-Identifier: BSD-3-Clause
//
// What the answers may claim at the edges of the arithmetic: tolerances below the finest split of time, budgets that end
// early, transforms that are rigid only to rounding.
#include <cfenv>

#include <fcl/geometry/shape/sphere.h>
#include <gtest/gtest.h>

#include "cases.h"
#include "fcl_artic/fcl_artic.h"

namespace fcl_artic {
namespace numerics_test {
namespace {

/// A sphere of radius 0.1 that slides from x = 0 to 1, past or into obstacles of radius 0.1.
struct Slider {
  std::shared_ptr<KinematicTree> tree = std::make_shared<KinematicTree>("slider");
  std::shared_ptr<fcl::Sphered> ball = std::make_shared<fcl::Sphered>(0.1);
  fcl::CollisionObjectd moving{ball};
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> obstacles;
  std::unique_ptr<ArticulatedCollisionManager> manager;
  CertifiedResult result;

  explicit Slider(const std::vector<Eigen::Vector3d>& at) {
    tree->addLink("base");
    tree->addLink("link");
    Joint joint;
    joint.name = "slide";
    joint.type = JointType::prismatic;
    joint.parent = "base";
    joint.child = "link";
    tree->addJoint(joint);
    manager = std::make_unique<ArticulatedCollisionManager>(tree);
    manager->bind("link", &moving);
    for (const Eigen::Vector3d& x : at) {
      obstacles.push_back(std::make_unique<fcl::CollisionObjectd>(ball, Eigen::Isometry3d(Eigen::Translation3d(x))));
      manager->registerObject(obstacles.back().get());
    }
    manager->setup();
  }
  void slide(const CertifiedRequest& request) {
    manager->continuousCollide(JointMotion::linear(*tree, Eigen::VectorXd::Zero(1), Eigen::VectorXd::Ones(1)), request,
                               result);
  }
};

/// Contact at x = 0.5 exactly, of balls of 0.1 and 0.1 with one of them at x = 0.7.
TEST(Promise, ToleranceBelowTheFinestSplitStillEnds) {
  Slider slider({{0.7, 0, 0}});
  CertifiedRequest request;
  request.tolerance_time = 1e-30;
  request.tolerance_distance = 1e-30;
  for (const int mode : kRoundingModes) {
    const ScopedRounding scope(mode);
    slider.slide(request);
    EXPECT_EQ(slider.result.status, Status::contact);
    EXPECT_LE(slider.result.t_lower, 0.5);
    EXPECT_GT(slider.result.t_lower, 0.5 - 1e-12);
  }
}

TEST(Promise, BracketHoldsTheContactInEveryRoundingMode) {
  Slider slider({{0.7, 0, 0}});
  for (const int mode : kRoundingModes) {
    const ScopedRounding scope(mode);
    slider.slide(CertifiedRequest());
    EXPECT_TRUE(slider.result.certain);
    EXPECT_LE(slider.result.t_lower, 0.5);
    EXPECT_GE(slider.result.t_upper, 0.5);
    EXPECT_LE(slider.result.t_upper - slider.result.t_lower, 1e-6);
  }
}

TEST(Promise, BudgetThatEndsEarlyClaimsNothingOfPairsLeftOut) {
  // Both near misses and the hit cost work; the hit at 0.2 is the last pair.
  Slider slider({{0.7, 0.2001, 0}, {0.6, 0.2001, 0}, {0.4, 0, 0}});
  CertifiedRequest request;
  request.mode = ContactMode::firstOfEveryPair;
  int undecided = 0;
  for (std::uint64_t budget = 1; budget < 200; ++budget) {
    request.work_budget = budget;
    slider.slide(request);
    EXPECT_NE(slider.result.status, Status::free) << budget;
    EXPECT_LE(slider.result.t_lower, 0.2) << budget;
    undecided += slider.result.status == Status::undecided;
  }
  EXPECT_GT(undecided, 0);
}

TEST(Promise, BudgetThatEndsAmongInitialContactsIsNotFree) {
  // In contact at 0, free from 0.1 on, and a second obstacle that is hit at 0.5.
  Slider slider({{-0.1, 0, 0}, {0.7, 0, 0}});
  CertifiedRequest request;
  request.ignore_initial_contact = true;
  for (std::uint64_t budget = 1; budget < 100; ++budget) {
    request.work_budget = budget;
    slider.slide(request);
    EXPECT_NE(slider.result.status, Status::free) << budget;
    EXPECT_LE(slider.result.t_lower, 0.5) << budget;
  }
  request.work_budget = 0;
  slider.slide(request);
  EXPECT_EQ(slider.result.status, Status::contact);
  EXPECT_EQ(slider.result.ignored_initial_contacts.size(), 1u);
}

TEST(Promise, JointOriginsAreMadeOrthonormal) {
  Random random(seedOf("Orthonormal"));
  double worst = 0;
  for (int i = 0; i < 300; ++i) {
    const ScopedRounding scope(kRoundingModes[i % 4]);
    KinematicTree tree;
    tree.addLink("base");
    tree.addLink("link");
    Joint joint;
    joint.name = "fixed";
    joint.parent = "base";
    joint.child = "link";
    joint.origin.linear() = random.rotation() * (1 + random.in(-4e-10, 4e-10));
    tree.addJoint(joint);
    const Eigen::Isometry3d& M = tree.joint(0).origin;
    const RealRigid exact = properly(M);
    Real distance;  // Frobenius, to some proper rotation: at least that to the nearest one
    for (std::size_t j = 0; j < 3; ++j) {
      const Real3 e = exactly(M.linear().col(static_cast<int>(j))) - exact.R[j];
      distance += dot(e, e);
    }
    worst = std::max(worst, sqrt(distance).toDouble());
  }
  std::printf("farthest from a rotation: %.2f of 2^-52 (pads allow for %g)\n", worst * 0x1p52, kStoredUlps);
  EXPECT_LE(worst, kStoredUlps * 0x1p-52);
}

}  // namespace
}  // namespace numerics_test
}  // namespace fcl_artic
