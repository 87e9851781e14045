// SPDX-License-Identifier: BSD-3-Clause
//
// Joints of pinocchio: the same forward kinematics, the same way between two configurations, errors that name.
#include <gtest/gtest.h>

#include <pinocchio/fwd.hpp>  // before boost's variant

#include <pinocchio/algorithm/joint-configuration.hpp>
#include <pinocchio/algorithm/kinematics.hpp>

#include "fcl_artic/pinocchio/pinocchio.h"
#include "random_robot.h"

namespace fcl_artic {
namespace joints_test {
namespace {

using pinocchio::JointIndex;
using pinocchio::SE3;
using test::Random;

SE3 randomPlacement(Random& random) {
  const Eigen::Isometry3d M = test::randomPose(random, 0.5);
  return {M.linear(), M.translation()};
}

/// Every joint of pinocchio's that this library has, one after the other and one mimic joint of each kind. Another
/// joint comes after each mimic: others pinocchio 3.7 may miscount (Model::check() is false).
pinocchio::Model everyJoint(bool on_groups) {
  using namespace pinocchio;
  Random random(7);
  Model model;
  JointIndex last = 0;
  const auto add = [&](const JointModel& joint, const std::string& name) {
    last = model.addJoint(last, joint, randomPlacement(random), name);
    return last;
  };
  const Eigen::Vector3d n = Eigen::Vector3d(1, -2, 0.5).normalized();
  const JointIndex rx = add(JointModelRX(), "rx");
  add(JointModelRY(), "ry");
  add(JointModelRZ(), "rz");
  add(JointModelRevoluteUnaligned(n), "ru");
  const JointIndex ux = add(JointModelRUBX(), "ux");
  add(JointModelRUBY(), "uy");
  add(JointModelRUBZ(), "uz");
  add(JointModelRevoluteUnboundedUnaligned(n), "uu");
  const JointIndex px = add(JointModelPX(), "px");
  add(JointModelPY(), "py");
  add(JointModelPZ(), "pz");
  add(JointModelPrismaticUnaligned(n), "pu");
  add(JointModelMimic(JointModelRevoluteUnaligned(n), model.joints[rx], -0.5, 0.3), "mimic_rx");
  add(JointModelTranslation(), "translation");
  add(JointModelSphericalZYX(), "zyx");
  add(JointModelMimic(JointModelRUBY(), model.joints[ux], 2, -0.1), "mimic_ux");
  add(JointModelUniversal(Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitX()), "universal");
  add(JointModelSpherical(), "spherical");
  add(JointModelMimic(JointModelPZ(), model.joints[px], 1.5, 0.2), "mimic_px");
  JointModelComposite inner(JointModelRUBZ(), randomPlacement(random));
  JointModelComposite composite(JointModelPY(), randomPlacement(random));
  composite.addJoint(JointModelSpherical(), randomPlacement(random));
  composite.addJoint(inner, randomPlacement(random));
  add(composite, "composite");
  if (on_groups) {
    add(JointModelPlanar(), "planar");
    add(JointModelFreeFlyer(), "free_flyer");
  }
  return model;
}

Eigen::VectorXd randomConfiguration(const pinocchio::Model& model) {
  return pinocchio::randomConfiguration(model, Eigen::VectorXd::Constant(model.nq, -2),
                                        Eigen::VectorXd::Constant(model.nq, 2));
}

/// The largest difference of any joint's pose.
double poseDifference(const pinocchio::Model& model, const PinocchioRobot& robot, const Eigen::VectorXd& q_pinocchio,
                      const Eigen::VectorXd& q) {
  pinocchio::Data data(model);
  pinocchio::forwardKinematics(model, data, q_pinocchio);
  double largest = 0;
  for (JointIndex j = 0; j < static_cast<JointIndex>(model.njoints); ++j) {
    const Eigen::Isometry3d M = robot.tree->linkPose(robot.link(j), q);
    largest = std::max(largest, (M.matrix() - data.oMi[j].toHomogeneousMatrix()).cwiseAbs().maxCoeff());
  }
  return largest;
}

TEST(PinocchioJoints, ForwardKinematicsIsTheSame) {
  const pinocchio::Model model = everyJoint(true);
  const PinocchioRobot robot = fromPinocchio(model, {});
  EXPECT_EQ(robot.tree->name(), "robot");
  for (int i = 0; i < 200; ++i) {
    const Eigen::VectorXd q = randomConfiguration(model), ours = robot.configuration(q);
    ASSERT_EQ(ours.size(), robot.tree->dof());
    ASSERT_LT(poseDifference(model, robot, q, ours), 1e-12) << i;
    ASSERT_LT((robot.toPinocchio(ours) - q).cwiseAbs().maxCoeff(), 1e-15) << i;
  }
}

TEST(PinocchioJoints, TheWayIsPinocchiosInterpolation) {
  const pinocchio::Model model = everyJoint(false);
  const PinocchioRobot robot = fromPinocchio(model, {});
  std::mt19937_64 random(1);
  for (int i = 0; i < 200; ++i) {
    const Eigen::VectorXd q0 = randomConfiguration(model), q1 = randomConfiguration(model);
    const JointMotion motion = robot.motion(q0, q1);
    const double u = std::uniform_real_distribution<double>(0, 1)(random);
    // The mimic of the unbounded joint turns with the shorter way: whole turns of its master are whole turns of it.
    ASSERT_LT(poseDifference(model, robot, pinocchio::interpolate(model, q0, q1, u), motion.configuration(u)), 1e-7)
        << i << ", u = " << u;
  }
}

TEST(PinocchioJoints, FreeFlyersAndPlanarJointsGoStraight) {
  pinocchio::Model model;
  const JointIndex planar = model.addJoint(0, pinocchio::JointModelPlanar(), SE3::Identity(), "planar");
  const JointIndex flyer = model.addJoint(0, pinocchio::JointModelFreeFlyer(), SE3::Identity(), "flyer");
  const PinocchioRobot robot = fromPinocchio(model, {});
  double leaves_screw = 0;
  for (int i = 0; i < 100; ++i) {
    const Eigen::VectorXd q0 = randomConfiguration(model), q1 = randomConfiguration(model);
    const JointMotion motion = robot.motion(q0, q1);
    pinocchio::Data data(model);
    for (const JointIndex j : {planar, flyer}) {
      pinocchio::forwardKinematics(model, data, q0);
      const SE3 M0 = data.oMi[j];
      pinocchio::forwardKinematics(model, data, q1);
      const SE3 M1 = data.oMi[j];
      const Eigen::Isometry3d middle = robot.tree->linkPose(robot.link(j), motion.configuration(0.5));
      EXPECT_LT((middle.translation() - 0.5 * (M0.translation() + M1.translation())).norm(), 1e-12);
      const Eigen::Matrix3d half =
          M0.rotation() * pinocchio::exp3(0.5 * pinocchio::log3(M0.rotation().transpose() * M1.rotation()));
      EXPECT_LT((middle.linear() - half).cwiseAbs().maxCoeff(), 1e-7);
      pinocchio::forwardKinematics(model, data, pinocchio::interpolate(model, q0, q1, 0.5));
      leaves_screw = std::max(leaves_screw, (middle.translation() - data.oMi[j].translation()).norm());
    }
  }
  EXPECT_GT(leaves_screw, 0.1);  // m: pinocchio's own way is another one, as the page says
}

TEST(PinocchioJoints, LimitsAreRead) {
  pinocchio::Model model;
  const Eigen::VectorXd one = Eigen::VectorXd::Ones(1);
  model.addJoint(0, pinocchio::JointModelRX(), SE3::Identity(), "limited", one, one, -2 * one, 3 * one);
  model.addJoint(1, pinocchio::JointModelRX(), SE3::Identity(), "unlimited");
  const PinocchioRobot robot = fromPinocchio(model, {});
  EXPECT_EQ(robot.tree->joint("limited").lower, -2);
  EXPECT_EQ(robot.tree->joint("limited").upper, 3);
  EXPECT_FALSE(hasLimits(robot.tree->joint("unlimited")));
}

/// The message of what a call throws.
template <class Call>
std::string refusal(const Call& call) {
  try {
    call();
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "nothing was thrown";
}

TEST(PinocchioJoints, WhatIsNotThereIsNamed) {
  using namespace pinocchio;
  const auto alone = [](const JointModel& joint) {
    return refusal([&] {
      Model model;
      model.addJoint(0, joint, SE3::Identity(), "screw");
      fromPinocchio(model, {});
    });
  };
  EXPECT_NE(alone(JointModelHX(0.1)).find("joint 'screw' is a JointModelHX"), std::string::npos);
  EXPECT_NE(alone(JointModelHelicalUnaligned(Eigen::Vector3d::UnitX(), 0.1)).find("joint 'screw'"), std::string::npos);
  EXPECT_NE(alone(JointModelComposite(JointModelHX(0.1))).find("joint 'screw' is a JointModelComposite"),
            std::string::npos);
  // pinocchio asserts unit axes; in a build without assertions it slides twice as far along this one.
  JointModelPrismaticUnaligned slide(Eigen::Vector3d::UnitX());
  slide.axis *= 2;
  EXPECT_NE(alone(slide).find("joint 'screw' has an axis that is not of length 1"), std::string::npos);
  Model model;
  model.addJoint(0, JointModelRUBX(), SE3::Identity(), "wheel");
  const PinocchioRobot robot = fromPinocchio(model, {});
  EXPECT_NE(refusal([&] { robot.configuration(Eigen::Vector2d(0.5, 0)); }).find("joint 'wheel'"), std::string::npos);
  EXPECT_NE(refusal([&] { robot.configuration(Eigen::Vector3d::Zero()); }).find("nq = 2"), std::string::npos);
  EXPECT_LT(std::abs(robot.configuration(Eigen::Vector2d(0, -1))[0] + M_PI_2), 1e-15);
}

}  // namespace
}  // namespace joints_test
}  // namespace fcl_artic
