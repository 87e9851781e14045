// SPDX-License-Identifier: BSD-3-Clause
//
// doc/PROMISE.md, "When an answer is decided": a gap that stays above margin + tolerance_distance ends as `free`, and a
// contact into which bodies go fast enough as `certain`. Bodies of all kinds face each other along x, so that a plane
// says how far apart they are, whatever the engine says.

#include <cmath>
#include <string>

#include <fcl/geometry/shape/sphere.h>
#include <fcl/math/motion/interp_motion.h>
#include <fcl/math/motion/translation_motion.h>
#include <gtest/gtest.h>

#include "fcl_artic/continuous_collision.h"
#include "fcl_artic/fcl_artic.h"
#include "geometries.h"
#include "random.h"

namespace decided_test {

namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using fcl_artic::CertifiedPairResult;
using fcl_artic::CertifiedRequest;
using fcl_artic::ContactMode;
using fcl_artic::Status;
using Body = dropin::Geometry<double>;

/// `still` reaches up to x = 0 from the left; `moving`, turned about z by half a turn, down to x = gap from the right.
Isometry3d placeStill(const Body& body) {
  Isometry3d M = Isometry3d::Identity();
  M.linear() = body.turn;
  M.translation() = Vector3d(-body.reach, 0, 0);
  return M;
}
Isometry3d placeMoving(const Body& body, double gap, const Vector3d& aside = Vector3d::Zero(), double spin = 0) {
  const Eigen::Matrix3d half_turn = Vector3d(-1, -1, 1).asDiagonal();
  Isometry3d M = Isometry3d::Identity();
  M.linear() = AngleAxisd(spin, Vector3d::UnitX()).toRotationMatrix() * half_turn * body.turn;
  M.translation() = Vector3d(body.reach + gap, 0, 0) + aside;
  return M;
}

CertifiedPairResult ask(const Body& a, const Body& b, const Isometry3d& from, const Isometry3d& to,
                        const CertifiedRequest& request) {
  const fcl::TranslationMotiond rest(placeStill(a), placeStill(a));
  CertifiedPairResult result;
  if (from.linear() == to.linear()) {
    const fcl::TranslationMotiond go(from, to);
    fcl_artic::continuousCollide(a.geometry.get(), &rest, b.geometry.get(), &go, request, result);
  } else {
    const fcl::InterpMotion<double> go(from.linear(), from.translation(), to.linear(), to.translation(),
                                       Vector3d::Zero());
    fcl_artic::continuousCollide(a.geometry.get(), &rest, b.geometry.get(), &go, request, result);
  }
  return result;
}

CertifiedRequest anyRequest(pairs::Random& random) {
  CertifiedRequest request;
  request.tolerance_distance = std::pow(10, random.uniform(-10, -3));
  request.tolerance_time = std::pow(10, random.uniform(-9, -3));
  if (random.chance(0.5)) request.margin = std::pow(10, random.uniform(-6, -1));
  if (random.chance(0.3)) request.added_margin = std::pow(10, random.uniform(-6, -2));
  if (random.chance(0.3)) request.mode = ContactMode::any;
  if (random.chance(0.2)) request.method = fcl_artic::Method::redon2004;
  return request;
}

/// Sizes are 1 m, and the path has one factor: its pad is below this (NUMERICS, section 9).
constexpr double kPad = 1e-12;

TEST(Decided, AGapAboveTheToleranceEndsFree) {
  const std::vector<Body> bodies = dropin::allGeometries();
  pairs::Random random(50);
  int asked = 0, slid = 0, turned = 0, returned = 0;
  for (const Body& a : bodies) {
    for (const Body& b : bodies) {
      if (a.unbounded && b.unbounded) continue;  // they meet unless they stay parallel, however far away
      for (int i = 0; i < 6; ++i) {
        const CertifiedRequest request = anyRequest(random);
        const double margin = request.margin + request.added_margin;
        const double gap = margin + request.tolerance_distance * (1 + 1e-6) + kPad;
        const double angle = random.uniform(0, 2 * M_PI);
        const Vector3d aside = random.uniform(0, 2) * Vector3d(0, std::cos(angle), std::sin(angle));
        Isometry3d from, to;
        if (i % 3 == 0) {  // past each other, all the time at this gap
          from = placeMoving(b, gap, aside);
          to = placeMoving(b, gap, -aside);
          ++slid;
        } else if (i % 3 == 1) {  // about the axis through both
          from = placeMoving(b, gap);
          to = placeMoving(b, gap, Vector3d::Zero(), random.uniform(0.1, 3));
          ++turned;
        } else {  // from afar down to this gap
          from = placeMoving(b, gap + random.uniform(0, 1), aside);
          to = placeMoving(b, gap);
          ++returned;
        }
        if (a.unbounded && i % 3 == 1) continue;  // a body that turns about a plane's normal: the same question
        const CertifiedPairResult result = ask(a, b, from, to, request);
        EXPECT_EQ(result.status, Status::free)
            << a.name << ", " << b.name << ", motion " << i % 3 << ", tolerance " << request.tolerance_distance
            << ", margin " << margin << ": " << result.t_lower;
        ++asked;
      }
    }
  }
  std::printf("%d asked; %d slid, %d turned, %d came near\n", asked, slid, turned, returned);
  EXPECT_GT(asked, 2000);
}

/// A ball goes round another one at a gap of margin + tolerance_distance, without turning, so no direction serves for
/// long in either's frame. The tolerance of time is so coarse that the search comes to its finest part of the motion
/// before the ball has gone round. There it may take a near ball for a contact.
TEST(Decided, AGapAboveTheToleranceEndsFreeHoweverCoarseTheToleranceOfTime) {
  using namespace fcl_artic;
  pairs::Random random(52);
  for (int i = 0; i < 8; ++i) {
    CertifiedRequest request;
    request.tolerance_distance = std::pow(10, random.uniform(-9, -8));
    request.tolerance_time = random.uniform(0.2, 1);
    if (i % 2) request.margin = random.uniform(0, 0.1);
    Isometry3d reach = Isometry3d::Identity();
    reach.translation().x() = 0.5 + request.margin + request.tolerance_distance * (1 + 1e-6) + 4 * kPad;
    auto tree = std::make_shared<KinematicTree>("arm");
    for (const char* name : {"base", "arm", "ball"}) tree->addLink(name);
    tree->addJoint(Joint::revolute("shoulder", "base", "arm", Vector3d::UnitZ()));
    tree->addJoint(Joint::revolute("wrist", "arm", "ball", Vector3d::UnitZ(), reach));
    ArticulatedCollisionManager manager(tree);
    manager.bind("ball", std::make_shared<fcl::CollisionObjectd>(std::make_shared<fcl::Sphered>(0.2)));
    manager.registerObject(std::make_shared<fcl::CollisionObjectd>(std::make_shared<fcl::Sphered>(0.3)));
    manager.setup();
    const double turn = random.uniform(1, 3);
    CertifiedResult result;
    manager.continuousCollide(JointMotion::linear(*tree, Eigen::Vector2d(0, 0), Eigen::Vector2d(turn, -turn)), request,
                              result);
    EXPECT_EQ(result.status, Status::free)
        << "case " << i << ", tolerance " << request.tolerance_distance << ": " << result.t_lower;
  }
}

/// Whether the body is one convex piece with an interior, or what an unbounded one borders.
bool isOnePiece(const Body& body) {
  switch (body.geometry->getNodeType()) {
    case fcl::GEOM_BOX:
    case fcl::GEOM_SPHERE:
    case fcl::GEOM_ELLIPSOID:
    case fcl::GEOM_CAPSULE:
    case fcl::GEOM_CONE:
    case fcl::GEOM_CYLINDER:
    case fcl::GEOM_CONVEX:
    case fcl::GEOM_HALFSPACE:
    case fcl::GEOM_PLANE:
      return true;
    default:
      return false;
  }
}

TEST(Decided, AContactIntoWhichBodiesGoIsCertain) {
  const std::vector<Body> bodies = dropin::allGeometries();
  pairs::Random random(51);
  int deep = 0, flat = 0, certain_flat = 0;
  for (const Body& a : bodies) {
    for (const Body& b : bodies) {
      if (a.unbounded && b.unbounded) continue;
      for (int i = 0; i < 12; ++i) {
        const CertifiedRequest request = anyRequest(random);
        const double margin = request.margin + request.added_margin;
        // They go this far into each other within tolerance_time.
        const double way = std::pow(10, random.uniform(-10, -3)), speed = way / request.tolerance_time;
        if (speed > 0.4) continue;
        const double before = random.uniform(0.1, 0.9) * speed, t = before / speed;
        const CertifiedPairResult result =
            ask(a, b, placeMoving(b, margin + before), placeMoving(b, margin + before - speed), request);
        ASSERT_EQ(result.status, Status::contact) << a.name << ", " << b.name;
        EXPECT_LE(result.t_lower, t + kPad / speed + 1e-15);
        // Grown by a margin two triangles in one plane have a depth; without, where they pass through each other, none.
        if (margin > 0 || (isOnePiece(a) && isOnePiece(b))) {
          EXPECT_TRUE(result.certain) << a.name << ", " << b.name << ", " << way << " m within "
                                      << request.tolerance_time << ", margin " << margin << ", tolerance "
                                      << request.tolerance_distance;
          ++deep;
        } else {
          ++flat;
          certain_flat += result.certain;
        }
        EXPECT_GE(result.t_upper, result.certain ? t - kPad / speed - 1e-15 : 1);
      }
    }
  }
  std::printf("%d of pieces with a depth, all certain; of %d others, %d\n", deep, flat, certain_flat);
  EXPECT_GT(deep, 1000);
  EXPECT_GT(flat, 300);
  EXPECT_GT(certain_flat, 0.95 * flat);
}

}  // namespace

}  // namespace decided_test
