// SPDX-License-Identifier: BSD-3-Clause
//
// Reports of users about FCL's continuous collision, restated with answers worked out by hand. Each test is named for
// its issue.
#include <cmath>
#include <cstring>

#include <fcl/geometry/geometric_shape_to_BVH_model.h>
#include <fcl/math/motion/interp_motion.h>
#include <fcl/math/motion/screw_motion.h>
#include <fcl/math/motion/spline_motion.h>
#include <fcl/math/motion/translation_motion.h>
#include <gtest/gtest.h>

#include "fcl_artic/continuous_collision.h"
#include "geometries.h"

namespace issues_test {

namespace {

using fcl::Transform3d;
using fcl::Vector3d;

constexpr fcl::CCDSolverType kSolvers[] = {fcl::CCDC_NAIVE, fcl::CCDC_CONSERVATIVE_ADVANCEMENT, fcl::CCDC_RAY_SHOOTING,
                                           fcl::CCDC_POLYNOMIAL_SOLVER};
constexpr double kTocErr = 1e-4;  // the request's default
constexpr double kRounding = 1e-13;

Transform3d at(double x, double y, double z) {
  Transform3d M = Transform3d::Identity();
  M.translation() = Vector3d(x, y, z);
  return M;
}
Transform3d at(double x, double y, double z, double angle, const Vector3d& axis) {
  Transform3d M = at(x, y, z);
  M.linear() = Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
  return M;
}

/// Contact at the time expected: never after, and by the tolerance of time before at most.
testing::AssertionResult hitsAt(double expected, double returned, const fcl::ContinuousCollisionResultd& result) {
  if (!result.is_collide) return testing::AssertionFailure() << "missed";
  if (returned != result.time_of_contact) return testing::AssertionFailure() << "returned " << returned;
  if (returned > expected + kRounding)
    return testing::AssertionFailure() << "late: " << returned << ", not " << expected;
  if (returned < expected - kTocErr - 1e-5)
    return testing::AssertionFailure() << "early: " << returned << ", not " << expected;
  return testing::AssertionSuccess();
}

testing::AssertionResult staysFree(double returned, const fcl::ContinuousCollisionResultd& result) {
  if (result.is_collide) return testing::AssertionFailure() << "false alarm at " << result.time_of_contact;
  if (returned != 1 || result.time_of_contact != 1) return testing::AssertionFailure() << "returned " << returned;
  return testing::AssertionSuccess();
}

/// Uniform cubic B-spline at t.
Vector3d bSpline(const Vector3d (&p)[4], double t) {
  const double u = 1 - t;
  return (u * u * u * p[0] + (3 * t * t * t - 6 * t * t + 4) * p[1] + (-3 * t * t * t + 3 * t * t + 3 * t + 1) * p[2] +
          t * t * t * p[3]) /
         6;
}

/// Root of a function that falls from positive to negative on [0, 1].
template <class F>
double fallingRoot(F&& f) {
  double lo = 0, hi = 1;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (lo + hi);
    (f(middle) > 0 ? lo : hi) = middle;
  }
  return 0.5 * (lo + hi);
}

}  // namespace

// A result that said 'contact' once went on saying so.
TEST(Fcl117, ResultOfAnEarlierQueryIsNotKept) {
  const fcl::Boxd box(1, 1, 1);
  for (const auto solver : kSolvers) {
    fcl::ContinuousCollisionRequestd request;
    request.ccd_solver_type = solver;
    fcl::ContinuousCollisionResultd result;
    const auto go = [&](double y) {
      return fcl_artic::continuousCollide<double>(&box, at(0, 0, 0), at(0, 0, 0), &box, at(3, y, 0), at(-3, y, 0),
                                                  request, result);
    };
    ASSERT_TRUE(hitsAt(1.0 / 3, go(0), result));
    EXPECT_TRUE(staysFree(go(2), result));
    EXPECT_EQ(result.contact_tf2.matrix(), at(-3, 2, 0).matrix());  // this query's end, not the contact before
    EXPECT_TRUE(hitsAt(1.0 / 3, go(0), result));
  }
}

// Motions stood at the identity until integrate() was called, which made every query a contact, and a screw without a
// turn went another way than the others.
TEST(Fcl119, MotionsNeedNoIntegrateAndAgreeOnATranslation) {
  const fcl::Sphered sphere(0.5);
  const Transform3d begin = at(1, 1, 1), end = at(2, 2, 2), still = at(3.5, 1.5, 1.5);
  // Centres come from (2.5, .5, .5) to (1.5, -.5, -.5): |c(t)|^2 = (2.5 - t)^2 + 2 (.5 - t)^2 >= 2.166 > 1: free. And
  // the ball at (2.2, 2, 2): (1.2 - t)^2 + 2 (1 - t)^2 = 1 at t = (6.4 - sqrt(6.4^2 - 12 * 2.44)) / 6.
  const Transform3d near = at(2.2, 2, 2);
  const double expected = (6.4 - std::sqrt(6.4 * 6.4 - 12 * 2.44)) / 6;
  const fcl::ContinuousCollisionRequestd request;
  fcl::ContinuousCollisionResultd result;

  const fcl::TranslationMotiond rest(still, still), rest_near(near, near);
  const fcl::TranslationMotiond translation(begin, end);
  const fcl::InterpMotion<double> interp(begin.linear(), begin.translation(), end.linear(), end.translation(),
                                         Vector3d(0, 0, 0));
  for (const fcl::MotionBased* motion :
       {static_cast<const fcl::MotionBased*>(&translation), static_cast<const fcl::MotionBased*>(&interp)}) {
    for (const double state : {-1.0, 0.5, 1.0}) {  // -1: as it was built
      if (state >= 0) motion->integrate(state);
      double t = fcl_artic::continuousCollide<double>(&sphere, motion, &sphere, &rest, request, result);
      EXPECT_TRUE(staysFree(t, result));
      t = fcl_artic::continuousCollide<double>(&sphere, motion, &sphere, &rest_near, request, result);
      EXPECT_TRUE(hitsAt(expected, t, result));
    }
  }
  for (const auto type : {fcl::CCDM_TRANS, fcl::CCDM_LINEAR, fcl::CCDM_SCREW}) {
    fcl::ContinuousCollisionRequestd of_type;
    of_type.ccd_motion_type = type;
    double t = fcl_artic::continuousCollide<double>(&sphere, begin, end, &sphere, still, still, of_type, result);
    EXPECT_TRUE(staysFree(t, result)) << "type " << type;
    t = fcl_artic::continuousCollide<double>(&sphere, begin, end, &sphere, near, near, of_type, result);
    EXPECT_TRUE(hitsAt(expected, t, result)) << "type " << type;
  }
  // The object that FCL builds really goes |d| = sqrt(3) times as far; what it does is what counts. (1.2 - s)^2 + 2 (1
  // - s)^2 = 1 at s = sqrt(3) t.
  const fcl::ScrewMotion<double> screw(begin, end);
  screw.integrate(1);
  Transform3d real_end;
  screw.getCurrentTransform(real_end);
  ASSERT_LT((real_end.translation() - Vector3d::Constant(1 + std::sqrt(3.0))).norm(), 1e-12);
  const double t = fcl_artic::continuousCollide<double>(&sphere, &screw, &sphere, &rest_near, request, result);
  EXPECT_TRUE(hitsAt(expected / std::sqrt(3.0), t, result));
}

// Box against box, head on: conservative advancement steps over the touch that it lands on exactly.
TEST(Fcl120, BoxesHeadOnAtAnyDistance) {
  const fcl::Boxd box(1, 1, 1);
  for (int i = 0; i < 200; ++i) {
    const double start = 1.01 + 0.02 * i, way = 6;
    for (const auto gjk : {fcl::GST_LIBCCD, fcl::GST_INDEP}) {
      const fcl::ContinuousCollisionRequestd request(10, kTocErr, fcl::CCDM_TRANS, gjk,
                                                     fcl::CCDC_CONSERVATIVE_ADVANCEMENT);
      fcl::ContinuousCollisionResultd result;
      const double t = fcl_artic::continuousCollide<double>(&box, at(0, 0, 0), at(0, 0, 0), &box, at(start, 0, 0),
                                                            at(start - way, 0, 0), request, result);
      EXPECT_TRUE(hitsAt((start - 1) / way, t, result)) << "from " << start;
    }
  }
}

// Two balls on splines that pass through each other; one of them is turned by half a turn all the way, which made FCL's
// normals wrong.
TEST(Fcl501, BallsOnSplinesOneOfThemTurned) {
  const double kPi = 3.14159265358979323846;
  const Vector3d a[4] = {{7.55, 8, 0}, {4.18, 8, 0}, {0.82, 8, 0}, {-2.55, 8, 0}};
  const Vector3d b[4] = {{-0.03, 8, 0}, {1.26, 8, 0}, {3.05, 8, 0}, {4.63, 8, 0}};
  const Vector3d turned(0, 0, kPi), zero(0, 0, 0);
  const fcl::SplineMotion<double> motion_a(a[0], a[1], a[2], a[3], turned, turned, turned, turned);
  const fcl::SplineMotion<double> motion_b(b[0], b[1], b[2], b[3], zero, zero, zero, zero);
  const double expected = fallingRoot([&](double t) { return (bSpline(a, t) - bSpline(b, t)).x() - 1; });
  ASSERT_GT(expected, 0.2);
  const fcl::Sphered ball(0.5);
  for (const auto solver : kSolvers) {
    fcl::ContinuousCollisionRequestd request;
    request.ccd_solver_type = solver;
    fcl::ContinuousCollisionResultd result;
    const double t = fcl_artic::continuousCollide<double>(&ball, &motion_a, &ball, &motion_b, request, result);
    EXPECT_TRUE(hitsAt(expected, t, result));
  }
}

// A ball against the mesh of a box, on splines: FCL's recursion never ends.
TEST(Fcl512, BallAgainstMeshOnSplines) {
  const Vector3d a[4] = {{7.5, 8, 0}, {4.2, 8, 0}, {0.8, 8, 0}, {-2.5, 8, 0}};
  const Vector3d b[4] = {{0, 8, 0}, {1.25, 8, 0}, {3, 8, 0}, {4.5, 8, 0}};
  const Vector3d zero(0, 0, 0);
  const auto motion_a = std::make_shared<fcl::SplineMotion<double>>(a[0], a[1], a[2], a[3], zero, zero, zero, zero);
  const auto motion_b = std::make_shared<fcl::SplineMotion<double>>(b[0], b[1], b[2], b[3], zero, zero, zero, zero);
  const double expected = fallingRoot([&](double t) { return (bSpline(a, t) - bSpline(b, t)).x() - 1; });
  const auto ball = std::make_shared<fcl::Sphered>(0.5);
  const auto mesh = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
  fcl::generateBVHModel(*mesh, fcl::Boxd(1, 1, 1), Transform3d::Identity(), fcl::FinalizeModel::DO);
  fcl::ContinuousCollisionRequestd request;
  request.ccd_solver_type = fcl::CCDC_CONSERVATIVE_ADVANCEMENT;
  fcl::ContinuousCollisionResultd result;
  const fcl::ContinuousCollisionObjectd o1(ball, motion_a), o2(mesh, motion_b);
  EXPECT_TRUE(hitsAt(expected, fcl_artic::collide(&o1, &o2, request, result), result));
  EXPECT_TRUE(hitsAt(expected, fcl_artic::collide(&o2, &o1, request, result), result));
}

// Two meshes that approach each other: bounds of opposite sign cancel in FCL, and the first step goes to the end.
//
//     +--+            +--+
//     |1 | ->      <- | 2|     faces meet in the middle
//     +--+            +--+
TEST(Fcl555, MeshesThatApproachEachOther) {
  const auto mesh = dropin::boxMesh<fcl::OBBRSSd>(2, 2, 2);
  for (const auto solver : kSolvers) {
    for (const auto type : {fcl::CCDM_TRANS, fcl::CCDM_LINEAR, fcl::CCDM_SCREW}) {
      fcl::ContinuousCollisionRequestd request;
      request.ccd_motion_type = type;
      request.ccd_solver_type = solver;
      fcl::ContinuousCollisionResultd result;
      // Gap 4 - 8 t.
      const double t = fcl_artic::continuousCollide<double>(mesh.get(), at(0, 0, 3), at(0, 0, -1), mesh.get(),
                                                            at(0, 0, -3), at(0, 0, 1), request, result);
      EXPECT_TRUE(hitsAt(0.5, t, result));
    }
  }
}

// A mesh against a Cylinder ended within libccd. Here the mesh of a box comes down flat on the cylinder's end, turning
// about its axis.
TEST(Fcl637, MeshComesDownOnACylinder) {
  const auto mesh = dropin::boxMesh<fcl::OBBRSSd>(0.5, 0.4, 0.2);
  const fcl::Cylinderd cylinder(0.3, 1);
  fcl::ContinuousCollisionRequestd request;
  request.ccd_motion_type = fcl::CCDM_SCREW;
  for (const auto solver : kSolvers) {
    request.ccd_solver_type = solver;
    for (int i = 0; i <= 10; ++i) {
      const double aside = 0.05 * i;  // less than both half widths together, in any direction
      fcl::ContinuousCollisionResultd result;
      const Transform3d begin = at(aside, 0, 1.6), end = at(aside, 0, -0.4, 2, Vector3d(0, 0, 1)), still = at(0, 0, 0);
      // Bottom at 1.5 - 2 t (a screw along z that starts aside keeps z linear), top of the cylinder at 0.5.
      double t = fcl_artic::continuousCollide<double>(mesh.get(), begin, end, &cylinder, still, still, request, result);
      EXPECT_TRUE(result.is_collide);
      EXPECT_LE(std::abs(t - 0.5), kTocErr + 1e-5) << "aside by " << aside;
      t = fcl_artic::continuousCollide<double>(&cylinder, still, still, mesh.get(), begin, end, request, result);
      EXPECT_LE(std::abs(t - 0.5), kTocErr + 1e-5) << "aside by " << aside;
    }
  }
}

// Any BVHModel ended in a crash.
TEST(PythonFcl10, MeshAsEitherObject) {
  const auto mesh = dropin::boxMesh<fcl::OBBRSSd>(1, 2, 3);
  const auto box = std::make_shared<fcl::Boxd>(1, 2, 3);
  const fcl::CollisionObjectd mesh_object(mesh, at(-4, 0, 0)), box_object(box, at(4, 0, 0));
  const fcl::ContinuousCollisionRequestd request;
  fcl::ContinuousCollisionResultd result;
  // Gap 7 - 14 t.
  double t = fcl_artic::continuousCollide(&mesh_object, at(3, 0, 0), &box_object, at(-3, 0, 0), request, result);
  EXPECT_TRUE(hitsAt(0.5, t, result));
  t = fcl_artic::continuousCollide(&box_object, at(-3, 0, 0), &mesh_object, at(3, 0, 0), request, result);
  EXPECT_TRUE(hitsAt(0.5, t, result));
}

// A box that comes along x to a cone gave another answer each time, as a part of FCL's motion is never initialised. The
// rim of the cone's base and the face of the box meet at x = -1: t = (10 - 1.5) / 20.
TEST(PythonFcl11, SameAnswerEachTimeWhateverWasInMemory) {
  for (const auto type : {fcl::CCDM_TRANS, fcl::CCDM_LINEAR, fcl::CCDM_SCREW}) {
    fcl::ContinuousCollisionRequestd request;
    request.ccd_motion_type = type;
    double first = 0;
    for (int i = 0; i < 100; ++i) {
      {
        std::vector<std::unique_ptr<char[]>> dirt;  // memory that the next ones will get
        for (std::size_t size = 16; size < 4096; size += 16) {
          dirt.emplace_back(new char[size]);
          std::memset(dirt.back().get(), 0x11 * (i % 16), size);
        }
      }
      const auto box = std::make_shared<fcl::Boxd>(1, 2, 3);
      const auto cone = std::make_shared<fcl::Coned>(1, 3);
      const fcl::CollisionObjectd o1(box, at(-10, 0, 0)), o2(cone, at(0, 0, 0));
      fcl::ContinuousCollisionResultd result;
      const double t = fcl_artic::continuousCollide(&o1, at(10, 0, 0), &o2, at(0, 0, 0), request, result);
      ASSERT_TRUE(hitsAt(0.425, t, result));
      if (i == 0) first = t;
      ASSERT_EQ(t, first);
    }
  }
}

// A simple pair of meshes that FCL loses: a cube that falls through another one, from far and from near, and one beside
// it.
TEST(PythonFcl38, CubesOfTriangles) {
  const auto mesh = dropin::boxMesh<fcl::OBBRSSd>(1, 1, 1);
  for (const double start : {1.5, 3.0, 10.0}) {
    fcl::CollisionObjectd falling(mesh, at(0.25, 0.25, start)), still(mesh, at(0, 0, 0));
    const fcl::ContinuousCollisionRequestd request;
    fcl::ContinuousCollisionResultd result;
    double t = fcl_artic::continuousCollide(&falling, at(0.25, 0.25, -start), &still, at(0, 0, 0), request, result);
    EXPECT_TRUE(hitsAt((start - 1) / (2 * start), t, result));
    falling.setTransform(at(1.01, 0, start));
    t = fcl_artic::continuousCollide(&falling, at(1.01, 0, -start), &still, at(0, 0, 0), request, result);
    EXPECT_TRUE(staysFree(t, result));
  }
}

}  // namespace issues_test
