// SPDX-License-Identifier: BSD-3-Clause
//
// Promises of the drop-in beside right times: every overload, both scalars, results in full, bad input, contacts,
// constant inputs.
#include "fcl_artic/continuous_collision.h"

#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <thread>

#include <fcl/broadphase/default_broadphase_callbacks.h>
#include <fcl/math/motion/interp_motion.h>
#include <fcl/math/motion/screw_motion.h>
#include <fcl/math/motion/spline_motion.h>
#include <fcl/math/motion/translation_motion.h>
#include <fcl/narrowphase/collision.h>
#include <gtest/gtest.h>

#include "fcl_artic/bounded_motion.h"
#include "geometries.h"

namespace dropin_test {

namespace {

using fcl::CollisionGeometryd;
using fcl::ContinuousCollisionRequestd;
using fcl::ContinuousCollisionResultd;
using fcl::Transform3d;
using fcl::TranslationMotiond;
using fcl::Vector3d;
using fcl_artic::CertifiedPairResult;
using fcl_artic::CertifiedRequest;
using fcl_artic::Status;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

template <class S = double>
fcl::Transform3<S> at(double x, double y = 0, double z = 0) {
  fcl::Transform3<S> M = fcl::Transform3<S>::Identity();
  M.translation() = Vector3d(x, y, z).cast<S>();
  return M;
}

template <class F>
std::string messageOf(F&& f) {
  try {
    f();
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "nothing was thrown";
}

testing::AssertionResult contains(const std::string& text, const std::string& part) {
  if (text.find(part) != std::string::npos) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "'" << text << "' lacks '" << part << "'";
}

/// A ball of 0.5 that goes from x = -2 to 2, and a cube of 1 around the origin: they touch at x = -1, t = 1/4.
template <class S>
struct BallAndCube {
  std::shared_ptr<fcl::Sphere<S>> ball = std::make_shared<fcl::Sphere<S>>(S(0.5));
  std::shared_ptr<fcl::Box<S>> cube = std::make_shared<fcl::Box<S>>(S(1), S(1), S(1));
  fcl::Transform3<S> begin = at<S>(-2), end = at<S>(2), still = at<S>(0);
  std::shared_ptr<fcl::TranslationMotion<S>> go = std::make_shared<fcl::TranslationMotion<S>>(begin, end);
  std::shared_ptr<fcl::TranslationMotion<S>> rest = std::make_shared<fcl::TranslationMotion<S>>(still, still);
  fcl::ContinuousCollisionRequest<S> request;
  fcl::ContinuousCollisionResult<S> result;
};

template <class S>
class DropInScalar : public testing::Test {};
using Scalars = testing::Types<double, float>;
TYPED_TEST_SUITE(DropInScalar, Scalars, );

}  // namespace

TYPED_TEST(DropInScalar, AllFourOverloadsGiveTheOneAnswer) {
  using S = TypeParam;
  BallAndCube<S> s;
  const fcl::CollisionObject<S> o1(s.ball, s.begin), o2(s.cube, s.still);
  const fcl::ContinuousCollisionObject<S> c1(s.ball, s.go), c2(s.cube, s.rest);
  const std::vector<std::function<S()>> overloads = {
      [&] {
        return fcl_artic::continuousCollide<S>(s.ball.get(), s.go.get(), s.cube.get(), s.rest.get(), s.request,
                                               s.result);
      },
      [&] {
        return fcl_artic::continuousCollide<S>(s.ball.get(), s.begin, s.end, s.cube.get(), s.still, s.still, s.request,
                                               s.result);
      },
      [&] { return fcl_artic::continuousCollide(&o1, s.end, &o2, s.still, s.request, s.result); },
      [&] { return fcl_artic::collide(&c1, &c2, s.request, s.result); },
  };
  for (std::size_t i = 0; i < overloads.size(); ++i) {
    s.result = fcl::ContinuousCollisionResult<S>();
    const S t = overloads[i]();
    EXPECT_TRUE(s.result.is_collide) << i;
    EXPECT_EQ(t, s.result.time_of_contact) << i;
    EXPECT_LE(t, S(0.25)) << i;
    EXPECT_NEAR(static_cast<double>(t), 0.25, 1e-4) << i;
    EXPECT_NEAR(static_cast<double>(s.result.contact_tf1.translation().x()), -2 + 4 * static_cast<double>(t), 1e-6)
        << i;
    EXPECT_EQ(s.result.contact_tf2.matrix(), s.still.matrix()) << i;
  }
}

// The nearest float of a time may be after it: here t = 0.1 + 2^-30 - a little, and the float next to it is above.
TEST(DropIn, TimesInFloatAreNeverLate) {
  const fcl::Sphere<float> ball(0.5f);
  for (int i = 0; i < 200; ++i) {
    const float gap = 0.1f + 0.013f * static_cast<float>(i);
    fcl::ContinuousCollisionRequest<float> request;
    request.toc_err = 1e-9f;
    fcl::ContinuousCollisionResult<float> result;
    const float start = 1 + gap;
    const float t = fcl_artic::continuousCollide<float>(&ball, at<float>(0), at<float>(0), &ball, at<float>(start),
                                                        at<float>(start - 3), request, result);
    ASSERT_TRUE(result.is_collide);
    // In doubles the ends are exact: x = start + t (end - start) = 1.
    const double x0 = static_cast<double>(start), x1 = static_cast<double>(start - 3);
    const double exact = (x0 - 1) / (x0 - x1);
    EXPECT_LE(static_cast<double>(t), exact * (1 + 1e-15));
    EXPECT_NEAR(static_cast<double>(t), exact, 1e-6);
  }
}

TEST(DropIn, FloatGeometriesAllWork) {
  const auto geometries = dropin::allGeometries<float>();
  ASSERT_EQ(geometries.size(), 19u);
  const fcl::Sphere<float> ball(0.25f);
  for (const auto& g : geometries) {
    fcl::Transform3f pose = fcl::Transform3f::Identity();
    pose.linear() = g.turn;
    fcl::ContinuousCollisionResult<float> result;
    // The ball's centre comes from x = reach + 1.25 along -x: gap 1 - 3 t.
    const float from = g.reach + 1.25f;
    const float t =
        fcl_artic::continuousCollide<float>(g.geometry.get(), pose, pose, &ball, at<float>(from), at<float>(from - 3),
                                            fcl::ContinuousCollisionRequestf(), result);
    EXPECT_TRUE(result.is_collide) << g.name;
    EXPECT_NEAR(t, 1.0 / 3, 2e-4) << g.name;
  }
}

// The faces meet at the very end: FCL calls that free.
TEST(DropIn, ContactAtExactlyTheEndIsContact) {
  const fcl::Boxd box(1, 1, 1);
  ContinuousCollisionResultd result;
  const double t = fcl_artic::continuousCollide<double>(&box, at(0), at(0), &box, at(2), at(1),
                                                        ContinuousCollisionRequestd(), result);
  EXPECT_TRUE(result.is_collide);
  EXPECT_LE(t, 1);
  EXPECT_GE(t, 1 - 1e-4);
  fcl_artic::continuousCollide<double>(&box, at(0), at(0), &box, at(2), at(1 + 1e-5), ContinuousCollisionRequestd(),
                                       result);
  EXPECT_FALSE(result.is_collide);
}

TEST(DropIn, ContactAtTheStartIsAtZero) {
  BallAndCube<double> s;
  const double t = fcl_artic::continuousCollide<double>(s.ball.get(), s.still, s.end, s.cube.get(), s.still, s.still,
                                                        s.request, s.result);
  EXPECT_TRUE(s.result.is_collide);
  EXPECT_EQ(t, 0);
}

// A plane has two sides: a contact that nothing proves nor excludes is reported where the box is next to the plane, not
// at the box's far end.
TEST(DropIn, UncertainContactIsOnEitherSideOfAPlane) {
  const fcl::Planed plane(Vector3d(0, 0, 1), 0);
  const fcl::Boxd box(0.2, 0.2, 0.2);
  for (const auto& [side, begin] : {std::pair{1.0, 1.0}, {-1.0, 1.0}, {1.0, 0.1}, {-1.0, 0.1}}) {
    // Comes to the plane, or rests on it all the time.
    const Transform3d far = at(0, 0, begin * side), touching = at(begin == 1 ? 0 : 0.3, 0, 0.1 * side);
    for (const bool plane_first : {true, false}) {
      CertifiedPairResult result;
      if (plane_first) {
        fcl_artic::continuousCollide(&plane, at(0), at(0), &box, far, touching, fcl::CCDM_TRANS, CertifiedRequest(),
                                     result);
      } else {
        fcl_artic::continuousCollide(&box, far, touching, &plane, at(0), at(0), fcl::CCDM_TRANS, CertifiedRequest(),
                                     result);
      }
      ASSERT_EQ(result.contacts.size(), 1u);
      EXPECT_FALSE(result.certain);
      EXPECT_NEAR(result.contacts[0].point.z(), 0, 2e-6);
      EXPECT_NEAR(result.contacts[0].normal.z(), plane_first ? side : -side, 1e-12);
    }
  }
}

// Pieces that are a margin apart have nearest points as far apart, a half-space's or plane's too.
TEST(DropIn, NearestPointsAreAMarginApart) {
  const fcl::Sphered ball(0.5);
  const fcl::Halfspaced below(Vector3d(0, 0, 1), 0);
  const fcl::Planed plane(Vector3d(0, 0, 1), 0);
  const fcl::Boxd box(4, 4, 2);
  CertifiedRequest request;
  request.margin = 0.25;
  const std::pair<const CollisionGeometryd*, double> grounds[] = {{&below, 0}, {&plane, 0}, {&box, -1}};
  for (const auto& [ground, z] : grounds) {
    for (const bool ground_first : {false, true}) {
      CertifiedPairResult result;
      const Transform3d begin = at(0, 0, 3), end = at(0, 0, 0.7), there = at(0, 0, z);
      if (ground_first) {
        fcl_artic::continuousCollide(ground, there, there, &ball, begin, end, fcl::CCDM_TRANS, request, result);
      } else {
        fcl_artic::continuousCollide(&ball, begin, end, ground, there, there, fcl::CCDM_TRANS, request, result);
      }
      ASSERT_EQ(result.contacts.size(), 1u);
      const Vector3d of_ball = ground_first ? result.contacts[0].nearest2 : result.contacts[0].nearest1,
                     of_ground = ground_first ? result.contacts[0].nearest1 : result.contacts[0].nearest2;
      EXPECT_LT((of_ball - Vector3d(0, 0, 0.25)).norm(), 1e-5) << of_ball.transpose();
      EXPECT_LT((of_ground - Vector3d(0, 0, 0)).norm(), 1e-5) << of_ground.transpose();
    }
  }
}

// Where a contact is proven, but not by the equations of two features, its point is the proof's, at t_upper.
TEST(DropIn, PointOfACertainContactIsAtTUpper) {
  // A corner ahead, along y, against a corner.
  const fcl::TrianglePd a(Vector3d(0, 0.25, 0.5), Vector3d(-0.25, 0.5, 0.25), Vector3d(0.25, 0.5, 0));
  const fcl::TrianglePd b(Vector3d(0, -0.5, 0.25), Vector3d(-0.5, -0.5, -0.25), Vector3d(-0.25, -0.25, 0.25));
  Transform3d begin = at(0, -1.75, 0.5), end = at(0, 1.5, 0.5), there = at(-0.25, -0.25, 0);
  begin.linear() << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  end.linear() = begin.linear();
  there.linear() << -1, 0, 0, 0, -1, 0, 0, 0, 1;
  const Vector3d across = (a.b - a.a).cross(a.c - a.a).normalized();
  for (const double tolerance : {1e-6, 0x1p-12, 0.1}) {
    CertifiedRequest request;
    request.tolerance_time = tolerance;
    CertifiedPairResult result;
    fcl_artic::continuousCollide(&a, begin, end, &b, there, there, fcl::CCDM_TRANS, request, result);
    ASSERT_TRUE(result.certain);
    const fcl_artic::CertifiedContact& contact = result.contacts.at(0);
    EXPECT_EQ(contact.feature, fcl_artic::FeatureKind::vertexVertex);
    EXPECT_NEAR(across.dot(result.tf1_at_upper.inverse() * contact.point - a.a), 0, 1e-9) << tolerance;
  }
}

// Half-spaces and planes that are not parallel all along meet at once, however far off; parallel ones where they do.
TEST(DropIn, UnboundedPairsMeetUnlessTheyStayParallel) {
  const fcl::Halfspaced below(Vector3d(0, 0, 1), 0);
  const fcl::Planed plane(Vector3d(0, 0, 1), 0);
  Transform3d high = at(0, 0, 5), higher = at(0, 0, 6), on_its_back = high, tilted = high;
  on_its_back.linear() = Eigen::AngleAxisd(2 * std::acos(0.0), Vector3d::UnitX()).toRotationMatrix();
  tilted.linear() = Eigen::AngleAxisd(1e-3, Vector3d::UnitX()).toRotationMatrix();
  struct Case {
    const CollisionGeometryd *g1, *g2;
    Transform3d begin, end;
    bool contact;
    double time;
  };
  const Case cases[] = {
      {&below, &below, high, higher, true, 0},               // both reach down without end
      {&below, &below, on_its_back, higher, true, 0},        // CCDM_LINEAR turns it
      {&below, &below, on_its_back, on_its_back, false, 1},  // back to back, 5 m apart
      {&below, &plane, high, higher, false, 1},              // above the half-space
      {&plane, &below, high, higher, true, 0},               // the plane is within
      {&below, &plane, high, at(0, 0, -5), true, 0.5},       // comes down on it
      {&plane, &plane, high, higher, false, 1},
      {&plane, &plane, high, at(0, 0, -15), true, 0.25},  // passes
      {&plane, &plane, tilted, tilted, true, 0},          // meet 5 km away
  };
  ContinuousCollisionRequestd request;
  request.ccd_motion_type = fcl::CCDM_LINEAR;
  for (const Case& c : cases) {
    ContinuousCollisionResultd result;
    const double t = fcl_artic::continuousCollide<double>(c.g1, at(0), at(0), c.g2, c.begin, c.end, request, result);
    EXPECT_EQ(result.is_collide, c.contact) << &c - cases;
    EXPECT_LE(t, c.time + 1e-14) << &c - cases;
    EXPECT_GE(t, c.time - 1.1e-4) << &c - cases;
  }
}

/// A pose at each time, which only its author knows.
struct OwnMotion : fcl::MotionBased, fcl_artic::BoundedMotion {
  std::function<Transform3d(double)> pose;
  Bounds of_all;
  bool integrate(double) const override { return true; }
  double computeMotionBound(const fcl::BVMotionBoundVisitor<double>&) const override { return 0; }
  double computeMotionBound(const fcl::TriangleMotionBoundVisitor<double>&) const override { return 0; }
  void getCurrentTransform(Transform3d& M) const override { M = pose(0); }
  void getTaylorModel(fcl::TMatrix3<double>&, fcl::TVector3<double>&) const override {}
  State state(double t) const override {
    State s;
    s.pose = pose(t);
    return s;
  }
  Bounds bounds(double, double) const override { return of_all; }
  bool hasDerivatives() const override { return false; }
};

// A bounded motion may stop turning: a half-space that faces the other one 1 m away from t = 0.3 on, and comes down on
// it at 0.8. That they meet at first, and are not parallel then, does not mean that they never part.
TEST(DropIn, UnboundedPairsAlongABoundedMotion) {
  const fcl::Halfspaced below(Vector3d(0, 0, 1), 0);
  const TranslationMotiond still(at(0), at(0));
  OwnMotion turns;
  turns.of_all.speed = 5.01;
  turns.of_all.angular_speed = 1.68;
  const double pi = 2 * std::acos(0.0);
  turns.pose = [&](double t) {
    Transform3d M = at(0, 0, t < 0.6 ? 1 : 1 - 5 * (t - 0.6));
    if (t < 0.3) M.linear() = Eigen::AngleAxisd(pi - 0.5 * (1 - t / 0.3), Vector3d::UnitX()).toRotationMatrix();
    if (t >= 0.3) M.linear() = Vector3d(1, -1, -1).asDiagonal();
    return M;
  };
  for (const bool ignore : {false, true}) {
    CertifiedRequest request;
    request.ignore_initial_contact = ignore;
    CertifiedPairResult result;
    fcl_artic::continuousCollide(&below, &still, &below, &turns, request, result);
    EXPECT_EQ(result.status, Status::contact) << ignore;
    EXPECT_EQ(result.t_lower, 0) << ignore;
    EXPECT_EQ(result.certain, !ignore);
    EXPECT_FALSE(result.ignored_initial_contact);
  }
  // Its rotation may be off by 5e-13: two that face each other 2 m apart are no proven contact for that.
  int no_contact = 0;
  for (const double off : {0.0, 1e-15, 1e-13, 4e-13}) {
    OwnMotion rests;
    rests.pose = [&](double) {
      Transform3d M = at(0, 0, 2);
      M.linear() = Vector3d(1, -1, -1).asDiagonal();
      M.linear()(1, 2) = M.linear()(2, 1) = off;
      return M;
    };
    CertifiedPairResult result;
    fcl_artic::continuousCollide(&below, &still, &below, &rests, {}, result);
    EXPECT_FALSE(result.certain) << off;
    no_contact += result.isFree();
  }
  EXPECT_EQ(no_contact, 4);
}

/// A body that goes from p by `way`, at constant velocity along n, and turns about n by `angle`.
std::shared_ptr<fcl::MotionBased> turningWay(int kind, const Eigen::Matrix3d& R, const Vector3d& p, const Vector3d& way,
                                             const Vector3d& n, double angle) {
  const Eigen::Matrix3d to = Eigen::AngleAxisd(angle, n) * R;
  if (kind == 0) {  // about a point off the origin
    return std::make_shared<fcl::InterpMotion<double>>(R, p, to, p + way, Vector3d(0.3, 0.2, -0.1));
  }
  if (kind == 1) return std::make_shared<fcl::ScrewMotion<double>>(R, p, to, p + way);
  // A spline's rotation vector stays along n where R is a turn about it, too: here none.
  return std::make_shared<fcl::SplineMotion<double>>(p - way, p, p + way, p + 2 * way, -angle * n, Vector3d::Zero(),
                                                     angle * n, 2 * angle * n);
}

// Half-spaces and planes that turn about their common normal stay parallel. In every order, whichever turns, wherever
// the axis is, their distance goes along a line from 2 m to 1 m (free) or to -2 m (contact at 0.5). A turn about any
// other axis takes them to where they meet.
TEST(DropIn, UnboundedPairsThatTurnAboutTheirNormalStayParallel) {
  struct Kinds {
    bool half1, half2;
  };
  int free = 0, contacts = 0, askew = 0;
  for (int kind = 0; kind < 3; ++kind) {
    for (const double tilt : {0.0, 1e-9, 0.3}) {
      // The world is turned but for splines, whose rotation is 1 at first.
      const Eigen::Matrix3d W =
          kind == 2 ? Eigen::Matrix3d::Identity() : Eigen::AngleAxisd(1.1, Vector3d(1, -2, 2) / 3).toRotationMatrix();
      const Vector3d n = W.col(2), side = W.col(0), axis = (n + tilt * side).normalized();
      for (const Kinds kinds : {Kinds{true, true}, {true, false}, {false, true}, {false, false}}) {
        for (int mover = 1; mover < 4; ++mover) {
          for (const bool hit : {false, true}) {
            // Body 1 is below its boundary, at offset 0.25 along its normal, body 2 looks down on it.
            const Vector3d n1(0, 0, 1), n2(0, 0, -1);
            std::shared_ptr<CollisionGeometryd> g1, g2;
            g1 = std::make_shared<fcl::Halfspaced>(n1, 0.25);
            g2 = std::make_shared<fcl::Halfspaced>(n2, -0.5);
            if (!kinds.half1) g1 = std::make_shared<fcl::Planed>(n1, 0.25);
            if (!kinds.half2) g2 = std::make_shared<fcl::Planed>(n2, -0.5);
            const double closing = hit ? 4 : 1;  // m along n
            const double share1 = mover == 1 ? 1 : mover == 3 ? 0.25 : 0;
            const Vector3d aside = 0.7 * side;
            const Vector3d way1 = share1 * closing * n, way2 = (share1 - 1) * closing * n;
            const auto m1 = turningWay(kind, W, Vector3d(0.1, 0.2, 0.3), way1, axis, mover != 2 ? 0.8 : 0);
            const auto m2 =
                turningWay(kind, W, Vector3d(0.1, 0.2, 0.3) + 1.75 * n + aside, way2, axis, mover != 1 ? 1.3 : 0);
            fcl_artic::CertifiedRequest request;
            fcl_artic::CertifiedPairResult result;
            fcl_artic::continuousCollide(g1.get(), m1.get(), g2.get(), m2.get(), request, result);
            const auto which = ::testing::Message()
                               << "motion " << kind << ", tilt " << tilt << ", half-spaces " << kinds.half1
                               << kinds.half2 << ", mover " << mover << ", hit " << hit;
            if (tilt > 0) {
              EXPECT_EQ(result.status, fcl_artic::Status::contact) << which;
              EXPECT_EQ(result.t_lower, 0) << which;
              ++askew;
            } else if (hit) {
              ASSERT_EQ(result.status, fcl_artic::Status::contact) << which;
              // (That two planes pass each other no single pose proves.)
              EXPECT_EQ(result.certain, kinds.half1 || kinds.half2) << which;
              EXPECT_LE(result.t_lower, 0.5 + 1e-13) << which;
              EXPECT_GE(result.t_lower, 0.5 - 1e-6 - 1e-13) << which;
              EXPECT_GE(result.t_upper, 0.5 - 1e-13) << which;
              ++contacts;
            } else {
              EXPECT_EQ(result.status, fcl_artic::Status::free) << which;
              ++free;
            }
          }
        }
      }
    }
  }
  EXPECT_EQ(free, 36);
  EXPECT_EQ(contacts, 36);
  EXPECT_EQ(askew, 144);
}

// A value that is no tolerance is refused, 0 too, and the message has the number itself, however small.
TEST(DropIn, TolerancesThatAreNoPositiveNumbersAreRefusedByValue) {
  const fcl::Boxd box(1, 1, 1);
  const TranslationMotiond rest(at(0), at(0)), go(at(3), at(2));
  const double inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
  struct Bad {
    double value;
    const char* shown;
    bool margin;  ///< as a margin, too
  };
  for (const Bad& bad :
       {Bad{0.0, " 0,", false}, {-1e-12, " -1e-12,", true}, {inf, " inf,", true}, {nan, " nan,", true}}) {
    for (double fcl_artic::CertifiedRequest::*field :
         {&fcl_artic::CertifiedRequest::tolerance_time, &fcl_artic::CertifiedRequest::tolerance_distance,
          &fcl_artic::CertifiedRequest::margin}) {
      if (field == &fcl_artic::CertifiedRequest::margin && !bad.margin) continue;
      fcl_artic::CertifiedRequest request;
      request.*field = bad.value;
      fcl_artic::CertifiedPairResult result;
      try {
        fcl_artic::continuousCollide(&box, &rest, &box, &go, request, result);
        ADD_FAILURE() << bad.shown << " is accepted";
      } catch (const std::invalid_argument& e) {
        EXPECT_NE(std::string(e.what()).find(bad.shown), std::string::npos) << e.what();
      }
    }
  }
  fcl_artic::CertifiedRequest tiny;
  tiny.tolerance_time = tiny.tolerance_distance = std::numeric_limits<double>::denorm_min();
  fcl_artic::CertifiedPairResult result;
  fcl_artic::continuousCollide(&box, &rest, &box, &go, tiny, result);
  EXPECT_TRUE(result.isFree());
}

// One answer, to the bit, whatever of the request has no meaning.
TEST(DropIn, SolversAndIterationsHaveNoEffect) {
  BallAndCube<double> s;
  const auto ask = [&] {
    return fcl_artic::continuousCollide<double>(s.ball.get(), s.begin, s.end, s.cube.get(), s.still, s.still, s.request,
                                                s.result);
  };
  const double t = ask();
  for (const std::size_t iterations : {0, 1, 10, 1000000}) {
    for (const auto gjk : {fcl::GST_LIBCCD, fcl::GST_INDEP}) {
      for (const auto solver :
           {fcl::CCDC_NAIVE, fcl::CCDC_CONSERVATIVE_ADVANCEMENT, fcl::CCDC_RAY_SHOOTING, fcl::CCDC_POLYNOMIAL_SOLVER}) {
        s.request = ContinuousCollisionRequestd(iterations, 1e-4, fcl::CCDM_TRANS, gjk, solver);
        EXPECT_EQ(ask(), t);
        EXPECT_TRUE(s.result.is_collide);
      }
    }
  }
}

// A ball against a ball that turns about a far point of its own: no line, so that the tolerance shows.
TEST(DropIn, TocErrIsTheToleranceOfTime) {
  // The turning ball's centre is at 2 (cos a, sin a), a = 3 t; the other one's at (0, 2): they touch when the chord is
  // 1, a = pi/2 - 2 asin(1/4).
  const double exact = (std::acos(0.0) - 2 * std::asin(0.25)) / 3;
  const auto ball = std::make_shared<fcl::Sphered>(0.5);
  const Eigen::Matrix3d turned = Eigen::AngleAxisd(3, Vector3d::UnitZ()).toRotationMatrix();
  const fcl::ScrewMotion<double> swing(Eigen::Matrix3d::Identity(), Vector3d(2, 0, 0), turned,
                                       turned * Vector3d(2, 0, 0));
  const TranslationMotiond rest(at(0, 2), at(0, 2));
  double widest = 0;
  for (const double toc_err : {1e-1, 1e-2, 1e-4, 1e-6, 1e-9, 0.0}) {
    ContinuousCollisionRequestd request;
    request.toc_err = toc_err;
    ContinuousCollisionResultd result;
    const double t = fcl_artic::continuousCollide<double>(ball.get(), &swing, ball.get(), &rest, request, result);
    ASSERT_TRUE(result.is_collide);
    EXPECT_LE(t, exact + 1e-14) << toc_err;
    EXPECT_GE(t, exact - toc_err - 1e-12) << toc_err;
    widest = std::max(widest, exact - t);
  }
  EXPECT_GT(widest, 1e-12);  // else nothing was tested
}

// A toc_err of 1 asks whether, not when: any proven contact will do.
TEST(DropIn, TocErrOfOneAsksForAnyContact) {
  const auto cube = std::make_shared<fcl::Boxd>(1, 1, 1);
  const TranslationMotiond rest(at(0, 0), at(0, 0));
  int early = 0;
  for (int i = 0; i < 100; ++i) {
    const double y = -2 + 0.04 * i;  // within 1: it passes through
    const TranslationMotiond through(at(-3, y), at(3, y));
    ContinuousCollisionRequestd request;
    ContinuousCollisionResultd fine, any;
    fcl_artic::continuousCollide<double>(cube.get(), &through, cube.get(), &rest, request, fine);
    for (const double toc_err : {1.0, 7.0}) {
      request.toc_err = toc_err;
      const double t = fcl_artic::continuousCollide<double>(cube.get(), &through, cube.get(), &rest, request, any);
      EXPECT_EQ(any.is_collide, fine.is_collide) << y;
      EXPECT_LE(t, fine.time_of_contact + 1e-12) << y;
      EXPECT_EQ(t, any.time_of_contact);
      EXPECT_LT((any.contact_tf1.translation() - at(-3 + 6 * t, y).translation()).norm(), 1e-12);
      early += t < fine.time_of_contact - 0.01;
    }
  }
  EXPECT_GT(early, 20) << "not when: the first one is not looked for";
}

// A bracket narrower than asked for answers the question as well; it is what costs least.
TEST(DropIn, LooserTocErrIsNoDearer) {
  const auto cube = std::make_shared<fcl::Boxd>(1, 1, 1);
  const auto ask = [&](double toc_err) {
    const fcl::ScrewMotion<double> turn(Eigen::Matrix3d::Identity(), Vector3d(3, 0, 0),
                                        Eigen::AngleAxisd(2, Vector3d::UnitZ()).toRotationMatrix(), Vector3d(0, 1, 0));
    const TranslationMotiond rest(at(0, 0), at(0, 0));
    ContinuousCollisionRequestd request;
    request.toc_err = toc_err;
    ContinuousCollisionResultd result;
    return fcl_artic::continuousCollide<double>(cube.get(), &turn, cube.get(), &rest, request, result);
  };
  EXPECT_EQ(ask(1e-4), ask(0.1));
  EXPECT_EQ(ask(1e-4), ask(0.999));
}

// CCDM_TRANS drops the end's rotation, the others don't: a bar of 4 m beside a ball, that would hit it when it turned.
TEST(DropIn, MotionTypeChoosesTheWay) {
  const fcl::Boxd bar(4, 0.2, 0.2);
  const fcl::Sphered ball(0.2);
  Transform3d turned = at(0);
  turned.linear() = Eigen::AngleAxisd(2, Vector3d::UnitZ()).toRotationMatrix();
  ContinuousCollisionRequestd request;
  ContinuousCollisionResultd result;
  const auto ask = [&] {
    return fcl_artic::continuousCollide<double>(&bar, at(0), turned, &ball, at(0, 1.5), at(0, 1.5), request, result);
  };
  ask();
  EXPECT_FALSE(result.is_collide);
  EXPECT_EQ(result.contact_tf1.matrix(), at(0).matrix());
  // Ball 1.5 off the centre, upper face 0.1 above the bar's line: 1.5 cos(2 t) = 0.3.
  for (const auto type : {fcl::CCDM_LINEAR, fcl::CCDM_SCREW}) {
    request.ccd_motion_type = type;
    const double t = ask();
    EXPECT_TRUE(result.is_collide);
    EXPECT_NEAR(t, std::acos(0.2) / 2, 1.1e-4);
  }
  request.ccd_motion_type = fcl::CCDM_SPLINE;
  EXPECT_TRUE(contains(messageOf(ask), "SPLINE"));
}

TEST(DropIn, BadInputIsNamedAndProvesNothing) {
  BallAndCube<double> s;
  const CollisionGeometryd* none = nullptr;
  const fcl::MotionBased* no_motion = nullptr;
  const fcl::CollisionObjectd* no_object = nullptr;
  const fcl::ContinuousCollisionObjectd* no_moving = nullptr;
  const fcl::CollisionObjectd object(s.cube, s.still);
  const fcl::ContinuousCollisionObjectd moving(s.ball, s.go), without_motion(s.ball);
  const fcl::BVHModel<fcl::OBBRSSd> empty;
  fcl::BVHModel<fcl::OBBRSSd> points;
  points.beginModel();
  points.addSubModel(std::vector<Vector3d>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  points.endModel();
  const fcl::Boxd flat(1, 0, 1), nan_box(1, kNaN, 1);
  Transform3d skew = at(0);
  skew.linear()(0, 1) = 0.1;
  const TranslationMotiond nan_motion(at(0), at(kNaN));
  struct Foreign : TranslationMotiond {
    Foreign() : TranslationMotiond(at(0), at(1)) {}
  } foreign;

  const auto byMotion = [&](const CollisionGeometryd* g1, const fcl::MotionBased* m1, const CollisionGeometryd* g2,
                            const fcl::MotionBased* m2) {
    return [&, g1, m1, g2, m2] { fcl_artic::continuousCollide<double>(g1, m1, g2, m2, s.request, s.result); };
  };
  const auto byPoses = [&](const Transform3d& begin, const Transform3d& end) {
    return [&, begin, end] {
      fcl_artic::continuousCollide<double>(s.ball.get(), s.begin, s.end, s.cube.get(), begin, end, s.request, s.result);
    };
  };
  const auto* ball = s.ball.get();
  const auto *go = s.go.get(), *rest = s.rest.get();
  const std::vector<std::pair<std::function<void()>, std::vector<std::string>>> cases = {
      {byMotion(none, go, s.cube.get(), rest), {"object 1", "geometry is null"}},
      {byMotion(ball, go, none, rest), {"object 2", "geometry is null"}},
      {byMotion(ball, no_motion, s.cube.get(), rest), {"object 1", "motion is null"}},
      {byMotion(ball, go, s.cube.get(), no_motion), {"object 2", "motion is null"}},
      {byMotion(&empty, go, s.cube.get(), rest), {"object 1", "BVHModel"}},
      {byMotion(ball, go, &points, rest), {"object 2", "point cloud"}},
      {byMotion(&flat, go, s.cube.get(), rest), {"object 1", "Box"}},
      {byMotion(ball, go, &nan_box, rest), {"object 2", "Box"}},
      {byMotion(ball, go, s.cube.get(), &nan_motion), {"object 2", "TranslationMotion"}},
      {byMotion(ball, &foreign, s.cube.get(), rest), {"object 1", "Foreign"}},
      {byPoses(at(kNaN), at(0)), {"object 2", "finite"}},
      {byPoses(at(0), skew), {"object 2", "orthonormal"}},
      {[&] { fcl_artic::continuousCollide(no_object, s.end, &object, s.still, s.request, s.result); },
       {"object 1", "null"}},
      {[&] { fcl_artic::continuousCollide(&object, s.end, no_object, s.still, s.request, s.result); },
       {"object 2", "null"}},
      {[&] { fcl_artic::collide(no_moving, &moving, s.request, s.result); }, {"object 1", "null"}},
      {[&] { fcl_artic::collide(&moving, &without_motion, s.request, s.result); }, {"object 2", "motion is null"}},
  };
  for (std::size_t i = 0; i < cases.size(); ++i) {
    s.result.is_collide = false;  // what an earlier query proved
    s.result.time_of_contact = 1;
    const std::string message = messageOf(cases[i].first);
    for (const std::string& part : cases[i].second) EXPECT_TRUE(contains(message, part)) << "case " << i;
    EXPECT_TRUE(s.result.is_collide) << "case " << i;
    EXPECT_EQ(s.result.time_of_contact, 0) << "case " << i;
  }
  for (const double toc_err : {-1e-4, kNaN, kInfinity}) {
    s.request.toc_err = toc_err;
    s.result.is_collide = false;
    EXPECT_TRUE(contains(messageOf(byMotion(ball, go, s.cube.get(), rest)), "toc_err"));
    EXPECT_TRUE(s.result.is_collide);
  }
  CertifiedPairResult certified;
  certified.status = Status::free;
  EXPECT_TRUE(contains(
      messageOf([&] { fcl_artic::continuousCollide(none, go, s.cube.get(), rest, CertifiedRequest(), certified); }),
      "object 1"));
  EXPECT_EQ(certified.status, Status::undecided);
  CertifiedRequest bad;
  bad.margin = -1;
  certified.status = Status::free;
  EXPECT_TRUE(contains(messageOf([&] { fcl_artic::collide(&moving, &moving, bad, certified); }), "margin"));
  EXPECT_EQ(certified.status, Status::undecided);
}

// Steps of a longer way: the poses of the last result are the next query's input.
TEST(DropIn, PosesOfTheResultMayBeTheInput) {
  BallAndCube<double> s;
  s.result.contact_tf1 = s.begin;
  s.result.contact_tf2 = s.still;
  const double t = fcl_artic::continuousCollide<double>(s.ball.get(), s.result.contact_tf1, s.end, s.cube.get(),
                                                        s.result.contact_tf2, s.still, s.request, s.result);
  EXPECT_NEAR(t, 0.25, 1e-4);
}

TEST(DropIn, NothingIsPrinted) {
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  const auto geometries = dropin::allGeometries();
  ContinuousCollisionRequestd request;
  request.ccd_solver_type = fcl::CCDC_RAY_SHOOTING;
  for (const auto& a : geometries) {
    for (const auto& b : geometries) {
      ContinuousCollisionResultd result;
      fcl_artic::continuousCollide<double>(a.geometry.get(), at(0), at(1), b.geometry.get(), at(3), at(2), request,
                                           result);
    }
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
}

// FCL's polynomial solver moves the caller's mesh, and integrate() the caller's motion.
TEST(DropIn, GeometriesAndMotionsStayAsTheyAre) {
  const auto mesh = dropin::boxMesh<fcl::OBBRSSd>(1, 1, 1);
  const std::vector<Vector3d> before(mesh->vertices, mesh->vertices + mesh->num_vertices);
  const fcl::SplineMotion<double> motion({-6, 0, 0}, {-3, 0, 0}, {0, 0, 0}, {3, 0, 0}, {0, 0, 0}, {0, 0, 0.1},
                                         {0, 0, 0.2}, {0, 0, 0.3});
  const TranslationMotiond rest(at(0), at(0));
  motion.integrate(0.3);
  Transform3d pose_before, pose_after;
  motion.getCurrentTransform(pose_before);
  for (const auto solver : {fcl::CCDC_NAIVE, fcl::CCDC_CONSERVATIVE_ADVANCEMENT, fcl::CCDC_POLYNOMIAL_SOLVER}) {
    ContinuousCollisionRequestd request;
    request.ccd_solver_type = solver;
    ContinuousCollisionResultd result;
    fcl_artic::continuousCollide<double>(mesh.get(), &motion, mesh.get(), &rest, request, result);
    EXPECT_TRUE(result.is_collide);
  }
  motion.getCurrentTransform(pose_after);
  EXPECT_EQ(pose_before.matrix(), pose_after.matrix());
  EXPECT_EQ(motion.getCurrentTime(), 0.3);
  for (std::size_t i = 0; i < before.size(); ++i) EXPECT_EQ(before[i], mesh->vertices[i]);
}

TEST(DropInCertified, OverloadsCarryTheProof) {
  BallAndCube<double> s;
  const fcl::CollisionObjectd o1(s.ball, s.begin), o2(s.cube, s.still);
  const fcl::ContinuousCollisionObjectd c1(s.ball, s.go), c2(s.cube, s.rest);
  const CertifiedRequest request;
  const std::vector<std::function<Status(CertifiedPairResult&)>> overloads = {
      [&](auto& r) {
        return fcl_artic::continuousCollide(s.ball.get(), s.go.get(), s.cube.get(), s.rest.get(), request, r);
      },
      [&](auto& r) {
        return fcl_artic::continuousCollide(s.ball.get(), s.begin, s.end, s.cube.get(), s.still, s.still,
                                            fcl::CCDM_LINEAR, request, r);
      },
      [&](auto& r) { return fcl_artic::continuousCollide(&o1, s.end, &o2, s.still, fcl::CCDM_SCREW, request, r); },
      [&](auto& r) { return fcl_artic::collide(&c1, &c2, request, r); },
  };
  for (std::size_t i = 0; i < overloads.size(); ++i) {
    CertifiedPairResult r;
    EXPECT_EQ(overloads[i](r), Status::contact) << i;
    EXPECT_EQ(r.status, Status::contact) << i;
    EXPECT_TRUE(r.certain) << i;
    EXPECT_LE(r.t_lower, 0.25 + 1e-14) << i;
    EXPECT_GE(r.t_upper, 0.25 - 1e-14) << i;
    EXPECT_LE(r.t_upper - r.t_lower, request.tolerance_time) << i;
    ASSERT_EQ(r.contacts.size(), 1u) << i;
    const fcl::Contactd contact = r.contacts[0].toFcl();
    EXPECT_EQ(contact.o1, s.ball.get()) << i;
    EXPECT_EQ(contact.o2, s.cube.get()) << i;
    EXPECT_EQ(contact.b1, -1) << i;
    EXPECT_EQ(contact.b2, -1) << i;
    EXPECT_LT((contact.pos - Vector3d(-0.5, 0, 0)).norm(), 1e-5) << i;
    EXPECT_LT((contact.normal - Vector3d::UnitX()).norm(), 1e-6) << i;
    EXPECT_EQ(contact.penetration_depth, 0) << i;
    EXPECT_LT((r.tf1_at_lower.translation() - Vector3d(-2 + 4 * r.t_lower, 0, 0)).norm(), 1e-12) << i;
    EXPECT_LT((r.tf1_at_upper.translation() - Vector3d(-2 + 4 * r.t_upper, 0, 0)).norm(), 1e-12) << i;
    EXPECT_EQ(r.contacts[0].body1.object, i == 2 ? &o1 : nullptr) << i;
    EXPECT_EQ(r.contacts[0].body2.object, i == 2 ? &o2 : nullptr) << i;
  }
}

// fcl#581: contact data at the time of contact. At t_lower FCL's static query finds nothing yet, a little after t_upper
// it does.
TEST(DropInCertified, StaticQueryAgreesOnBothSidesOfTheBracket) {
  const auto mesh = dropin::boxMesh<fcl::OBBRSSd>(1, 0.6, 0.4);
  const auto cylinder = std::make_shared<fcl::Cylinderd>(0.3, 1);
  const auto reached = [](const CollisionGeometryd* a, const Transform3d& A, const CollisionGeometryd* b,
                          const Transform3d& B) {
    fcl::CollisionResultd result;
    return fcl_artic::collide(a, A, b, B, fcl::CollisionRequestd(), result) > 0;
  };
  int contacts = 0;
  for (int i = 0; i < 20; ++i) {
    Transform3d begin = at(-2, 0.05 * i, -0.5), end = at(2, -0.02 * i, 0.5), still = at(0);
    end.linear() = Eigen::AngleAxisd(0.1 + 0.14 * i, Vector3d(1, i, 3).normalized()).toRotationMatrix();
    CertifiedPairResult r;
    fcl_artic::continuousCollide(mesh.get(), begin, end, mesh.get(), still, still, fcl::CCDM_LINEAR, CertifiedRequest(),
                                 r);
    if (r.status != Status::contact || !r.certain) continue;
    ++contacts;
    EXPECT_FALSE(reached(mesh.get(), r.tf1_at_lower, mesh.get(), r.tf2_at_lower)) << i;
    // FCL's own rounding: half a tolerance of time later.
    CertifiedPairResult later;
    const double t = r.t_upper + 1e-5;
    Transform3d M = at(0);
    M.translation() = begin.translation() + t * (end.translation() - begin.translation());
    M.linear() = Eigen::AngleAxisd(t * (0.1 + 0.14 * i), Vector3d(1, i, 3).normalized()).toRotationMatrix();
    EXPECT_TRUE(reached(mesh.get(), M, mesh.get(), still)) << i;
    EXPECT_GE(r.contacts[0].b1, 0) << i;
    EXPECT_LT(r.contacts[0].b1, mesh->num_tris) << i;
  }
  EXPECT_GE(contacts, 15);
}

TEST(DropInCertified, MarginBudgetAndInitialContact) {
  BallAndCube<double> s;
  CertifiedRequest request;
  request.margin = 0.4;  // (1 - 0.4) of 4 m
  CertifiedPairResult r;
  const auto ask = [&](const Transform3d& begin, const Transform3d& end) {
    return fcl_artic::continuousCollide(s.ball.get(), begin, end, s.cube.get(), s.still, s.still, fcl::CCDM_TRANS,
                                        request, r);
  };
  EXPECT_EQ(ask(s.begin, s.end), Status::contact);
  EXPECT_LE(r.t_lower, 0.15 + 1e-14);
  EXPECT_NEAR(r.t_lower, 0.15, 1e-6);

  const auto mesh = dropin::boxMesh<fcl::OBBRSSd>(1, 1, 1);
  request = CertifiedRequest();
  request.work_budget = 1;
  const Status status = fcl_artic::continuousCollide(mesh.get(), s.begin, s.end, mesh.get(), s.still, s.still,
                                                     fcl::CCDM_TRANS, request, r);
  EXPECT_EQ(status, Status::undecided);
  EXPECT_LE(r.t_lower, 0.25 + 1e-14);
  EXPECT_FALSE(r.isFree());

  request = CertifiedRequest();
  EXPECT_EQ(ask(at(0.9), at(3)), Status::contact);
  EXPECT_EQ(r.t_lower, 0);
  request.ignore_initial_contact = true;
  EXPECT_EQ(ask(at(0.9), at(3)), Status::free);
  EXPECT_TRUE(r.ignored_initial_contact);
}

// FCL's callback keeps what the last pair said; this one the earliest contact.
TEST(DropInCallback, KeepsTheEarliestContact) {
  BallAndCube<double> s;
  const auto far = std::make_shared<TranslationMotiond>(at(1.5), at(1.5));
  const auto aside = std::make_shared<TranslationMotiond>(at(0, 3), at(0, 3));
  fcl::ContinuousCollisionObjectd ball(s.ball, s.go), cube(s.cube, s.rest), far_cube(s.cube, far),
      free_cube(s.cube, aside);
  fcl::DefaultContinuousCollisionData<double> data;
  const auto meet = [&](fcl::ContinuousCollisionObjectd& o) {
    return fcl_artic::DefaultContinuousCollisionFunction<double>(&ball, &o, &data);
  };
  EXPECT_FALSE(meet(free_cube));
  EXPECT_FALSE(data.result.is_collide);
  EXPECT_FALSE(meet(far_cube));  // t = (2.5) / 4
  EXPECT_NEAR(data.result.time_of_contact, 0.625, 1e-4);
  EXPECT_FALSE(meet(cube));
  EXPECT_NEAR(data.result.time_of_contact, 0.25, 1e-4);
  EXPECT_FALSE(meet(far_cube));
  EXPECT_FALSE(meet(free_cube));
  EXPECT_TRUE(data.result.is_collide);
  EXPECT_NEAR(data.result.time_of_contact, 0.25, 1e-4);
  EXPECT_TRUE(meet(ball));  // touches itself at t = 0: nothing is earlier
  EXPECT_EQ(data.result.time_of_contact, 0);
}

// One motion and one geometry for 8 threads: every answer is the single thread's, to the bit.
TEST(DropInThreads, ShareMotionsAndGeometries) {
  const auto mesh = dropin::boxMesh<fcl::OBBRSSd>(1, 0.8, 0.6);
  const auto convex = dropin::octahedron<double>(0.5, 0.4, 0.3);
  const auto tree = dropin::cells<double>(0.25);
  const Eigen::Matrix3d turned = Eigen::AngleAxisd(2.5, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  const fcl::InterpMotion<double> interp(Eigen::Matrix3d::Identity(), Vector3d(-2, 0, 0), turned, Vector3d(2, 0.3, 0),
                                         Vector3d(0, 0, 0));
  const fcl::ScrewMotion<double> screw(Eigen::Matrix3d::Identity(), Vector3d(0, -2, 0), turned, Vector3d(0, 2, 0.2));
  const fcl::SplineMotion<double> spline({-4, 0, 0}, {-1, 0.2, 0}, {1, 0, 0.1}, {5, 0, 0}, {0, 0, 0}, {0, 1, 0},
                                         {0, 2, 1}, {0, 3, 1});
  const TranslationMotiond rest(at(0), at(0)), pass(at(-3, 1.5), at(3, 1.5));
  const std::vector<const CollisionGeometryd*> geometries{mesh.get(), convex.get(), tree.get()};
  const std::vector<const fcl::MotionBased*> motions{&interp, &screw, &spline, &rest, &pass};

  struct Numbers {  // an answer's bits
    double t, pose1[16], pose2[16], upper, point[3], normal[3];
    int status, collide;
  };
  const auto answers = [&] {
    std::vector<Numbers> all;
    for (const auto* g1 : geometries) {
      for (const auto* g2 : geometries) {
        for (const auto* m1 : motions) {
          for (const auto* m2 : motions) {
            Numbers n;
            std::memset(&n, 0, sizeof n);
            ContinuousCollisionResultd result;
            n.t = fcl_artic::continuousCollide(g1, m1, g2, m2, ContinuousCollisionRequestd(), result);
            n.collide = result.is_collide;
            Eigen::Matrix4d::Map(n.pose1) = result.contact_tf1.matrix();
            Eigen::Matrix4d::Map(n.pose2) = result.contact_tf2.matrix();
            CertifiedPairResult certified;
            n.status = static_cast<int>(fcl_artic::continuousCollide(g1, m1, g2, m2, CertifiedRequest(), certified));
            n.upper = certified.t_upper;
            if (!certified.contacts.empty()) {
              Vector3d::Map(n.point) = certified.contacts[0].point;
              Vector3d::Map(n.normal) = certified.contacts[0].normal;
            }
            all.push_back(n);
          }
        }
      }
    }
    return all;
  };
  constexpr std::size_t kThreads = 8;
  std::vector<std::vector<Numbers>> of_threads(kThreads);
  std::vector<std::thread> threads;
  for (auto& mine : of_threads) threads.emplace_back([&mine, &answers] { mine = answers(); });
  for (auto& thread : threads) thread.join();
  const std::vector<Numbers> alone = answers();  // last, so that the threads met nothing that was read before

  int hits = 0;
  for (const Numbers& n : alone) hits += n.collide;
  EXPECT_GT(hits, 50);
  EXPECT_LT(hits, static_cast<int>(alone.size()) - 50);
  for (const auto& mine : of_threads) {
    ASSERT_EQ(mine.size(), alone.size());
    EXPECT_EQ(std::memcmp(mine.data(), alone.data(), alone.size() * sizeof(Numbers)), 0);
  }
}

}  // namespace dropin_test
