// SPDX-License-Identifier: BSD-3-Clause
//
// Two carts cross: how much earlier or later one of them may be can be written down.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include <fcl/math/motion/translation_motion.h>
#include <fcl/narrowphase/continuous_collision_object.h>

#include "one_turn.h"

namespace fcl_artic {
namespace tube_test {
namespace {

/// A ball on a slide goes along z through (1, 0, 0), from -1 to 1. Another one goes along x through the same point, as
/// fast, and is `late` ahead. Their middles come as near as |late| / sqrt(2).
struct Crossing {
  OneTurn cart{JointType::prismatic};
  std::shared_ptr<fcl::ContinuousCollisionObjectd> other;
  explicit Crossing(double late) {
    const auto at = [&](double x) { return Eigen::Isometry3d(Eigen::Translation3d(1 + late + x, 0, 0)); };
    other = std::make_shared<fcl::ContinuousCollisionObjectd>(std::make_shared<fcl::Sphered>(kRadius),
                                                              std::make_shared<fcl::TranslationMotiond>(at(-1), at(1)));
    cart.manager->registerObject(other, "other");
  }
  CertifiedResult run(double duration, int pieces) {
    cart.manager->setup();
    CertifiedResult result;
    if (pieces == 0) {
      cart.manager->continuousCollide(
          JointMotion::linear(*cart.tree, VectorXd::Constant(1, -1), VectorXd::Constant(1, 1)), {}, result);
      return result;
    }
    std::vector<double> times;
    std::vector<VectorXd> waypoints;
    for (int k = 0; k <= pieces; ++k) {
      times.push_back(3 + duration * k / pieces);
      waypoints.push_back(VectorXd::Constant(1, 2.0 * k / pieces - 1));
    }
    cart.manager->continuousCollide(JointTrajectory::linear(*cart.tree, times, waypoints), {}, result);
    return result;
  }
};

TEST(Time, EarlierOrLaterThanAnObstacle) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> late(0.3, 0.8), tolerance(0, 0.3), log_duration(-2, 2);
  int free = 0, contact = 0, between = 0;
  for (int n = 0; n < 300; ++n) {
    const double by = (n % 2 ? 1 : -1) * late(random), part = tolerance(random);
    const int pieces = n % 4;
    const double duration = pieces ? std::exp(log_duration(random)) : 1;
    Crossing crossing(by);
    crossing.cart.manager->setTimeTolerance(part * duration);
    const CertifiedResult result = crossing.run(duration, pieces);
    ASSERT_NE(result.status, Status::undecided);
    // In that time the other one goes on by 2 * part.
    const double truly = (std::abs(by) - 2 * part) / std::sqrt(2.0) - 2 * kRadius;
    const double without_direction = std::abs(by) / std::sqrt(2.0) - 2 * part - 2 * kRadius;
    if (result.isFree()) EXPECT_GT(truly, 0) << n;
    if (without_direction > 1e-5) EXPECT_TRUE(result.isFree()) << n;
    if (without_direction < -1e-5) EXPECT_FALSE(result.isFree()) << n;
    (without_direction > 0 ? free : truly > 0 ? between : contact) += 1;
  }
  EXPECT_GT(free, 50);
  EXPECT_GT(contact, 50);
  EXPECT_GT(between, 10);
}

TEST(Time, IsForgottenStatedAndRefused) {
  Crossing crossing(0.5);
  EXPECT_TRUE(crossing.run(2, 2).isFree());
  EXPECT_THROW(crossing.cart.manager->setTimeTolerance(-1), std::invalid_argument);
  EXPECT_THROW(crossing.cart.manager->setTimeTolerance(std::nan("")), std::invalid_argument);
  EXPECT_TRUE(crossing.run(2, 2).isFree()) << "nothing has changed";
  crossing.cart.manager->setTimeTolerance(0.2);
  EXPECT_FALSE(crossing.run(1, 1).isFree());
  EXPECT_EQ(crossing.cart.manager->describeTolerances(), "0.2 units of time");
  CertifiedRequest certificate;
  certificate.certificate = true;
  CertifiedResult result;
  const JointMotion motion = JointMotion::linear(*crossing.cart.tree, VectorXd::Constant(1, -1), VectorXd::Zero(1));
  EXPECT_THROW(crossing.cart.manager->continuousCollide(motion, certificate, result), std::invalid_argument);
  // Obstacles that stand still are never late.
  crossing.cart.manager->unregisterObject(crossing.other.get());
  crossing.cart.manager->setup();
  EXPECT_NO_THROW(crossing.cart.manager->continuousCollide(motion, certificate, result));
  const Eigen::Isometry3d away(Eigen::Translation3d(9, 0, 0));
  const auto stands = std::make_shared<fcl::ContinuousCollisionObjectd>(
      std::make_shared<fcl::Sphered>(kRadius), std::make_shared<fcl::TranslationMotiond>(away, away));
  crossing.cart.manager->registerObject(stands, "stands");
  crossing.cart.manager->setup();
  EXPECT_NO_THROW(crossing.cart.manager->continuousCollide(motion, certificate, result));
  crossing.cart.manager->unregisterObject(stands.get());
  crossing.cart.manager->registerObject(crossing.other, "other");
  crossing.cart.manager->resetTolerances();
  EXPECT_TRUE(crossing.run(1, 1).isFree());
}

/// No factor makes obstacles less late: as with objects that move by themselves.
TEST(Time, CountsInFullWhateverTheFactorOnTolerances) {
  for (const bool late : {false, true}) {
    Crossing crossing(0.5);
    crossing.cart.manager->setJointTolerances({0, 1e-3});
    crossing.cart.manager->setTimeTolerance(late ? 0.4 : 0.01);
    crossing.cart.manager->setup();
    const ToleranceLeft left = crossing.cart.manager->toleranceLeft(
        JointMotion::linear(*crossing.cart.tree, VectorXd::Constant(1, -1), VectorXd::Constant(1, 1)), {});
    EXPECT_TRUE(left.within_accuracy);
    if (late) {
      EXPECT_EQ(left.upper, 0) << "the motion itself is not free";
    } else {
      EXPECT_GT(left.lower, 1);
    }
  }
}

/// Where times underflow, an obstacle is late all the same. It leaves the cart's way, and is there if it has not left.
TEST(Time, OfAnySizeCounts) {
  const auto at = [](double x) { return Eigen::Isometry3d(Eigen::Translation3d(x, 0, 0)); };
  for (const double duration : {5e-324, 1e-310, 1e-300, 1.0, 1e300}) {
    OneTurn cart(JointType::prismatic);
    const auto other = std::make_shared<fcl::ContinuousCollisionObjectd>(
        std::make_shared<fcl::Sphered>(kRadius), std::make_shared<fcl::TranslationMotiond>(at(1), at(1.3)));
    cart.manager->registerObject(other, "other");
    const auto pass = [&] {
      cart.manager->setup();
      CertifiedResult result;
      const std::vector<VectorXd> way = {VectorXd::Constant(1, -1), VectorXd::Constant(1, 1)};
      cart.manager->continuousCollide(JointTrajectory::linear(*cart.tree, {0, duration}, way), {}, result);
      return result;
    };
    EXPECT_TRUE(pass().isFree()) << duration;
    cart.manager->setTimeTolerance(duration);
    EXPECT_FALSE(pass().isFree()) << duration;
    // Where nobody is late, times are none of the tolerances' business.
    cart.manager->setTimeTolerance(0);
    cart.manager->setJointTolerances({0, 1e-3});
    EXPECT_TRUE(pass().isFree()) << duration;
  }
}

/// An object with a speed has moved for longer if the robot is late, whether it has a motion or not.
TEST(Time, ObjectsWithASpeedHaveLongerToMove) {
  for (const bool moving : {true, false}) {
    OneTurn cart(JointType::prismatic);
    const auto body = std::make_shared<fcl::Sphered>(kRadius);
    const Eigen::Isometry3d at = pose({1.7, 0, 0}), there = pose({1.7, 1e-6, 0});
    if (moving) {
      cart.manager->registerObject(
          std::make_shared<fcl::ContinuousCollisionObjectd>(body, std::make_shared<fcl::TranslationMotiond>(at, there)),
          "person");
    } else {
      cart.manager->registerObject(object(body, at), "person");
    }
    cart.manager->setObjectSpeed("person", {1, 0});
    for (const double time : {0.0, 0.05, 0.2}) {  // at 0.63 both are 0.74 apart, and the person has come 0.63 nearer
      cart.manager->setTimeTolerance(time);
      EXPECT_EQ(cart.turn(-1, 1).isFree(), time < 0.1) << time << " " << moving;
    }
    CertifiedRequest certificate;
    certificate.certificate = true;
    EXPECT_THROW(ask(*cart.manager, VectorXd::Constant(1, -1), VectorXd::Zero(1), certificate), std::invalid_argument);
  }
}

}  // namespace
}  // namespace tube_test
}  // namespace fcl_artic
