// SPDX-License-Identifier: BSD-3-Clause
//
// Sentences of doc/PROMISE.md that no other test has: solids and surfaces, near misses with fine tolerances, short
// separations after an ignored contact, and the processor's modes.

#include <algorithm>
#include <cfenv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/octree/octree.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cone.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/ellipsoid.h>
#include <fcl/geometry/shape/halfspace.h>
#include <fcl/geometry/shape/plane.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/geometry/shape/triangle_p.h>
#include <fcl/math/motion/translation_motion.h>
#include <gtest/gtest.h>

#include "control_bits.h"
#include "fcl_artic/continuous_collision.h"
#include "fcl_artic/fcl_artic.h"
#include "random.h"

namespace sentences_test {

namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using fcl_artic::CertifiedPairResult;
using fcl_artic::CertifiedRequest;
using fcl_artic::Status;
using fcl_artic::numerics_test::controlBits;
using fcl_artic::numerics_test::kFlushing;
using fcl_artic::numerics_test::kUsualControl;
using fcl_artic::numerics_test::setControlBits;
using GeometryPtr = std::shared_ptr<fcl::CollisionGeometryd>;
using Mesh = fcl::BVHModel<fcl::OBBRSSd>;

Isometry3d at(const Vector3d& x, const Matrix3d& R = Matrix3d::Identity()) {
  Isometry3d M = Isometry3d::Identity();
  M.linear() = R;
  M.translation() = x;
  return M;
}

GeometryPtr mesh(const std::vector<Vector3d>& vertices, const std::vector<fcl::Triangle>& triangles) {
  auto model = std::make_shared<Mesh>();
  model->beginModel();
  model->addSubModel(vertices, triangles);
  model->endModel();
  return model;
}

/// A mesh of a box with half sides x, y, z.
GeometryPtr boxMesh(double x, double y, double z) {
  std::vector<Vector3d> v;
  for (int c = 0; c < 8; ++c) v.emplace_back(c & 1 ? x : -x, c & 2 ? y : -y, c & 4 ? z : -z);
  const std::size_t sides[12][3] = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
                                    {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
  std::vector<fcl::Triangle> t;
  for (const auto& s : sides) t.emplace_back(s[0], s[1], s[2]);
  return mesh(v, t);
}

/// The second body goes straight.
CertifiedPairResult slide(const GeometryPtr& still, const GeometryPtr& moving, const Isometry3d& from,
                          const Vector3d& way, const CertifiedRequest& request) {
  const fcl::TranslationMotiond rest(at(Vector3d::Zero()), at(Vector3d::Zero()));
  const fcl::TranslationMotiond go(from, at(from.translation() + way, from.linear()));
  CertifiedPairResult result;
  fcl_artic::continuousCollide(still.get(), &rest, moving.get(), &go, request, result);
  return result;
}

/// "Meshes, TriangleP and Plane are surfaces; Box, Sphere, ... are solids": a small ball well within each of them.
TEST(PromiseSentences, SolidsAndSurfaces) {
  const auto faces =
      std::make_shared<std::vector<int>>(std::vector<int>{3, 0, 2, 1, 3, 0, 1, 3, 3, 0, 3, 2, 3, 1, 2, 3});
  const auto corners = std::make_shared<std::vector<Vector3d>>(
      std::vector<Vector3d>{{-1, -1, -1}, {3, -1, -1}, {-1, 3, -1}, {-1, -1, 3}});
  auto cells = std::make_shared<octomap::OcTree>(1.0);
  cells->updateNode(octomap::point3d(0.5f, 0.5f, 0.5f), true);
  struct Case {
    const char* name;
    GeometryPtr geometry;
    Vector3d place;
    bool solid;
  };
  const std::vector<Case> cases = {
      {"Box", std::make_shared<fcl::Boxd>(2, 2, 2), {0.2, 0.1, 0}, true},
      {"Sphere", std::make_shared<fcl::Sphered>(1), {0.2, 0.1, 0}, true},
      {"Capsule", std::make_shared<fcl::Capsuled>(1, 1), {0.2, 0.1, 0}, true},
      {"Cylinder", std::make_shared<fcl::Cylinderd>(1, 2), {0.2, 0.1, 0}, true},
      {"Cone", std::make_shared<fcl::Coned>(1, 2), {0.1, 0.1, -0.3}, true},
      {"Ellipsoid", std::make_shared<fcl::Ellipsoidd>(1, 0.8, 0.9), {0.2, 0.1, 0}, true},
      {"Convex", std::make_shared<fcl::Convexd>(corners, 4, faces), {-0.3, -0.2, -0.1}, true},
      {"Halfspace", std::make_shared<fcl::Halfspaced>(Vector3d::UnitZ(), 5), {0.2, 0.1, 0}, true},
      {"OcTree", std::make_shared<fcl::OcTreed>(cells), {0.5, 0.4, 0.5}, true},
      {"mesh", boxMesh(1, 1, 1), {0.2, 0.1, 0}, false},
      {"TriangleP",
       std::make_shared<fcl::TrianglePd>(Vector3d(-1, -1, 0.4), Vector3d(2, -1, 0.4), Vector3d(-1, 2, 0.4)),
       {0.2, 0.1, 0},
       false},
      {"Plane", std::make_shared<fcl::Planed>(Vector3d::UnitZ(), 5), {0.2, 0.1, 0}, false},
  };
  const GeometryPtr ball = std::make_shared<fcl::Sphered>(0.01), grain = boxMesh(0.01, 0.01, 0.01);
  for (const Case& c : cases) {
    for (const GeometryPtr& small : {ball, grain}) {
      const CertifiedPairResult result =
          slide(c.geometry, small, at(c.place), Vector3d(1e-3, 0, 0), CertifiedRequest());
      if (c.solid) {
        EXPECT_EQ(result.status, Status::contact) << c.name;
        EXPECT_EQ(result.t_lower, 0) << c.name;
        EXPECT_TRUE(result.certain) << c.name;
      } else {
        EXPECT_EQ(result.status, Status::free) << c.name;
      }
    }
  }
}

/// "Contact without certain: nearer than tolerance_distance, or too near for rounding to tell": a body of 1 m that
/// slides past another one at 1e-11 to 1e-8 m is neither, where the tolerance is 1e-12 m. A plane between them, through
/// the farthest points of both, says how far apart they are, whatever the engine says.
TEST(PromiseSentences, NearMissesAreFreeWithAFineTolerance) {
  struct Body {
    GeometryPtr geometry;
    std::function<Vector3d(const Vector3d&)> farthest;  ///< along a unit vector
  };
  const auto sign = [](double x) { return x < 0 ? -1.0 : 1.0; };
  const auto corner = [&](const Vector3d& n) { return Vector3d(0.5 * sign(n[0]), 0.3 * sign(n[1]), 0.4 * sign(n[2])); };
  const auto onRim = [](const Vector3d& n, double radius, double z) {
    const double across = std::hypot(n[0], n[1]);
    return across > 0 ? Vector3d(radius * n[0] / across, radius * n[1] / across, z) : Vector3d(0, 0, z);
  };
  const std::vector<Body> bodies = {
      {boxMesh(0.5, 0.3, 0.4), corner},
      {std::make_shared<fcl::Boxd>(1, 0.6, 0.8), corner},
      {std::make_shared<fcl::Cylinderd>(0.3, 0.8), [&](const Vector3d& n) { return onRim(n, 0.3, 0.4 * sign(n[2])); }},
      {std::make_shared<fcl::Capsuled>(0.2, 0.6),
       [&](const Vector3d& n) { return Vector3d(0.2 * n + Vector3d(0, 0, 0.3 * sign(n[2]))); }}};
  pairs::Random random(11);
  int asked = 0;
  for (int i = 0; i < 4000; ++i) {
    const std::size_t first = static_cast<std::size_t>(random.below(4)),
                      second = static_cast<std::size_t>(random.below(4));
    const Body &a = bodies[first], &b = bodies[random.chance(0.7) ? first : second];
    const Vector3d n = random.direction();
    const Matrix3d R = random.chance(0.25) ? Matrix3d(Matrix3d::Identity()) : random.rotation();
    const double gap = std::pow(10, random.uniform(-11, -8));
    const Vector3d place = a.farthest(n) + gap * n - R * b.farthest(R.transpose() * -n);
    const Vector3d way = n.cross(random.direction()).normalized();
    CertifiedRequest request;
    request.tolerance_distance = 1e-12;
    request.tolerance_time = random.chance(0.5) ? 1e-6 : 1e-9;
    const CertifiedPairResult result = slide(a.geometry, b.geometry, at(place - 0.3 * way, R), way, request);
    EXPECT_EQ(result.status, Status::free) << "case " << i << ", gap " << gap << ", t " << result.t_lower;
    ++asked;
  }
  EXPECT_EQ(asked, 4000);
}

/// Pairs not proven apart at t = 0 are left out. They are checked from the start of the first of the time intervals
/// examined (of 1/8, 1/64, 1/512) on which they are proven apart. Shorter separations are not looked for. A ball stands
/// between two walls of one mesh: it touches the first one at t = 0, and is apart from both for a while.
TEST(PromiseSentences, ShortSeparationsAreNotLookedFor) {
  const GeometryPtr ball = std::make_shared<fcl::Sphered>(0.1);
  for (const double apart : {0.0005, 0.0015, 0.0045, 0.02, 0.3}) {
    const double wall = 0.2 + apart;
    const GeometryPtr walls = mesh({{0, -1, -1}, {0, 2, -1}, {0, -1, 2}, {wall, -1, -1}, {wall, 2, -1}, {wall, -1, 2}},
                                   {{0, 1, 2}, {3, 4, 5}});
    CertifiedRequest request;
    request.ignore_initial_contact = true;
    const CertifiedPairResult result = slide(walls, ball, at(Vector3d::Zero()), Vector3d(1, 0, 0), request);
    EXPECT_TRUE(result.ignored_initial_contact);
    if (apart < 1.0 / 512) {
      EXPECT_EQ(result.status, Status::free) << apart;
    } else {  // an interval of 1/512 lies within
      ASSERT_EQ(result.status, Status::contact) << apart;
      EXPECT_TRUE(result.certain);
      EXPECT_LE(result.t_lower, 0.1 + apart + 1e-12);
      EXPECT_GE(result.t_upper, 0.1 + apart - 1e-12);
    }
  }
}

/// "Any rounding mode on entry, also when trees and managers are built; subnormals may be flushed", and each caller has
/// his mode back, also in what is called meanwhile.
/// A square of 2 size x 2 size in z = 0, cut into n x n x 2 triangles.
GeometryPtr plate(double size, std::size_t n) {
  std::vector<Vector3d> vertices;
  std::vector<fcl::Triangle> triangles;
  const auto place = [&](std::size_t i) { return size * (2.0 * static_cast<double>(i) / static_cast<double>(n) - 1); };
  for (std::size_t i = 0; i <= n; ++i) {
    for (std::size_t j = 0; j <= n; ++j) vertices.emplace_back(place(i), place(j), 0);
  }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      const std::size_t a = i * (n + 1) + j, b = a + 1, c = a + n + 1, d = c + 1;
      triangles.emplace_back(a, b, c);
      triangles.emplace_back(b, d, c);
    }
  }
  return mesh(vertices, triangles);
}

/// A smaller plate slides over a larger one, or lifts off, `gap` above it.
CertifiedPairResult slidePlates(double size, std::size_t n, const Matrix3d& R, double turn, double gap, bool lifts,
                                const CertifiedRequest& request) {
  const Matrix3d turned = R * Eigen::AngleAxisd(turn, Vector3d::UnitZ());
  const Vector3d begin = R * Vector3d(0.3 * size, 0, gap);
  const Vector3d way = R * Vector3d(-0.6, 0.1, lifts ? 0.3 : 0) * size;
  const fcl::TranslationMotiond still(at({0, 0, 0}, R), at({0, 0, 0}, R));
  const fcl::TranslationMotiond slides(at(begin, turned), at(begin + way, turned));
  const auto a = plate(size, n), b = plate(0.5 * size, n);
  CertifiedPairResult result;
  fcl_artic::continuousCollide(a.get(), &still, b.get(), &slides, request, result);
  return result;
}

std::uint64_t workOf(const CertifiedPairResult& result) {
  const fcl_artic::QueryStatistics& s = result.statistics;
  return s.node_tests + s.leaf_tests + s.certificates + s.gjk + s.contact_proofs;
}

// If bodies are huge, rounding hides more than tolerance_distance. Such a gap may be taken for contact at once, as no
// finer interval of time decides it. (It was divided down to the finest, up to a hundred times the work.)
TEST(PromiseSentences, RestingCostsNoMoreWhereRoundingHidesMore) {
  pairs::Random random(5);
  int contacts = 0;
  for (int i = 0; i < 12; ++i) {
    const Matrix3d R = random.rotation();
    const double turn = random.uniform(-1, 1), gap = i % 3 == 0 ? 0 : random.uniform(0, 4e-15);  // of the size
    std::uint64_t of_metres = 0;
    for (const double size : {1.0, 1e7, 1e8, 3e8}) {
      const CertifiedPairResult result = slidePlates(size, 8, R, turn, gap * size, i % 4 == 3, CertifiedRequest());
      EXPECT_EQ(result.status, Status::contact);
      EXPECT_EQ(result.t_lower, 0);
      contacts += result.status == Status::contact;
      if (size == 1) of_metres = workOf(result);
      EXPECT_LT(workOf(result), 4 * of_metres) << size << " of " << i;
    }
  }
  EXPECT_EQ(contacts, 48);
}

// A body that rests exactly on another costs about as much as one 10 um farther up. No triangle of it is proven apart
// or in contact, but some of them are enough. (All were looked at, a thousand times the work.)
TEST(PromiseSentences, RestingCostsAboutWhatStandingClearCosts) {
  pairs::Random random(6);
  for (int i = 0; i < 24; ++i) {
    const Matrix3d R = i % 3 == 0 ? Matrix3d(Matrix3d::Identity()) : random.rotation();
    const double turn = i % 2 ? random.uniform(-1, 1) : 0;
    for (const auto mode :
         {fcl_artic::ContactMode::first, fcl_artic::ContactMode::any, fcl_artic::ContactMode::firstOfEveryPair}) {
      CertifiedRequest request;
      request.mode = mode;
      const CertifiedPairResult clear = slidePlates(1, 24, R, turn, 1e-5, i % 4 == 3, request);
      const CertifiedPairResult resting = slidePlates(1, 24, R, turn, 0, i % 4 == 3, request);
      EXPECT_TRUE(clear.isFree());
      EXPECT_EQ(resting.status, Status::contact);
      EXPECT_EQ(resting.t_lower, 0);
      EXPECT_LT(workOf(resting), 600 + 10 * workOf(clear)) << i;
    }
  }
}

/// A tube about z without ends, of n x 2 triangles as long as it is.
GeometryPtr tube(double radius, double half, std::size_t n) {
  std::vector<Vector3d> vertices;
  std::vector<fcl::Triangle> triangles;
  for (std::size_t i = 0; i < n; ++i) {
    const double angle = 2 * 3.14159265358979 * static_cast<double>(i) / static_cast<double>(n);
    for (const double z : {-half, half}) vertices.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
    const std::size_t next = (i + 1) % n;
    triangles.emplace_back(2 * i, 2 * next, 2 * next + 1);
    triangles.emplace_back(2 * i, 2 * next + 1, 2 * i + 1);
  }
  return mesh(vertices, triangles);
}

// If bodies are in each other at the start, some triangles that touch are enough. (All that do were divided down to the
// finest interval: of crossing tubes a hundred times the work.)
TEST(PromiseSentences, WhatIsInEachOtherAtTheStartIsContactWithoutMoreAdo) {
  pairs::Random random(8);
  const GeometryPtr one = tube(0.1, 0.7, 150), other = tube(0.1, 0.7, 150);
  std::vector<std::uint64_t> work;
  for (int i = 0; i < 60; ++i) {
    const Isometry3d M = at(random.vector(0, 0.05), random.rotation());
    const CertifiedPairResult result = slide(one, other, M, random.vector(0, 0.3), CertifiedRequest());
    ASSERT_EQ(result.status, Status::contact) << i;
    EXPECT_TRUE(result.certain) << i;
    EXPECT_EQ(result.t_lower, 0) << i;
    EXPECT_EQ(result.t_upper, 0) << i;
    work.push_back(workOf(result));
  }
  std::sort(work.begin(), work.end());
  std::printf("work: median %d, most %d\n", static_cast<int>(work[30]), static_cast<int>(work.back()));
  EXPECT_LT(work[30], 10000u);  // 360,000, and 530,000 at most, when all of them were looked at
  EXPECT_LT(work.back(), 100000u);
}

/// The surface of a box, every face n x n squares of two triangles.
GeometryPtr box(const Vector3d& lower, const Vector3d& upper, std::size_t n) {
  std::vector<Vector3d> vertices;
  std::vector<fcl::Triangle> triangles;
  for (int k = 0; k < 3; ++k) {
    for (const double end : {0.0, 1.0}) {
      const std::size_t first = vertices.size();
      for (std::size_t i = 0; i <= n; ++i) {
        for (std::size_t j = 0; j <= n; ++j) {
          Vector3d part;
          part[k] = end;
          part[(k + 1) % 3] = static_cast<double>(i) / static_cast<double>(n);
          part[(k + 2) % 3] = static_cast<double>(j) / static_cast<double>(n);
          vertices.push_back(lower + part.cwiseProduct(upper - lower));
        }
      }
      for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j < n; ++j) {
          const std::size_t a = first + i * (n + 1) + j, c = a + n + 1;
          triangles.emplace_back(a, a + 1, c);
          triangles.emplace_back(a + 1, c + 1, c);
        }
      }
    }
  }
  return mesh(vertices, triangles);
}

// Boxes that are deep in each other, some of their faces in one plane: of the first triangles that touch none may be
// proven to, and others are. (The first ones were the end of it: contact, not certain.)
TEST(PromiseSentences, ContactOfDeepBodiesIsCertainThoughSomeOfTheirFacesAreInOnePlane) {
  int asked = 0;
  for (const std::size_t n : {1, 2}) {  // of finer ones a few are not certain, as no two of their triangles cross
    const GeometryPtr still = box(Vector3d::Constant(-0.5), Vector3d::Constant(0.5), n);
    for (const double bottom : {-0.5, -0.375}) {
      for (const double top : {0.25, 0.5}) {
        const GeometryPtr moving = box(Vector3d(-0.25, -0.25, bottom), Vector3d(0.75, 0.75, top), n);
        for (const double speed : {0.0, 0.25}) {
          for (const auto mode : {fcl_artic::ContactMode::first, fcl_artic::ContactMode::any}) {
            CertifiedRequest request;
            request.mode = mode;
            const CertifiedPairResult result =
                slide(still, moving, at(Vector3d::Zero()), Vector3d(speed, 0, 0), request);
            EXPECT_EQ(result.status, Status::contact);
            EXPECT_TRUE(result.certain) << n << ", " << bottom << " to " << top << ", " << speed;
            ++asked;
          }
        }
      }
    }
  }
  EXPECT_EQ(asked, 32);
}

// A plate comes down on another one, a tile of it somewhat lower than the rest: both meet within one of the finest
// lanes. There are many pairs that can't be decided. Some of them are enough, and the tile may not be among them: no
// contact is late.
TEST(PromiseSentences, OfManyUndecidedPairsTheEarliestIsNotLate) {
  pairs::Random random(7);
  int contacts = 0;
  for (int i = 0; i < 150; ++i) {
    CertifiedRequest request;
    request.tolerance_time = std::pow(10, -1 - random.below(3));
    request.tolerance_distance = std::pow(10, -random.below(4));
    request.mode = random.chance(0.5) ? fcl_artic::ContactMode::first : fcl_artic::ContactMode::firstOfEveryPair;
    const double height = random.uniform(0.1, 0.6),
                 lower = 0.01 * std::floor(100 * random.uniform(0, 1)) * request.tolerance_time / 8;
    const std::size_t n = 4 + static_cast<std::size_t>(random.below(8));
    std::vector<Vector3d> vertices;
    std::vector<fcl::Triangle> triangles;
    for (std::size_t k = 0; k <= n; ++k) {
      for (std::size_t l = 0; l <= n; ++l) {
        vertices.emplace_back(2.0 * static_cast<double>(k) / static_cast<double>(n) - 1,
                              2.0 * static_cast<double>(l) / static_cast<double>(n) - 1, lower);
      }
    }
    for (std::size_t k = 0; k < n; ++k) {
      for (std::size_t l = 0; l < n; ++l) {
        const std::size_t c = k * (n + 1) + l;
        triangles.emplace_back(c, c + 1, c + n + 1);
        triangles.emplace_back(c + 1, c + n + 2, c + n + 1);
      }
    }
    const double x = random.uniform(-0.9, 0.8), y = random.uniform(-0.9, 0.8);
    for (const Vector3d& corner : {Vector3d(x, y, 0), Vector3d(x + 0.06, y, 0), Vector3d(x, y + 0.06, 0)}) {
      vertices.push_back(corner);
    }
    triangles.emplace_back(vertices.size() - 3, vertices.size() - 2, vertices.size() - 1);
    const Vector3d way(random.chance(0.5) ? 0 : random.uniform(-0.2, 0.2), 0, -1);
    const CertifiedPairResult result =
        slide(plate(2, n + 2), mesh(vertices, triangles), at({0, 0, height}), way, request);
    EXPECT_EQ(result.status, Status::contact);
    EXPECT_LE(result.t_lower, height + 1e-14) << i;
    contacts += result.status == Status::contact;
  }
  EXPECT_EQ(contacts, 150);
}

TEST(PromiseSentences, AnyModeOnEntryIsLeftAsItWas) {
  const auto ball = std::make_shared<fcl::Sphered>(0.1);
  const auto grain = std::make_shared<fcl::Boxd>(0.2, 0.2, 0.2);
  int asked = 0, told = 0, certain = 0;
  for (const int rounding : {FE_TONEAREST, FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
    for (const std::uint64_t flush : {std::uint64_t{0}, kFlushing}) {
      const std::uint64_t before = controlBits();
      const int rounding_before = std::fegetround();
      std::fesetround(rounding);
      setControlBits(controlBits() | flush);
      const std::uint64_t mode = controlBits();
      std::vector<std::uint64_t> seen;
      std::vector<std::pair<double, double>> brackets;
      bool free = true;
      {
        auto tree = std::make_shared<fcl_artic::KinematicTree>("slide");
        tree->addLink("base");
        tree->addLink("link");
        fcl_artic::Joint joint;
        joint.name = "joint";
        joint.type = fcl_artic::JointType::prismatic;
        joint.axis = Vector3d::UnitX();
        joint.parent = "base";
        joint.child = "link";
        tree->addJoint(joint);
        for (const GeometryPtr& geometry : {GeometryPtr(ball), GeometryPtr(grain)}) {
          fcl_artic::ArticulatedCollisionManager manager(tree);
          fcl::CollisionObjectd moving(geometry, Isometry3d::Identity()), still(geometry, at({0.7, 0, 0}));
          manager.bind("link", &moving);
          manager.registerObject(&still);
          manager.setup();
          for (const auto method : {fcl_artic::Method::standard, fcl_artic::Method::redon2004}) {
            for (const double to : {1.0, 0.4}) {
              CertifiedRequest request;
              request.method = method;
              request.progress = [&](double) {
                ++told;
                const std::uint64_t here = controlBits();
                seen.push_back(here == kUsualControl ? mode : here);  // his own, or the usual one
                return true;
              };
              fcl_artic::CertifiedResult result;
              manager.continuousCollide(
                  fcl_artic::JointMotion::linear(*tree, Eigen::VectorXd::Zero(1), Eigen::VectorXd::Constant(1, to)),
                  request, result);
              seen.push_back(controlBits());
              ++asked;
              if (to < 0.5) free = free && result.isFree();
              if (to > 0.5) brackets.emplace_back(result.t_lower, result.certain ? result.t_upper : 2);
            }
          }
        }
      }
      std::fesetround(rounding_before);
      setControlBits(before);
      for (const std::uint64_t m : seen) EXPECT_EQ(m, mode);
      EXPECT_TRUE(free);
      for (const auto& [lower, upper] : brackets) {
        EXPECT_LE(lower, 0.5);
        EXPECT_GE(upper, 0.5);
        if (upper < 2) {
          EXPECT_LE(upper - lower, 1e-6);
        }
        certain += upper < 2;
      }
    }
  }
  EXPECT_EQ(asked, 64);
  EXPECT_GE(certain, 24);  // faces head on are not, in the paper's method
  EXPECT_GE(told, 8);
}

}  // namespace

}  // namespace sentences_test
