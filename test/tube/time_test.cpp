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

/// Judges by the balls' places at many times, each with the other ball earlier and later by up to `part` of its way.
/// Before its motion begins, and after it ends, it stands.
struct Places {
  double by, part;  ///< the crossing's, the tolerance of time
  double from, to;  ///< of the cart
  double gap(double t, double shift) const {
    const double s = std::max(0.0, std::min(1.0, t + shift));
    return std::hypot(by - 1 + 2 * s, from + t * (to - from)) - 2 * kRadius;
  }
  double leastAt(double t) const {
    double least = 1e300;
    for (int k = -40; k <= 40; ++k) least = std::min(least, gap(t, part * k / 40));
    return least;
  }
  double least() const {
    double least = 1e300;
    for (int k = 0; k <= 400; ++k) least = std::min(least, leastAt(k / 400.0));
    return least;
  }
  /// Without the directions in which the two go: as if the other one could be 2 * part nearer.
  double bound() const {
    double least = 1e300;
    for (int k = 0; k <= 4000; ++k) least = std::min(least, gap(k / 4000.0, 0) - 2 * part);
    return least;
  }
  JointMotion motion(const KinematicTree& tree) const {
    return JointMotion::linear(tree, VectorXd::Constant(1, from), VectorXd::Constant(1, to));
  }
  void judge(const CertifiedResult& r) const {
    ASSERT_NE(r.status, Status::undecided);
    if (r.isFree()) EXPECT_GT(least(), 0);
    if (bound() > 1e-3) EXPECT_TRUE(r.isFree());                        // between the samples it is no nearer than that
    if (r.certain) EXPECT_LT(leastAt(r.t_upper), 0.025 * part + 1e-9);  // a sample is so near
  }
};

Places drawPlaces(std::mt19937& random, bool stands) {
  std::uniform_real_distribution<double> late(-0.8, 0.8), tolerance(0, 0.3), z(-1, 1);
  Places p;
  p.by = late(random);
  p.part = tolerance(random);
  p.from = z(random);
  p.to = stands ? p.from : z(random);
  return p;
}

TEST(Time, CountsInBatches) {
  std::mt19937 random(7);
  int free = 0, contact = 0, by_time = 0;
  for (int n = 0; n < 20; ++n) {
    const Places first = drawPlaces(random, false);
    Crossing crossing(first.by);
    std::vector<Places> all;
    std::vector<JointMotion> motions;
    for (int k = 0; k < 12; ++k) {
      all.push_back(drawPlaces(random, k % 4 == 0));
      all.back().by = first.by;
      all.back().part = first.part;
      motions.push_back(all.back().motion(*crossing.cart.tree));
    }
    std::vector<CertifiedResult> punctual, results;
    crossing.cart.manager->setup();
    crossing.cart.manager->continuousCollide(motions, {}, punctual, 2);
    crossing.cart.manager->setTimeTolerance(first.part);
    crossing.cart.manager->setup();
    for (const int threads : {1, 2, 0}) {
      crossing.cart.manager->continuousCollide(motions, {}, results, threads);
      ASSERT_EQ(results.size(), motions.size());
      for (std::size_t k = 0; k < motions.size(); ++k) {
        all[k].judge(results[k]);
        const CertifiedResult one = crossing.cart.manager->continuousCollide(motions[k]);
        EXPECT_EQ(results[k].status, one.status) << n << " " << k;
        EXPECT_EQ(results[k].t_lower, one.t_lower) << n << " " << k;
        EXPECT_EQ(results[k].t_upper, one.t_upper) << n << " " << k;
        (results[k].isFree() ? free : contact) += 1;
        by_time += punctual[k].isFree() && !results[k].isFree();
      }
    }
  }
  EXPECT_GT(free, 100);
  EXPECT_GT(contact, 100);
  EXPECT_GT(by_time, 50);
}

TEST(Time, CountsInClearance) {
  std::mt19937 random(8);
  int apart = 0, by_time = 0;
  for (int n = 0; n < 60; ++n) {
    const Places p = drawPlaces(random, n % 5 == 0);
    Crossing crossing(p.by);
    const bool timed = n % 2;
    const double duration = timed ? 3 : 1;
    crossing.cart.manager->setTimeTolerance(p.part * duration);
    crossing.cart.manager->setup();
    const std::vector<VectorXd> ends = {VectorXd::Constant(1, p.from), VectorXd::Constant(1, p.to)};
    const Clearance c =
        timed ? crossing.cart.manager->clearance(JointTrajectory::linear(*crossing.cart.tree, {5, 8}, ends))
              : crossing.cart.manager->clearance(p.motion(*crossing.cart.tree));
    const double least = std::max(0.0, p.least()), bound = std::max(0.0, p.bound());
    EXPECT_LE(c.lower, least + 1e-12) << n;
    EXPECT_GE(c.lower, bound - std::max(0.01 * bound, 1e-4) - 1e-9) << n;
    const double t = timed ? (c.time - 5) / 3 : c.time;
    if (std::isfinite(c.upper)) EXPECT_LE(p.leastAt(t), c.upper + 0.025 * p.part + 1e-9) << n;
    apart += c.lower > 0;
    Places punctual = p;
    punctual.part = 0;
    by_time += c.lower > 0 && c.lower < 0.9 * punctual.least();
  }
  EXPECT_GT(apart, 20);
  EXPECT_GT(by_time, 10);
}

/// The cart stands, and the other one passes: early or late it goes the same way.
TEST(Time, CountsAtSingleConfigurations) {
  std::mt19937 random(9);
  int free = 0, contact = 0, cautious = 0;
  for (int n = 0; n < 120; ++n) {
    Places p = drawPlaces(random, true);
    if (n % 4 == 0) p.from = p.to = 0.05 * p.from;
    Crossing crossing(p.by);
    crossing.cart.manager->setTimeTolerance(p.part);
    crossing.cart.manager->setup();
    const VectorXd q = VectorXd::Constant(1, p.from);
    const CertifiedResult result = crossing.cart.manager->collide(q);
    p.judge(result);
    EXPECT_EQ(crossing.cart.manager->isFree(q, q), result.isFree()) << n;
    (result.isFree() ? free : p.least() <= 0 ? contact : cautious) += 1;
  }
  EXPECT_GT(free, 20);
  EXPECT_GT(contact, 5);
  EXPECT_GT(cautious, 10);
}

}  // namespace
}  // namespace tube_test
}  // namespace fcl_artic
