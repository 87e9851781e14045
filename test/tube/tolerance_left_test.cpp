// SPDX-License-Identifier: BSD-3-Clause
//
// How many times the tolerances may be as large, where that can be written down.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include <fcl/geometry/shape/halfspace.h>

#include "../query/arms.h"

namespace fcl_artic {
namespace tolerance_left_test {
namespace {

using namespace fcl_artic::test;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kRadius = 0.01, kInfinity = std::numeric_limits<double>::infinity();

VectorXd one(double q) {
  return VectorXd::Constant(1, q);
}

testing::AssertionResult holds(const ToleranceLeft& left, double factor, double relative = 0.01) {
  if (left.lower <= factor * (1 + 1e-9) && left.upper >= factor * (1 - 1e-9) && left.within_accuracy &&
      left.upper - left.lower <= std::max(relative * left.upper, 1e-3)) {
    return testing::AssertionSuccess();
  }
  return testing::AssertionFailure() << "[" << left.lower << ", " << left.upper << "] instead of " << factor;
}

/// A ball on a slide along z, below the half-space z >= 1. The bound is exact here.
struct Lift {
  std::shared_ptr<KinematicTree> tree = std::make_shared<KinematicTree>("lift");
  std::shared_ptr<fcl::CollisionObjectd> tip = ball(kRadius),
                                         wall = object(std::make_shared<fcl::Halfspaced>(-Vector3d::UnitZ(), -1));
  std::unique_ptr<ArticulatedCollisionManager> manager;
  static constexpr double kGap = 0.125;  ///< at the motion's end

  Lift() {
    for (const char* link : {"base", "lift"}) tree->addLink(link);
    tree->addJoint(makeJoint("joint", JointType::prismatic, "base", "lift", Vector3d::UnitZ()));
    manager = std::make_unique<ArticulatedCollisionManager>(tree);
    manager->bind("lift", tip);
    manager->registerObject(wall.get(), "wall");
  }
  JointMotion motion() const { return JointMotion::linear(*tree, one(0), one(1 - kRadius - kGap)); }
  ToleranceLeft left(const ToleranceLeftRequest& request = {}) const {
    manager->setup();
    return manager->toleranceLeft(motion(), request);
  }
};

TEST(ToleranceLeft, OfASlideBeforeAHalfspace) {
  for (const double tolerance : {0.0125, 0.1, 0.125 / 3, 3.0}) {
    Lift lift;
    lift.manager->setJointTolerances({0, tolerance});
    const double factor = Lift::kGap / tolerance;
    const ToleranceLeft left = lift.left();
    EXPECT_TRUE(holds(left, factor)) << tolerance;
    ASSERT_TRUE(left.certain);
    EXPECT_EQ(left.body1.name, "lift");
    EXPECT_EQ(left.body2.name, "wall");
    // With the factor `upper` the tube first touches where the slide is that near.
    ASSERT_EQ(left.q_witness.size(), 1);
    const double q = left.time * (1 - kRadius - Lift::kGap);
    EXPECT_LE(left.q_witness[0] - q, left.upper * tolerance * (1 + 1e-12));
    EXPECT_GE(left.q_witness[0], 1 - kRadius - 1e-9);
    EXPECT_GT(left.statistics.pairs, 0u);
    // As near as is wanted, and the number that a check at the tolerances as they are would give.
    ToleranceLeftRequest fine;
    fine.accuracy_relative = 0;
    fine.accuracy_factor = 1e-5;
    const ToleranceLeft nearer = lift.left(fine);
    EXPECT_TRUE(holds(nearer, factor));
    EXPECT_LE(nearer.upper - nearer.lower, 1e-5);
    EXPECT_EQ(ask(*lift.manager, one(0), one(1 - kRadius - Lift::kGap)).isFree(), nearer.lower >= 1);
  }
}

TEST(ToleranceLeft, OfATurnBeforeABall) {
  auto tree = std::make_shared<KinematicTree>("arm");
  for (const char* link : {"base", "arm"}) tree->addLink(link);
  tree->addJoint(makeJoint("joint", JointType::revolute, "base", "arm", Vector3d::UnitZ()));
  ArticulatedCollisionManager manager(tree);
  const double at = 1.2, touch = at - 2 * std::asin(kRadius);
  const auto tip = ball(kRadius), obstacle = ball(kRadius, Vector3d(std::cos(at), std::sin(at), 0));
  manager.bind("arm", tip, pose(Vector3d::UnitX()));
  manager.registerObject(obstacle.get(), "ball");
  // From 0.1 rad before the contact. The bound takes the chord at the ball's farthest point; along the chord there is
  // the gap. So it lets through this much, and the robot really touches at 0.1 rad.
  const double gap = 2 * std::sin(0.5 * (at - (touch - 0.1))) - 2 * kRadius, bound = gap / (1 + kRadius);
  for (const double tolerance : {0.004, 0.4}) {
    manager.setJointTolerances({tolerance, 0});
    manager.setup();
    const ToleranceLeft left = manager.toleranceLeft(JointMotion::linear(*tree, one(0), one(touch - 0.1)));
    EXPECT_TRUE(left.within_accuracy);
    EXPECT_GE(left.lower * tolerance, 0.98 * bound);
    EXPECT_LE(left.lower * tolerance, 0.1 * (1 + 1e-9)) << "said free, and touches";
    EXPECT_LE(left.upper * tolerance, 0.1 * 1.02) << "beyond, there is a contact";
    EXPECT_EQ(left.certain, left.q_witness.size() == 1);
    if (left.certain) {
      EXPECT_GE(left.q_witness[0], touch - 1e-9);
    }
    EXPECT_GE(left.time, 0.9);
    EXPECT_EQ(left.body2.name, "ball");
  }
}

// An angle beyond which its chord grows no more: half a turn of the base, and of the joint, reach all that they can.
TEST(ToleranceLeft, HasNoEndWhereNoAngleTouches) {
  auto tree = std::make_shared<KinematicTree>("arm");
  for (const char* link : {"base", "arm"}) tree->addLink(link);
  tree->addJoint(makeJoint("joint", JointType::revolute, "base", "arm", Vector3d::UnitZ()));
  ArticulatedCollisionManager manager(tree);
  const auto tip = ball(kRadius), far = ball(kRadius, Vector3d(0, 6, 0));
  manager.bind("arm", tip, pose(Vector3d::UnitX()));
  manager.registerObject(far.get(), "far");
  manager.setJointTolerances({0.1, 0});
  manager.setBaseTolerance({0, 0.1, Vector3d::Zero()});
  manager.setup();
  ToleranceLeftRequest request;
  request.most = 1e6;
  const ToleranceLeft left = manager.toleranceLeft(JointMotion::still(*tree, one(0)), request);
  EXPECT_EQ(left.lower, 1e6);
  EXPECT_EQ(left.upper, kInfinity);
  EXPECT_TRUE(left.within_accuracy && left.body1.name.empty() && !left.certain);
}

TEST(ToleranceLeft, AllTolerancesGrowTogether) {
  Lift lift;
  ArticulatedCollisionManager& m = *lift.manager;
  m.setBaseTolerance({0.01, 0, Vector3d::Zero()});
  EXPECT_TRUE(holds(lift.left(), Lift::kGap / 0.01));
  m.setJointTolerances({0, 0.02});
  EXPECT_TRUE(holds(lift.left(), Lift::kGap / 0.03));
  // The base's angle, with a chord: the ball is 0.865 from the pivot at the end, and its farthest point 0.01 more.
  m.setBaseTolerance({0, 0.01, Vector3d::Zero()});
  EXPECT_TRUE(holds(lift.left(), Lift::kGap / (0.02 + 0.01 * (1 - Lift::kGap)), 0.02));
  m.resetTolerances();
  const auto post = ball(kRadius, Vector3d(0.1, 0, 0));
  m.unregisterObject(lift.wall.get());
  m.registerObject(post.get(), "post");
  m.setObjectTolerance("post", {0.004, 0, Vector3d::Zero()});
  EXPECT_TRUE(holds(lift.left(), (0.1 - 2 * kRadius) / 0.004));
  const double far = std::sqrt(3) * kRadius;  // of the corners of its box
  m.setObjectTolerance("post", {0.002, 0.1, Vector3d::Zero()});
  EXPECT_TRUE(holds(lift.left(), (0.1 - 2 * kRadius) / (0.002 + 0.1 * far), 0.02));
  EXPECT_FALSE(lift.left().certain) << "the deviation of objects is not tried";
}

TEST(ToleranceLeft, MarginsCount) {
  Lift lift;
  lift.manager->setJointTolerances({0, 0.01});
  ToleranceLeftRequest request;
  request.margin = 0.025;
  EXPECT_TRUE(holds(lift.left(request), (Lift::kGap - 0.025) / 0.01));
  lift.manager->setMargin("wall", 0.05);
  EXPECT_TRUE(holds(lift.left(request), (Lift::kGap - 0.05) / 0.01));
  request.added_margin = 0.025;
  EXPECT_TRUE(holds(lift.left(request), (Lift::kGap - 0.075) / 0.01));
}

TEST(ToleranceLeft, OfWhatTouchesByItselfIsNone) {
  Lift lift;
  lift.manager->setJointTolerances({0, 0.01});
  ToleranceLeftRequest request;
  request.margin = 2 * Lift::kGap;
  const ToleranceLeft left = lift.left(request);
  EXPECT_EQ(left.lower, 0);
  EXPECT_EQ(left.upper, 0);
  EXPECT_TRUE(left.certain && left.within_accuracy);
  EXPECT_NEAR(left.time, (1 - kRadius - 2 * Lift::kGap) / (1 - kRadius - Lift::kGap), 1e-5);
  EXPECT_EQ(left.body2.name, "wall");
  request.check_scene = false;
  EXPECT_EQ(lift.left(request).lower, request.most);
}

TEST(ToleranceLeft, InATrajectorysOwnTime) {
  Lift lift;
  lift.manager->setJointTolerances({0, 0.05});
  lift.manager->setup();
  // Nearest at time 5, where two pieces meet.
  const auto trajectory =
      JointTrajectory::linear(*lift.tree, {3, 5, 9}, {one(0), one(1 - kRadius - Lift::kGap), one(0.2)});
  const ToleranceLeft left = lift.manager->toleranceLeft(trajectory);
  EXPECT_TRUE(holds(left, Lift::kGap / 0.05));
  EXPECT_TRUE(left.certain);
  EXPECT_NEAR(left.time, 5, 0.02);
  // As the single motion says.
  EXPECT_TRUE(holds(lift.left(), Lift::kGap / 0.05));
}

/// Beyond the joint's limit of 1 the tip meets a ball on the base, at 1.1.
struct Stop {
  std::shared_ptr<KinematicTree> tree = std::make_shared<KinematicTree>("arm");
  std::shared_ptr<fcl::CollisionObjectd> tip = ball(kRadius), stop = ball(kRadius);
  std::unique_ptr<ArticulatedCollisionManager> manager;
  Stop() {
    for (const char* link : {"base", "arm"}) tree->addLink(link);
    tree->addJoint(Joint::revolute("joint", "base", "arm", Vector3d::UnitZ(), Eigen::Isometry3d::Identity(), 0, 1));
    manager = std::make_unique<ArticulatedCollisionManager>(tree);
    manager->bind("arm", tip, pose(Vector3d::UnitX()));
    manager->bind("base", stop, pose(Vector3d(std::cos(1.1), std::sin(1.1), 0)));
    AllowedCollisionMatrix checked;
    checked.disallow("base", "arm");
    manager->setAllowedCollisions(checked);
  }
  /// Of a motion to 0.7: the tip's ball is 0.4 - 2 asin(0.01) rad from touching.
  void expect() {
    const double touch = 0.4 - 2 * std::asin(kRadius), gap = 2 * std::sin(0.2) - 2 * kRadius;
    for (const double tolerance : {0.01, 0.05, 0.6}) {
      manager->setJointTolerances({tolerance, 0});
      manager->setup();
      const ToleranceLeft left = manager->toleranceLeft(JointMotion::linear(*tree, one(0), one(0.7)));
      EXPECT_TRUE(left.within_accuracy) << tolerance;
      EXPECT_GE(left.lower * tolerance, 0.98 * gap / (1 + kRadius)) << tolerance;
      EXPECT_LE(left.lower * tolerance, touch * (1 + 1e-9)) << tolerance << ": said free, and touches";
      EXPECT_TRUE(std::isfinite(left.upper)) << tolerance;
      EXPECT_EQ(std::minmax(left.body1.name, left.body2.name), std::minmax<std::string>("arm", "base"));
    }
  }
};

TEST(ToleranceLeft, TablesOfTwoLinksAreAskedForAllOfIt) {
  Stop arm;
  arm.expect();
}

TEST(ToleranceLeft, ProofsOfRangesAreAskedForAllOfIt) {
  Stop arm;
  arm.manager->setLinkPairProofs(arm.manager->classifyLinkPairs().proofs);
  arm.expect();
}

// Two links side by side. The bound is that of the wrist alone, by the lengths between both, before any table.
TEST(ToleranceLeft, OfTwoLinksByTheirLargestStray) {
  auto tree = std::make_shared<KinematicTree>("two");
  for (const char* link : {"base", "one", "two"}) tree->addLink(link);
  tree->addJoint(makeJoint("shoulder", JointType::revolute, "base", "one", Vector3d::UnitZ()));
  tree->addJoint(makeJoint("wrist", JointType::revolute, "one", "two", Vector3d::UnitZ(), pose(Vector3d(10, 0, 0))));
  ArticulatedCollisionManager manager(tree);
  const auto a = ball(0.1), b = ball(0.1);
  manager.bind("one", a, pose(Vector3d(10, 0.5, 0)));
  manager.bind("two", b, pose(Vector3d(0.5, 0, 0)));
  AllowedCollisionMatrix checked;
  checked.disallow("one", "two");
  manager.setAllowedCollisions(checked);
  const double gap = std::sqrt(0.5) - 0.2, touch = 0.5 * 3.14159265358979323846 - 2 * std::asin(0.1 / 0.5);
  for (const double tolerance : {0.02, 2.5}) {
    manager.setJointTolerances({tolerance, 0});
    manager.setup();
    const ToleranceLeft left = manager.toleranceLeft(JointMotion::still(*tree, VectorXd::Zero(2)));
    EXPECT_TRUE(left.within_accuracy);
    EXPECT_GE(left.lower * tolerance, 0.98 * gap / 0.6) << tolerance;
    EXPECT_LE(left.lower * tolerance, touch) << tolerance;
    EXPECT_LE(left.upper * tolerance, 1.02 * touch) << tolerance;
  }
}

TEST(ToleranceLeft, LeavesOutWhatAQueryIgnoresAtTheBegin) {
  Lift lift;
  const auto pad = ball(kRadius, Vector3d(0.03, 0, 0));  // 0.01 from the ball at the motion's begin
  lift.manager->registerObject(pad.get(), "pad");
  lift.manager->setObjectTolerance("pad", {0.02, 0, Vector3d::Zero()});
  lift.manager->setJointTolerances({0, 0.025});
  const ToleranceLeft all = lift.left();
  EXPECT_EQ(all.body2.name, "pad");
  EXPECT_LE(all.lower, 0.5 * (1 + 1e-9));
  ToleranceLeftRequest request;
  request.ignore_initial_contact = true;
  const ToleranceLeft rest = lift.left(request);
  EXPECT_TRUE(holds(rest, Lift::kGap / 0.025));
  ASSERT_EQ(rest.ignored_initial_contacts.size(), 1u);
  EXPECT_EQ(rest.ignored_initial_contacts[0].first.name, "pad");
  const auto trajectory =
      JointTrajectory::linear(*lift.tree, {3, 4, 6}, {one(0), one(0.3), one(1 - kRadius - Lift::kGap)});
  const ToleranceLeft of_trajectory = lift.manager->toleranceLeft(trajectory, request);
  EXPECT_TRUE(holds(of_trajectory, Lift::kGap / 0.025));
  EXPECT_EQ(of_trajectory.ignored_initial_contacts.size(), 1u);
}

TEST(ToleranceLeft, BudgetAndProgressEndItWithWhatIsProven) {
  Lift lift;
  lift.manager->setJointTolerances({0, 0.01});
  ToleranceLeftRequest request;
  for (request.work_budget = 1; request.work_budget < 60; ++request.work_budget) {
    const ToleranceLeft left = lift.left(request);
    EXPECT_LE(left.lower, Lift::kGap / 0.01 * (1 + 1e-9));
    EXPECT_GE(left.upper, Lift::kGap / 0.01 * (1 - 1e-9));
  }
  request.work_budget = 1;
  EXPECT_FALSE(lift.left(request).within_accuracy);
  request.work_budget = 0;
  double last = 0;
  request.progress = [&](double lower, double upper) {
    EXPECT_LE(lower, upper);
    EXPECT_GE(lower, last);
    last = lower;
    return false;
  };
  const ToleranceLeft ended = lift.left(request);
  EXPECT_LE(ended.lower, Lift::kGap / 0.01 * (1 + 1e-9));
}

TEST(ToleranceLeft, BadRequestsAreRefused) {
  Lift lift;
  lift.manager->setup();
  try {
    (void)lift.manager->toleranceLeft(lift.motion());
    ADD_FAILURE() << "no tolerance is set";
  } catch (const std::logic_error& error) {
    EXPECT_NE(std::string(error.what()).find("setJointTolerances()"), std::string::npos) << error.what();
  }
  lift.manager->setJointTolerances({0, 0.01});
  EXPECT_THROW((void)lift.manager->toleranceLeft(lift.motion()), std::logic_error) << "not set up";
  lift.manager->setup();
  const auto expectRefused = [&](const char* name, const auto& spoil) {
    ToleranceLeftRequest request;
    spoil(request);
    try {
      (void)lift.manager->toleranceLeft(lift.motion(), request);
      ADD_FAILURE() << name;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
    }
  };
  for (const double bad : {-1.0, 0.0, 1e7, std::nan(""), kInfinity}) {
    expectRefused("most", [&](auto& request) { request.most = bad; });
    if (bad != 1e7) expectRefused("accuracy_factor", [&](auto& request) { request.accuracy_factor = bad; });
    if (bad != 0) expectRefused("accuracy_relative", [&](auto& request) { request.accuracy_relative = bad; });
    if (bad != 1e7) expectRefused("tolerance_time", [&](auto& request) { request.tolerance_time = bad; });
    if (bad != 1e7 && bad != 0) expectRefused("margin", [&](auto& request) { request.margin = bad; });
  }
  const auto other = sliderTree({"a", "b", "c"});
  EXPECT_THROW((void)lift.manager->toleranceLeft(JointMotion::still(*other, VectorXd::Zero(2))), std::invalid_argument);
}

}  // namespace
}  // namespace tolerance_left_test
}  // namespace fcl_artic
