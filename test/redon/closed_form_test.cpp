// SPDX-License-Identifier: BSD-3-Clause
// Contacts whose time is known in closed form, solved by the paper's method.
#include <cmath>

#include <gtest/gtest.h>

#include "fcl_artic/fcl_artic.h"
#include "meshes.h"

namespace closed_form_test {

namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using fcl_artic::CertifiedPairResult;
using fcl_artic::CertifiedRequest;
using fcl_artic::FeatureKind;
using fcl_artic::Status;
using redon_test::boxMesh;
using redon_test::triangle;

constexpr double kPi = 3.14159265358979323846;

Isometry3d at(double x, double y, double z) {
  return Isometry3d(Eigen::Translation3d(x, y, z));
}

CertifiedRequest paper() {
  CertifiedRequest request;
  request.method = fcl_artic::Method::redon2004;
  request.max_contacts = 100;
  return request;
}

/// Body 1 goes straight from tf1 to end1; body 2 stands still.
CertifiedPairResult slide(const fcl::CollisionGeometryd& body1, const Isometry3d& begin1, const Isometry3d& end1,
                          const fcl::CollisionGeometryd& body2, const Isometry3d& tf2,
                          const CertifiedRequest& request = paper()) {
  CertifiedPairResult result;
  fcl_artic::continuousCollide(&body1, begin1, end1, &body2, tf2, tf2, fcl::CCDM_TRANS, request, result);
  return result;
}

void expectContactAt(const CertifiedPairResult& result, double t) {
  ASSERT_EQ(result.status, Status::contact);
  EXPECT_LE(result.t_lower, t);
  EXPECT_GE(result.t_lower, t - 1e-6);
  if (result.certain) {
    EXPECT_GE(result.t_upper, t);
    EXPECT_LE(result.t_upper, t + 1e-6);
  }
  EXPECT_EQ(result.statistics.redon.pairs_by_standard, 0u);
}

/// A T-junction closed by a sliver that comes first, so that the tip is its own: corners in a line but for the rounding
/// of a turn. Its box takes no part in the walls' orientation.
TEST(ClosedForm, TipOfASliverMeetsFace) {
  const Vector3d tip(0.57999999999999996, 0.57999999999999996, 3.4681054687499995e-20);
  const auto wedge = redon_test::mesh(
      {{0.42, 0.42, 2.5113867187499998e-20},
       {0.099999999999999895, 0.1, 5.9794921875000005e-21},
       tip,
       {0.1, 0.1, -0.3},
       {0.1, 0.1, 0.3}},
      {fcl::Triangle(0, 1, 2), fcl::Triangle(1, 2, 3), fcl::Triangle(2, 0, 4), fcl::Triangle(0, 1, 4)});
  const Vector3d n = Vector3d(1, 1, 0).normalized(), side = Vector3d(1, -1, 0).normalized();
  for (int k = 0; k < 24; ++k) {
    const double angle = k * kPi / 12, far = 3;
    const Vector3d u = std::cos(angle) * side + std::sin(angle) * Vector3d::UnitZ(), v = n.cross(u);
    const Vector3d middle = (tip.dot(n) + 0.13) * n;
    const auto wall = triangle(middle - far * (u + v), middle + far * (2 * u - v), middle + far * (2 * v - u));
    const Vector3d way = 0.14 * n;  // 10 mm beyond
    const CertifiedPairResult result =
        slide(*wedge, at(0, 0, 0), Isometry3d(Eigen::Translation3d(way)), *wall, at(0, 0, 0));
    expectContactAt(result, 0.13 / 0.14);
  }
}

TEST(ClosedForm, VertexMeetsFace) {
  const auto floor = triangle({-1, -1, 0}, {2, -1, 0}, {-1, 2, 0});
  const auto tip = triangle({0, 0, 0}, {0.3, 0.1, 1}, {-0.2, 0.3, 1});
  const CertifiedPairResult result = slide(*tip, at(0, 0, 0.75), at(0, 0, -0.25), *floor, at(0, 0, 0));
  expectContactAt(result, 0.75);
  EXPECT_TRUE(result.certain);
  ASSERT_EQ(result.contacts.size(), 1u);
  EXPECT_EQ(result.contacts[0].feature, FeatureKind::vertexFace);
  EXPECT_NEAR(result.contacts[0].point.norm(), 0, 1e-6);
  EXPECT_NEAR(result.contacts[0].normal.z(), -1, 1e-9);  // from body 1 down to the floor
}

TEST(ClosedForm, FaceMeetsVertex) {
  const auto floor = triangle({-1, -1, 0}, {2, -1, 0}, {-1, 2, 0});
  const auto tip = triangle({0, 0, 0}, {0.3, 0.1, 1}, {-0.2, 0.3, 1});
  const CertifiedPairResult result = slide(*floor, at(0, 0, -0.25), at(0, 0, 0.25), *tip, at(0, 0, 0));
  expectContactAt(result, 0.5);
  ASSERT_EQ(result.contacts.size(), 1u);
  EXPECT_EQ(result.contacts[0].feature, FeatureKind::faceVertex);
  EXPECT_NEAR(result.contacts[0].normal.z(), 1, 1e-9);
}

TEST(ClosedForm, EdgesCross) {
  const auto across = triangle({-1, 0, 0}, {1, 0, 0}, {0, 0.2, 1});
  const auto along = triangle({0, -1, 0}, {0, 1, 0}, {0.2, 0, -1});
  const CertifiedPairResult result = slide(*across, at(0.1, 0.2, 0.6), at(0.1, 0.2, -0.4), *along, at(0, 0, 0));
  expectContactAt(result, 0.6);
  EXPECT_TRUE(result.certain);
  ASSERT_EQ(result.contacts.size(), 1u);
  EXPECT_EQ(result.contacts[0].feature, FeatureKind::edgeEdge);
  EXPECT_LT((result.contacts[0].point - Vector3d(0, 0.2, 0)).norm(), 1e-6);
  EXPECT_NEAR(result.contacts[0].normal.z(), -1, 1e-9);
}

TEST(ClosedForm, SupportingLinesThatMeetOutsideTheEdgesAreNoContact) {
  const auto across = triangle({-1, 0, 0}, {1, 0, 0}, {0, 0.2, 1});
  const auto along = triangle({0, -1, 0}, {0, 1, 0}, {0.2, 0, -1});
  const CertifiedPairResult result = slide(*across, at(1.2, 0.2, 0.6), at(1.2, 0.2, -0.4), *along, at(0, 0, 0));
  EXPECT_EQ(result.status, Status::free);
  EXPECT_EQ(result.statistics.redon.pairs_by_standard, 0u);
}

TEST(ClosedForm, TurningEdgeMeetsEdge) {
  // A needle turns about z and meets a post at distance 0.5 under 30 degrees.
  const auto needle = triangle({0, 0, 0}, {1, 0, 0}, {0.5, 0, 0.1});
  const double x = 0.5 * std::cos(kPi / 6), y = 0.5 * std::sin(kPi / 6);
  const auto post = triangle({x, y, -1}, {x, y, 1}, {2, 2, 0});
  const Isometry3d end(Eigen::AngleAxisd(kPi / 3, Vector3d::UnitZ()));
  CertifiedPairResult result;
  fcl_artic::continuousCollide(needle.get(), Isometry3d::Identity(), end, post.get(), Isometry3d::Identity(),
                               Isometry3d::Identity(), fcl::CCDM_LINEAR, paper(), result);
  expectContactAt(result, 0.5);
  EXPECT_TRUE(result.certain);
}

TEST(ClosedForm, ArmMeetsWallByTheAngleOfItsTip) {
  // Two links of 1 m; the second joint alone turns; its tip, at height sin q, meets a ceiling at 0.5 m when q = 30
  // degrees.
  auto tree = std::make_shared<fcl_artic::KinematicTree>("arm");
  for (const char* name : {"base", "upper", "fore"}) tree->addLink(name);
  fcl_artic::Joint joint;
  joint.type = fcl_artic::JointType::revolute;
  joint.axis = -Vector3d::UnitY();
  joint.name = "shoulder", joint.parent = "base", joint.child = "upper";
  tree->addJoint(joint);
  joint.name = "elbow", joint.parent = "upper", joint.child = "fore", joint.origin = at(1, 0, 0);
  tree->addJoint(joint);
  fcl::CollisionObjectd fore(triangle({0, 0, 0}, {1, 0, 0}, {0.5, 0.1, 0}));
  fcl::CollisionObjectd ceiling(triangle({0, -3, 0.5}, {6, 0, 0.5}, {0, 3, 0.5}));
  fcl_artic::ArticulatedCollisionManager manager(tree);
  manager.bind("fore", &fore);
  manager.registerObject(&ceiling, "ceiling");
  manager.setup();
  const auto motion = fcl_artic::JointMotion::linear(*tree, Eigen::Vector2d(0, 0), Eigen::Vector2d(0, kPi / 4));
  fcl_artic::CertifiedResult result;
  manager.continuousCollide(motion, paper(), result);
  ASSERT_EQ(result.status, Status::contact);
  EXPECT_TRUE(result.certain);
  EXPECT_LE(result.t_lower, 2.0 / 3);
  EXPECT_GE(result.t_upper, 2.0 / 3);
  EXPECT_LE(result.t_upper - result.t_lower, 1e-6);
  EXPECT_LT((result.contacts[0].point - Vector3d(1 + std::sqrt(0.75), 0, 0.5)).norm(), 1e-5);
  EXPECT_GT(result.statistics.redon.box_tests, 0u);
}

TEST(ClosedForm, ParallelEdgesMeetAtAnEndOfTheirCommonPart) {
  // Two roofs, ridge on ridge; the common part of the ridges runs from y = 0 to y = 1.
  const auto roof = triangle({0, 0, 0}, {0, 2, 0}, {0.5, 1, -1});
  const auto upside_down = triangle({0, -1, 0}, {0, 1, 0}, {0.3, 0, 1});
  const CertifiedPairResult result = slide(*upside_down, at(0, 0, 0.5), at(0, 0, -0.5), *roof, at(0, 0, 0));
  expectContactAt(result, 0.5);
  ASSERT_EQ(result.contacts.size(), 1u);
  const Vector3d& point = result.contacts[0].point;
  EXPECT_LT(std::min(point.norm(), (point - Vector3d(0, 1, 0)).norm()), 1e-5) << point.transpose();
}

TEST(ClosedForm, CoplanarTrianglesMeetInTheirPlane) {
  const auto left = triangle({-1, -1, 0}, {0, 0, 0}, {-1, 1, 0});
  const auto right = triangle({0, -1, 0}, {0, 1, 0}, {1, 0, 0});
  expectContactAt(slide(*left, at(-0.25, 0, 0), at(0.25, 0, 0), *right, at(0, 0, 0)), 0.5);
  // Past each other, 10 cm apart, in one plane all the while: every equation vanishes for good.
  EXPECT_EQ(slide(*left, at(-0.1, -3, 0), at(-0.1, 3, 0), *right, at(0, 0, 0)).status, Status::free);
}

TEST(ClosedForm, SegmentsAndPointsAsDegenerateTriangles) {
  const Vector3d a(-1, 0, 0), b(1, 0, 0), tip(0.25, 0.125, 0);
  const auto segment = triangle(a, b, b), point = triangle(tip, tip, tip);
  const auto floor = triangle({-2, -2, 0}, {4, -2, 0}, {-2, 4, 0});
  expectContactAt(slide(*segment, at(0, 0, 0.5), at(0, 0, -0.5), *floor, at(0, 0, 0)), 0.5);
  expectContactAt(slide(*point, at(0, 0, 0.25), at(0, 0, -0.75), *floor, at(0, 0, 0)), 0.25);
  expectContactAt(slide(*point, at(0, 0.375, 0), at(0, -0.625, 0), *segment, at(0, 0, 0)), 0.5);
  EXPECT_EQ(slide(*point, at(0, 0.375, 0.01), at(0, -0.625, 0.01), *segment, at(0, 0, 0)).status, Status::free);
}

TEST(ClosedForm, OfSimultaneousContactsOneIsReported) {
  // Four corners come down on the floor together.
  const auto box = boxMesh(0.5, 0.25, 0.125);
  const auto floor = triangle({-4, -4, 0}, {8, -4, 0}, {-4, 8, 0});
  const CertifiedPairResult result = slide(*box, at(0, 0, 0.625), at(0, 0, -0.375), *floor, at(0, 0, 0));
  expectContactAt(result, 0.5);
  EXPECT_TRUE(result.certain);
  ASSERT_EQ(result.contacts.size(), 1u);
  const Vector3d& point = result.contacts[0].point;
  EXPECT_LT((point.cwiseAbs() - Vector3d(0.5, 0.25, 0)).norm(), 1e-5) << "no corner: " << point.transpose();
}

TEST(ClosedForm, StartInsideASolidIsContactInsideAMeshIsNot) {
  const auto small = boxMesh(0.1, 0.1, 0.1);
  const fcl::Boxd solid(2, 2, 2);
  const auto shell = boxMesh(1, 1, 1);
  const CertifiedPairResult inside = slide(*small, at(0, 0, 0), at(0, 0, 0.1), solid, at(0, 0, 0));
  EXPECT_EQ(inside.status, Status::contact);
  EXPECT_EQ(inside.t_lower, 0);
  EXPECT_EQ(slide(*small, at(0, 0, 0), at(0, 0, 0.1), *shell, at(0, 0, 0)).status, Status::free);
  expectContactAt(slide(*small, at(0, 0, 0), at(0, 0, 1.8), *shell, at(0, 0, 0)), 0.5);
}

TEST(ClosedForm, ABoxShapeIsMetAtItsSides) {
  const fcl::Boxd solid(2, 2, 2);
  expectContactAt(slide(*boxMesh(0.25, 0.25, 0.25), at(3.25, 0.1, 0.2), at(-0.75, 0.1, 0.2), solid, at(0, 0, 0)), 0.5);
}

TEST(ClosedForm, TouchAtTheStartIsTimeZero) {
  const CertifiedPairResult result =
      slide(*boxMesh(1, 1, 1), at(0, 0, 0), at(0, 0, 1), *boxMesh(1, 1, 1), at(0.5, 0.3, 0.2));
  EXPECT_EQ(result.status, Status::contact);
  EXPECT_EQ(result.t_lower, 0);
}

TEST(ClosedForm, WhatThePaperHasNoMethodForIsTheLibrarysOwn) {
  const fcl::Sphered ball(0.5);
  const CertifiedPairResult result = slide(ball, at(0, 0, 2), at(0, 0, 0), *boxMesh(1, 1, 0.5), at(0, 0, 0));
  ASSERT_EQ(result.status, Status::contact);
  EXPECT_NEAR(result.t_lower, 0.5, 1e-6);
  EXPECT_EQ(result.statistics.redon.pairs_by_standard, 1u);
  CertifiedRequest request = paper();
  request.margin = 0.25;
  const CertifiedPairResult near =
      slide(*boxMesh(1, 1, 1), at(0, 0, 4), at(0, 0, 2), *boxMesh(1, 1, 1), at(0, 0, 0), request);
  ASSERT_EQ(near.status, Status::contact);
  EXPECT_NEAR(near.t_lower, 0.875, 1e-6);
}

TEST(ClosedForm, BudgetThatRunsOutKeepsItsLowerBound) {
  CertifiedRequest request = paper();
  request.work_budget = 20;
  const CertifiedPairResult result =
      slide(*boxMesh(1, 1, 1), at(0.1, 0.2, 4), at(0.1, 0.2, 0), *boxMesh(1, 1, 1), at(0, 0, 0), request);
  EXPECT_EQ(result.status, Status::undecided);
  EXPECT_LE(result.t_lower, 0.5);
}

TEST(ClosedForm, OptionsOutOfRangeAreRefused) {
  CertifiedRequest request = paper();
  request.redon.refinement_level = 7;
  CertifiedPairResult result;
  EXPECT_THROW(slide(*boxMesh(1, 1, 1), at(0, 0, 4), at(0, 0, 0), *boxMesh(1, 1, 1), at(0, 0, 0), request),
               std::invalid_argument);
}

}  // namespace

}  // namespace closed_form_test
