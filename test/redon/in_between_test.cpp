// SPDX-License-Identifier: BSD-3-Clause
// Section 3: the arbitrary in-between motion.
#include <cmath>

#include <fcl/geometry/shape/sphere.h>
#include <gtest/gtest.h>

#include "fcl_artic/fcl_artic.h"
#include "fcl_artic/in_between.h"
#include "meshes.h"

namespace in_between_test {

namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using fcl_artic::JointMotion;
using fcl_artic::KinematicTree;

constexpr double kPi = 3.14159265358979323846;

/// base - arm - hand, two hinges.
std::shared_ptr<KinematicTree> twoHinges() {
  auto tree = std::make_shared<KinematicTree>("hinges");
  for (const char* name : {"base", "arm", "hand"}) tree->addLink(name);
  fcl_artic::Joint joint;
  joint.type = fcl_artic::JointType::revolute;
  joint.axis = Vector3d::UnitZ();
  joint.name = "shoulder", joint.parent = "base", joint.child = "arm";
  tree->addJoint(joint);
  joint.name = "wrist", joint.parent = "arm", joint.child = "hand";
  joint.origin.translation() = Vector3d(1, 0, 0);
  tree->addJoint(joint);
  return tree;
}

Isometry3d pose(double x, double y, double z, double angle, const Vector3d& axis) {
  return Eigen::Translation3d(x, y, z) * AngleAxisd(angle, axis.normalized());
}

TEST(InBetween, MeetsBothEndsAndMovesEvenlyBetweenThem) {
  const auto tree = fcl_artic::inBetweenTree(*twoHinges());
  EXPECT_EQ(tree->linkId("hand"), 2);
  const std::vector<Isometry3d> begin{pose(0, 0, 0, 0.3, {1, 2, 3}), pose(1, 2, 3, -1, {0, 1, 0}),
                                      pose(2, 2, 2, 2, {1, 0, 1})};
  const std::vector<Isometry3d> end{pose(1, 0, 0.5, 1.3, {1, -2, 3}), pose(-1, 1, 3, 1, {0, 1, 1}),
                                    pose(0, 3, 1, 0.2, {1, 1, 1})};
  const JointMotion motion = fcl_artic::inBetweenMotion(*tree, begin, end);
  std::vector<Isometry3d> at0, at1;
  tree->forwardKinematics(motion.configuration(0), at0);
  tree->forwardKinematics(motion.configuration(1), at1);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_TRUE(at0[i].isApprox(begin[i], 1e-12)) << i;
    EXPECT_TRUE(at1[i].isApprox(end[i], 1e-12)) << i;
  }
  // Seen from the parent: the origin on a straight line at constant velocity, one axis, constant speed.
  const auto relative = [&](double t, int link, int parent) {
    std::vector<Isometry3d> M;
    tree->forwardKinematics(motion.configuration(t), M);
    return Isometry3d(M[static_cast<std::size_t>(parent)].inverse() * M[static_cast<std::size_t>(link)]);
  };
  for (const auto& [link, parent] : {std::pair<int, int>{1, 0}, {2, 1}, {0, 3}}) {
    const Isometry3d A = relative(0, link, parent), B = relative(1, link, parent);
    const AngleAxisd whole(Eigen::Matrix3d(B.linear() * A.linear().transpose()));
    for (const double t : {0.25, 0.5, 0.9}) {
      const Isometry3d M = relative(t, link, parent);
      EXPECT_LT((M.translation() - ((1 - t) * A.translation() + t * B.translation())).norm(), 1e-12);
      const Eigen::Matrix3d R = AngleAxisd(t * whole.angle(), whole.axis()) * A.linear();
      EXPECT_LT((M.linear() - R).norm(), 1e-12);
    }
  }
}

/// Links that overlap at their joints may do so on floating joints too.
TEST(InBetween, NeighboursStayNeighbours) {
  const auto tree = fcl_artic::inBetweenTree(*twoHinges());
  fcl_artic::ArticulatedCollisionManager manager(tree);
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> balls;
  for (const char* link : {"base", "arm", "hand"}) {
    balls.push_back(std::make_unique<fcl::CollisionObjectd>(std::make_shared<fcl::Sphered>(0.1)));
    manager.bind(link, balls.back().get());
  }
  manager.setup();
  const Isometry3d I = Isometry3d::Identity(), out(Eigen::Translation3d(1, 0, 0));
  const Isometry3d turned(AngleAxisd(1, Vector3d::UnitZ()));
  fcl_artic::CertifiedResult result;
  manager.continuousCollide(fcl_artic::inBetweenMotion(*tree, {I, I, out}, {I, turned, turned * out}), {}, result);
  EXPECT_TRUE(result.isFree()) << "the arm's ball stays within the base's";
  manager.continuousCollide(fcl_artic::inBetweenMotion(*tree, {I, I, out}, {I, turned, I}), {}, result);
  EXPECT_EQ(result.status, fcl_artic::Status::contact) << "the hand comes to the base, which is not its neighbour";
}

TEST(InBetween, BothMethodsFindTheContactOfTheInBetweenMotion) {
  // The arm turns from 0 to 90 degrees while the hand's origin, seen from it, goes straight from (1, 0, 0) to (2, 0,
  // 0): at t the tip is at radius 1 + t under t 90 degrees. A post under 45 degrees, between the radii 1.4 and 1.7, is
  // met at t = 1/2.
  const auto hinges = twoHinges();
  const auto tree = fcl_artic::inBetweenTree(*hinges);
  const Isometry3d turned(AngleAxisd(kPi / 2, Vector3d::UnitZ()));
  const Isometry3d I = Isometry3d::Identity();
  const std::vector<Isometry3d> begin{I, I, I * Eigen::Translation3d(1, 0, 0)},
      end{I, turned, turned * Eigen::Translation3d(2, 0, 0)};
  const JointMotion motion = fcl_artic::inBetweenMotion(*tree, begin, end);
  fcl::CollisionObjectd hand(redon_test::triangle({0, 0, -0.1}, {0, 0, 0.1}, {-0.2, 0, 0}));
  const Vector3d u = Vector3d(1, 1, 0).normalized();
  fcl::CollisionObjectd post(redon_test::triangle(1.4 * u, 1.7 * u, 1.6 * u + Vector3d(0, 0, 3)));
  fcl_artic::ArticulatedCollisionManager manager(tree);
  manager.bind("hand", &hand);
  manager.registerObject(&post, "post");
  manager.setup();
  for (const auto method : {fcl_artic::Method::standard, fcl_artic::Method::redon2004}) {
    fcl_artic::CertifiedRequest request;
    request.method = method;
    fcl_artic::CertifiedResult result;
    manager.continuousCollide(motion, request, result);
    ASSERT_EQ(result.status, fcl_artic::Status::contact);
    EXPECT_TRUE(result.certain);
    EXPECT_LE(result.t_lower, 0.5);
    EXPECT_GE(result.t_upper, 0.5);
    EXPECT_LE(result.t_upper - result.t_lower, 1e-6);
    if (method == fcl_artic::Method::redon2004) {
      EXPECT_EQ(result.statistics.redon.pairs_by_standard, 0u);
    }
  }
  // The joints by themselves keep the hand at radius 1: they pass below the post.
  fcl_artic::ArticulatedCollisionManager by_joints(hinges);
  by_joints.bind("hand", &hand);
  by_joints.registerObject(&post, "post");
  by_joints.setup();
  fcl_artic::CertifiedResult result;
  by_joints.continuousCollide(JointMotion::linear(*hinges, Eigen::Vector2d(0, 0), Eigen::Vector2d(kPi / 2, 0)), {},
                              result);
  EXPECT_TRUE(result.isFree());
}

TEST(InBetween, BadInputIsRefused) {
  const auto tree = fcl_artic::inBetweenTree(*twoHinges());
  const std::vector<Isometry3d> good(3, Isometry3d::Identity()), few(2, Isometry3d::Identity());
  std::vector<Isometry3d> sheared = good;
  sheared[1].linear()(0, 1) = 0.1;
  EXPECT_THROW(fcl_artic::inBetweenMotion(*tree, few, good), std::invalid_argument);
  EXPECT_THROW(fcl_artic::inBetweenMotion(*tree, good, sheared), std::invalid_argument);
  EXPECT_THROW(fcl_artic::inBetweenMotion(*twoHinges(), good, good), std::invalid_argument);
}

}  // namespace

}  // namespace in_between_test
