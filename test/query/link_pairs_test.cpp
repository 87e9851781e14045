// SPDX-License-Identifier: BSD-3-Clause
//
// Pairs of links over all joint values, and their use by queries.
#include "fcl_artic/link_pairs.h"

#include <cmath>
#include <sstream>
#include <stdexcept>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/geometric_shape_to_BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/sphere.h>
#include <gtest/gtest.h>

#include "fcl_artic/manager.h"
#include "fcl_artic/solid_mesh.h"

namespace link_pairs_test {

using namespace fcl_artic;
using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

/// Two turns in a plane, with arms of 1 m and 0.5 m. There is a ball on the base, and one on the hand. The hand's ball
/// comes within 0.5 m of the base's middle where the second turn is at pi, and no nearer.
///
///     base (+)------ 1 ------(elbow)--- 0.5 ---(+) hand
class PlanarArm {
 public:
  explicit PlanarArm(double base_radius, double elbow_limit = 0) {
    auto tree = std::make_shared<KinematicTree>("planar");
    for (const char* link : {"base", "upper", "hand"}) tree->addLink(link);
    Joint shoulder;
    shoulder.name = "shoulder";
    shoulder.parent = "base";
    shoulder.child = "upper";
    shoulder.type = JointType::revolute;
    shoulder.axis = Vector3d::UnitZ();
    Joint elbow = shoulder;
    elbow.name = "elbow";
    elbow.parent = "upper";
    elbow.child = "hand";
    elbow.origin.translation().x() = 1;
    elbow.lower = -elbow_limit;
    elbow.upper = elbow_limit;
    tree->addJoint(shoulder);
    tree->addJoint(elbow);
    base_ = std::make_shared<fcl::Sphered>(base_radius);
    base_object_ = std::make_shared<fcl::CollisionObjectd>(base_);
    hand_object_ = std::make_shared<fcl::CollisionObjectd>(std::make_shared<fcl::Sphered>(0.1));
    tree_ = tree;
  }
  ArticulatedCollisionManager manager() const {
    ArticulatedCollisionManager manager(tree_);
    manager.bind("base", base_object_);
    Isometry3d at_end = Isometry3d::Identity();
    at_end.translation().x() = 0.5;
    manager.bind("hand", hand_object_, at_end);
    return manager;
  }
  fcl::Sphered& base() { return *base_; }

 private:
  std::shared_ptr<const KinematicTree> tree_;
  std::shared_ptr<fcl::Sphered> base_;
  std::shared_ptr<fcl::CollisionObjectd> base_object_, hand_object_;
};

CertifiedRequest any() {
  CertifiedRequest request;
  request.mode = ContactMode::any;
  return request;
}

constexpr double kPi = 3.14159265358979323846;

TEST(LinkPairs, NeverIsProvenUpToNearlyTheDistance) {
  const ArticulatedCollisionManager manager = PlanarArm(0.3).manager();  // they keep 0.1 m
  LinkPairOptions options;
  for (const double margin : {0.0, 0.05, 0.09}) {
    options.margin = margin;
    const LinkPairReport report = manager.classifyLinkPairs(options);
    ASSERT_EQ(report.pairs.size(), 1u);
    EXPECT_EQ(report.pairs[0].kind, LinkPairKind::never) << margin;
    EXPECT_TRUE(report.pairs[0].proven);
    EXPECT_EQ(report.pairs[0].configuration.size(), 0);
    EXPECT_TRUE(report.needNoCheck().allowed("hand", "base"));
    EXPECT_FALSE(report.alwaysTouching().allowed("hand", "base"));
  }
  // A margin that only elbows within 0.01 rad or so of pi break: no configuration tried evenly does.
  options.margin = 0.10002;
  options.samples = 40;
  const LinkPairFinding finding = manager.classifyLinkPairs(options).pairs.at(0);
  EXPECT_EQ(finding.kind, LinkPairKind::sometimes);
  ASSERT_EQ(finding.configuration.size(), 2);
  EXPECT_NEAR(std::abs(finding.configuration[1]), kPi, 0.03);
}

TEST(LinkPairs, SometimesShowsWhere) {
  const ArticulatedCollisionManager manager = PlanarArm(0.6).manager();
  const LinkPairReport report = manager.classifyLinkPairs();
  const LinkPairFinding& finding = report.pairs.at(0);
  EXPECT_EQ(finding.kind, LinkPairKind::sometimes);
  EXPECT_EQ(finding.tried, 1000u);
  // In contact where 1.25 + cos(elbow) <= 0.7^2: that is a share of acos(0.76) / pi of all elbows.
  EXPECT_NEAR(static_cast<double>(finding.touching) / 1000, std::acos(0.76) / kPi, 0.02);
  ASSERT_EQ(finding.configuration.size(), 2);
  EXPECT_LE(1.25 + std::cos(finding.configuration[1]), 0.49);
  EXPECT_EQ(finding.nearest, 0);
  EXPECT_FALSE(report.needNoCheck().allowed("hand", "base"));
  std::ostringstream out;
  out << finding;
  EXPECT_NE(out.str().find("base and hand: sometimes"), std::string::npos) << out.str();
}

// They touch where the elbow is within 0.05 rad of pi: a cone of the range that the one sample, at rest, is far from.
TEST(LinkPairs, ASearchFindsContactsThatSamplesMiss) {
  const PlanarArm arm(0.401);
  LinkPairOptions options;
  options.samples = 1;
  const LinkPairReport report = arm.manager().classifyLinkPairs(options);
  const LinkPairFinding* pair = nullptr;
  for (const LinkPairFinding& finding : report.pairs) {
    if (finding.link1 == "base" && finding.link2 == "hand") pair = &finding;
  }
  ASSERT_NE(pair, nullptr);
  EXPECT_EQ(pair->kind, LinkPairKind::sometimes);
  EXPECT_EQ(pair->tried, 2u);
  EXPECT_EQ(pair->touching, 1u);
  ASSERT_EQ(pair->configuration.size(), 2);
  EXPECT_LT(std::abs(std::remainder(pair->configuration[1] - M_PI, 2 * M_PI)), 0.07);
}

TEST(LinkPairs, AlwaysIsSaidOfWhatTouchesInAllThatWasTried) {
  const LinkPairReport report = PlanarArm(1.5).manager().classifyLinkPairs();
  EXPECT_EQ(report.pairs.at(0).kind, LinkPairKind::always);
  EXPECT_FALSE(report.pairs.at(0).proven);
  EXPECT_EQ(report.pairs.at(0).touching, report.pairs.at(0).tried);
  EXPECT_TRUE(report.alwaysTouching().allowed("hand", "base"));
}

TEST(LinkPairs, ProofsHoldWithinTheLimitsOnly) {
  PlanarArm arm(0.6, 2);  // the elbow's limits keep the hand away
  ArticulatedCollisionManager manager = arm.manager();
  const LinkPairReport report = manager.classifyLinkPairs();
  ASSERT_EQ(report.pairs.at(0).kind, LinkPairKind::never);
  manager.setLinkPairProofs(report.proofs);
  manager.setup();
  const CertifiedResult within = manager.continuousCollide(Vector2d(-9, -2), Vector2d(9, 2), any());
  EXPECT_TRUE(within.isFree());
  EXPECT_EQ(within.statistics.pairs_after_culling, 0u);
  EXPECT_EQ(within.statistics.node_tests + within.statistics.leaf_tests, 0u);
  const CertifiedResult beyond = manager.continuousCollide(Vector2d(0, -2), Vector2d(0, kPi));
  EXPECT_EQ(beyond.status, Status::contact);
  EXPECT_TRUE(beyond.certain);
  // Curved: both ends are within the limits, the middle is not.
  Eigen::MatrixXd coefficients(2, 3);
  coefficients << 0, 0, 0, 1.9, 4, -4;
  const JointMotion there_and_back = JointMotion::polynomial(manager.tree(), coefficients);
  EXPECT_EQ(manager.continuousCollide(there_and_back).status, Status::contact);
}

TEST(LinkPairs, ProofsServeNoLargerMargin) {
  PlanarArm arm(0.3);
  ArticulatedCollisionManager manager = arm.manager();
  LinkPairOptions options;
  options.margin = 0.05;
  manager.setLinkPairProofs(manager.classifyLinkPairs(options).proofs);
  manager.setup();
  CertifiedRequest request = any();
  for (const double margin : {0.05, 0.2}) {
    request.margin = margin;
    const CertifiedResult result = manager.continuousCollide(Vector2d(0, 3), Vector2d(0, kPi), request);
    EXPECT_EQ(result.isFree(), margin < 0.1);
    EXPECT_EQ(result.statistics.pairs_after_culling, margin > 0.05 ? 1u : 0u);
  }
  request.margin = 0;
  request.added_margin = 0.2;
  EXPECT_FALSE(manager.continuousCollide(Vector2d(0, 3), Vector2d(0, kPi), request).isFree());
  manager.setMargin("base", "hand", 0.2);
  manager.setup();
  EXPECT_FALSE(manager.continuousCollide(Vector2d(0, 3), Vector2d(0, kPi), any()).isFree());
}

TEST(LinkPairs, ProofsAreOfTheVeryGeometry) {
  PlanarArm arm(0.3);
  ArticulatedCollisionManager manager = arm.manager();
  const auto proofs = manager.classifyLinkPairs().proofs;
  manager.setLinkPairProofs(proofs);
  manager.setup();
  const auto isFree = [&] { return manager.isFree(Vector2d(0, 3), Vector2d(0, kPi)); };
  EXPECT_TRUE(isFree());
  arm.base().radius = 0.5;  // in place
  manager.update();
  EXPECT_FALSE(isFree());
  arm.base().radius = 0.3;
  manager.update();
  EXPECT_TRUE(isFree());

  // They serve another manager if all is the same by content, and do no harm if it is not. (That a pair is left out
  // does not tell: its table knows as much. The count of allowed pairs does.)
  const auto proven = [&](ArticulatedCollisionManager other) {
    other.setLinkPairProofs(proofs);
    other.allow("base", "hand");
    other.setup();
    return other.continuousCollide(Vector2d(0, 3), Vector2d(0, 3.1), any()).unproven_allowed_pairs == 0;
  };
  EXPECT_TRUE(proven(PlanarArm(0.3).manager()));
  EXPECT_FALSE(proven(PlanarArm(0.3001).manager()));
  EXPECT_FALSE(proven(PlanarArm(0.3, 3.2).manager()));
  manager.setLinkPairProofs(nullptr);
  manager.setup();
  EXPECT_TRUE(isFree());
}

TEST(LinkPairs, AnswersCountAllowedPairsThatNothingProvesApart) {
  PlanarArm arm(0.3, 3);
  ArticulatedCollisionManager manager = arm.manager();
  fcl::CollisionObjectd table(std::make_shared<fcl::Boxd>(1, 1, 0.1));
  table.setTranslation(Vector3d(0, 0, -1));
  manager.registerObject(&table, "table");
  manager.allow("base", "hand");
  manager.allow("table", "base");
  manager.setup();
  const auto unproven = [&](double elbow, const CertifiedRequest& request = any()) {
    return manager.continuousCollide(Vector2d(0, 0), Vector2d(0, elbow), request).unproven_allowed_pairs;
  };
  EXPECT_EQ(unproven(2), 2u);
  manager.setLinkPairProofs(manager.classifyLinkPairs().proofs);
  manager.setup();
  EXPECT_EQ(unproven(2), 1u);
  EXPECT_EQ(unproven(3.2), 2u);  // beyond the limits
  CertifiedRequest wide = any();
  wide.margin = 0.01;
  EXPECT_EQ(unproven(2, wide), 2u);         // the proof is for no margin
  manager.setMargin("base", "hand", 0.01);  // its own, though nobody asks for the pair
  manager.setup();
  EXPECT_EQ(unproven(2), 2u);
  manager.setMargin("base", "hand", 0);
  manager.setup();
  EXPECT_EQ(unproven(2), 1u);
  EXPECT_EQ(unproven(2, wide), 1u);  // its own counts
  wide.added_margin = 0.01;
  EXPECT_EQ(unproven(2, wide), 2u);
  manager.resetMargins();
  manager.setMargin("hand", 0.01);
  manager.setup();
  EXPECT_EQ(unproven(2), 2u);
  manager.resetMargins();
  manager.setMargin("upper", 0.01);  // other pairs' margins are not this one's
  manager.setup();
  EXPECT_EQ(unproven(2), 1u);
  manager.resetMargins();
  manager.setup();
  CertifiedRequest self_only = any();
  self_only.check_scene = false;
  EXPECT_EQ(unproven(2, self_only), 0u);
  CertifiedRequest scene_only = any();
  scene_only.check_self = false;
  EXPECT_EQ(unproven(3.2, scene_only), 1u);
  EXPECT_EQ(manager.collide(Vector2d(0, 3.2)).unproven_allowed_pairs, 2u);

  std::ostringstream out;
  out << manager.continuousCollide(Vector2d(0, 0), Vector2d(0, 3.2));
  EXPECT_EQ(out.str(), "free: proven, but for 2 allowed pairs not proven apart");
  out.str("");
  out << manager.continuousCollide(Vector2d(0, 0), Vector2d(0, 2));
  EXPECT_EQ(out.str(), "free: proven, but for 1 allowed pair not proven apart");

  // A trajectory has those that any of its pieces has.
  const auto& tree = manager.tree();
  const JointTrajectory trajectory =
      JointTrajectory::linear(tree, {0, 1, 2}, {Vector2d(0, 0), Vector2d(0, 2), Vector2d(0, 3.2)});
  EXPECT_EQ(manager.continuousCollide(trajectory).unproven_allowed_pairs, 2u);
}

TEST(LinkPairs, TheSameOverThreads) {
  const ArticulatedCollisionManager manager = PlanarArm(0.6).manager();
  LinkPairOptions options;
  options.threads = 1;
  const LinkPairFinding one = manager.classifyLinkPairs(options).pairs.at(0);
  options.threads = 4;
  const LinkPairFinding four = manager.classifyLinkPairs(options).pairs.at(0);
  EXPECT_EQ(one.touching, four.touching);
  EXPECT_EQ(one.configuration, four.configuration);
}

TEST(LinkPairs, WithinASolidMeshIsContact) {
  PlanarArm arm(0.01);
  const auto tree = arm.manager().sharedTree();
  // A mesh around everything: its surface is never touched.
  auto mesh = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
  fcl::generateBVHModel(*mesh, fcl::Boxd(6, 6, 6), Isometry3d::Identity());
  const auto hand = std::make_shared<fcl::CollisionObjectd>(std::make_shared<fcl::Sphered>(0.1));
  const auto kindWith = [&](const std::shared_ptr<fcl::CollisionGeometryd>& geometry) {
    ArticulatedCollisionManager manager(tree);
    manager.bind("base", std::make_shared<fcl::CollisionObjectd>(geometry));
    manager.bind("hand", hand);
    return manager.classifyLinkPairs().pairs.at(0).kind;
  };
  EXPECT_EQ(kindWith(mesh), LinkPairKind::never);
  EXPECT_EQ(kindWith(makeSolid(*mesh)), LinkPairKind::always);
}

TEST(LinkPairs, SeveralGeometriesOfALinkAreOnePair) {
  PlanarArm arm(0.3);
  ArticulatedCollisionManager manager = arm.manager();
  const auto extra = std::make_shared<fcl::CollisionObjectd>(std::make_shared<fcl::Sphered>(0.05));
  Isometry3d far = Isometry3d::Identity();
  far.translation().z() = 1;
  manager.bind("base", extra, far);
  LinkPairReport report = manager.classifyLinkPairs();
  ASSERT_EQ(report.pairs.size(), 1u);
  EXPECT_EQ(report.pairs[0].kind, LinkPairKind::never);
  // One that the hand sweeps over makes the pair one that touches, though the others never do.
  Isometry3d on_way = Isometry3d::Identity();
  on_way.translation().x() = 1.4;
  const auto in_the_way = std::make_shared<fcl::CollisionObjectd>(std::make_shared<fcl::Sphered>(0.2));
  manager.bind("base", in_the_way, on_way);
  report = manager.classifyLinkPairs();
  ASSERT_EQ(report.pairs.size(), 1u);
  EXPECT_EQ(report.pairs[0].kind, LinkPairKind::sometimes);
  manager.setLinkPairProofs(report.proofs);
  manager.allow("base", "hand");
  manager.setup();
  EXPECT_EQ(manager.continuousCollide(Vector2d(0, 0), Vector2d(0, 1)).unproven_allowed_pairs, 1u);
}

/// Two carts on rails from one root; pieces that leave the limits of the one, then of the other.
std::shared_ptr<KinematicTree> twoCarts() {
  auto tree = std::make_shared<KinematicTree>("carts");
  for (const char* link : {"root", "a0", "a", "b0", "b"}) tree->addLink(link);
  const auto rail = [&](const char* name, const char* parent, const char* child, double lower, double upper) {
    tree->addJoint(Joint::prismatic(name, parent, child, Vector3d::UnitX(), Isometry3d::Identity(), lower, upper));
  };
  rail("ja0", "root", "a0", 2, 3);
  rail("ja", "a0", "a", 2, 3);
  rail("jb0", "root", "b0", -3, -2);
  rail("jb", "b0", "b", -3, -2);
  return tree;
}

std::shared_ptr<fcl::CollisionObjectd> ball(double radius) {
  return std::make_shared<fcl::CollisionObjectd>(std::make_shared<fcl::Sphered>(radius));
}

TEST(LinkPairs, ATrajectoryCountsEachPairThatAnyPieceLeavesUnproven) {
  ArticulatedCollisionManager manager(twoCarts());
  for (const char* link : {"root", "a0", "a", "b0", "b"}) manager.bind(link, ball(0.1));
  manager.setLinkPairProofs(manager.classifyLinkPairs().proofs);
  manager.allow("root", "a");
  manager.allow("root", "b");
  manager.setup();
  const VectorXd in = Eigen::Vector4d(2.5, 2.5, -2.5, -2.5), a_out = Eigen::Vector4d(2.5, 3.5, -2.5, -2.5),
                 b_out = Eigen::Vector4d(2.5, 2.5, -2.5, -3.5);
  const auto unproven = [&](const std::vector<VectorXd>& way) {
    std::vector<double> times;
    for (std::size_t i = 0; i < way.size(); ++i) times.push_back(static_cast<double>(i));
    return manager.continuousCollide(JointTrajectory::linear(manager.tree(), times, way)).unproven_allowed_pairs;
  };
  EXPECT_EQ(unproven({in, in}), 0u);
  EXPECT_EQ(unproven({in, a_out, in}), 1u);
  EXPECT_EQ(unproven({in, a_out, in, b_out, in}), 2u);
}

TEST(LinkPairs, GeometriesBoundInAnyOrderTakeTheirOwnValues) {
  // There is one pair, but some paths begin at a and some at b.
  auto tree = std::make_shared<KinematicTree>("t");
  for (const char* link : {"root", "a", "b"}) tree->addLink(link);
  tree->addJoint(Joint::prismatic("ja", "root", "a", Vector3d::UnitX(), Isometry3d::Identity(), 5, 6));
  tree->addJoint(Joint::prismatic("jb", "root", "b", Vector3d::UnitX(), Isometry3d::Identity(), 0, 1));
  ArticulatedCollisionManager manager(tree);
  const auto bind = [&](const char* link, double radius, const Vector3d& at) {
    manager.bind(link, ball(radius), Isometry3d(Eigen::Translation3d(at)));
  };
  bind("a", 0.2, {0, 50, 0});
  bind("b", 0.1, {0, 0, 0});
  bind("a", 0.1, {1, 0, 0});
  LinkPairOptions options;
  options.samples = 200;
  const auto kindAt = [&](double margin) {
    options.margin = margin;
    return manager.classifyLinkPairs(options).pairs.at(0).kind;
  };
  // Their distance is from 5 + 1 - 1 - 0.2 to 6 + 1 - 0 - 0.2 m.
  EXPECT_EQ(kindAt(4.7), LinkPairKind::never);
  EXPECT_EQ(kindAt(4.9), LinkPairKind::sometimes);
  EXPECT_EQ(kindAt(6.9), LinkPairKind::always);
}

TEST(LinkPairs, OnlyTheseAndProgress) {
  const ArticulatedCollisionManager manager = PlanarArm(0.3).manager();
  AllowedCollisionMatrix none;
  LinkPairOptions options;
  options.only = &none;
  EXPECT_TRUE(manager.classifyLinkPairs(options).pairs.empty());
  none.allow("hand", "base");
  std::vector<std::pair<std::size_t, std::size_t>> told;
  options.progress = [&](std::size_t done, std::size_t total) { told.emplace_back(done, total); };
  EXPECT_EQ(manager.classifyLinkPairs(options).pairs.size(), 1u);
  EXPECT_EQ(told, (std::vector<std::pair<std::size_t, std::size_t>>{{1, 1}}));
}

TEST(LinkPairs, RefusesBadOptions) {
  const ArticulatedCollisionManager manager = PlanarArm(0.3).manager();
  LinkPairOptions options;
  options.margin = -1;
  EXPECT_THROW(static_cast<void>(manager.classifyLinkPairs(options)), std::invalid_argument);
  options.margin = std::nan("");
  EXPECT_THROW(static_cast<void>(manager.classifyLinkPairs(options)), std::invalid_argument);
  options = {};
  options.samples = 0;
  EXPECT_THROW(static_cast<void>(manager.classifyLinkPairs(options)), std::invalid_argument);
  options = {};
  options.threads = -1;
  EXPECT_THROW(static_cast<void>(manager.classifyLinkPairs(options)), std::invalid_argument);
}

}  // namespace

}  // namespace link_pairs_test
