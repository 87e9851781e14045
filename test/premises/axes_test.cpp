// SPDX-License-Identifier: BSD-3-Clause
//
// Values that lemmas take for unit vectors and proper rotations, given by callers as badly as they can. There are
// subnormal and huge axes, turns of hardly any angle, offsets that are orthonormal to nine digits, and long products.
// Bodies that are in each other are never free.
#include <cfenv>
#include <cmath>
#include <limits>

#include <fcl/geometry/shape/box.h>
#include <fcl/math/motion/translation_motion.h>
#include <fcl/narrowphase/continuous_collision_object.h>
#include <gtest/gtest.h>

#include "arms.h"
#include "control_bits.h"
#include "fcl_artic/fcl_artic.h"

namespace axes_test {

using namespace fcl_artic;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using Eigen::VectorXd;
using test::makeJoint;
using test::object;
using test::pose;

constexpr double kLeast = std::numeric_limits<double>::denorm_min(), kMost = std::numeric_limits<double>::max();

std::shared_ptr<fcl::CollisionGeometryd> box(double x, double y, double z) {
  return std::make_shared<fcl::Boxd>(x, y, z);
}

/// A bar on a joint whose axis is given, beside a wall that it is in or not.
struct BarAndWall {
  std::shared_ptr<KinematicTree> tree = std::make_shared<KinematicTree>("bar");
  std::shared_ptr<fcl::CollisionObjectd> bar = object(box(2, 0.4, 0.6)), wall = object(box(1, 8, 8), pose({1.6, 0, 0}));
  std::unique_ptr<ArticulatedCollisionManager> manager;

  BarAndWall(JointType type, const Vector3d& axis) {
    tree->addLink("base");
    tree->addLink("link");
    tree->addJoint(makeJoint("joint", type, "base", "link", axis));
    manager = std::make_unique<ArticulatedCollisionManager>(tree);
    manager->bind("link", bar.get(), pose({0.1, 0.2, 0.1}, 0.4, {1, 2, 3}));
    manager->registerObject(wall.get(), "wall");
    manager->setup();
  }
  CertifiedResult at(const VectorXd& q) const { return test::ask(*manager, q, q); }
};

const double kScales[] = {kLeast, 3 * kLeast, 1e-320, 1e-312, 1e-308, 1e-200,   1e-162,
                          1e-160, 1e-150,     1e150,  1e154,  1e200,  kMost / 8};

TEST(Axes, OfAnyLengthButZeroAreTheDirectionThatTheyHave) {
  const Vector3d direction(1, -2, 3);  // multiples of these are exact, subnormal ones too; the length is not
  int meet = 0, apart = 0;
  for (const JointType type : {JointType::revolute, JointType::continuous, JointType::prismatic, JointType::planar}) {
    const BarAndWall expected(type, direction);
    const int variables = expected.tree->dof();
    for (const double scale : kScales) {
      const BarAndWall bar(type, scale * direction);
      EXPECT_LE((bar.tree->joint(0).axis - direction.normalized()).norm(), 4e-16) << scale;
      for (int n = 0; n < 11; ++n) {
        VectorXd q = VectorXd::Zero(variables);
        q[0] = 0.2 * n - 1;
        q[variables - 1] = 0.3 * n - 1;
        const CertifiedResult is = bar.at(q), should = expected.at(q);
        EXPECT_EQ(is.status, should.status) << "axis times " << scale << " at " << q.transpose();
        ++(should.status == Status::contact ? meet : apart);
      }
    }
  }
  EXPECT_GT(meet, 50);
  EXPECT_GT(apart, 50);
}

TEST(Axes, ZeroAndNumbersThatAreNotFiniteAreRefusedByName) {
  for (const double bad : {0.0, -0.0, std::numeric_limits<double>::infinity(), std::nan("")}) {
    try {
      BarAndWall bar(JointType::revolute, Vector3d(0, bad, 0));
      ADD_FAILURE() << "an axis with " << bad;
    } catch (const std::invalid_argument& e) {
      EXPECT_NE(std::string(e.what()).find("joint 'joint' has an axis"), std::string::npos) << e.what();
    }
  }
}

/// A planar joint whose normal is so near to -z that what is across it squared is nothing.
TEST(Axes, PlanarJointsNextToMinusZHaveAFrame) {
  for (const double off : {kLeast, 3 * kLeast, 1e-310, 1e-200, 1e-163, 1e-162, 1e-161, 1e-155, 1e-20, 1e-9}) {
    for (const Vector3d& axis : {Vector3d(off, 0, -1), Vector3d(0, -off, -1), Vector3d(off, off, -1)}) {
      const BarAndWall bar(JointType::planar, axis);
      // However its plane's axes lie, it turns about -z, with the plane's origin at the joint's: the bar meets the wall
      // just as where it turns about z the other way.
      for (const double angle : {-1.0, 0.0, 0.4, 1.5}) {
        const BarAndWall plain(JointType::revolute, Vector3d::UnitZ());
        VectorXd q = VectorXd::Zero(3);
        q[2] = -angle;
        const Isometry3d M = bar.tree->linkPose(1, q);
        EXPECT_TRUE(M.matrix().allFinite()) << off;
        const CertifiedResult is = bar.at(q), should = plain.at(VectorXd::Constant(1, angle));
        EXPECT_EQ(is.status, should.status) << axis.transpose() << " at " << angle;
        // It is a plane's frame, too: x and y go across the axis, by as much as they are told.
        for (int k = 0; k < 2; ++k) {
          VectorXd slid = q;
          slid[k] += 1;
          const Vector3d way = bar.tree->linkPose(1, slid).translation() - M.translation();
          EXPECT_NEAR(way.norm(), 1, 4e-15);
          EXPECT_NEAR(way.dot(bar.tree->joint(0).axis), 0, 4e-15);
        }
      }
    }
  }
}

fcl::CollisionGeometryd* unitBox() {
  static fcl::Boxd unit(1, 1, 1);
  return &unit;
}

Status pairStatus(const fcl::MotionBased& motion, const Isometry3d& other) {
  const fcl::TranslationMotiond still(other, other);
  CertifiedPairResult result;
  return continuousCollide(unitBox(), &motion, unitBox(), &still, {}, result);
}

TEST(Axes, LinkMotionsTurnByHardlyAnyAngle) {
  KinematicTree tree("free");
  tree.addLink("world");
  tree.addLink("body");
  tree.addJoint(makeJoint("joint", JointType::floating, "world", "body", Vector3d::UnitX()));
  for (double size = 8e-163; size < 3e-162; size *= 1.02) {
    for (const Vector3d& axis :
         {Vector3d(0, 1, 0), Vector3d(0.6, 0, 0.8), Vector3d(1e-161, 0, 2e-161), Vector3d(0, 0, 1e10)}) {
      Eigen::MatrixXd coefficients = Eigen::MatrixXd::Zero(7, 2);
      coefficients.col(0) = tree.neutralConfiguration();
      coefficients.col(1).segment<3>(3) = size * axis;
      const FclLinkMotion motion(tree, JointMotion::polynomial(tree, coefficients), 1, pose({0, 0, 0}, 0.3, {1, 1, 0}));
      EXPECT_TRUE(motion.pose(1).linear().isUnitary(1e-14)) << size * axis.transpose();
      // The other box is this one, so much to each side, seen from it: 50 mm deep.
      for (int side = 0; side < 6; ++side) {
        const Isometry3d other = motion.pose(0) * pose((side % 2 ? 0.95 : -0.95) * Vector3d::Unit(side / 2));
        EXPECT_EQ(pairStatus(motion, other), Status::contact)
            << "turn by " << size * axis.transpose() << ", side " << side;
      }
    }
  }
}

TEST(Axes, PosesThatDifferByHardlyAnyAngleArePosesOfOneMotion) {
  const Isometry3d begin = Isometry3d::Identity();
  for (const fcl::CCDMotionType type : {fcl::CCDM_LINEAR, fcl::CCDM_SCREW, fcl::CCDM_TRANS}) {
    for (const double angle :
         {kLeast, 2 * kLeast, 3 * kLeast, 5 * kLeast, 8 * kLeast, 1e-310, 1e-300, 1e-170, 1.1e-162, 1e-150, 1e-12}) {
      for (const Vector3d& axis : {Vector3d(1, 0, 0), Vector3d(1, 2, 0), Vector3d(-1, 1, 1), Vector3d(3, 1, 2)}) {
        Isometry3d end = begin;
        const Vector3d w = angle * axis;
        end.linear() << 1, -w[2], w[1], w[2], 1, -w[0], -w[1], w[0], 1;
        for (int side = 0; side < 6; ++side) {
          const Isometry3d other = pose((side % 2 ? 0.9 : -0.9) * Vector3d::Unit(side / 2));
          CertifiedPairResult result;
          EXPECT_EQ(continuousCollide(unitBox(), begin, end, unitBox(), other, other, type, {}, result),
                    Status::contact)
              << "motion " << type << " by " << w.transpose() << ", side " << side;
          EXPECT_EQ(continuousCollide(unitBox(), begin, end, unitBox(), begin * pose({1.1, 0, 0}),
                                      begin * pose({1.1, 0, 0}), type, {}, result),
                    Status::free);
        }
      }
    }
  }
}

/// Offsets as typed or printed with nine digits: bodies are where the proper rotation next to the offset puts them.
TEST(Rotations, OffsetsOfLinkMotionsAreMadeOrthonormal) {
  KinematicTree tree("slider");
  tree.addLink("world");
  tree.addLink("body");
  tree.addJoint(makeJoint("joint", JointType::prismatic, "world", "body", Vector3d::UnitX()));
  const JointMotion still = JointMotion::still(tree, VectorXd::Zero(1));
  for (const double error : {-4.5e-10, 4.5e-10}) {
    Isometry3d offset = Isometry3d::Identity();
    offset.linear() *= 1 + error;
    const FclLinkMotion motion(tree, still, 1, offset);
    EXPECT_LE((motion.pose(0).linear() - Matrix3d::Identity()).norm(), 4e-15);
    for (int side = 0; side < 6; ++side) {
      const Vector3d out = (side % 2 ? 1 : -1) * Vector3d::Unit(side / 2);
      const Isometry3d in = pose((1 - 1e-10) * out), apart = pose((1 + 1e-10) * out);
      CertifiedPairRequest request;
      request.tolerance_distance = 1e-12;
      const auto status = [&](const Isometry3d& other) {
        const fcl::TranslationMotiond stays(other, other);
        CertifiedPairResult result;
        return continuousCollide(unitBox(), &motion, unitBox(), &stays, request, result);
      };
      EXPECT_EQ(status(in), Status::contact) << error << " on side " << side;
      EXPECT_EQ(status(apart), Status::free) << error << " on side " << side;

      // In the manager of moving objects, and as an obstacle that moves.
      const auto shared = std::make_shared<fcl::Boxd>(1, 1, 1);
      fcl::ContinuousCollisionObjectd a(shared, std::make_shared<FclLinkMotion>(tree, still, 1, offset));
      fcl::ContinuousCollisionObjectd b(shared, std::make_shared<fcl::TranslationMotiond>(in, in));
      ContinuousCollisionManager objects;
      objects.registerObject(&a);
      objects.registerObject(&b);
      objects.setup();
      CertifiedPairsResult pairs;
      objects.continuousCollide(request, pairs);
      EXPECT_EQ(pairs.status, Status::contact);

      const auto stage = std::make_shared<KinematicTree>(tree);
      const auto body = object(shared);
      ArticulatedCollisionManager manager(stage);
      manager.bind("body", body.get(), in);
      manager.registerObject(&a, "moving");
      manager.setup();
      CertifiedRequest asked;
      asked.tolerance_distance = 1e-12;
      EXPECT_EQ(test::ask(manager, VectorXd::Zero(1), VectorXd::Zero(1), asked).status, Status::contact);
    }
  }
}

/// A joint mimics another one, with a multiple and an offset that cancel but for the rounding of their sum: the
/// computed value is off by this much. Balls and boxes that reach into each other by half of it are not free.
TEST(Axes, LinkMotionsOfMimicJointsCountTheTermsThatCancel) {
  for (const JointType type : {JointType::revolute, JointType::prismatic}) {
    const auto fingers = [&](double multiplier, double q) {
      KinematicTree tree("fingers");
      for (const char* link : {"hand", "left", "right"}) tree.addLink(link);
      tree.addJoint(makeJoint("master", JointType::prismatic, "hand", "left", Vector3d::UnitX()));
      const Vector3d axis = type == JointType::revolute ? Vector3d(0, 0, 1) : Vector3d(0, 1, 0);
      Joint joint = makeJoint("mimic", type, "hand", "right", axis);
      joint.mimics = true;
      joint.mimic = {"master", multiplier, -(multiplier * q)};
      tree.addJoint(joint);
      return tree;
    };
    for (const auto& [multiplier, q] : {std::pair(0.3, 99999.7), {-0.3, 99999.7}, {0.4567, 99999.3}, {163210.7, 0.3}}) {
      const KinematicTree tree = fingers(multiplier, q);
      const double value = std::fma(multiplier, q, tree.joint(1).mimic.offset);  // of the model, exactly
      ASSERT_GT(std::abs(value), 1e-12);
      const FclLinkMotion motion(tree, JointMotion::still(tree, VectorXd::Constant(1, q)), 2, pose({1, 0, 0}));
      const fcl::Sphered ball(0.1);
      for (const double deep : {0.5 * std::abs(value), -1e-6}) {
        const Isometry3d other = pose({1, std::copysign(0.6 + std::abs(value) - deep, value), 0});
        const fcl::TranslationMotiond stays(other, other);
        CertifiedPairRequest request;
        request.tolerance_distance = 1e-15;
        CertifiedPairResult result;
        const Status status = continuousCollide(&ball, &motion, unitBox(), &stays, request, result);
        EXPECT_EQ(status, deep > 0 ? Status::contact : Status::free) << multiplier << " " << q << ": " << deep << " m";
      }
    }
    // Where they cancel by more, they are refused, as the coefficients of a polynomial are.
    for (const auto& [multiplier, q] : {std::pair(0.6, 99999.7), {3.1e9, 99999.7}, {-3.1e9, 0.3}}) {
      const KinematicTree tree = fingers(multiplier, q);
      EXPECT_NEAR(tree.jointValue(1, VectorXd::Constant(1, q)), 0, 1e-12);
      EXPECT_THROW((void)JointMotion::still(tree, VectorXd::Constant(1, q)), std::invalid_argument);
      EXPECT_THROW((void)JointMotion::linear(tree, VectorXd::Zero(1), VectorXd::Constant(1, q)), std::invalid_argument);
    }
  }
}

/// More than a thousand fixed joints, each of which turns by the same, in rounding modes that err to one side. Their
/// product is farther from a rotation than any one stored rotation is.
TEST(Rotations, ProductsOfFixedJointsCountWithTheirErrors) {
  using Exact = Eigen::Matrix<long double, 3, 3>;
  constexpr int kJoints = 2500;
  KinematicTree tree("chain");
  tree.addLink("l0");
  Isometry3d origin = Isometry3d::Identity();
  origin.linear() = Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  for (int i = 0; i < kJoints; ++i) {
    tree.addLink("l" + std::to_string(i + 1));
    tree.addJoint(Joint::fixed("f" + std::to_string(i), "l" + std::to_string(i), "l" + std::to_string(i + 1), origin));
  }
  tree.addLink("end");
  tree.addJoint(makeJoint("last", JointType::prismatic, "l" + std::to_string(kJoints), "end", Vector3d::UnitX()));
  // The error from the rotation next to the stored one, in long doubles.
  Exact R = tree.joint(0).origin.linear().cast<long double>(), product = Exact::Identity();
  for (int k = 0; k < 4; ++k) R += 0.5L * R * (Exact::Identity() - R.transpose() * R);
  for (int i = 0; i < kJoints; ++i) product = product * R;
  // Far out, where a turn that is off by 1e-13 moves it by 1e-7 m.
  const Eigen::Matrix<long double, 3, 1> place = product * Eigen::Matrix<long double, 3, 1>(0, 0, 1e6L);
  const Vector3d at = place.cast<double>();
  double farthest = 0;
  for (const int mode : {FE_TONEAREST, FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
    std::fesetround(mode);
    const FclLinkMotion motion(tree, JointMotion::still(tree, VectorXd::Zero(1)), kJoints + 1, pose({0, 0, 1e6}));
    const Vector3d is = motion.pose(0).translation();
    std::fesetround(FE_TONEAREST);
    const double off = (is - at).norm();
    farthest = std::max(farthest, off);
    for (const double share : {-0.4, -0.02, 0.02, 0.4}) {  // of it balls reach into each other, on either side
      const fcl::Sphered ball(0.01);
      const Isometry3d other = pose(at + std::copysign(0.02 - std::abs(share) * off, share) * (at - is).normalized());
      const fcl::TranslationMotiond stays(other, other);
      CertifiedPairRequest request;
      request.tolerance_distance = 1e-12;
      CertifiedPairResult result;
      std::fesetround(mode);
      const Status status = continuousCollide(&ball, &motion, &ball, &stays, request, result);
      std::fesetround(FE_TONEAREST);
      EXPECT_NE(status, Status::free) << "mode " << mode << ", off by " << off;
    }
  }
  EXPECT_GT(farthest, 1e-7);
}

}  // namespace axes_test
