// SPDX-License-Identifier: BSD-3-Clause
//
// Certificates of answers, and what the verifier makes of them.
#include <array>

#include <gtest/gtest.h>

#include <fcl/geometry/octree/octree.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/cone.h>
#include <fcl/geometry/shape/ellipsoid.h>
#include <fcl/geometry/shape/halfspace.h>
#include <fcl/geometry/shape/plane.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/math/motion/translation_motion.h>

#include "certificate/sha256.h"
#include "fcl_artic/fcl_artic.h"
#include "proof.h"
#include "report.h"

namespace fcl_artic {
namespace certificate_test {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

std::shared_ptr<fcl::CollisionObjectd> ball(double radius, const Vector3d& at = Vector3d::Zero()) {
  return std::make_shared<fcl::CollisionObjectd>(std::make_shared<fcl::Sphered>(radius), Eigen::Matrix3d::Identity(),
                                                 at);
}
std::shared_ptr<fcl::CollisionObjectd> box(const Vector3d& size, const Vector3d& at = Vector3d::Zero()) {
  return std::make_shared<fcl::CollisionObjectd>(std::make_shared<fcl::Boxd>(size), Eigen::Matrix3d::Identity(), at);
}

verify::Verdict verdictOn(const Certificate& certificate) {
  const verify::World world = verify::readWorld(*certificate.world);
  const std::string record = certificate.record();
  return verify::verifyRecord(world, verify::splitRecords(record).at(0));
}
void expectProven(const std::shared_ptr<const Certificate>& certificate) {
  ASSERT_TRUE(certificate);
  ASSERT_TRUE(*certificate) << certificate->missing;
  const verify::Verdict verdict = verdictOn(*certificate);
  EXPECT_TRUE(verdict.verified) << verdict.reason << "\n" << *certificate->world << certificate->motion;
}
bool hasLine(const std::string& text, const std::string& line) {
  return text.find("\n" + line + "\n") != std::string::npos;
}

/// base - slider (along x) - arm (about z, 1 m long): boxes of 0.2 m on all links, 1 m apart.
class Machine : public ::testing::Test {
 protected:
  Machine() : tree_(std::make_shared<KinematicTree>("machine")) {
    for (const char* link : {"base", "slider", "arm", "hand"}) tree_->addLink(link);
    tree_->addJoint(Joint::prismatic("slide", "base", "slider", Vector3d::UnitX(), at(0, 0, 1)));
    tree_->addJoint(Joint::revolute("turn", "slider", "arm", Vector3d::UnitZ(), at(0, 0, 1)));
    tree_->addJoint(Joint::revolute("wrist", "arm", "hand", Vector3d::UnitX(), at(1, 0, 0)));
    manager_ = std::make_unique<ArticulatedCollisionManager>(tree_);
    for (const char* link : {"base", "slider", "arm", "hand"}) manager_->bind(link, box({0.2, 0.2, 0.2}));
    post_ = box({0.2, 0.2, 4}, {1.5, 0.6, 0});
    manager_->registerObject(post_, "post");
  }
  static Isometry3d at(double x, double y, double z) { return Isometry3d(Eigen::Translation3d(x, y, z)); }

  CertifiedResult ask(const Vector3d& q0, const Vector3d& q1, CertifiedRequest request = {}) {
    manager_->setup();
    request.certificate = true;
    return manager_->continuousCollide(q0, q1, request);
  }

  std::shared_ptr<KinematicTree> tree_;
  std::unique_ptr<ArticulatedCollisionManager> manager_;
  std::shared_ptr<fcl::CollisionObjectd> post_;
};

TEST(Sha256, OfTheStandardsExamples) {
  using certificate::sha256Text;
  EXPECT_EQ(sha256Text(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256Text("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256Text("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(sha256Text(std::string(1000000, 'a')), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST_F(Machine, OnlyThoseWhoAskGetOne) {
  manager_->setup();
  const CertifiedResult result = manager_->continuousCollide(Vector3d(0, 0, 0), Vector3d(0, -1, 0));
  EXPECT_TRUE(result.isFree());
  EXPECT_FALSE(result.certificate);
}

TEST_F(Machine, AFreeMotionIsProvenAgain) {
  const CertifiedResult result = ask({0, 0, 0}, {0, -1, 0.5});
  ASSERT_TRUE(result.isFree());
  expectProven(result.certificate);
  // The post with all but the base, which stands still beside it, and five pairs of links.
  EXPECT_EQ(verdictOn(*result.certificate).checked, 8u);
  EXPECT_LT(result.certificate->proof.size(), 120u);
}

TEST_F(Machine, AContactIsProvenFromBothSides) {
  const CertifiedResult result = ask({0, 0, 0}, {1.2, 1, 0.5});
  ASSERT_TRUE(result.certain);
  expectProven(result.certificate);
  const verify::Verdict verdict = verdictOn(*result.certificate);
  EXPECT_TRUE(verdict.contact);
  EXPECT_LT(verdict.until, result.t_lower);
  EXPECT_GT(verdict.until, result.t_lower - 2e-6);
}

TEST_F(Machine, ALargerMarginIsAnotherClaim) {
  CertifiedRequest request;
  request.margin = 0.05;
  const CertifiedResult result = ask({0, 0, 0}, {0, -1, 0.5}, request);
  ASSERT_TRUE(result.isFree());
  expectProven(result.certificate);
  // The same proof of 1 m: neither by this motion's hash nor by the right one.
  Certificate forged = *result.certificate;
  const std::string line = "margin 0x1.999999999999ap-5";
  ASSERT_NE(forged.motion.find(line), std::string::npos);
  forged.motion.replace(forged.motion.find(line), line.size(), "margin 0x1p+0");
  EXPECT_FALSE(verdictOn(forged).verified);
  const auto hash = certificate::sha256(forged.motion);
  forged.proof.replace(0, hash.size(), reinterpret_cast<const char*>(hash.data()), hash.size());
  const verify::Verdict verdict = verdictOn(forged);
  EXPECT_FALSE(verdict.verified);
  EXPECT_FALSE(verdict.bad_input) << verdict.reason;
}

TEST_F(Machine, MarginsOfBodiesAndPairsAreStated) {
  manager_->setMargin("post", 0.02);
  manager_->setMargin("hand", "post", 0.25);
  CertifiedRequest request;
  request.added_margin = 0.125;
  const CertifiedResult result = ask({0, 0, 0}, {0, -1, 0.5}, request);
  ASSERT_TRUE(result.isFree());
  expectProven(result.certificate);
  EXPECT_TRUE(hasLine(*result.certificate->world, "margin hand post 0x1p-2"));
  EXPECT_TRUE(hasLine(*result.certificate->world, "margin post 0x1.47ae147ae147bp-6"));
  EXPECT_TRUE(hasLine(result.certificate->motion, "added 0x1p-3"));
}

TEST_F(Machine, WhatIsNotCheckedIsSaidWithItsReason) {
  manager_->allow("base", "hand");
  const auto cup = ball(0.1, {3, 3, 3});
  manager_->registerObject(cup, "a cup");
  manager_->attach("hand", cup.get(), at(0.25, 0, 0), {"arm"});
  const CertifiedResult result = ask({0, 0, 0}, {0, -1, 0.5});
  ASSERT_TRUE(result.isFree());
  expectProven(result.certificate);
  const std::string& world = *result.certificate->world;
  // The slide has no limits: its neighbours can't be decided. The others are proven apart, and checked for touching.
  for (const char* line : {"unchecked allowed base hand", "unchecked neighbours base slider",
                           "unchecked touch-link a%20cup arm", "margin arm slider 0x0p+0", "margin arm hand 0x0p+0"}) {
    EXPECT_TRUE(hasLine(world, line)) << line << "\n" << world;
  }
}

TEST_F(Machine, TheWorldIsSharedUntilTheNextSetup) {
  manager_->setup();
  CertifiedRequest request;
  request.certificate = true;
  std::vector<CertifiedResult> results;
  const std::vector<JointMotion> motions = {JointMotion::linear(*tree_, Vector3d(0, 0, 0), Vector3d(0, -1, 0)),
                                            JointMotion::linear(*tree_, Vector3d(0, -1, 0), Vector3d(-1, -1, 0))};
  manager_->continuousCollide(motions, request, results, 2);
  for (const CertifiedResult& result : results) expectProven(result.certificate);
  EXPECT_EQ(results[0].certificate->world, results[1].certificate->world);
  const auto before = results[0].certificate->world;

  post_->setTranslation(Vector3d(1.5, 0.8, 0));
  manager_->update(post_.get());
  const CertifiedResult moved = manager_->continuousCollide(motions[0], request);
  expectProven(moved.certificate);
  EXPECT_NE(*moved.certificate->world, *before);
  // The old proof is of another world.
  Certificate mixed = *results[0].certificate;
  mixed.world = moved.certificate->world;
  EXPECT_FALSE(verdictOn(mixed).verified);
}

TEST_F(Machine, ATrajectoryAmongMovingObstaclesIsProvenPieceByPiece) {
  const auto motion =
      std::make_shared<fcl::TranslationMotion<double>>(fcl::Transform3d(at(2, -3, 2)), fcl::Transform3d(at(2, 3, 2)));
  fcl::ContinuousCollisionObjectd passer(std::make_shared<fcl::Sphered>(0.2), motion);
  manager_->registerObject(&passer, "passer");
  manager_->setup();
  CertifiedRequest request;
  request.certificate = true;
  const auto trajectory =
      JointTrajectory::linear(*tree_, {0, 1, 2}, {Vector3d(0, 0, 0), Vector3d(-1, -0.5, 0), Vector3d(-1, -1, 1)});
  const CertifiedResult result = manager_->continuousCollide(trajectory, request);
  ASSERT_TRUE(result.isFree());
  expectProven(result.certificate);
  EXPECT_EQ(verdictOn(*result.certificate).pieces, 2u);
}

TEST_F(Machine, InitialContactsAreLeftOutUntilTheyEnd) {
  manager_->unregisterObject(post_.get());
  const auto floor = box({0.5, 0.5, 0.2}, {0, 0, -0.15});
  manager_->registerObject(floor, "floor");
  manager_->disallow("base", "floor");  // else they stand still against each other, and nobody asks
  CertifiedRequest request;
  request.ignore_initial_contact = true;
  const CertifiedResult result = ask({0, 0, 0}, {0, -1, 0.5}, request);
  ASSERT_TRUE(result.isFree());
  ASSERT_EQ(result.ignored_initial_contacts.size(), 1u);
  expectProven(result.certificate);
  EXPECT_NE(result.certificate->motion.find("\nignored 0 1 0x1p+0\n"), std::string::npos);
}

TEST_F(Machine, AWallThatMovesAmongOthers) {
  const auto moves = [&](std::shared_ptr<fcl::CollisionGeometryd> geometry, const Vector3d& from, const char* name) {
    const Isometry3d begin(Eigen::Translation3d{from}), end(Eigen::Translation3d{from + Vector3d(0, 0.1, 0)});
    manager_->registerObject(
        std::shared_ptr<const fcl::ContinuousCollisionObjectd>(std::make_shared<fcl::ContinuousCollisionObjectd>(
            geometry, std::make_shared<fcl::TranslationMotion<double>>(begin, end))),
        name);
  };
  moves(std::make_shared<fcl::Sphered>(0.1), {0, 3, 0}, "ball");
  moves(std::make_shared<fcl::Planed>(Vector3d(1, 1, 0), 9.0), {0, 0, 0}, "wall");
  moves(std::make_shared<fcl::Sphered>(0.1), {0, 3, 1}, "another ball");
  const CertifiedResult result = ask({0, 0, 0}, {0, -1, 0.5});
  ASSERT_TRUE(result.isFree());
  expectProven(result.certificate);
}

TEST_F(Machine, WhereNothingIsCheckedNothingIsClaimed) {
  CertifiedRequest request;
  request.check_self = request.check_scene = false;
  const CertifiedResult result = ask({0, 0, 0}, {0, -1, 0.5}, request);
  ASSERT_TRUE(result.certificate);
  EXPECT_FALSE(*result.certificate);
  EXPECT_NE(result.certificate->missing.find("nothing is claimed"), std::string::npos) << result.certificate->missing;
  // A scene that is asked for and has no obstacle is no claim either: fcl_artic_verify would refuse it.
  manager_->unregisterObject(post_.get());
  request.check_scene = true;
  const CertifiedResult empty = ask({0, 0, 0}, {0, -1, 0.5}, request);
  ASSERT_TRUE(empty.certificate);
  EXPECT_FALSE(*empty.certificate);
  EXPECT_NE(empty.certificate->missing.find("no pair of bodies is checked"), std::string::npos)
      << empty.certificate->missing;
}

TEST(Certificates, OfJointsThatTurnSeveralTimes) {
  const auto tree = std::make_shared<KinematicTree>("ball joint");
  tree->addLink("base");
  tree->addLink("rod");
  Joint joint;
  joint.name = "joint";
  joint.type = JointType::spherical;
  joint.parent = "base";
  joint.child = "rod";
  tree->addJoint(joint);
  ArticulatedCollisionManager manager(tree);
  manager.bind("rod", box({1, 0.1, 0.1}));
  const auto far = ball(0.1, {1, 0, 0}), near = ball(0.1, {0.3, 0.3, 0.3});
  manager.registerObject(far);
  manager.registerObject(near);
  manager.setup();
  Eigen::MatrixXd c = Eigen::MatrixXd::Zero(4, 2);  // about x, twice
  c(3, 0) = 1;
  c(0, 1) = 12;
  CertifiedRequest request;
  request.certificate = true;
  const CertifiedResult result = manager.continuousCollide(JointMotion::polynomial(*tree, c), request);
  ASSERT_TRUE(result.isFree());
  expectProven(result.certificate);
}

/// Sizes that enter by squares, or by a product of three squares, must show in the verifier's last digits.
TEST(CertificatesOfPairs, ContactsOfSmallShapesAreProven) {
  const auto at = [](double x, double y) { return fcl::Transform3d(Eigen::Translation3d(x, y, 0)); };
  int proven = 0;
  for (const double s : {1e-2, 1e-3, 2e-4}) {
    const fcl::Ellipsoidd ellipsoid(s, s, 0.8 * s);
    const fcl::Coned cone(s, 2 * s);
    const fcl::Boxd block(s, s, s);
    for (const fcl::CollisionGeometryd* moving : {static_cast<const fcl::CollisionGeometryd*>(&ellipsoid),
                                                  static_cast<const fcl::CollisionGeometryd*>(&cone)}) {
      for (const double margin : {0.0, 0.2 * s}) {
        CertifiedPairRequest request;
        request.certificate = true;
        request.margin = margin;
        CertifiedPairResult result;
        continuousCollide(moving, at(-4 * s, 0.1 * s), at(4 * s, 0.1 * s), &block, at(0, 0), at(0, 0), fcl::CCDM_TRANS,
                          request, result);
        ASSERT_TRUE(result.certain);
        expectProven(result.certificate);
        proven += verdictOn(*result.certificate).contact;
      }
    }
  }
  EXPECT_GE(proven, 10);
}

/// A proof by pieces says nothing about bodies within a closed surface, unless the mesh is a solid.
TEST(CertificatesOfPairs, ASolidIsNotItsSurface) {
  auto mesh = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
  std::vector<Vector3d> corners;
  for (int i = 0; i < 8; ++i) corners.emplace_back(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
  const int faces[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                            {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  std::vector<fcl::Triangle> triangles;
  for (const auto& f : faces) triangles.emplace_back(f[0], f[1], f[2]);
  mesh->beginModel();
  mesh->addSubModel(corners, triangles);
  mesh->endModel();
  const fcl::Sphered ball(0.2);
  CertifiedPairRequest request;
  request.certificate = true;
  CertifiedPairResult result;
  const auto ask = [&](const fcl::CollisionGeometryd& o1, double from, double to) {
    continuousCollide(&o1, fcl::Transform3d::Identity(), fcl::Transform3d::Identity(), &ball,
                      fcl::Transform3d(Eigen::Translation3d(from, 0, 0)),
                      fcl::Transform3d(Eigen::Translation3d(to, 0, 0)), fcl::CCDM_LINEAR, request, result);
  };
  ask(*mesh, -0.5, 0.5);
  ASSERT_TRUE(result.isFree());
  expectProven(result.certificate);
  // The same proof for a solid is refused.
  Certificate forged = *result.certificate;
  std::string world = *forged.world;
  world.replace(world.find("mesh surface"), 12, "mesh solid");
  const std::string hash = certificate::sha256Text(world);
  forged.motion.replace(forged.motion.find("world ") + 6, hash.size(), hash);
  const auto bytes = certificate::sha256(forged.motion);
  forged.proof.replace(0, bytes.size(), reinterpret_cast<const char*>(bytes.data()), bytes.size());
  forged.world = std::make_shared<const std::string>(world);
  const verify::Verdict verdict = verdictOn(forged);
  EXPECT_FALSE(verdict.verified);
  EXPECT_FALSE(verdict.bad_input) << verdict.reason;

  const auto solid = makeSolid(*mesh);
  ask(*solid, 1.5, 3);
  ASSERT_TRUE(result.isFree());
  expectProven(result.certificate);
  ask(*solid, 0, 0.5);
  EXPECT_FALSE(result.isFree());
  EXPECT_FALSE(*result.certificate);  // they touch from the beginning on
}

/// In the notch of an L no direction parts a ball from all of the solid. So the solid is cut, and the proof names the
/// points that show that neither body is in the other.
TEST(CertificatesOfPairs, ASolidThatIsCutNamesItsPoints) {
  const double outline[6][2] = {{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}};
  std::vector<Vector3d> corners;
  for (const double z : {0.0, 1.0}) {
    for (const auto& p : outline) corners.emplace_back(p[0], p[1], z);
  }
  std::vector<fcl::Triangle> triangles;
  for (const auto& [a, b, c] : {std::array{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}}) {
    triangles.emplace_back(6 + a, 6 + b, 6 + c);
    triangles.emplace_back(a, c, b);
  }
  for (int i = 0; i < 6; ++i) {
    const int j = (i + 1) % 6;
    triangles.emplace_back(i, j, 6 + j);
    triangles.emplace_back(i, 6 + j, 6 + i);
  }
  fcl::BVHModel<fcl::OBBRSSd> surface;
  surface.beginModel();
  surface.addSubModel(corners, triangles);
  surface.endModel();
  const auto solid = makeSolid(surface);
  std::vector<Vector3d> small;
  for (const Vector3d& p : corners) small.push_back(0.05 * p);
  fcl::BVHModel<fcl::OBBRSSd> small_surface;
  small_surface.beginModel();
  small_surface.addSubModel(small, triangles);
  small_surface.endModel();
  const auto small_solid = makeSolid(small_surface);
  const fcl::Sphered ball(0.2);
  CertifiedPairRequest request;
  request.certificate = true;
  for (const fcl::CollisionGeometryd* other :
       {static_cast<const fcl::CollisionGeometryd*>(&ball), static_cast<const fcl::CollisionGeometryd*>(&small_surface),
        static_cast<const fcl::CollisionGeometryd*>(small_solid.get())}) {
    const fcl::Transform3d from(Eigen::Translation3d(1.5, 1.5, 0.5)), to(Eigen::Translation3d(1.6, 1.7, 0.4)),
        still = fcl::Transform3d::Identity();
    CertifiedPairResult one, two;
    continuousCollide(solid.get(), still, still, other, from, to, fcl::CCDM_LINEAR, request, one);
    continuousCollide(other, from, to, solid.get(), still, still, fcl::CCDM_LINEAR, request, two);
    for (const CertifiedPairResult& result : {one, two}) {
      ASSERT_TRUE(result.isFree());
      expectProven(result.certificate);
      const std::string record = result.certificate->record();
      const std::string text =
          verify::proofAsJson(verify::readWorld(*result.certificate->world), verify::splitRecords(record).at(0));
      EXPECT_NE(text.find("\"outside\": [["), std::string::npos) << text;
    }
  }
}

#if FCL_HAVE_OCTOMAP
/// A query reads the cells near the motion only; a certificate is about the whole map.
TEST(CertificatesOfPairs, AMapIsStatedWhole) {
  auto map = std::make_shared<octomap::OcTree>(0.1);
  for (double x = 0.05; x < 10; x += 0.1) map->updateNode(octomap::point3d(static_cast<float>(x), 0, 0), true);
  const fcl::OcTree<double> tree(map);
  const fcl::Sphered ball(0.2);
  CertifiedPairRequest request;
  request.certificate = true;
  CertifiedPairResult result;
  continuousCollide(&tree, fcl::Transform3d::Identity(), fcl::Transform3d::Identity(), &ball,
                    fcl::Transform3d(Eigen::Translation3d(0, 1, 0)), fcl::Transform3d(Eigen::Translation3d(0, 2, 0)),
                    fcl::CCDM_LINEAR, request, result);
  ASSERT_TRUE(result.isFree());
  expectProven(result.certificate);
  EXPECT_TRUE(hasLine(*result.certificate->world, "cells 100"));
}
#endif

TEST(CertificatesOfPairs, HalfSpacesAreToldByTheirNormals) {
  const fcl::Halfspaced ground(Vector3d::UnitZ(), 0);
  const fcl::Boxd block(1, 1, 1);
  CertifiedPairRequest request;
  request.certificate = true;
  CertifiedPairResult result;
  continuousCollide(&ground, fcl::Transform3d::Identity(), fcl::Transform3d::Identity(), &block,
                    fcl::Transform3d(Eigen::Translation3d(0, 0, 1)), fcl::Transform3d(Eigen::Translation3d(50, 0, 0.9)),
                    fcl::CCDM_LINEAR, request, result);
  ASSERT_TRUE(result.isFree());
  expectProven(result.certificate);
  EXPECT_EQ(result.certificate->proof.size(), 33u);  // one byte
}

/// Moves as only its author knows.
class Secret : public fcl::MotionBase<double>, public BoundedMotion {
 public:
  bool integrate(double) const override { return true; }
  double computeMotionBound(const fcl::BVMotionBoundVisitor<double>&) const override { return 0; }
  double computeMotionBound(const fcl::TriangleMotionBoundVisitor<double>&) const override { return 0; }
  void getCurrentTransform(fcl::Transform3d& tf) const override { tf.setIdentity(); }
  void getTaylorModel(fcl::TMatrix3<double>&, fcl::TVector3<double>&) const override {}
  State state(double) const override { return {}; }
  Bounds bounds(double, double) const override { return {}; }
};

TEST(CertificatesOfPairs, WhereThereIsNoneTheReasonIsSaid) {
  const Secret secret;
  const fcl::TranslationMotion<double> still(fcl::Transform3d(Eigen::Translation3d(2, 0, 0)),
                                             fcl::Transform3d(Eigen::Translation3d(3, 0, 0)));
  const fcl::Sphered ball(0.2);
  CertifiedPairRequest request;
  request.certificate = true;
  CertifiedPairResult result;
  continuousCollide(&ball, &secret, &ball, &still, request, result);
  ASSERT_TRUE(result.isFree());
  ASSERT_TRUE(result.certificate);
  EXPECT_FALSE(*result.certificate);
  EXPECT_NE(result.certificate->missing.find("BoundedMotion"), std::string::npos) << result.certificate->missing;
  EXPECT_TRUE(result.certificate->proof.empty());
}

TEST(CertificatesOfPairs, OfTwoHalfSpacesThereIsNone) {
  // The answer comes from a point in the place of one of them, which is nothing to prove about the two.
  const fcl::Halfspaced below(Vector3d::UnitZ(), -1), above(-Vector3d::UnitZ(), -1);
  const fcl::Transform3d here = fcl::Transform3d::Identity();
  const fcl::TranslationMotion<double> still(here, here), rises(here, fcl::Transform3d(Eigen::Translation3d(0, 0, 1)));
  CertifiedPairRequest request;
  request.certificate = true;
  CertifiedPairResult result;
  continuousCollide(&below, &still, &above, &rises, request, result);
  EXPECT_TRUE(result.isFree());
  ASSERT_TRUE(result.certificate);
  EXPECT_FALSE(*result.certificate);
}

TEST(CertificatesOfPairs, AManagerOfManyPairsRefuses) {
  ContinuousCollisionManager manager;
  manager.setup();
  CertifiedPairRequest request;
  request.certificate = true;
  CertifiedPairsResult result;
  EXPECT_THROW(manager.continuousCollide(request, result), std::invalid_argument);
}

}  // namespace
}  // namespace certificate_test
}  // namespace fcl_artic
