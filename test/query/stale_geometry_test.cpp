// SPDX-License-Identifier: BSD-3-Clause
//
// The next setup() or update() reads changes that callers make by themselves, of geometry in place above all.
#include <functional>
#include <limits>

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
#include <fcl/geometry/shape/triangle_p.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fcl/math/motion/translation_motion.h>
#include <gtest/gtest.h>

#include "arms.h"
#include "fcl_artic/continuous_manager.h"
#include "meshes.h"

namespace stale_geometry_test {

using namespace fcl_artic;
using namespace fcl_artic::test;
using Eigen::Vector3d;

namespace {

using Geometry = std::shared_ptr<fcl::CollisionGeometryd>;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// A geometry that lies within 0.5 of its origin, and what its owner does to it in place: then it reaches to x = -1.5.
struct Growing {
  const char* name;
  Geometry geometry;
  std::function<void()> grow;
};

std::vector<Growing> growing(bool bounded_only) {
  std::vector<Growing> all;
  const auto add = [&](const char* name, auto geometry, auto grow) {
    auto* raw = geometry.get();
    all.push_back({name, geometry, [raw, grow] { grow(*raw); }});
  };
  add("Box", std::make_shared<fcl::Boxd>(1, 1, 1), [](fcl::Boxd& g) { g.side[0] = 3; });
  add("Sphere", std::make_shared<fcl::Sphered>(0.5), [](fcl::Sphered& g) { g.radius = 1.5; });
  add("Capsule", std::make_shared<fcl::Capsuled>(0.4, 0.1), [](fcl::Capsuled& g) { g.radius = 1.5; });
  add("Cylinder", std::make_shared<fcl::Cylinderd>(0.4, 0.1), [](fcl::Cylinderd& g) { g.radius = 1.5; });
  add("Cone", std::make_shared<fcl::Coned>(0.4, 0.01), [](fcl::Coned& g) { g.radius = 1.5; });
  add("Ellipsoid", std::make_shared<fcl::Ellipsoidd>(0.4, 0.3, 0.3), [](fcl::Ellipsoidd& g) { g.radii[0] = 1.5; });
  add("TriangleP",
      std::make_shared<fcl::TrianglePd>(Vector3d(-0.4, 0, 0), Vector3d(0.4, 0.1, 0), Vector3d(0.4, 0, 0.1)),
      [](fcl::TrianglePd& g) { g.a[0] = -1.5; });
  const auto corners = std::make_shared<std::vector<Vector3d>>(
      std::vector<Vector3d>{{-0.4, 0, 0}, {0.4, -0.1, -0.1}, {0.4, 0.1, -0.1}, {0.4, 0, 0.1}});
  const auto faces =
      std::make_shared<std::vector<int>>(std::vector<int>{3, 0, 1, 2, 3, 0, 2, 3, 3, 0, 3, 1, 3, 1, 3, 2});
  add("Convex", std::make_shared<fcl::Convexd>(corners, 4, faces, true),
      [corners](fcl::Convexd&) { (*corners)[0][0] = -1.5; });
  const auto mesh = cubeMesh(0.4);
  add("BVHModel, vertices", mesh, [](Mesh& g) { g.vertices[0] = Vector3d(-1.5, 0, 0); });
  add("BVHModel, updateVertex", cubeMesh(0.4), [](Mesh& g) {
    const std::vector<Vector3d> before(g.vertices, g.vertices + g.num_vertices);
    g.beginUpdateModel();
    for (const Vector3d& v : before) g.updateVertex(Vector3d(v[0] < 0 ? -1.5 : v[0], v[1], v[2]));
    g.endUpdateModel(true, true);
  });
  // An unused vertex far away: a triangle is told to use it.
  const auto loose = std::make_shared<Mesh>();
  loose->beginModel();
  loose->addSubModel(std::vector<Vector3d>{{-0.4, 0, 0}, {0.4, 0.1, 0}, {0.4, 0, 0.1}, {-1.5, 0, 0}},
                     std::vector<fcl::Triangle>{fcl::Triangle(0, 1, 2)});
  loose->endModel();
  add("BVHModel, triangle", loose, [](Mesh& g) { g.tri_indices[0].set(3, 1, 2); });
  const auto cells = std::make_shared<octomap::OcTree>(0.25);
  cells->updateNode(octomap::point3d(0.1f, 0.1f, 0.1f), true);
  add("OcTree, cell", std::make_shared<fcl::OcTreed>(cells),
      [cells](fcl::OcTreed&) { cells->updateNode(octomap::point3d(-1.45f, 0.05f, 0.05f), true); });
  const auto doubtful = std::make_shared<octomap::OcTree>(0.25);
  doubtful->updateNode(octomap::point3d(0.1f, 0.1f, 0.1f), true);
  for (int i = 0; i < 3; ++i) doubtful->updateNode(octomap::point3d(0.1f, 0.1f, 0.1f), true);
  doubtful->updateNode(octomap::point3d(-1.45f, 0.05f, 0.05f), 0.1f);
  const auto strict = std::make_shared<fcl::OcTreed>(doubtful);
  strict->setOccupancyThres(0.9);
  add("OcTree, threshold", strict, [](fcl::OcTreed& g) { g.setOccupancyThres(0.5); });
  const auto empty = std::make_shared<octomap::OcTree>(0.25);
  add("OcTree, empty at first", std::make_shared<fcl::OcTreed>(empty),
      [empty](fcl::OcTreed&) { empty->updateNode(octomap::point3d(-1.45f, 0.05f, 0.05f), true); });
  if (bounded_only) return all;
  add("Halfspace", std::make_shared<fcl::Halfspaced>(-1, 0, 0, -0.5), [](fcl::Halfspaced& g) { g.d = 1.5; });
  add("Halfspace, normal", std::make_shared<fcl::Halfspaced>(-1, 0, 0, -1.5), [](fcl::Halfspaced& g) {
    g.n = {1, 0, 0};
  });
  add("Plane", std::make_shared<fcl::Planed>(1, 0, 0, 0.5), [](fcl::Planed& g) { g.d = -1.5; });
  add("Plane, normal", std::make_shared<fcl::Planed>(1, 0, 0, 1.5), [](fcl::Planed& g) { g.n = {-1, 0, 0}; });
  return all;
}

enum class How { update, updateObject, updateObjects, setup };
constexpr How kHows[] = {How::update, How::updateObject, How::updateObjects, How::setup};

void readAgain(ArticulatedCollisionManager& manager, How how, fcl::CollisionObjectd* object) {
  switch (how) {
    case How::update:
      return manager.update();
    case How::updateObject:
      return manager.update(object);
    case How::updateObjects:
      return manager.update(std::vector<fcl::CollisionObjectd*>{object});
    case How::setup:
      return manager.setup();
  }
}

}  // namespace

// The cart's ball comes to x = 0; the obstacle's frame is at x = 1.
TEST(StaleGeometry, Obstacle) {
  for (const How how : kHows) {
    for (const Growing& g : growing(false)) {
      Cart cart;
      const auto obstacle = object(g.geometry, pose({1, 0, 0}));
      cart.manager->registerObject(obstacle.get(), "obstacle");
      cart.manager->setup();
      EXPECT_TRUE(cart.run(-2, 0).isFree()) << g.name;
      g.grow();
      EXPECT_TRUE(cart.run(-2, 0).isFree()) << g.name << ": queries go by what was read";
      readAgain(*cart.manager, how, obstacle.get());
      EXPECT_EQ(cart.run(-2, 0).status, Status::contact) << g.name << ' ' << static_cast<int>(how);
    }
  }
}

TEST(StaleGeometry, LinksGeometry) {
  for (const How how : kHows) {
    for (const Growing& g : growing(true)) {
      Cart cart(g.geometry);
      const auto wall = ball(0.1, {-2.6, 0, 0});
      cart.manager->registerObject(wall.get(), "wall");
      cart.manager->setup();
      EXPECT_TRUE(cart.run(0, -1.2).isFree()) << g.name;
      g.grow();
      readAgain(*cart.manager, how, cart.body.get());
      EXPECT_EQ(cart.run(0, -1.2).status, Status::contact) << g.name << ' ' << static_cast<int>(how);
    }
  }
}

// A ball on the cart, and what grows on a link two slides before it: in one query they come within 1.5 m.
TEST(StaleGeometry, TwoLinksAndAnAttachedObject) {
  const auto run = [](const ArticulatedCollisionManager& manager) {
    return ask(manager, Vector3d(0, 0, 2), Vector3d(0, 0, 1.2));
  };
  for (const bool attached : {false, true}) {
    for (const How how : kHows) {
      for (const Growing& g : growing(true)) {
        ArticulatedCollisionManager manager(sliderTree({"rail", "cart", "middle", "front"}));
        const auto body = ball(0.1), grows = object(g.geometry, pose({9, 9, 9}));
        manager.bind("cart", body.get());
        if (attached) {
          manager.registerObject(grows.get(), "load");
          manager.attach("front", grows.get(), pose({0, 0, 0}));
        } else {
          manager.bind("front", grows.get());
        }
        manager.setup();
        EXPECT_TRUE(run(manager).isFree()) << g.name;
        g.grow();
        readAgain(manager, how, grows.get());
        EXPECT_EQ(run(manager).status, Status::contact) << g.name << ' ' << static_cast<int>(how) << attached;
      }
    }
  }
}

TEST(StaleGeometry, MovingObstacle) {
  for (const int how : {0, 1, 2}) {
    for (const Growing& g : growing(false)) {
      Cart cart;
      fcl::ContinuousCollisionObjectd obstacle(
          g.geometry, std::make_shared<fcl::TranslationMotiond>(pose({1, 0, 0}), pose({1, 0.01, 0})));
      cart.manager->registerObject(&obstacle, "obstacle");
      cart.manager->setup();
      EXPECT_TRUE(cart.run(-2, 0).isFree()) << g.name;
      g.grow();
      if (how == 0) cart.manager->update();
      if (how == 1) cart.manager->update(&obstacle);
      if (how == 2) cart.manager->setup();
      EXPECT_EQ(cart.run(-2, 0).status, Status::contact) << g.name << ' ' << how;
    }
  }
}

TEST(StaleGeometry, BetweenAttachAndDetach) {
  for (const Growing& g : growing(true)) {
    Cart cart;
    const auto load = object(g.geometry, pose({1, 0, 0}));
    cart.manager->registerObject(load.get(), "load");
    cart.manager->attach("rail", load.get(), pose({1, 0, 0}), {});
    g.grow();
    cart.manager->setup();
    EXPECT_EQ(cart.run(-2, 0).status, Status::contact) << g.name << ": attached";
  }
  for (const Growing& g : growing(true)) {
    Cart cart;
    const auto load = object(g.geometry, pose({1, 0, 0}));
    cart.manager->registerObject(load.get(), "load");
    cart.manager->attach("rail", load.get(), pose({1, 0, 0}), {});
    cart.manager->setup();
    EXPECT_TRUE(cart.run(-2, 0).isFree()) << g.name;
    g.grow();
    cart.manager->detach(load.get());
    cart.manager->setup();
    EXPECT_EQ(cart.run(-2, 0).status, Status::contact) << g.name << ": detached";
  }
}

// Between register and setup(), and from one setup() to the next: transforms are read again too.
TEST(StaleGeometry, TransformsAreReadBySetup) {
  Cart cart;
  const auto wall = ball(0.1, {9, 0, 0});
  cart.manager->registerObject(wall.get(), "wall");
  wall->setTranslation(Vector3d(-1, 0, 0));
  cart.manager->setup();
  EXPECT_EQ(cart.run(-2, 0).status, Status::contact);
  wall->setTranslation(Vector3d(9, 0, 0));
  cart.manager->setup();
  EXPECT_TRUE(cart.run(-2, 0).isFree());
}

// Two spheres have grown; each counts once it is read.
TEST(StaleGeometry, OnlyTheGivenObjectIsRead) {
  Cart cart;
  const auto sphere = std::make_shared<fcl::Sphered>(0.1), other = std::make_shared<fcl::Sphered>(0.1);
  const auto a = object(sphere, pose({-1, 1, 0})), b = object(other, pose({-1, -1, 0}));
  cart.manager->registerObjects({a.get(), b.get()});
  cart.manager->setup();
  sphere->radius = other->radius = 1;
  cart.manager->update(a.get());
  const CertifiedResult r = cart.run(-3, 1);
  ASSERT_EQ(r.contacts.size(), 1u);
  EXPECT_EQ(r.contacts[0].body2.object, a.get());
  sphere->radius = 0.1;
  cart.manager->update(a.get());
  EXPECT_TRUE(cart.run(-3, 1).isFree());
  cart.manager->update();
  EXPECT_EQ(cart.run(-3, 1).contacts.at(0).body2.object, b.get());
  const auto stranger = ball(1);
  EXPECT_THROW(cart.manager->update(stranger.get()), std::invalid_argument);
  EXPECT_THROW(cart.manager->update(static_cast<fcl::CollisionObjectd*>(nullptr)), std::invalid_argument);
}

// All or nothing: among what was changed well one geometry is none any more.
TEST(StaleGeometry, BadGeometryThrowsAndChangesNothing) {
  const auto mesh = cubeMesh(0.1);
  const auto box = std::make_shared<fcl::Boxd>(0.2, 0.2, 0.2);
  const auto plain = std::make_shared<fcl::Sphered>(0.1);
  fcl::ContinuousCollisionObjectd moving(plain,
                                         std::make_shared<fcl::TranslationMotiond>(pose({0, 3, 0}), pose({0, 3, 0})));
  Cart cart(plain);
  const auto a = object(mesh, pose({1, 0, 0})), b = object(box, pose({0, 2, 0}));
  cart.manager->registerObject(a.get(), "a");
  cart.manager->registerObject(b.get(), "b");
  cart.manager->registerObject(&moving, "c");
  cart.manager->setup();
  const auto time = [&] { return cart.run(0, 1).t_lower; };
  const double before = time();
  const auto expectUnchanged = [&](const char* what, const std::function<void()>& spoil,
                                   const std::function<void()>& mend) {
    spoil();
    EXPECT_THROW(cart.manager->setup(), std::invalid_argument) << what;
    EXPECT_THROW(cart.manager->update(), std::invalid_argument) << what;
    EXPECT_EQ(time(), before) << what;
    mend();
    cart.manager->setup();
    EXPECT_EQ(time(), before) << what;
  };
  const Vector3d corner = mesh->vertices[3];
  expectUnchanged(
      "vertex",
      [&] {
        mesh->vertices[3][1] = kNaN;
        plain->radius = 0.3;  // of the cart: read before it, and of the moving obstacle
      },
      [&] {
        mesh->vertices[3] = corner;
        plain->radius = 0.1;
      });
  expectUnchanged(
      "side",
      [&] {
        box->side[2] = -1;
        mesh->vertices[3][0] -= 0.3;
      },
      [&] {
        box->side[2] = 0.2;
        mesh->vertices[3] = corner;
      });
  expectUnchanged(
      "radius", [&] { plain->radius = 0; }, [&] { plain->radius = 0.1; });
  expectUnchanged(
      "index", [&] { mesh->tri_indices[5].set(0, 1, 99); },
      [&] { mesh->tri_indices[5] = cubeMesh(0.1)->tri_indices[5]; });
  expectUnchanged(
      "triangles", [&] { mesh->num_tris = 0; }, [&] { mesh->num_tris = 12; });
  expectUnchanged(
      "transform",
      [&] {
        b->setTranslation(Vector3d(kNaN, 0, 0));
        plain->radius = 0.2;
      },
      [&] {
        b->setTranslation(Vector3d(0, 2, 0));
        plain->radius = 0.1;
      });
}

TEST(StaleGeometry, ManyObjects) {
  const auto slides = [](const Geometry& geometry, const Vector3d& from, const Vector3d& to) {
    return std::make_unique<fcl::ContinuousCollisionObjectd>(
        geometry, std::make_shared<fcl::TranslationMotiond>(pose(from), pose(to)));
  };
  for (const bool one : {true, false}) {
    for (const Growing& g : growing(false)) {
      const auto grows = slides(g.geometry, {1, 0, 0}, {1, 0.01, 0});
      const auto goes = slides(std::make_shared<fcl::Sphered>(0.1), {-2, 0, 0}, {0, 0, 0});
      ContinuousCollisionManager manager;
      manager.registerObjects({grows.get(), goes.get()});
      manager.setup();
      CertifiedPairsResult result;
      manager.continuousCollide({}, result);
      EXPECT_TRUE(result.isFree()) << g.name;
      g.grow();
      one ? manager.update(grows.get()) : manager.update();
      manager.continuousCollide({}, result);
      EXPECT_FALSE(result.isFree()) << g.name;
    }
  }
}

}  // namespace stale_geometry_test
