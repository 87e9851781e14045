// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "fcl_artic/fcl_artic.h"
#include "fcl_artic/urdf/urdf.h"

namespace fcl_artic {
namespace bundled_robot_test {
namespace {

const std::string kData = FCL_ARTIC_BUNDLED_DATA;

const Robot& puma() {
  static const Robot robot = loadUrdf(kData + "/puma560/puma560.urdf");
  return robot;
}

/// Uniform within the joint limits.
Eigen::VectorXd randomConfiguration(std::mt19937& random) {
  const KinematicTree& tree = *puma().tree;
  Eigen::VectorXd q(tree.dof());
  for (int v = 0; v < tree.dof(); ++v) {
    const Joint& joint = tree.joint(tree.variableJoint(v));
    q[v] = joint.lower + (joint.upper - joint.lower) * (static_cast<double>(random()) / 4294967296.0);
  }
  return q;
}

TEST(BundledPuma, HasSixJointsWithinLimitsAndABodyOnEachLink) {
  const Robot& robot = puma();
  EXPECT_EQ(robot.tree->name(), "puma560");
  ASSERT_EQ(robot.tree->dof(), 6);
  EXPECT_EQ(robot.geometry.size(), 7u);
  EXPECT_TRUE(robot.notes.empty()) << robot.notes.front();
  const double lower[] = {-160, -45, -225, -110, -100, -266}, upper[] = {160, 225, 45, 170, 100, 266};
  for (int v = 0; v < 6; ++v) {
    const Joint& joint = robot.tree->joint(robot.tree->variableJoint(v));
    EXPECT_NEAR(joint.lower, lower[v] * M_PI / 180, 1e-6) << joint.name;
    EXPECT_NEAR(joint.upper, upper[v] * M_PI / 180, 1e-6) << joint.name;
  }
}

// The flange's pose from the published table itself, A_i = Rz(q_i) Tz(d_i) Tx(a_i) Rx(alpha_i), beside the URDF's
// chain of frames.
TEST(BundledPuma, FollowsThePublishedDenavitHartenbergTable) {
  const double a[] = {0, 0.4318, 0.0203, 0, 0, 0}, d[] = {0, 0, 0.15005, 0.4318, 0, 0.05625};
  const double alpha[] = {M_PI / 2, 0, -M_PI / 2, M_PI / 2, -M_PI / 2, 0};
  using Eigen::AngleAxisd, Eigen::Translation3d, Eigen::Vector3d;
  const KinematicTree& tree = *puma().tree;
  std::mt19937 random(1);
  std::vector<Eigen::Isometry3d> M_0;
  for (int k = 0; k < 100; ++k) {
    const Eigen::VectorXd q = randomConfiguration(random);
    Eigen::Isometry3d M(Translation3d(0, 0, 0.67183));
    for (int i = 0; i < 6; ++i) {
      M = M * AngleAxisd(q[i], Vector3d::UnitZ()) * Translation3d(a[i], 0, d[i]) *
          AngleAxisd(alpha[i], Vector3d::UnitX());
    }
    tree.forwardKinematics(q, M_0);
    const Eigen::Isometry3d& tool = M_0[static_cast<std::size_t>(tree.linkId("tool0"))];
    EXPECT_LT((tool.matrix() - M.matrix()).cwiseAbs().maxCoeff(), 1e-12) << q.transpose();
  }
}

TEST(BundledPuma, OnlyNeighbouringLinksTouch) {
  ArticulatedCollisionManager manager(puma().tree);
  puma().addTo(manager);
  manager.setup();
  std::mt19937 random(2);
  for (int k = 0; k < 100; ++k) {
    const Eigen::VectorXd q = randomConfiguration(random);
    CertifiedResult result;
    manager.collide(q, CertifiedRequest(), result);
    EXPECT_TRUE(result.isFree()) << q.transpose() << ": " << result.contacts.front().body1.name << " - "
                                 << result.contacts.front().body2.name;
  }
}

// The two motions of data/README.md.
TEST(BundledPuma, DocumentedMotionsAreFreeAndInContact) {
  const Scene scene = loadScene(kData + "/pipes.obj");
  ArticulatedCollisionManager manager(puma().tree);
  puma().addTo(manager);
  scene.addTo(manager);
  manager.setup();
  Eigen::VectorXd from(6), past(6), into(6);
  from << -2.1, 1, -1, -0.1, -0.1, 0;
  past << 0.9, 0.4, -2, 0, 0.2, 0;
  into << -0.1, 0.3, -2.3, -1, 1.1, 0;

  CertifiedResult result;
  manager.continuousCollide(JointMotion::linear(*puma().tree, from, past), CertifiedRequest(), result);
  EXPECT_TRUE(result.isFree());

  manager.continuousCollide(JointMotion::linear(*puma().tree, from, into), CertifiedRequest(), result);
  EXPECT_EQ(result.status, Status::contact);
  EXPECT_TRUE(result.certain);
  EXPECT_NEAR(result.t_lower, 0.43, 0.01);
  ASSERT_EQ(result.contacts.size(), 1u);
  EXPECT_EQ(result.contacts[0].body1.name, "wrist_roll");
  for (const Eigen::VectorXd* end : {&from, &past, &into}) {
    manager.collide(*end, CertifiedRequest(), result);
    EXPECT_TRUE(result.isFree()) << end->transpose();
  }
}

}  // namespace
}  // namespace bundled_robot_test
}  // namespace fcl_artic
