// SPDX-License-Identifier: BSD-3-Clause
//
// mend() refuses the caller's mistakes before it looks for anything. (Mended plans: test/plans.)
#include "fcl_artic/ompl/mend.h"

#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <stdexcept>
#include <vector>

#include <fcl/geometry/shape/sphere.h>

#include "../urdf/temp_folder.h"
#include "slide.h"

namespace fcl_artic::planning {
namespace mend_test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// A slide with a turn on it.
class MendTest : public testing::Test {
 protected:
  MendTest() {
    auto tree = std::make_shared<KinematicTree>("crane");
    for (const char* link : {"rail", "cart", "arm"}) tree->addLink(link);
    tree->addJoint(makeJoint("slide", JointType::prismatic, "rail", "cart", Eigen::Vector3d::UnitX(), -10, 10));
    tree->addJoint(makeJoint("turn", JointType::revolute, "cart", "arm", Eigen::Vector3d::UnitZ(), -3, 3));
    World world(tree);
    const auto ball = std::make_shared<fcl::Sphered>(0.1);
    manager_ = world.bind("arm", ball, at(1, 0)).obstacle(ball, at(0, 9)).manager();
    objects_ = std::make_shared<World>(std::move(world));
  }
  std::string refusal(const std::vector<int>& variables, const MendOptions& options = {}) const {
    return messageOf<std::invalid_argument>(
        [&] { (void)mend(manager_, way_, variables, JointTrajectory::Unwrap::no, options); });
  }

  std::shared_ptr<const ArticulatedCollisionManager> manager_;
  std::shared_ptr<World> objects_;
  Waypoints way_{{0, 1}, {Eigen::Vector2d(0, 0), Eigen::Vector2d(1, 0.5)}, {}, {}};
};

TEST_F(MendTest, VariablesAreThoseOfTheTreeEachOnce) {
  EXPECT_EQ(mend(manager_, way_, {1, 0}, JointTrajectory::Unwrap::no).detours, 0u) << "nothing touches";
  expectContains(refusal({}), "`variables` is empty: no joint may move");
  expectContains(refusal({0, 2}), "`variables` holds 2; robot 'crane' has variables 0 to 1");
  expectContains(refusal({-1}), "`variables` holds -1; robot 'crane' has variables 0 to 1");
  expectContains(refusal({1, 1}), "`variables` holds 1 ('turn') twice");
}

TEST_F(MendTest, OtherVariablesStandStill) {
  expectContains(refusal({0}),
                 "'turn' (1) is not in `variables`, and waypoint 1 has it elsewhere than waypoint 0: add");
  way_.positions[1][1] = 0;
  EXPECT_EQ(mend(manager_, way_, {0}, JointTrajectory::Unwrap::no).detours, 0u);
}

TEST_F(MendTest, WhatIsNoWayAndNoOptionIsRefused) {
  MendOptions options;
  options.seconds = 0;
  expectContains(refusal({0, 1}, options), "options.seconds is 0, not a number above 0");
  options.seconds = kNaN;
  expectContains(refusal({0, 1}, options), "options.seconds is nan");
  options.seconds = 1;
  options.clearance = -0.001;
  expectContains(refusal({0, 1}, options), "options.clearance is -0.001, not a number of at least 0 (m)");
  way_.times = {0, 0};
  expectContains(refusal({0, 1}), "time");
  way_.times = {0, 1};
  way_.positions[1] = Eigen::VectorXd::Zero(3);
  expectContains(refusal({0, 1}), "3 entries");
  manager_ = nullptr;
  expectContains(refusal({0, 1}), "the manager is null");
}

/// A ball stands 0.05 m beside the way: within 0.1 rad, at 1 m, the arm may touch it.
TEST_F(MendTest, AMendedWayIsFreeWithinTheTolerances) {
  const auto ball = std::make_shared<fcl::Sphered>(0.1);
  way_.positions = {Eigen::Vector2d(0, 0), Eigen::Vector2d(4, 0)};
  for (const double angle : {0.0, 0.1}) {
    World world(manager_->sharedTree());
    world.bind("arm", ball, at(1, 0)).obstacle(ball, at(3, 0.25)).tolerance({angle, 0});
    const auto manager = world.manager();
    const Mended mended = mend(manager, way_, {0, 1}, JointTrajectory::Unwrap::no);
    EXPECT_EQ(mended.detours, angle == 0 ? 0u : 1u);
    for (std::size_t k = 1; k < mended.waypoints.positions.size(); ++k) {
      EXPECT_TRUE(manager->isFree(mended.waypoints.positions[k - 1], mended.waypoints.positions[k]));
    }
  }
}

}  // namespace
}  // namespace mend_test
}  // namespace fcl_artic::planning
