// SPDX-License-Identifier: BSD-3-Clause
//
// Claims of answers at the edges of the arithmetic: tolerances below the finest split of time, budgets that end early,
// transforms that are rigid only to rounding.
#include <cfenv>

#include <fcl/geometry/shape/sphere.h>
#include <gtest/gtest.h>

#include "cases.h"
#include "fcl_artic/fcl_artic.h"

namespace fcl_artic {
namespace numerics_test {
namespace promise_test {
namespace {

/// A sphere of radius 0.1 that slides along x, or turns about z at a distance of 1, past or into others of its kind.
struct Mover {
  std::shared_ptr<KinematicTree> tree = std::make_shared<KinematicTree>("mover");
  std::shared_ptr<fcl::Sphered> ball = std::make_shared<fcl::Sphered>(0.1);
  fcl::CollisionObjectd moving{ball};
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> obstacles;
  std::unique_ptr<ArticulatedCollisionManager> manager;
  CertifiedResult result;

  Mover(JointType type, const std::vector<Eigen::Vector3d>& at) {
    tree->addLink("base");
    tree->addLink("link");
    Joint joint;
    joint.name = "joint";
    joint.type = type;
    const bool slides = type == JointType::prismatic;
    joint.axis = slides ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitZ();
    joint.parent = "base";
    joint.child = "link";
    tree->addJoint(joint);
    manager = std::make_unique<ArticulatedCollisionManager>(tree);
    manager->bind("link", &moving, Eigen::Isometry3d(Eigen::Translation3d(slides ? 0 : 1, 0, 0)));
    for (const Eigen::Vector3d& x : at) {
      obstacles.push_back(std::make_unique<fcl::CollisionObjectd>(ball, Eigen::Isometry3d(Eigen::Translation3d(x))));
      manager->registerObject(obstacles.back().get());
    }
    manager->setup();
  }
  void move(double to, const CertifiedRequest& request) {
    const JointMotion motion = JointMotion::linear(*tree, Eigen::VectorXd::Zero(1), Eigen::VectorXd::Constant(1, to));
    manager->continuousCollide(motion, request, result);
  }
};

/// Contact at x = 0.5 exactly, of balls of 0.1 and 0.1 with one of them at x = 0.7.
TEST(Promise, ToleranceBelowTheFinestSplitStillEnds) {
  Mover mover(JointType::prismatic, {{0.7, 0, 0}});
  CertifiedRequest request;
  request.tolerance_time = 1e-30;
  request.tolerance_distance = 1e-30;
  for (const int mode : kRoundingModes) {
    const ScopedRounding scope(mode);
    mover.move(1, request);
    EXPECT_EQ(mover.result.status, Status::contact);
    EXPECT_LE(mover.result.t_lower, 0.5);
    EXPECT_GT(mover.result.t_lower, 0.5 - 1e-12);
  }
}

TEST(Promise, BracketHoldsTheContactInEveryRoundingMode) {
  Mover mover(JointType::prismatic, {{0.7, 0, 0}});
  for (const int mode : kRoundingModes) {
    const ScopedRounding scope(mode);
    mover.move(1, CertifiedRequest());
    EXPECT_TRUE(mover.result.certain);
    EXPECT_LE(mover.result.t_lower, 0.5);
    EXPECT_GE(mover.result.t_upper, 0.5);
    EXPECT_LE(mover.result.t_upper - mover.result.t_lower, 1e-6);
  }
}

TEST(Promise, BudgetThatEndsEarlyClaimsNothingOfPairsLeftOut) {
  // Obstacles are met from the far end of the motion on: the first contact, at t = 0.2, is looked for last.
  Mover mover(JointType::prismatic, {{-0.9, 0, 0}, {-0.7, 0.1999, 0}, {-0.4, 0, 0}});
  CertifiedRequest request;
  request.mode = ContactMode::firstOfEveryPair;
  int undecided = 0;
  for (std::uint64_t budget = 1; budget < 400; ++budget) {
    request.work_budget = budget;
    mover.move(-1, request);
    EXPECT_NE(mover.result.status, Status::free) << budget;
    EXPECT_LE(mover.result.t_lower, 0.2 + 1e-15) << budget;
    undecided += mover.result.status == Status::undecided;
  }
  EXPECT_GT(undecided, 0);
}

TEST(Promise, BudgetThatEndsAmongInitialContactsIsNotFree) {
  // In contact at 0, apart soon, and in contact again after almost a whole turn.
  Mover mover(JointType::revolute, {{1, 0.15, 0}});
  CertifiedRequest request;
  request.ignore_initial_contact = true;
  for (std::uint64_t budget = 1; budget < 100; ++budget) {
    request.work_budget = budget;
    mover.move(-6.2, request);
    EXPECT_NE(mover.result.status, Status::free) << budget;
  }
  request.work_budget = 0;
  mover.move(-6.2, request);
  EXPECT_EQ(mover.result.status, Status::contact);
  EXPECT_GT(mover.result.t_lower, 0.9);
  EXPECT_EQ(mover.result.ignored_initial_contacts.size(), 1u);
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
  std::printf("farthest from a rotation: %.2f of 2^-52 (pads allow for %g)\n", worst * 0x1p52, Rotation::kUlps);
  EXPECT_LE(worst, Rotation::kUlps * 0x1p-52);
}

}  // namespace
}  // namespace promise_test
}  // namespace numerics_test
}  // namespace fcl_artic
