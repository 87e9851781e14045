// SPDX-License-Identifier: BSD-3-Clause
//
// Planar, spherical and floating joints: what they mean, and contact times known in closed form.
#include "scene.h"

namespace trajectory_test {
namespace joints_test {
namespace {

/// A rotation that is none of the simple ones.
const Quaterniond kTilt = Quaterniond(Eigen::AngleAxisd(2.1, Vector3d(1, -2, 0.5).normalized()));

VectorXd floatingAt(const Vector3d& x, const Quaterniond& q) {
  VectorXd out(7);
  out << x, q.coeffs();
  return out;
}

TEST(Joints, VariablesNamesAndPoses) {
  Scene scene;
  scene.add("hinge", JointType::revolute, "base", "a");
  scene.add("free", JointType::floating, "a", "b");
  scene.add("floor", JointType::planar, "b", "c", Vector3d::UnitY());
  scene.add("ball", JointType::spherical, "c", "d");
  scene.add("weld", JointType::fixed, "d", "e");
  const KinematicTree& tree = *scene.tree;
  ASSERT_EQ(tree.dof(), 15);
  const std::vector<std::string> names = {"hinge",       "free/trans_x", "free/trans_y", "free/trans_z", "free/rot_x",
                                          "free/rot_y",  "free/rot_z",   "free/rot_w",   "floor/x",      "floor/y",
                                          "floor/theta", "ball/rot_x",   "ball/rot_y",   "ball/rot_z",   "ball/rot_w"};
  for (int v = 0; v < tree.dof(); ++v) {
    EXPECT_EQ(tree.variableName(v), names[static_cast<std::size_t>(v)]);
    EXPECT_EQ(tree.isAngle(v), v == 0 || v == 10) << v;
  }
  EXPECT_EQ(tree.jointVariable(2), 8);
  EXPECT_EQ(tree.numVariables(1), 7);
  EXPECT_EQ(tree.quaternionVariable(1), 4);
  EXPECT_EQ(tree.quaternionVariable(3), 11);
  EXPECT_EQ(tree.quaternionVariable(2), -1);

  VectorXd q = tree.neutralConfiguration();
  EXPECT_EQ(q.sum(), 2);
  EXPECT_EQ(q[7], 1);
  EXPECT_EQ(q[14], 1);
  std::vector<Isometry3d> M;
  tree.forwardKinematics(q, M);
  for (const Isometry3d& m : M) EXPECT_TRUE(m.isApprox(Isometry3d::Identity(), 1e-15));

  q.segment<7>(1) = floatingAt({1, 2, 3}, kTilt);
  q.segment<3>(8) << 0.5, 0.25, 0.3;
  q.segment<4>(11) = -kTilt.coeffs();  // the same orientation
  tree.forwardKinematics(q, M);
  const Isometry3d free = translation({1, 2, 3}) * kTilt;
  EXPECT_TRUE(M[2].isApprox(free, 1e-14));
  // z turns to y the shortest way, about -x: x stays, y becomes -z.
  const Isometry3d plane = translation({0.5, 0, -0.25}) * Eigen::AngleAxisd(0.3, Vector3d::UnitY());
  EXPECT_TRUE(M[3].isApprox(free * plane, 1e-14));
  EXPECT_TRUE(M[5].isApprox(free * plane * kTilt, 1e-14));

  q.segment<4>(11) *= 0.9995;  // typed with few digits
  tree.forwardKinematics(q, M);
  EXPECT_TRUE(M[5].isApprox(free * plane * kTilt, 1e-14));
}

TEST(Joints, RefusesWhatIsNoQuaternion) {
  Scene scene;
  scene.add("ball", JointType::spherical, "base", "a");
  const KinematicTree& tree = *scene.tree;
  const VectorXd good = tree.neutralConfiguration();
  expectContains(refusal([&] { JointMotion::linear(tree, VectorXd::Zero(4), good); }),
                 "q0: the quaternion of joint 'ball'");
  expectContains(refusal([&] { JointMotion::linear(tree, good, 1.01 * good); }),
                 "q1: the quaternion of joint 'ball' has the length 1.01");
  expectContains(refusal([&] { tree.jointValue(0, good); }), "joint 'ball' has no single value");
  MatrixXd c = MatrixXd::Zero(4, 2);
  c(3, 0) = c(3, 1) = 1;
  expectContains(refusal([&] { JointMotion::polynomial(tree, c); }), "'ball/rot_w'");
}

/// Slerp: the shortest way at constant speed, whichever sign the quaternions have; at t = 1 the end.
TEST(Joints, QuaternionsTakeTheShortestRotationAtConstantSpeed) {
  Scene scene;
  scene.add("free", JointType::floating, "base", "a");
  const KinematicTree& tree = *scene.tree;
  const Quaterniond end(Eigen::AngleAxisd(-0.4, Vector3d(0.3, 1, -1).normalized()));
  for (const double sign : {1.0, -1.0}) {
    VectorXd q0 = floatingAt({1, 0, 0}, kTilt), q1 = floatingAt({0, 2, 0}, end);
    q1.tail<4>() *= sign;
    const JointMotion motion = JointMotion::linear(tree, q0, q1);
    EXPECT_TRUE(motion.q0().isApprox(q0, 1e-15));
    for (double t = 0; t <= 1; t += 0.125) {
      const VectorXd q = motion.configuration(t);
      EXPECT_TRUE(q.head<3>().isApprox(Vector3d(1 - t, 2 * t, 0), 1e-15) || t == 0 || t == 1);
      const Quaterniond here(Eigen::Vector4d(q.tail<4>()));
      EXPECT_LT(here.angularDistance(kTilt.slerp(t, end)), 1e-7) << t;  // acos near 1 gives no more
    }
    EXPECT_TRUE(motion.coefficients().col(0).isApprox(q0, 1e-15));
    const JointMotion again = JointMotion::polynomial(tree, motion.coefficients());
    EXPECT_EQ(again.variables(), motion.variables());
  }
}

/// A ball of radius 0.1 on an arm of 1 m, across the axis of rotation. It runs into a ball of radius 0.15 that sits on
/// the path at three quarters of the way. They touch where the chord 2 sin(angle / 2) is 0.25.
TEST(Joints, SphericalJointMeetsABallAtTheTimeWorkedOut) {
  const Vector3d axis = Vector3d(1, 2, -0.5).normalized();
  const double angle = 2.5;
  const Quaterniond end = Quaterniond(Eigen::AngleAxisd(angle, axis)) * kTilt;
  const Vector3d start = axis.unitOrthogonal();  // of the ball, in the base
  Scene scene;
  scene.add("ball", JointType::spherical, "base", "arm");
  scene.ball("arm", 0.1, kTilt.conjugate() * start);
  scene.obstacle("in the way", std::make_shared<fcl::Sphered>(0.15),
                 translation(Eigen::AngleAxisd(0.75 * angle, axis) * start));
  VectorXd q0(4), q1(4);
  q0 << kTilt.coeffs();
  q1 << end.coeffs();
  const double t = 0.75 - 2 * std::asin(0.125) / angle;
  expectContact(scene.run(JointMotion::linear(*scene.tree, q0, q1)), t);
  // The other way round it comes from behind.
  expectContact(scene.run(JointMotion::linear(*scene.tree, q1, q0)), 0.25 - 2 * std::asin(0.125) / angle);
  EXPECT_TRUE(scene.run(JointMotion::linear(*scene.tree, q0, kTilt.slerp(0.6, end).coeffs())).isFree());
}

/// The same, seen from the arm. Its link runs into another arm that hangs on the arm's own tip by a second joint, so
/// the pair's path goes up through the spherical joint.
TEST(Joints, SelfCollisionThroughASphericalJoint) {
  const Vector3d axis = Vector3d(1, 2, -0.5).normalized();
  const double angle = 2.5;
  const Quaterniond end = Quaterniond(Eigen::AngleAxisd(angle, axis)) * kTilt;
  const Vector3d start = axis.unitOrthogonal(), target = Eigen::AngleAxisd(0.75 * angle, axis) * start;
  Scene scene;
  scene.add("ball", JointType::spherical, "base", "arm");
  scene.add("rail", JointType::prismatic, "base", "cart", Vector3d::UnitX(), translation(target));
  scene.ball("arm", 0.1, kTilt.conjugate() * start);
  scene.ball("cart", 0.15);
  VectorXd q0(5), q1(5);
  q0 << kTilt.coeffs(), 0;
  q1 << end.coeffs(), 0;
  const CertifiedResult r = scene.run(JointMotion::linear(*scene.tree, q0, q1));
  expectContact(r, 0.75 - 2 * std::asin(0.125) / angle);
}

/// Thrown upwards, spinning about the vertical: a ball on an arm is as high as the body, z = 1 + 3 t - 5 t^2 (of its
/// own height 0.2), and comes to the floor where z = 0.1.
TEST(Joints, FloatingBaseFallsToTheFloor) {
  Scene scene("world");
  scene.add("free", JointType::floating, "world", "body");
  scene.ball("body", 0.1, kTilt.conjugate() * Vector3d(0.4, -0.3, 0.2));
  scene.obstacle("floor", std::make_shared<fcl::Boxd>(100, 100, 1), translation({0, 0, -0.5}));
  MatrixXd c = MatrixXd::Zero(7, 3);
  c.col(0) << 0, 0, 1, kTilt.coeffs();
  c.col(1) << 2, -1, 3, 0, 0, 20, 0;
  c.col(2) << 0, 0, -5, 0, 0, 0, 0;
  const double t = (3 + std::sqrt(9 + 20 * 1.1)) / 10;  // 5 t^2 - 3 t - 1.1 = 0
  expectContact(scene.run(JointTrajectory::piecewise(*scene.tree, {0, 1}, {c})), t);
  expectContact(scene.run(JointTrajectory::piecewise(*scene.tree, {-3, -2}, {c})), t - 3);
}

/// A base that drives in the plane across y: its x is the world's x, its y the world's -z. Turned by a right angle, a
/// ball at 0.3 m along the base's x is below it (a rotation about y takes x to -z).
TEST(Joints, PlanarBaseMeetsTheFloor) {
  Scene scene("world");
  scene.add("plane", JointType::planar, "world", "body", Vector3d::UnitY());
  scene.ball("body", 0.1, {0.3, 0, 0});
  scene.obstacle("floor", std::make_shared<fcl::Boxd>(100, 100, 1), translation({0, 0, -1.5}));
  // Height -y - 0.3 sin(theta), of the floor -1, of the ball 0.1.
  const JointMotion down = JointMotion::linear(*scene.tree, values({0, 0, kPi / 2}), values({5, 1, kPi / 2}));
  expectContact(scene.run(down), 0.6);
  const JointMotion turn = JointMotion::linear(*scene.tree, values({0, 0.75, 0}), values({1, 0.75, 1}));
  expectContact(scene.run(turn), std::asin(0.15 / 0.3));
}

/// A link of the world is no neighbour of what flies or drives about before it: the ball at x = 2 t meets its face
/// at 1.5.
TEST(Joints, FreeBodiesMeetTheLinkThatTheyMoveOn) {
  for (const JointType type : {JointType::floating, JointType::planar, JointType::prismatic}) {
    Scene scene("world");
    scene.add("move", type, "world", "body", type == JointType::prismatic ? Vector3d::UnitX() : Vector3d::UnitZ());
    scene.ball("body", 0.1);
    scene.bind("world", std::make_shared<fcl::Boxd>(1, 1, 1), translation({2, 0, 0}));
    const VectorXd q0 = scene.tree->neutralConfiguration();
    VectorXd q1 = q0;
    q1[0] = 2;
    const CertifiedResult r = scene.run(JointMotion::linear(*scene.tree, q0, q1));
    if (type == JointType::prismatic) {
      EXPECT_TRUE(r.isFree()) << "neighbours";
    } else {
      expectContact(r, 0.7);
    }
  }
}

TEST(Joints, ShortestWrapsThePlanarAngle) {
  Scene scene;
  scene.add("plane", JointType::planar, "base", "body");
  const VectorXd q0 = values({0, 0, 3}), q1 = values({7, 0, -3});
  EXPECT_EQ(JointMotion::linear(*scene.tree, q0, q1).dq()[2], -6);
  EXPECT_NEAR(JointMotion::shortest(*scene.tree, q0, q1).dq()[2], 2 * kPi - 6, 1e-15);
  EXPECT_EQ(JointMotion::shortest(*scene.tree, q0, q1).dq()[0], 7);
}

/// FCL's own queries see the same motion; polynomials are beyond them.
TEST(Joints, FclLinkMotionFollowsThem) {
  Scene scene;
  scene.add("free", JointType::floating, "base", "a", Vector3d::UnitX(), translation({0.1, 0, 0}) * kTilt);
  scene.add("plane", JointType::planar, "a", "b", Vector3d::UnitX(), translation({0, 0.2, 0}));
  scene.add("ball", JointType::spherical, "b", "c", Vector3d::UnitX(), translation({0, 0, 0.3}) * kTilt);
  const KinematicTree& tree = *scene.tree;
  VectorXd q0 = tree.neutralConfiguration(), q1 = q0;
  q0.head<7>() = floatingAt({1, 2, 3}, kTilt);
  q1.segment<3>(7) << 1, -1, 2;
  q1.tail<4>() = kTilt.coeffs();
  const JointMotion motion = JointMotion::linear(tree, q0, q1);
  const Isometry3d offset = translation({0.5, 0, 0}) * kTilt;
  const FclLinkMotion link(tree, motion, tree.linkId("c"), offset);
  std::vector<Isometry3d> M;
  Isometry3d before = link.pose(0);
  for (int i = 0; i <= 16; ++i) {
    const double t = i / 16.0;
    tree.forwardKinematics(motion.configuration(t), M);
    EXPECT_TRUE(link.pose(t).isApprox(M[3] * offset, 1e-13)) << t;
    EXPECT_LE((link.pose(t).translation() - before.translation()).norm(), link.speedBound(0) / 16);
    before = link.pose(t);
  }
  MatrixXd c = MatrixXd::Zero(tree.dof(), 3);
  c.col(0) = q0;
  c(0, 2) = 1;
  expectContains(refusal([&] { FclLinkMotion(tree, JointMotion::polynomial(tree, c), 3); }), "degree 2");
}

}  // namespace
}  // namespace joints_test
}  // namespace trajectory_test
