// SPDX-License-Identifier: BSD-3-Clause
// The oracle tried by itself: exact predicates against rationals and closed forms, distances, kinematics, sampling, and
// FCL's static answers where they are clear.
#include <cmath>

#include <gtest/gtest.h>

#include <fcl/narrowphase/collision.h>

#include "engine.h"
#include "generator.h"
#include "oracle.h"
#include "random.h"

namespace campaign {
namespace oracle_test {
namespace {

Vec3 anyPoint(Random& r, double size = 1) {
  return Vec3{r.uniform(-size, size), r.uniform(-size, size), r.uniform(-size, size)};
}

TEST(Orient3d, AgreesWithRationals) {
  Random r(1);
  int zero = 0;
  for (int i = 0; i < 20000; ++i) {
    Vec3 a = anyPoint(r), b = anyPoint(r), c = anyPoint(r), d = anyPoint(r);
    if (i % 2) {  // almost in one plane, some exactly
      const double x = r.uniform(-1, 2), y = r.uniform(-1, 2);
      d = a + x * (b - a) + y * (c - a);
      if (i % 4 == 1) a.z() = b.z() = c.z() = d.z() = 0.3;
    }
    const int exact = orient3dExact(a, b, c, d);
    ASSERT_EQ(orient3d(a, b, c, d), exact);
    ASSERT_EQ(orient3d(b, a, c, d), -exact);
    zero += exact == 0;
  }
  EXPECT_GE(zero, 4000);
}

TEST(TrianglesTouch, DegenerateMeetings) {
  const Triangle t = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  const double up = std::nextafter(0.0, 1.0);
  const auto touches = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    const Triangle s = {a, b, c};
    EXPECT_EQ(trianglesTouch(s, t), trianglesTouch(t, s));
    return trianglesTouch(s, t);
  };
  EXPECT_TRUE(touches({0.25, 0.25, 0}, {0, 0, 1}, {1, 1, 1})) << "vertex on face";
  EXPECT_FALSE(touches({0.25, 0.25, up}, {0, 0, 1}, {1, 1, 1})) << "vertex the least double above the face";
  EXPECT_TRUE(touches({0.5, 0.5, 0}, {1, 1, 1}, {1, 1, -1})) << "vertex on edge";
  EXPECT_TRUE(touches({1, 0, 0}, {2, 0, 1}, {2, 0, -1})) << "vertex on vertex";
  EXPECT_FALSE(touches({std::nextafter(1.0, 2.0), 0, 0}, {2, 0, 1}, {2, 0, -1}));
  EXPECT_TRUE(touches({0.2, 0.2, 0}, {0.3, 0.2, 0}, {0.2, 0.3, 0})) << "coplanar, inside";
  EXPECT_TRUE(touches({-1, 0.5, 0}, {2, 0.5, 0}, {0, 3, 0})) << "coplanar, crossing";
  EXPECT_FALSE(touches({1, 1, 0}, {2, 1, 0}, {1, 2, 0})) << "coplanar, beside";
  EXPECT_TRUE(touches({0.5, -1, -1}, {0.5, -1, 1}, {0.5, 1, 0})) << "piercing";
}

TEST(TrianglesTouch, AgreesWithDistancesAndClearCrossingIsContact) {
  Random r(2);
  int touching = 0;
  for (int i = 0; i < 20000; ++i) {
    const auto any = [&] { return Triangle{anyPoint(r, 0.5), anyPoint(r, 0.5), anyPoint(r, 0.5)}; };
    Piece s, t;
    s.kind = t.kind = Piece::triangle;
    s.corners = any(), t.corners = any();
    const Separation d = separation(s, t, 1e-9);
    const bool touch = trianglesTouch(s.corners, t.corners);
    touching += touch;
    ASSERT_LE(d.lower, d.upper + 1e-15);
    if (touch) ASSERT_LE(d.lower, 1e-14);
    if (!touch) ASSERT_GT(d.upper, 0);
    if (d.upper > 1e-9) ASSERT_FALSE(touch);
    if (trianglesClearlyCross(s.corners, t.corners, 1e-13)) ASSERT_TRUE(touch);
    if (touch && d.upper < 1e-14) {
      // Generic contacts are clear ones.
      ASSERT_TRUE(trianglesClearlyCross(s.corners, t.corners, 1e-14)) << i;
    }
  }
  EXPECT_GE(touching, 2000);
}

TEST(Separation, ClosedForms) {
  Random r(3);
  for (int i = 0; i < 5000; ++i) {
    Piece box, sphere, cylinder;
    box.kind = Piece::box, sphere.kind = Piece::sphere, cylinder.kind = Piece::cylinder;
    box.R = r.rotation(), cylinder.R = r.rotation();
    box.centre = anyPoint(r), sphere.centre = anyPoint(r), cylinder.centre = anyPoint(r);
    box.half = Vec3{r.uniform(0.1, 0.5), r.uniform(0.1, 0.5), r.uniform(0.1, 0.5)};
    sphere.half.setConstant(r.uniform(0.1, 0.5));
    cylinder.half = Vec3(r.uniform(0.1, 0.4), 0, r.uniform(0.1, 0.5));
    cylinder.half.y() = cylinder.half.x();
    // A point and a box, or a cylinder: what is left after clamping.
    const Vec3 in_box = box.R.transpose() * (sphere.centre - box.centre);
    const double to_box = (in_box.cwiseAbs() - box.half).cwiseMax(0).norm() - sphere.half.x();
    const Vec3 in_cylinder = cylinder.R.transpose() * (sphere.centre - cylinder.centre);
    const double to_cylinder =
        std::hypot(std::max(0.0, std::hypot(in_cylinder.x(), in_cylinder.y()) - cylinder.half.x()),
                   std::max(0.0, std::abs(in_cylinder.z()) - cylinder.half.z())) -
        sphere.half.x();
    for (const auto& [piece, truth] : {std::pair{&box, to_box}, {&cylinder, to_cylinder}}) {
      const Separation d = separation(*piece, sphere, 1e-9);
      ASSERT_LE(d.lower, truth + 1e-14);
      ASSERT_GE(d.upper, truth - 1e-14);
      ASSERT_LE(d.upper - d.lower, 1e-8) << i;
      ASSERT_EQ(clearlyOverlap(*piece, sphere, 1e-9), truth < -2e-9) << truth;
      ASSERT_EQ(clearlyOverlap(sphere, *piece, 1e-9), truth < -2e-9) << truth;
    }
  }
}

TEST(Separation, ClearOverlapHasAPointInBothAndNoGap) {
  Random r(4);
  int overlaps = 0;
  for (int i = 0; i < 20000; ++i) {
    Piece p[2];
    for (Piece& x : p) {
      x.kind = static_cast<Piece::Kind>(r.below(4));
      x.R = r.rotation();
      x.centre = anyPoint(r, 0.6);
      x.half = Vec3{r.uniform(0.1, 0.4), 0, r.uniform(0.1, 0.4)};
      x.half.y() = x.half.x();
      x.corners = {anyPoint(r, 0.6), anyPoint(r, 0.6), anyPoint(r, 0.6)};
    }
    if (p[0].kind == Piece::triangle && p[1].kind == Piece::triangle) continue;
    const Separation d = separation(p[0], p[1], 1e-9);
    const bool clear = clearlyOverlap(p[0], p[1], kClearSolids);
    overlaps += clear;
    ASSERT_NE(clear, d.lower > 1e-9) << i << ": neither, or both, of a gap and an overlap";
  }
  EXPECT_GE(overlaps, 5000);
}

TEST(Proximity, AgreesWithAllPairsOfPieces) {
  Random r(5);
  for (int i = 0; i < 60; ++i) {
    const GeometryPtr a = MeshLibrary::instance().any(r);
    const GeometryPtr b = i % 3 ? MeshLibrary::instance().any(r) : Geometry::cylinder(0.1, 0.3);
    if (a->numPieces() * b->numPieces() > 40000) continue;
    const Pose A{r.rotation(), anyPoint(r, 0.3)}, B{r.rotation(), anyPoint(r, 0.5)};
    double least = 1e9;
    bool touch = false;
    for (int k = 0; k < a->numPieces(); ++k)
      for (int l = 0; l < b->numPieces(); ++l) {
        const Piece x = a->piece(k, A), y = b->piece(l, B);
        least = std::min(least, std::max(0.0, separation(x, y, 1e-6).upper));
        touch |= b->isMesh() ? trianglesTouch(x.corners, y.corners) : clearlyOverlap(x, y, kClearSolids);
      }
    const Proximity p = proximity(*a, A, *b, B, 0, 1e-6, {});
    EXPECT_EQ(p.touching, touch);
    if (!touch) {
      EXPECT_LE(p.gap, least + 1e-12);
      EXPECT_GE(p.gap, least * (1 - 1e-5) - 1e-12);
      EXPECT_NEAR(p.upper, least, 1e-5 * least + 1e-12);
    }
  }
}

TEST(Kinematics, AgreesWithTheLibrarysForwardKinematics) {
  for (std::uint64_t i = 0; i < 300; ++i) {
    const Scene s = makeScene(i % 2 ? "tree/random" : "chain/random", Random::mix(6, i));
    const Kinematics k(s);
    const auto tree = treeOf(s);
    const fcl_artic::JointMotion motion = motionOf(s, *tree);
    for (const double t : {0.0, 0.37, 1.0}) {
      std::vector<Eigen::Isometry3d> M;
      tree->forwardKinematics(motion.configuration(t), M);
      for (std::size_t l = 0; l < M.size(); ++l) {
        const Pose own = k.linkPose(static_cast<int>(l), t);
        ASSERT_LE((M[l].linear() - own.R).norm() + (M[l].translation() - own.p).norm(), 1e-13);
      }
    }
  }
}

TEST(Kinematics, NoPointIsFasterThanTheSpeedBound) {
  Random r(7);
  for (std::uint64_t i = 0; i < 300; ++i) {
    const Scene s = makeScene(i % 2 ? "tree/random" : "chain/random", Random::mix(7, i));
    const Kinematics k(s);
    for (const auto& [a, b] : k.pairs()) {
      const double t = r.unit(), h = 1e-4;
      const Vec3 local = s.bodies[static_cast<std::size_t>(b)].geometry->surfacePoint(r.unit(), r.unit(), r.unit());
      const auto seen = [&, a = a, b = b](double at) {
        return k.bodyPose(a, at).inverse() * (k.bodyPose(b, at) * local);
      };
      // Speed seen from a turning body: its own turn carries the point along; so look from a's reach only.
      const double reach = (seen(t) - s.bodies[static_cast<std::size_t>(a)].geometry->centre()).norm();
      if (reach > s.bodies[static_cast<std::size_t>(a)].geometry->radius()) continue;
      ASSERT_LE((seen(t + h) - seen(t)).norm(), k.relativeSpeed(a, b) * h + 1e-12);
    }
  }
}

TEST(Oracle, ContactTimeInClosedForm) {
  // A sphere of radius 0.1 goes 1 m along x towards the side x = 0.5 of a block: contact at t = 0.4.
  for (const bool mesh : {false, true}) {
    Random r(8);
    Scene s;
    s.links.resize(2);
    s.links[1].parent = 0;
    s.links[1].joint = JointKind::prismatic;
    s.q0 = {0}, s.q1 = {1};
    s.bodies.push_back({Geometry::sphere(0.1), 1, {}});
    s.bodies.push_back({mesh ? boxMesh({0.4, 0.4, 0.4}, 3, 0, r) : Geometry::box({0.4, 0.4, 0.4}),
                        -1,
                        {Mat3::Identity(), Vec3(0.7, 0.02, 0.03)}});
    const Truth t = Oracle(s).judge(false);
    ASSERT_TRUE(t.hit);
    EXPECT_GE(t.time, 0.4 - 1e-15);
    EXPECT_LE(t.time, 0.4 + 3 * kClearSolids);
    s.bodies[1].pose.p.y() = 0.3 + 1e-6;  // passes by
    const Truth past = Oracle(s).judge(false);
    EXPECT_FALSE(past.hit);
    EXPECT_NEAR(past.pairs[0].gap, 1e-6, 1e-8);
    s.bodies[1].pose.p.y() = 0.3 - 1e-8;  // grazes
    EXPECT_TRUE(Oracle(s).judge(false).hit);
  }
}

TEST(Oracle, FindsWhatDenseSamplingFinds) {
  int hits = 0;
  for (std::uint64_t i = 0; i < 60; ++i) {
    const Scene s = makeScene(familyOf(9, i), Random::mix(9, i));
    const Oracle oracle(s);
    for (const auto& [a, b] : oracle.kinematics().pairs()) {
      const PairTruth p = oracle.firstContact(a, b);
      for (int k = 0; k <= 200; ++k) {
        const double t = k / 200.0;
        if (!oracle.at(a, b, t, 0.2).clear) continue;
        EXPECT_TRUE(p.hit);
        EXPECT_LE(p.time, t);
        ++hits;
        break;
      }
    }
  }
  EXPECT_GE(hits, 15);
}

/// Whether some pieces are in each other by 1e-4 m (two meshes: cross), far beyond FCL's tolerance for shapes.
bool deepContact(const Geometry& A, const Pose& M_a, const Geometry& B, const Pose& M_b) {
  for (int i = 0; i < A.numPieces(); ++i)
    for (int j = 0; j < B.numPieces(); ++j) {
      const Piece a = A.piece(i, M_a), b = B.piece(j, M_b);
      if (A.isMesh() && B.isMesh() ? trianglesClearlyCross(a.corners, b.corners, 1e-9) : clearlyOverlap(a, b, 1e-4))
        return true;
    }
  return false;
}

TEST(Oracle, AgreesWithFclWhereThatIsClear) {
  int hit = 0, apart = 0;
  for (std::uint64_t i = 0; i < 900; ++i) {
    const std::string& family = families()[i % 9];  // one body and one obstacle
    Scene s = makeScene(family, Random::mix(10, i));
    s.margin = 0;
    const Geometry &A = *s.bodies[0].geometry, &B = *s.bodies[1].geometry;
    // FCL has no answer for meshes with different kinds of bounding volumes.
    if (A.isMesh() && B.isMesh() && A.fclGeometry()->getNodeType() != B.fclGeometry()->getNodeType()) continue;
    if (A.numPieces() * B.numPieces() > 100000) continue;
    const Oracle oracle(s);
    const PairTruth p = oracle.firstContact(0, 1);
    const double t = p.hit ? p.time + 0.1 * (1 - p.time) : 0.5;
    const Pose M_a = oracle.kinematics().bodyPose(0, t), M_b = oracle.kinematics().bodyPose(1, t);
    const bool deep = deepContact(A, M_a, B, M_b);
    const Proximity now = oracle.at(0, 1, t, 1e-6);
    if (!deep && (now.clear || now.gap < 1e-5)) continue;
    EXPECT_EQ(now.clear, deep) << i << " " << family;
    const fcl::CollisionObjectd a(A.fclGeometry(), M_a.R, M_a.p), b(B.fclGeometry(), M_b.R, M_b.p);
    fcl::CollisionResultd result;
    fcl::collide(&a, &b, fcl::CollisionRequestd(), result);
    EXPECT_EQ(result.isCollision(), deep) << i << " " << family;
    (deep ? hit : apart) += 1;
  }
  EXPECT_GE(hit, 100);
  EXPECT_GE(apart, 100);
}

}  // namespace
}  // namespace oracle_test
}  // namespace campaign
