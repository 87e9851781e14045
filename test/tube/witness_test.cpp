// SPDX-License-Identifier: BSD-3-Clause
//
// Witnesses of contacts within the tolerances of base and objects, where these can be written down.
#include <cmath>

#include <gtest/gtest.h>

#include <fcl/geometry/shape/halfspace.h>
#include <fcl/math/motion/translation_motion.h>
#include <fcl/narrowphase/continuous_collision_object.h>

#include "one_turn.h"

namespace fcl_artic {
namespace tube_test {
namespace {

/// The angle of a deviation's rotation, rad.
double turnOf(const Eigen::Isometry3d& M) {
  return Eigen::AngleAxisd(M.linear()).angle();
}

/// Where the middle of a ball is at a witness, which stands at x without deviations.
Vector3d middleAt(const Vector3d& x, const Eigen::Isometry3d& before, const Eigen::Isometry3d& own) {
  return before * (x + own.translation());
}

TEST(Tube, AWitnessMovesTheBase) {
  // A ball at (1, 0, 0), another one at (1, 0.1, 0), and a wall beyond x = 1.09: gaps of 0.08.
  const double gap = 0.08;
  for (const bool wall : {false, true}) {
    OneTurn arm;
    const auto other = wall ? object(std::make_shared<fcl::Halfspaced>(-Vector3d::UnitX(), -1.09))
                            : ball(kRadius, Vector3d(1, 0.1, 0));
    arm.manager->registerObject(other, "other");
    // By a length, by an angle about the origin, and about a pivot far away, which stays where it is.
    for (const PoseTolerance& most :
         {PoseTolerance{1.01 * gap, 0, Vector3d::Zero()}, PoseTolerance{0, 1.05 * gap, Vector3d::Zero()},
          PoseTolerance{0, 1.05 * gap / 9, Vector3d(-8, 0, 0)}, PoseTolerance{0, 1.05 * gap / 2, Vector3d(1, 0, 2)},
          PoseTolerance{0.6 * gap, 0.45 * gap / 2, Vector3d(1, 0, 2)}}) {
      arm.manager->setBaseTolerance(most);
      const CertifiedResult result = arm.turn(0, 0);
      // A turn about the z axis moves a ball on the x axis along y alone.
      const bool may = !wall || most.pivot.z() > 0 || most.length > 0;
      ASSERT_EQ(result.status, Status::contact);
      ASSERT_EQ(result.certain, may) << most.angle;
      if (!may) continue;
      const CertifiedContact& contact = result.contacts.at(0);
      EXPECT_EQ(contact.q_witness[0], 0);
      const Eigen::Isometry3d& T = contact.base_deviation;
      EXPECT_LE(turnOf(T), most.angle);
      const double shift = (T * most.pivot - most.pivot).norm();
      EXPECT_LE(shift, most.length > 0 ? most.length : 1e-14);
      EXPECT_TRUE(contact.deviation1.matrix().isIdentity(0) && contact.deviation2.matrix().isIdentity(0));
      const Vector3d tip = middleAt(Vector3d::UnitX(), T, Eigen::Isometry3d::Identity());
      EXPECT_LE(wall ? 1.09 - tip.x() : (tip - Vector3d(1, 0.1, 0)).norm(), (wall ? 1 : 2) * kRadius + kRounding);
      EXPECT_LE((contact.point - tip).norm(), gap + 2 * kRadius);
    }
  }
}

TEST(Tube, AWitnessMovesTheBaseBeforeWhatMoves) {
  // The other ball comes from (1, 0.3, 0) to (1, 0.1, 0).
  OneTurn arm;
  const auto motion =
      std::make_shared<fcl::TranslationMotiond>(pose(Vector3d(1, 0.3, 0), 0.4), pose(Vector3d(1, 0.1, 0), 0.4));
  arm.manager->registerObject(
      std::make_shared<fcl::ContinuousCollisionObjectd>(std::make_shared<fcl::Sphered>(kRadius), motion), "ball");
  for (const PoseTolerance& most :
       {PoseTolerance{0.13, 0, Vector3d::Zero()}, PoseTolerance{0, 0.13, Vector3d::Zero()}}) {
    arm.manager->setBaseTolerance(most);
    const CertifiedResult result = arm.turn(0, 0);
    ASSERT_TRUE(result.certain);
    const CertifiedContact& contact = result.contacts.at(0);
    EXPECT_LE(contact.base_deviation.translation().norm(), most.length);
    EXPECT_LE(turnOf(contact.base_deviation), most.angle);
    const Vector3d tip = contact.base_deviation * Vector3d::UnitX();
    EXPECT_LE((tip - Vector3d(1, 0.3 - 0.2 * contact.t_upper, 0)).norm(), 2 * kRadius + kRounding);
    EXPECT_NEAR(contact.t_upper, 0.75, 0.03);  // they are 0.15 apart; few later times are tried
  }
}

TEST(Tube, ToleranceOfAnySizeHasAWitnessOrNone) {
  OneTurn arm;
  arm.manager->registerObject(ball(kRadius, Vector3d(1, 0.1, 0)), "ball");
  const Vector3d far(0, 0, 1e300);
  int certain = 0;
  for (const PoseTolerance& most :
       {PoseTolerance{1e300, 0, Vector3d::Zero()}, PoseTolerance{0.1, 1e300, Vector3d::Zero()},
        PoseTolerance{0.1, 0.1, far}, PoseTolerance{0, 1e-300, far}, PoseTolerance{1e-300, 0, far}}) {
    for (const bool base : {false, true}) {
      arm.manager->setBaseTolerance(base ? most : PoseTolerance());
      arm.manager->setObjectTolerance("ball", base ? PoseTolerance() : most);
      const CertifiedResult result = arm.turn(0, 0);
      EXPECT_TRUE(result.isFree() || result.status == Status::contact);
      certain += result.certain;
      if (!result.certain) continue;
      const CertifiedContact& c = result.contacts.at(0);
      const Vector3d tip = c.base_deviation * Vector3d::UnitX(),
                     other = Vector3d(1, 0.1, 0) + c.deviation2.translation();
      EXPECT_LE((tip - other).norm(), 2 * kRadius + kRounding);
    }
  }
  EXPECT_GE(certain, 2);
}

TEST(Tube, AWitnessMovesObstacles) {
  // The obstacle's frame is turned: what it is off by is in its own frame, also while it moves.
  const double gap = 0.08;
  const Eigen::Isometry3d turned = pose(Vector3d::Zero(), 1.1, Vector3d(1, 2, 3));
  for (const bool moves : {false, true}) {
    OneTurn arm;
    Eigen::Isometry3d at = pose(Vector3d(1, 0.1, 0)) * turned, away = pose(Vector3d(1, 0.3, 0)) * turned;
    if (moves) {
      const auto motion = std::make_shared<fcl::TranslationMotiond>(away, at);
      arm.manager->registerObject(
          std::make_shared<fcl::ContinuousCollisionObjectd>(std::make_shared<fcl::Sphered>(kRadius), motion), "ball");
    } else {
      arm.manager->registerObject(object(std::make_shared<fcl::Sphered>(kRadius), at), "ball");
    }
    const Vector3d pivot = turned.linear().transpose() * Vector3d(1, 0, 0);
    for (const PoseTolerance& most :
         {PoseTolerance{1.01 * gap, 0, Vector3d::Zero()}, PoseTolerance{0, 1.05 * gap, pivot},
          PoseTolerance{0.5 * gap, 0.55 * gap, pivot}}) {
      arm.manager->setObjectTolerance("ball", most);
      const CertifiedResult result = arm.turn(0, 0);
      ASSERT_EQ(result.status, Status::contact);
      ASSERT_TRUE(result.certain) << moves << most.angle;
      const CertifiedContact& contact = result.contacts.at(0);
      EXPECT_EQ(contact.body2.name, "ball");
      const Eigen::Isometry3d& D = contact.deviation2;
      EXPECT_LE(turnOf(D), most.angle);
      EXPECT_LE((D * most.pivot - most.pivot).norm(), most.length > 0 ? most.length : 1e-14);
      EXPECT_TRUE(contact.base_deviation.matrix().isIdentity(0) && contact.deviation1.matrix().isIdentity(0));
      if (moves) at.translation().y() = 0.3 - 0.2 * contact.t_upper;
      EXPECT_LE(((at * D).translation() - Vector3d::UnitX()).norm(), 2 * kRadius + kRounding);
    }
    // A turn by all that it may be off misses the other ball: from the pivot, the box's corners are farther away.
    const double far = std::sqrt(std::pow(1 + kRadius, 2) + 2 * std::pow(kRadius, 2));
    arm.manager->setObjectTolerance("ball", {0, 1.001 * gap / far, pivot});
    const CertifiedResult near = arm.turn(0, 0);
    EXPECT_EQ(near.status, Status::contact);
    EXPECT_FALSE(near.certain);
  }
}

TEST(Tube, AWitnessMovesCarriedObjectsAndAllTogether) {
  // A link carries a ball beside its tip, at (1, 0, 0.5); an obstacle is 0.08 away from it.
  const double gap = 0.08;
  OneTurn arm;
  const auto carried = ball(kRadius), obstacle = ball(kRadius, Vector3d(1, gap + 2 * kRadius, 0.5));
  arm.manager->registerObject(carried, "carried");
  arm.manager->attach("arm", carried.get(), pose(Vector3d(1, 0, 0.5), 0.7, Vector3d::UnitX()));
  arm.manager->registerObject(obstacle.get(), "obstacle");
  ASSERT_TRUE(arm.turn(0, 0).isFree());
  const auto expectWitness = [&](const PoseTolerance& base, const PoseTolerance& own, const PoseTolerance& other,
                                 double joint) {
    arm.manager->setBaseTolerance(base);
    arm.manager->setObjectTolerance("carried", own);
    arm.manager->setObjectTolerance("obstacle", other);
    arm.manager->setJointTolerances({joint, 0});
    const CertifiedResult result = arm.turn(0, 0);
    ASSERT_TRUE(result.certain);
    const CertifiedContact& c = result.contacts.at(0);
    EXPECT_LE(c.base_deviation.translation().norm(), base.length);
    EXPECT_LE(c.deviation1.translation().norm(), own.length);
    EXPECT_LE(c.deviation2.translation().norm(), other.length);
    EXPECT_LE(std::abs(c.q_witness[0]), joint);
    const Eigen::Isometry3d M =
        pose(Vector3d::Zero(), c.q_witness[0]) * pose(Vector3d(1, 0, 0.5), 0.7, Vector3d::UnitX());
    const Vector3d first = (c.base_deviation * M * c.deviation1).translation();
    const Vector3d second = obstacle->getTranslation() + c.deviation2.translation();
    EXPECT_LE((first - second).norm(), 2 * kRadius + kRounding);
  };
  expectWitness({}, {1.01 * gap, 0, Vector3d::Zero()}, {}, 0);
  // No part of them would do: each is needed.
  const PoseTolerance part{0.26 * gap, 0, Vector3d::Zero()};
  expectWitness(part, part, part, 0.26 * gap);
}

}  // namespace
}  // namespace tube_test
}  // namespace fcl_artic
