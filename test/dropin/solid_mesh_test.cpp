// SPDX-License-Identifier: BSD-3-Clause
//
// SolidMesh in the drop-in: for FCL a mesh, here what it encloses too.
#include "fcl_artic/solid_mesh.h"

#include <gtest/gtest.h>

#include <fcl/math/motion/interp_motion.h>
#include <fcl/narrowphase/collision.h>

#include "fcl_artic/continuous_collision.h"
#include "geometries.h"

namespace solid_mesh_test {

namespace {

using namespace fcl_artic;

template <class S>
fcl::Transform3<S> at(S x) {
  return fcl::Transform3<S>(Eigen::Translation<S, 3>(x, S(0), S(0)));
}

/// A mesh of 2 m around the origin, and a small ball that moves within it.
template <class BV>
void ballWithinAMesh() {
  using S = typename BV::S;
  const auto surface = dropin::boxMesh<BV>(2, 2, 2);
  const SolidMesh<BV> solid(*surface);
  const fcl::Sphere<S> ball(S(0.1));
  fcl::ContinuousCollisionRequest<S> request;
  fcl::ContinuousCollisionResult<S> result;
  for (const bool ball_first : {false, true}) {
    const auto ask = [&](const fcl::CollisionGeometry<S>& mesh, S from, S to) {
      return ball_first
                 ? fcl_artic::continuousCollide<S>(&ball, at(from), at(to), &mesh, at(S(0)), at(S(0)), request, result)
                 : fcl_artic::continuousCollide<S>(&mesh, at(S(0)), at(S(0)), &ball, at(from), at(to), request, result);
    };
    EXPECT_EQ(ask(*surface, S(-0.5), S(0.5)), S(1));
    EXPECT_FALSE(result.is_collide);
    EXPECT_EQ(ask(solid, S(-0.5), S(0.5)), S(0));
    EXPECT_TRUE(result.is_collide);
    EXPECT_EQ(ask(*surface, S(-0.5), S(0.5)), S(1));                       // from the cache, once more
    EXPECT_NEAR(static_cast<double>(ask(solid, S(3), S(1))), 0.95, 1e-5);  // from outside: 3 - 2 t = 1.1
    EXPECT_EQ(ask(solid, S(3), S(2)), S(1));
  }
}

TEST(SolidMesh, OfEveryBoundingVolume) {
  ballWithinAMesh<fcl::AABBd>();
  ballWithinAMesh<fcl::OBBd>();
  ballWithinAMesh<fcl::RSSd>();
  ballWithinAMesh<fcl::kIOSd>();
  ballWithinAMesh<fcl::OBBRSSd>();
  ballWithinAMesh<fcl::KDOP<double, 16>>();
  ballWithinAMesh<fcl::KDOP<double, 18>>();
  ballWithinAMesh<fcl::KDOP<double, 24>>();
  ballWithinAMesh<fcl::OBBRSSf>();
  ballWithinAMesh<fcl::AABBf>();
}

// The certified calls, with all modes; what is ignored at first is ignored until it has left.
TEST(SolidMesh, Certified) {
  const auto solid = makeSolid(*dropin::boxMesh<fcl::OBBRSSd>(2, 2, 2));
  const fcl::Boxd box(0.2, 0.2, 0.2);
  const auto way = [](double from, double to) {  // without the reference point FCL reads one that it never wrote
    const Eigen::Matrix3d straight = Eigen::Matrix3d::Identity();
    return fcl::InterpMotion<double>(straight, {from, 0, 0}, straight, {to, 0, 0}, {0, 0, 0});
  };
  for (const ContactMode mode : {ContactMode::first, ContactMode::any, ContactMode::firstOfEveryPair}) {
    for (const Method method : {Method::standard, Method::redon2004}) {
      CertifiedRequest request;
      request.mode = mode;
      request.method = method;
      CertifiedPairResult result;
      const auto stands = way(0, 0), within = way(0, 0.5), out = way(0, 3);
      EXPECT_EQ(continuousCollide(solid.get(), &stands, &box, &within, request, result), Status::contact);
      EXPECT_TRUE(result.certain);
      EXPECT_EQ(result.t_lower, 0);
      EXPECT_EQ(result.t_upper, 0);
      ASSERT_EQ(result.contacts.size(), 1u);
      EXPECT_LT(result.contacts[0].point.norm(), 0.2);
      EXPECT_EQ(continuousCollide(&box, &within, solid.get(), &stands, request, result), Status::contact);
      EXPECT_EQ(result.t_upper, 0);
      if (mode == ContactMode::any) continue;
      request.ignore_initial_contact = true;
      EXPECT_EQ(continuousCollide(solid.get(), &stands, &box, &out, request, result), Status::free);
      EXPECT_TRUE(result.ignored_initial_contact);
      EXPECT_EQ(continuousCollide(solid.get(), &stands, &box, &within, request, result), Status::free);
      EXPECT_TRUE(result.ignored_initial_contact);
    }
  }
}

// FCL's own collision sees the BVHModel that it is.
TEST(SolidMesh, IsAMeshForFcl) {
  const auto solid = makeSolid(*dropin::boxMesh<fcl::OBBRSSd>(2, 2, 2));
  const fcl::Sphered ball(0.1);
  fcl::CollisionRequestd request;
  fcl::CollisionResultd result;
  EXPECT_EQ(fcl::collide(solid.get(), at(0.0), &ball, at(0.0), request, result), 0u);
  EXPECT_EQ(fcl::collide(solid.get(), at(0.0), &ball, at(1.0), request, result), 1u);
}

TEST(SolidMesh, WhatIsNoneIsRefused) {
  const auto message = [](const auto& call) -> std::string {
    try {
      call();
    } catch (const std::invalid_argument& e) {
      return e.what();
    }
    return "";
  };
  fcl::BVHModel<fcl::RSSd> open;
  open.beginModel();
  open.addTriangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  open.endModel();
  const std::string made = message([&] { makeSolid(open); });
  EXPECT_NE(made.find("BVHModel<RSS>"), std::string::npos) << made;
  EXPECT_NE(made.find("not closed: 3 edges"), std::string::npos) << made;
  const SolidMesh<fcl::RSSd> asked(open);
  const fcl::Sphered ball(0.1);
  fcl::ContinuousCollisionResultd result;
  const std::string refused = message(
      [&] { fcl_artic::continuousCollide<double>(&ball, at(0.0), at(1.0), &asked, at(0.0), at(0.0), {}, result); });
  EXPECT_NE(refused.find("object 2"), std::string::npos) << refused;
  EXPECT_NE(refused.find("not closed"), std::string::npos) << refused;
  EXPECT_NE(message([&] { makeSolid(ball); }).find("Sphere is no mesh"), std::string::npos);
  EXPECT_EQ(message([&] {
              fcl_artic::continuousCollide<double>(&ball, at(5.0), at(6.0), &open, at(0.0), at(0.0), {}, result);
            }),
            "");
}

}  // namespace

}  // namespace solid_mesh_test
