// SPDX-License-Identifier: BSD-3-Clause
//
// Meshes that are solids, in the manager: what lies within one touches it. A cart on a rail along x, with times worked
// out by hand.
#include <cmath>

#include <fcl/geometry/octree/octree.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cone.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/ellipsoid.h>
#include <fcl/geometry/shape/halfspace.h>
#include <fcl/geometry/shape/triangle_p.h>
#include <fcl/math/motion/translation_motion.h>

#include "expect_time.h"
#include "fcl_artic/clearance.h"
#include "fcl_artic/trajectory.h"
#include "solid_meshes.h"

namespace solid_mesh_test {

using namespace fcl_artic;
using namespace fcl_artic::test;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

using Geometry = std::shared_ptr<fcl::CollisionGeometryd>;

/// Contact that is proven at t = 0 and no later.
testing::AssertionResult touchesAtStart(const CertifiedResult& r) {
  if (r.status != Status::contact) return testing::AssertionFailure() << "status " << static_cast<int>(r.status);
  if (!r.certain || r.t_lower != 0 || r.t_upper != 0) {
    return testing::AssertionFailure() << "[" << r.t_lower << ", " << r.t_upper << "], certain " << r.certain;
  }
  if (r.contacts.empty() || r.contacts[0].t_lower != 0 || r.contacts[0].t_upper != 0 || !r.contacts[0].certain) {
    return testing::AssertionFailure() << "its contact is another one";
  }
  return testing::AssertionSuccess();
}

std::vector<CertifiedRequest> allKinds() {
  std::vector<CertifiedRequest> kinds;
  for (const ContactMode mode : {ContactMode::first, ContactMode::any, ContactMode::firstOfEveryPair}) {
    for (const Method method : {Method::standard, Method::redon2004}) {
      for (const VisibilityMode visibility : {VisibilityMode::off, VisibilityMode::on}) {
        for (const double margin : {0.0, 0.01}) {
          CertifiedRequest request;
          request.mode = mode;
          request.method = method;
          request.visibility = visibility;
          request.margin = margin;
          kinds.push_back(request);
        }
      }
    }
  }
  return kinds;
}

std::shared_ptr<fcl::Convexd> tetrahedron(double size) {
  const auto vertices = std::make_shared<std::vector<Vector3d>>(
      std::vector<Vector3d>{{size, size, size}, {size, -size, -size}, {-size, size, -size}, {-size, -size, size}});
  const auto faces =
      std::make_shared<std::vector<int>>(std::vector<int>{3, 0, 1, 2, 3, 0, 3, 1, 3, 0, 2, 3, 3, 1, 3, 2});
  return std::make_shared<fcl::Convexd>(vertices, 4, faces);
}

std::shared_ptr<fcl::OcTreed> cells() {
  auto tree = std::make_shared<octomap::OcTree>(0.05);
  tree->updateNode(octomap::point3d(0.12f, 0.02f, 0.02f), true);
  tree->updateNode(octomap::point3d(-0.12f, 0.02f, 0.07f), true);
  return std::make_shared<fcl::OcTreed>(tree);
}

std::vector<Geometry> smallBodies() {
  return {std::make_shared<fcl::Sphered>(0.1),
          std::make_shared<fcl::Boxd>(0.1, 0.2, 0.15),
          std::make_shared<fcl::Cylinderd>(0.1, 0.3),
          std::make_shared<fcl::Coned>(0.1, 0.3),
          std::make_shared<fcl::Capsuled>(0.1, 0.2),
          std::make_shared<fcl::Ellipsoidd>(0.1, 0.2, 0.05),
          tetrahedron(0.15),
          std::make_shared<fcl::TrianglePd>(Vector3d(0.1, 0, 0), Vector3d(0, 0.1, 0), Vector3d(0, 0, 0.1)),
          cells(),
          cubeMesh(0.1),
          boxMesh({0.1, 0.1, 0.1}, false),
          solidCube(0.1)};
}

}  // namespace

// A cart at rest in the middle of a cube of 2 m: free of the cube's surface, not of the cube.
TEST(SolidMesh, EveryBodyWithinOneTouchesIt) {
  int kinds = 0;
  for (const Geometry& small : smallBodies()) {
    for (const bool solid : {false, true}) {
      for (const bool link_is_large : {false, true}) {
        const Geometry large = solid ? Geometry(solidCube(1)) : Geometry(cubeMesh(1));
        Cart cart(link_is_large ? large : small);
        const auto obstacle = object(link_is_large ? small : large);
        cart.manager->registerObject(obstacle.get(), "obstacle");
        cart.manager->setup();
        for (const CertifiedRequest& request : allKinds()) {
          const CertifiedResult r = cart.run(-0.1, 0.2, request);
          if (!solid) {
            EXPECT_TRUE(r.isFree()) << "a mesh is its surface";
            continue;
          }
          EXPECT_TRUE(touchesAtStart(r)) << "body " << kinds << ", the link is the larger one: " << link_is_large;
          ASSERT_EQ(r.contacts.size(), 1u);
          const CertifiedContact& c = r.contacts[0];
          EXPECT_EQ(c.body1.name, "cart");
          EXPECT_EQ(c.body2.name, "obstacle");
          EXPECT_EQ(c.feature, FeatureKind::volume);
          EXPECT_EQ(c.b1, -1);                            // of no triangle
          EXPECT_LT(c.point.cwiseAbs().maxCoeff(), 0.5);  // of the body within
          EXPECT_NEAR(c.normal.norm(), 1, 1e-12);
        }
      }
    }
    ++kinds;
  }
}

// The shortest way out: a ball at x = 0.6 leaves a cube of 2 m along x. The normal points from the link to the
// obstacle.
TEST(SolidMesh, NormalIsTheShortestWayOut) {
  Cart cart;
  const auto cube = object(solidCube(1));
  cart.manager->registerObject(cube.get(), "cube");
  cart.manager->setup();
  const CertifiedResult r = cart.run(0.6, 0.6);
  ASSERT_TRUE(touchesAtStart(r));
  EXPECT_NEAR(r.contacts[0].normal.x(), -1, 1e-9);
  EXPECT_NEAR((r.contacts[0].point - Vector3d(0.6, 0, 0)).norm(), 0, 1e-9);
}

// A ball that is not within is as before: from x = 3 to 0 the ball of 0.1 meets the cube's side x = 1 at 3 - 3 t = 1.1.
TEST(SolidMesh, SurfacesMeetAsBefore) {
  for (const Geometry& geometry : {Geometry(cubeMesh(1)), Geometry(solidCube(1))}) {
    Cart cart;
    const auto cube = object(geometry);
    cart.manager->registerObject(cube.get(), "cube");
    cart.manager->setup();
    EXPECT_TRUE(touchesAt(cart.run(3, 0), 1.9 / 3));
    EXPECT_TRUE(cart.run(3, 1.2).isFree());
    EXPECT_TRUE(cart.run(-1.2, -4).isFree());
  }
}

// A tube along the rail with a hole of 0.6 m: a rod in the hole is free, one in the wall is not, wholly within or not.
TEST(SolidMesh, RodInTheHoleOfATubeIsFree) {
  const auto tube = object(solidTube(1, 0.3, 2), pose({0, 0, 0}, 1.5707963267948966, Vector3d::UnitY()));
  const auto rodAt = [&](double y, double half_length) {
    Cart cart;
    const auto rod = object(std::make_shared<fcl::Boxd>(2 * half_length, 0.1, 0.1));
    cart.manager->unbind(cart.body.get());
    cart.manager->bind("cart", rod.get(), pose({0, y, 0}));
    cart.manager->registerObject(tube.get(), "tube");
    cart.manager->setup();
    return cart.run(-0.5, 0.5);
  };
  EXPECT_TRUE(rodAt(0, 1).isFree());
  EXPECT_TRUE(rodAt(0.2, 3).isFree());
  EXPECT_TRUE(touchesAtStart(rodAt(0.7, 1)));
  EXPECT_TRUE(touchesAtStart(rodAt(-0.6, 0.2)));
  EXPECT_TRUE(touchesAt(rodAt(0.3, 1), 0));  // through the inner wall
}

// One part within another: facing the other way it is the border of a cavity; the same way, nothing.
TEST(SolidMesh, CavitiesAreOutside) {
  const auto run = [](const Geometry& geometry) {
    Cart cart;
    const auto cube = object(geometry);
    cart.manager->registerObject(cube.get(), "cube");
    cart.manager->setup();
    return std::make_pair(cart.run(-0.2, 0.2), cart.run(0.72, 0.78));  // in the cavity; in the wall
  };
  EXPECT_TRUE(run(hollowCube()).first.isFree());
  EXPECT_TRUE(touchesAtStart(run(hollowCube()).second));
  Soup inside_out;  // all of it
  inside_out.addBox({1, 1, 1});
  inside_out.addBox({0.5, 0.5, 0.5}, {0, 0, 0}, true);
  inside_out.flip();
  EXPECT_TRUE(run(inside_out.solid()).first.isFree());
  EXPECT_TRUE(touchesAtStart(run(inside_out.solid()).second));
  Soup alike;
  alike.addBox({1, 1, 1});
  alike.addBox({0.5, 0.5, 0.5});
  EXPECT_TRUE(touchesAtStart(run(alike.solid()).first));
  EXPECT_TRUE(touchesAtStart(run(alike.solid()).second));
}

// Each part of a mesh counts by itself: a link of two cubes 4 m apart, the second of which is within the obstacle, or
// around it; its surface only, too.
TEST(SolidMesh, EveryPartCounts) {
  Soup dumbbell;
  dumbbell.addBox({0.2, 0.2, 0.2}, {-2, 0, 0});
  dumbbell.addBox({0.2, 0.2, 0.2}, {2, 0, 0});
  for (const bool solid_link : {false, true}) {
    Cart cart(solid_link ? Geometry(dumbbell.solid()) : Geometry(dumbbell.surface()));
    const auto large = object(solidCube(0.5), pose({2, 0, 0})), small = object(cubeMesh(0.05), pose({-2, 0, 0}));
    cart.manager->registerObject(large.get(), "large");
    cart.manager->setup();
    EXPECT_TRUE(touchesAtStart(cart.run(0, 0.1)));
    EXPECT_TRUE(cart.run(-0.75, -0.8).isFree());
    cart.manager->unregisterObject(large.get());
    cart.manager->registerObject(small.get(), "small");
    cart.manager->setup();
    if (solid_link) {
      EXPECT_TRUE(touchesAtStart(cart.run(0, 0.1)));
    } else {
      EXPECT_TRUE(cart.run(0, 0.1).isFree());
    }
  }
}

// The first contact of every pair: two bodies in the cube, one that comes to another obstacle later.
TEST(SolidMesh, FirstOfEveryPair) {
  Cart cart;
  const auto cube = object(solidCube(1)), around = object(solidCube(3)), wall = ball(0.1, {1.5, 0, 0});
  const auto far = ball(0.1, {2.5, 0, 0});
  cart.manager->registerObject(cube.get(), "cube");
  cart.manager->registerObject(around.get(), "around");
  cart.manager->registerObject(wall.get(), "wall");
  cart.manager->registerObject(far.get(), "far");
  cart.manager->setup();
  CertifiedRequest request;
  request.mode = ContactMode::firstOfEveryPair;
  request.max_contacts = 10;
  const CertifiedResult r = cart.run(0, 2, request);
  EXPECT_TRUE(touchesAtStart(r));
  std::map<std::string, std::pair<double, double>> brackets;
  for (const CertifiedContact& c : r.contacts) {
    if (!brackets.count(c.body2.name)) brackets[c.body2.name] = {c.t_lower, c.t_upper};
  }
  ASSERT_EQ(brackets.size(), 3u);
  EXPECT_EQ(brackets["cube"], std::make_pair(0.0, 0.0));
  EXPECT_EQ(brackets["around"], std::make_pair(0.0, 0.0));
  EXPECT_LE(brackets["wall"].first, 0.65 + 1e-9);
  EXPECT_GE(brackets["wall"].second, 0.65 - 1e-9);
}

// From the middle of a cube outward: ignored until it has left, and met from outside by the next one.
TEST(SolidMesh, IgnoredUntilItHasLeft) {
  for (const ContactMode mode : {ContactMode::first, ContactMode::firstOfEveryPair}) {
    Cart cart;
    const auto cube = object(solidCube(1)), next = object(solidCube(1), pose({4, 0, 0}));
    cart.manager->registerObject(cube.get(), "cube");
    cart.manager->registerObject(next.get(), "next");
    cart.manager->setup();
    CertifiedRequest request;
    request.mode = mode;
    request.ignore_initial_contact = true;
    CertifiedResult r = cart.run(0, 2, request);  // out of the cube, not to the next one
    EXPECT_TRUE(r.isFree());
    ASSERT_EQ(r.ignored_initial_contacts.size(), 1u);
    EXPECT_EQ(r.ignored_initial_contacts[0].first.name, "cube");
    EXPECT_TRUE(touchesAt(cart.run(0, 4, request), 2.9 / 4));  // into the next one
    r = cart.run(-0.2, 0.3, request);                          // within all the time
    EXPECT_TRUE(r.isFree());
    EXPECT_EQ(r.ignored_initial_contacts.size(), 1u);
    r = cart.run(1.5, 2, request);  // not within
    EXPECT_TRUE(r.isFree());
    EXPECT_EQ(r.ignored_initial_contacts.size(), 0u);
  }
}

// A ball of 0.1 begins in a hollow cube's wall at x = -0.75, is outside in the cavity around 0 and enters the other
// wall, from x = 0.5 on: contact at -0.75 + 1.5 t = 0.4.
TEST(SolidMesh, WatchedFromWhenItIsOutside) {
  Cart cart;
  const auto cube = object(hollowCube());
  cart.manager->registerObject(cube.get(), "cube");
  cart.manager->setup();
  CertifiedRequest request;
  request.ignore_initial_contact = true;
  EXPECT_TRUE(touchesAt(cart.run(-0.75, 0.75, request), 1.15 / 1.5));
  // From the cavity into the wall and on within it, where surfaces are apart: the ball of 0.1 is within at x = 0.75.
  EXPECT_TRUE(touchesAt(cart.run(0, 0.75), 0.4 / 0.75));
  // From the cavity's border, touching, into the wall: never apart, though the surfaces are at the end.
  EXPECT_TRUE(cart.run(0.45, 0.75, request).isFree());
  EXPECT_TRUE(cart.run(0.45, 2, request).isFree());  // and out of it on the other side
  // The same in pieces: a trajectory that begins in the border and moves within the wall.
  const auto trajectory = JointTrajectory::linear(
      *cart.tree, {0, 1, 2}, {VectorXd::Constant(1, 0.45), VectorXd::Constant(1, 0.75), VectorXd::Constant(1, 0.72)});
  CertifiedResult r;
  cart.manager->continuousCollide(trajectory, request, r);
  EXPECT_TRUE(r.isFree());
  EXPECT_EQ(r.ignored_initial_contacts.size(), 1u);
  cart.manager->continuousCollide(trajectory, CertifiedRequest(), r);
  EXPECT_EQ(r.status, Status::contact);
  EXPECT_EQ(r.t_lower, 0);
}

// A trajectory from within the cube, out of it and back: met when it comes back.
TEST(SolidMesh, Trajectory) {
  Cart cart;
  const auto cube = object(solidCube(1));
  cart.manager->registerObject(cube.get(), "cube");
  cart.manager->setup();
  const auto trajectory = JointTrajectory::linear(
      *cart.tree, {0, 1, 2, 3},
      {VectorXd::Constant(1, 0.1), VectorXd::Constant(1, 0.2), VectorXd::Constant(1, 2.2), VectorXd::Constant(1, 0.2)});
  CertifiedRequest request;
  CertifiedResult r;
  cart.manager->continuousCollide(trajectory, request, r);
  EXPECT_TRUE(touchesAtStart(r));
  request.ignore_initial_contact = true;
  cart.manager->continuousCollide(trajectory, request, r);
  ASSERT_EQ(r.status, Status::contact);
  EXPECT_LE(r.t_lower, 2 + 1.1 / 2 + 1e-9);  // 2.2 - 2 (t - 2) = 1.1
  EXPECT_GE(r.t_upper, 2 + 1.1 / 2 - 1e-9);
  EXPECT_TRUE(r.certain);
  EXPECT_EQ(r.ignored_initial_contacts.size(), 1u);
}

TEST(SolidMesh, BatchAndOneConfiguration) {
  Cart cart;
  const auto cube = object(solidCube(1));
  cart.manager->registerObject(cube.get(), "cube");
  cart.manager->setup();
  std::vector<JointMotion> motions;
  for (const double x : {0.0, 2.0, 0.5, -3.0}) {
    motions.push_back(JointMotion::linear(*cart.tree, VectorXd::Constant(1, x), VectorXd::Constant(1, x + 0.1)));
  }
  std::vector<CertifiedResult> results;
  cart.manager->continuousCollide(motions, CertifiedRequest(), results, 2);
  EXPECT_TRUE(touchesAtStart(results[0]));
  EXPECT_TRUE(results[1].isFree());
  EXPECT_TRUE(touchesAtStart(results[2]));
  EXPECT_TRUE(results[3].isFree());
  CertifiedResult r;
  cart.manager->collide(VectorXd::Constant(1, 0.2), CertifiedRequest(), r);
  EXPECT_TRUE(touchesAtStart(r));
}

TEST(SolidMesh, ClearanceIsZeroWithinOne) {
  for (const bool solid : {false, true}) {
    Cart cart;
    const auto cube = object(solid ? Geometry(solidCube(1)) : Geometry(cubeMesh(1)));
    cart.manager->registerObject(cube.get(), "cube");
    cart.manager->setup();
    const JointMotion motion = JointMotion::linear(*cart.tree, VectorXd::Constant(1, -0.1), VectorXd::Constant(1, 0.2));
    const Clearance c = cart.manager->clearance(motion);
    if (solid) {
      EXPECT_EQ(c.upper, 0);
      EXPECT_EQ(c.lower, 0);
      EXPECT_EQ(c.time, 0);
    } else {
      EXPECT_NEAR(c.lower, 0.7, 1e-3);
    }
  }
}

// Two links, one within the other: their table proves the surfaces apart all over, and must not be taken for more.
TEST(SolidMesh, TablesKnowSurfacesOnly) {
  for (const bool solid : {false, true}) {
    auto tree = std::make_shared<KinematicTree>("press");
    for (const char* link : {"frame", "carrier", "slider"}) tree->addLink(link);
    Joint one = makeJoint("one", JointType::prismatic, "frame", "carrier", Vector3d::UnitX());
    Joint two = makeJoint("two", JointType::prismatic, "carrier", "slider", Vector3d::UnitY());
    for (Joint* joint : {&one, &two}) {
      joint->lower = -0.3;
      joint->upper = 0.3;
    }
    tree->addJoint(one);
    tree->addJoint(two);
    ArticulatedCollisionManager manager(tree);
    const auto frame = object(solid ? Geometry(solidCube(1)) : Geometry(cubeMesh(1))), body = ball(0.1),
               carrier = ball(0.1);
    manager.bind("frame", frame.get());
    manager.bind("slider", body.get());
    manager.bind("carrier", carrier.get(), pose({9, 0, 0}));
    manager.setup();
    for (CertifiedRequest request : allKinds()) {
      const CertifiedResult r = ask(manager, VectorXd::Zero(2), VectorXd::Constant(2, 0.2), request);
      if (solid) {
        EXPECT_TRUE(touchesAtStart(r));
      } else {
        EXPECT_TRUE(r.isFree());
      }
      request.ignore_initial_contact = true;
      const CertifiedResult ignored = ask(manager, VectorXd::Zero(2), VectorXd::Constant(2, 0.2), request);
      EXPECT_TRUE(ignored.isFree());
      EXPECT_EQ(ignored.ignored_initial_contacts.size(), solid ? 1u : 0u);
    }
  }
}

// An obstacle that moves about with the cart within it; the cart within one that stands still, and the other way round.
TEST(SolidMesh, MovingObstacle) {
  for (const bool solid : {false, true}) {
    Cart cart;
    fcl::ContinuousCollisionObjectd moving(
        solid ? Geometry(solidCube(1)) : Geometry(cubeMesh(1)),
        std::make_shared<fcl::TranslationMotiond>(pose({-0.5, 0, 0}), pose({0.5, 0, 0})));
    cart.manager->registerObject(&moving, "moving");
    cart.manager->setup();
    for (const CertifiedRequest& request : allKinds()) {
      const CertifiedResult r = cart.run(0, 0, request);
      if (solid) {
        EXPECT_TRUE(touchesAtStart(r));
      } else {
        EXPECT_TRUE(r.isFree());
      }
    }
    EXPECT_TRUE(cart.run(2, 2).isFree());
  }
}

// A ball that the cart takes up and carries in the cube, and what it carries as a solid around a ball.
TEST(SolidMesh, AttachedObjects) {
  Cart cart;
  const auto cube = object(solidCube(1)), carried = ball(0.1, {5, 0, 0}),
             cover = object(solidCube(0.5), pose({9, 0, 0}));
  const auto post = ball(0.05, {7, 0, 0});
  for (const auto& [o, name] : {std::make_pair(cube, "cube"), {carried, "carried"}, {cover, "cover"}, {post, "post"}}) {
    cart.manager->registerObject(o.get(), name);
  }
  cart.manager->attach("cart", carried.get(), pose({-2, 0, 0}));
  cart.manager->setup();
  EXPECT_TRUE(touchesAtStart(cart.run(2, 2.1)));
  EXPECT_TRUE(cart.run(4, 4.1).isFree());
  cart.manager->detach(carried.get());
  cart.manager->attach("cart", cover.get(), pose({3, 0, 0}));
  cart.manager->setup();
  EXPECT_TRUE(touchesAtStart(cart.run(4, 4.1)));
  EXPECT_TRUE(cart.run(3, 3.1).isFree());
  cart.manager->detach(cover.get());
  cart.manager->setup();
  EXPECT_TRUE(cart.run(4, 4.1).isFree());
}

// Allowed pairs are not looked at, and neither is what the request leaves out.
TEST(SolidMesh, OnlyPairsThatAreAskedFor) {
  Cart cart;
  const auto cube = object(solidCube(1));
  cart.manager->registerObject(cube.get(), "cube");
  cart.manager->setup();
  CertifiedRequest request;
  request.check_scene = false;
  EXPECT_TRUE(cart.run(0, 0.1, request).isFree());
  AllowedCollisionMatrix allowed;
  allowed.allow("cart", "cube");
  cart.manager->setAllowedCollisions(allowed);
  cart.manager->setup();
  EXPECT_TRUE(cart.run(0, 0.1).isFree());
}

// An unbounded obstacle is not within a bounded one; a mesh beyond a half-space's border is in the half-space.
TEST(SolidMesh, HalfspaceBesideASolid) {
  Cart cart(solidCube(1));
  fcl::ContinuousCollisionObjectd ground(std::make_shared<fcl::Halfspaced>(Vector3d(0, 0, 1), -1.5),
                                         std::make_shared<fcl::TranslationMotiond>(pose({0, 0, 0}), pose({0, 0, 1})));
  cart.manager->registerObject(&ground, "ground");
  cart.manager->setup();
  EXPECT_TRUE(touchesAt(cart.run(0, 0), 0.5));
}

// At the door: closed and consistently oriented, with the obstacle's name, the reason and an edge where it is not.
/// The same vertices and triangles, byte for byte, as a surface and as a solid are two geometries.
TEST(SolidMesh, SurfaceThatBecomesASolidIsReadAgain) {
  const auto surface = cubeMesh(1);
  fcl::CollisionObjectd around(surface);
  for (const bool one : {true, false}) {
    around = fcl::CollisionObjectd(surface);
    Cart cart(std::make_shared<fcl::Sphered>(0.1));
    cart.manager->registerObject(&around);
    cart.manager->setup();
    EXPECT_TRUE(cart.run(0, 0.1).isFree());
    around = fcl::CollisionObjectd(std::make_shared<Solid>(*surface));
    one ? cart.manager->update(&around) : cart.manager->setup();
    EXPECT_TRUE(touchesAtStart(cart.run(0, 0.1)));
  }
}

TEST(SolidMesh, OthersAreRefused) {
  const auto reason = [](const Soup& soup) -> std::string {
    Cart cart;
    const auto body = object(soup.solid());
    try {
      cart.manager->registerObject(body.get(), "bowl");
      cart.manager->setup();
    } catch (const std::invalid_argument& e) {
      return e.what();
    }
    return "";
  };
  Soup box;
  box.addBox({1, 1, 1});
  EXPECT_EQ(reason(box), "");
  Soup open = box;
  open.triangles.pop_back();
  EXPECT_NE(reason(open).find("obstacle 'bowl'"), std::string::npos) << reason(open);
  EXPECT_NE(reason(open).find("not closed: 3 edges belong to an odd number of triangles"), std::string::npos);
  EXPECT_NE(reason(open).find("(-1, "), std::string::npos) << reason(open);
  Soup turned = box;
  std::swap(turned.triangles[3][0], turned.triangles[3][1]);
  EXPECT_NE(reason(turned).find("not consistently oriented: 3 edges"), std::string::npos) << reason(turned);
  Soup inside_out = box;
  inside_out.flip();
  EXPECT_EQ(reason(inside_out), "");
  Soup degenerate = box;  // a triangle without area, two of its corners in one place: it has no edges
  degenerate.triangles.emplace_back(0, 1, 0);
  EXPECT_EQ(reason(degenerate), "");
  Soup split = box;  // an edge cut in two on the one side, with a triangle of no area between the halves
  const Vector3d a = box.vertices[box.triangles[0][0]], b = box.vertices[box.triangles[0][1]], m = 0.5 * (a + b);
  const std::size_t n = split.vertices.size();
  split.vertices.insert(split.vertices.end(), {a, m, b});
  const fcl::Triangle t = split.triangles[0];
  split.triangles[0] = fcl::Triangle(t[0], n + 1, t[2]);
  split.triangles.emplace_back(n + 1, t[1], t[2]);
  EXPECT_NE(reason(split).find("not closed"), std::string::npos);
  split.triangles.emplace_back(n, n + 2, n + 1);
  EXPECT_EQ(reason(split), "") << "closed by the triangle without area";
  Soup pair = box;  // two cubes that share an edge: it is passed twice each way
  pair.addBox({1, 1, 1}, {2, 2, 0});
  EXPECT_EQ(reason(pair), "");
}

}  // namespace solid_mesh_test
