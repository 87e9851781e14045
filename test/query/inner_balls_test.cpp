// SPDX-License-Identifier: BSD-3-Clause
//
// Links whose meshes are closed, where any contact will do: what they enclose meets, and it is their surfaces that
// touch.
#include <cmath>
#include <cstdio>
#include <random>

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/narrowphase/collision.h>
#include <gtest/gtest.h>

#include "crossing_links.h"

namespace inner_balls_test {

using namespace fcl_artic;
using namespace fcl_artic::test;
using Eigen::Isometry3d;
using Eigen::Vector3d;

namespace {

/// A mesh's vertices moved, and with those of another one added.
std::shared_ptr<Mesh> together(const Mesh& a, const Mesh& b, const Isometry3d& M) {
  std::vector<Vector3d> v(a.vertices, a.vertices + a.num_vertices);
  std::vector<fcl::Triangle> t(a.tri_indices, a.tri_indices + a.num_tris);
  for (int i = 0; i < b.num_vertices; ++i) v.push_back(M * b.vertices[i]);
  for (int i = 0; i < b.num_tris; ++i) {
    const fcl::Triangle& s = b.tri_indices[i];
    const std::size_t first = static_cast<std::size_t>(a.num_vertices);
    t.emplace_back(first + s[0], first + s[1], first + s[2]);
  }
  return meshOf(v, t);
}

bool touch(const fcl::CollisionGeometryd& a, const Isometry3d& A, const fcl::CollisionGeometryd& b,
           const Isometry3d& B) {
  fcl::CollisionRequestd request;
  fcl::CollisionResultd result;
  return fcl::collide(&a, A, &b, B, request, result) > 0;
}

Isometry3d along(double x) {
  return pose(Vector3d(x, 0, 0));
}

bool provenByBalls(const CertifiedResult& r) {
  return r.certain && r.contacts.at(0).feature == FeatureKind::volume && r.contacts[0].b1 == -1 &&
         r.contacts[0].b2 == -1;
}

}  // namespace

/// Half in each other: proven by what they enclose, and the report says so.
TEST(InnerBalls, DeepLinksTouch) {
  const auto a = fineBoxMesh(Vector3d(0.3, 0.2, 0.2), 4), b = fineBoxMesh(Vector3d(0.25, 0.15, 0.3), 3);
  const CrossingLinks links(a, b, pose(Vector3d(0, 0.05, 0.02), 0.3));
  const CertifiedResult r = links.run(-1, 1);
  ASSERT_EQ(r.status, Status::contact);
  ASSERT_TRUE(provenByBalls(r));
  const CertifiedContact& contact = r.contacts[0];
  EXPECT_TRUE(touch(*a, Isometry3d::Identity(), *b, along(-1 + 2 * contact.t_upper) * links.at));
  // A point of both; the normal goes from the one towards the other.
  const Vector3d in_b = (along(-1 + 2 * contact.t_upper) * links.at).inverse() * contact.point;
  EXPECT_TRUE((contact.point.cwiseAbs().array() < Vector3d(0.3, 0.2, 0.2).array()).all());
  EXPECT_TRUE((in_b.cwiseAbs().array() < Vector3d(0.25, 0.15, 0.3).array()).all());
  EXPECT_NEAR(contact.normal.norm(), 1, 1e-12);
  EXPECT_EQ(contact.toFcl().b1, -1);
}

/// A link that two joints fold onto another one.
struct FoldingLinks {
  std::shared_ptr<Mesh> mesh = fineBoxMesh(Vector3d(0.4, 0.1, 0.1), 4);
  fcl::CollisionObjectd still{mesh}, turning{mesh};
  std::shared_ptr<KinematicTree> tree = std::make_shared<KinematicTree>("folding");
  std::unique_ptr<ArticulatedCollisionManager> manager;

  /// @param limit  of both joints, rad; 0: none.
  explicit FoldingLinks(double limit) {
    for (const char* link : {"still", "between", "turning"}) tree->addLink(link);
    Joint joint = makeJoint("lift", limit > 0 ? JointType::revolute : JointType::continuous, "still", "between",
                            Vector3d::UnitY(), pose(Vector3d(0.5, 0, 0)));
    joint.lower = -limit;
    joint.upper = limit;
    tree->addJoint(joint);
    joint.name = "fold", joint.parent = "between", joint.child = "turning";
    joint.origin = pose(Vector3d(0.02, 0, 0));
    tree->addJoint(joint);
    manager = std::make_unique<ArticulatedCollisionManager>(tree);
    manager->bind("still", &still);
    manager->bind("turning", &turning, pose(Vector3d(0.5, 0, 0)));
    manager->setup();
  }
  CertifiedResult run(const Eigen::Vector2d& q0, const Eigen::Vector2d& q1, ContactMode mode = ContactMode::any) const {
    CertifiedRequest request;
    request.mode = mode;
    return ask(*manager, q0, q1, request);
  }
};

/// Where contact is likely is looked at before all else. (Stage 1 counts the pairs.)
TEST(InnerBalls, LikelyContactsComeFirst) {
  constexpr double kTurn = 2 * 3.14159265358979323846;
  for (const double limit : {0.0, 3.0}) {
    const FoldingLinks links(limit);
    for (int turns = -2; turns <= 2; ++turns) {
      if (limit > 0 && turns) continue;
      const Eigen::Vector2d whole = turns * kTurn * Eigen::Vector2d(1, -3);
      const CertifiedResult r = links.run(Eigen::Vector2d(1.0, 1.0) + whole, Eigen::Vector2d(1.6, 1.9) + whole);
      ASSERT_TRUE(provenByBalls(r)) << turns;
      EXPECT_EQ(r.statistics.pairs, 0u) << turns;
    }
    EXPECT_EQ(links.run({-0.2, 0.1}, {1.2, -0.9}).status, Status::free);
  }
}

/// A guess that is wrong changes no answer: any contact and first contact agree on which motions are free, beyond
/// limits too.
TEST(InnerBalls, GuessesAreNoAnswers) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> u(-1, 1);
  int free = 0, guessed = 0, beyond = 0;
  for (const double limit : {0.0, 2.5}) {
    const FoldingLinks links(limit);
    for (int i = 0; i < 1000; ++i) {
      const Eigen::Vector2d q0 = 3.5 * Eigen::Vector2d(u(random), u(random));
      const Eigen::Vector2d q1 = q0 + (i % 2 ? 0.2 : 1.5) * Eigen::Vector2d(u(random), u(random));
      const CertifiedResult any = links.run(q0, q1), first = links.run(q0, q1, ContactMode::first);
      EXPECT_EQ(any.isFree(), first.isFree()) << q0.transpose() << " to " << q1.transpose();
      free += any.isFree();
      beyond += limit > 0 && q1.cwiseAbs().maxCoeff() > limit;
      guessed += !any.isFree() && any.statistics.pairs == 0;
    }
  }
  std::printf("%d of 2000 free; %d contacts guessed; %d motions end beyond limits\n", free, guessed, beyond);
  EXPECT_GT(free, 300);
  EXPECT_GT(guessed, 300);
  EXPECT_GT(beyond, 100);
}

/// A link that moves about in the hollow of another touches nothing, though what that one's surface goes around holds
/// it.
TEST(InnerBalls, LinkWithinAnotherIsFree) {
  const auto large = fineBoxMesh(Vector3d::Constant(1), 6), small = fineBoxMesh(Vector3d(0.2, 0.3, 0.25), 2);
  for (const bool swapped : {false, true}) {
    const CrossingLinks links(swapped ? small : large, swapped ? large : small, pose(Vector3d(0, 0.1, -0.1), 0.4));
    EXPECT_EQ(links.run(-0.3, 0.3).status, Status::free) << swapped;
    const CertifiedResult through = links.run(-0.3, 1.5);
    EXPECT_EQ(through.status, Status::contact) << swapped;
  }
  // The same with a wall: a second surface within the first.
  const auto hollow = together(*large, *fineBoxMesh(Vector3d::Constant(0.9), 5), Isometry3d::Identity());
  const CrossingLinks links(hollow, small, pose(Vector3d(0, 0.1, -0.1), 0.4));
  EXPECT_EQ(links.run(-0.3, 0.3).status, Status::free);
  // And in the wall, as far as that goes, where it is thick.
  const auto thick = together(*fineBoxMesh(Vector3d::Constant(2), 6), *large, Isometry3d::Identity());
  const CrossingLinks in_wall(thick, small, pose(Vector3d(1.5, 0, 0), 0.1));
  EXPECT_EQ(in_wall.run(-0.1, 0.1).status, Status::free);
}

/// A solid obstacle within a link touches nothing; one that reaches out of it does.
TEST(InnerBalls, ObstacleWithinALink) {
  struct Case {
    std::shared_ptr<fcl::CollisionGeometryd> geometry;
    bool reaches_out;
  };
  using Geometry = std::shared_ptr<fcl::CollisionGeometryd>;
  for (const Case& c :
       {Case{Geometry(new fcl::Boxd(0.4, 0.3, 0.5)), false}, Case{Geometry(new fcl::Boxd(0.2, 0.2, 2)), true},
        Case{Geometry(new fcl::Cylinderd(0.2, 0.5)), false}, Case{Geometry(new fcl::Cylinderd(0.1, 3)), true},
        Case{Geometry(new fcl::Capsuled(0.2, 0.3)), false}, Case{Geometry(new fcl::Capsuled(0.2, 2)), true},
        Case{Geometry(new fcl::Sphered(0.3)), false}}) {
    const auto mesh = fineBoxMesh(Vector3d(0.6, 0.6, 0.6), 4);
    const Cart cart(mesh);
    const auto obstacle = object(c.geometry, pose(Vector3d(0.02, 0.03, 0.01)));
    cart.manager->registerObject(obstacle.get());
    cart.manager->setup();
    CertifiedRequest request;
    request.mode = ContactMode::any;
    const CertifiedResult r = cart.run(-0.05, 0.05, request);
    EXPECT_EQ(r.status, c.reaches_out ? Status::contact : Status::free) << c.geometry->getNodeType();
    if (c.reaches_out) EXPECT_TRUE(provenByBalls(r)) << c.geometry->getNodeType();
    const CertifiedResult out = cart.run(-1, 0, request);
    ASSERT_EQ(out.status, Status::contact) << c.geometry->getNodeType();
    EXPECT_TRUE(touch(*mesh, along(-1 + out.t_upper), *c.geometry, obstacle->getTransform()))
        << c.geometry->getNodeType();
  }
}

/// Meshes of one and of two parts, anywhere: what is proven by balls is a contact of surfaces to FCL too, and both
/// modes say the same.
TEST(InnerBalls, FclAgrees) {
  std::mt19937 random(21);
  const auto in = [&](double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(random); };
  const auto size = [&](double least, double most) {
    return Vector3d(in(least, most), in(least, most), in(least, most));
  };
  int by_balls = 0, free = 0;
  for (int i = 0; i < 500; ++i) {
    const bool nested = i % 3 == 0;
    const Vector3d half = size(0.1, 0.4);
    auto a = fineBoxMesh(half, 1 + i % 4);
    if (i % 2)
      a = together(*a, *fineBoxMesh(nested ? Vector3d(0.9 * half) : size(0.05, 0.3), 2),
                   pose(nested ? Vector3d(0, 0, 0) : Vector3d(0.3, 0.1, 0)));
    const auto b = fineBoxMesh(nested ? Vector3d(in(0.2, 0.6) * half) : size(0.05, 0.4), 1 + i % 3);
    const double reach = nested ? 0.1 : 0.6;
    const CrossingLinks links(a, b,
                              pose(Vector3d(in(-reach, reach), in(-reach, reach), in(-reach, reach)), in(-3, 3),
                                   Vector3d(in(-1, 1), in(-1, 1), 1)));
    const double from = in(-reach, reach), to = in(-reach, reach);
    const CertifiedResult r = links.run(from, to);
    ASSERT_EQ(r.status, links.run(from, to, ContactMode::first).status) << i;
    free += r.isFree();
    if (r.isFree() || !provenByBalls(r)) continue;
    ++by_balls;
    const double x = from + r.contacts[0].t_upper * (to - from);
    ASSERT_TRUE(touch(*a, Isometry3d::Identity(), *b, along(x) * links.at)) << i;
  }
  std::printf("%d proven by balls, %d free\n", by_balls, free);
  EXPECT_GT(by_balls, 100);
  EXPECT_GT(free, 100);
}

}  // namespace inner_balls_test
