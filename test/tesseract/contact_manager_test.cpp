// SPDX-License-Identifier: BSD-3-Clause
//
// tesseract's own continuous tests restated with first contacts in closed form; the manager's other members; how its
// answers differ from those of tesseract's convex hulls.
#include <cmath>

#include <gtest/gtest.h>
#include <octomap/octomap.h>
#include <tesseract/collision/bullet/bullet_cast_simple_manager.h>
#include <tesseract/collision/contact_result_validator.h>
#include <tesseract/common/contact_allowed_validator.h>
#include <tesseract/common/resource_locator.h>
#include <tesseract/geometry/geometries.h>
#include <yaml-cpp/yaml.h>

#include "fcl_artic/tesseract/contact_manager.h"

namespace fcl_artic {
namespace contact_manager_test {
namespace {

namespace collision = ::tesseract::collision;
namespace common = ::tesseract::common;
namespace geometry = ::tesseract::geometry;
using collision::ContactRequest;
using collision::ContactResult;
using collision::ContactTestType;
using collision::ContinuousCollisionType;
using common::LinkId;
using Manager = collision::ContinuousContactManager;

Eigen::Isometry3d at(double x, double y, double z) {
  return Eigen::Isometry3d(Eigen::Translation3d(x, y, z));
}
Eigen::Isometry3d turned(double angle) {
  return Eigen::Isometry3d(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()));
}

void add(Manager& manager, const std::string& name, std::shared_ptr<const geometry::Geometry> shape,
         const Eigen::Isometry3d& pose = Eigen::Isometry3d::Identity()) {
  ASSERT_TRUE(manager.addCollisionObject(name, 0, {std::move(shape)}, {pose}));
}

std::vector<ContactResult> contacts(Manager& manager, const ContactRequest& request = {}) {
  collision::ContactResultMap map;
  manager.contactTest(map, request);
  collision::ContactResultVector all;
  map.flattenMoveResults(all);
  return {all.begin(), all.end()};
}

/// Which of the two links this is.
std::size_t side(const ContactResult& contact, const std::string& name) {
  return contact.link_ids[0] == name ? 0 : 1;
}

/// A box of 0.25 m passes the corner of a box of 1 m: tesseract's box-box test.
template <class M>
void placeBoxes(M& manager) {
  add(manager, "static_box_link", std::make_shared<geometry::Box>(1, 1, 1));
  add(manager, "thin_box_link", std::make_shared<geometry::Box>(0.1, 2, 1));
  manager.disableCollisionObject("thin_box_link");
  add(manager, "moving_box_link", std::make_shared<geometry::Box>(0.25, 0.25, 0.25), at(0.5, -0.5, 0));
  manager.setActiveCollisionObjects({"moving_box_link"});
  manager.setCollisionObjectsTransform("static_box_link", Eigen::Isometry3d::Identity());
  manager.setCollisionObjectsTransform("moving_box_link", at(-1.9, 0, 0), at(1.9, 3.8, 0));
}

TEST(TesseractContactManager, BoxPassesBox) {
  // The moving box's centre is at (-1.4 + 3.8 t, -0.5 + 3.8 t). With a margin m it comes near when 1.4 - 3.8 t =
  // 0.5 + 0.125 + m, the other axis overlapping by then. (tesseract's own: the deepest point, 0.2475 m at t = 0.25.)
  for (const double margin : {0.1, 0.0}) {
    TesseractContactManager manager;
    placeBoxes(manager);
    manager.setDefaultCollisionMargin(margin);
    const double t = (1.4 - 0.625 - margin) / 3.8;
    for (const auto type : {ContactTestType::ALL, ContactTestType::CLOSEST, ContactTestType::FIRST}) {
      const auto found = contacts(manager, type);
      ASSERT_EQ(found.size(), 1u);
      const ContactResult& c = found[0];
      const std::size_t still = side(c, "static_box_link"), moving = 1 - still;
      EXPECT_EQ(c.link_ids[moving], "moving_box_link");
      EXPECT_NEAR(c.cc_time[moving], t, 2e-6);
      EXPECT_EQ(c.cc_time[still], -1);
      EXPECT_EQ(c.cc_type[still], ContinuousCollisionType::CCType_None);
      EXPECT_EQ(c.cc_type[moving], ContinuousCollisionType::CCType_Between);
      EXPECT_NEAR(c.distance, margin, 2e-5);
      EXPECT_NEAR(c.nearest_points[still].x(), -0.5, 1e-5);
      EXPECT_NEAR(c.nearest_points[moving].x(), -0.5 - margin, 2e-5);
      EXPECT_NEAR((c.normal - (still == 0 ? -1 : 1) * Eigen::Vector3d::UnitX()).norm(), 0, 1e-6);
      // In the moving link's frame the point is on the face x = 0.5 + 0.125.
      EXPECT_NEAR(c.nearest_points_local[moving].x(), 0.625, 2e-5);
      EXPECT_TRUE(c.transform[moving].isApprox(at(-1.9, 0, 0)));
      EXPECT_TRUE(c.cc_transform[moving].isApprox(at(1.9, 3.8, 0)));
      EXPECT_EQ(c.shape_id[moving], 0);
    }
    EXPECT_TRUE(manager.result().certain);
  }
}

/// tesseract's sphere-sphere test: two balls of 0.25 m whose paths cross, 0.4 m apart at the crossing.
template <class M>
void placeSpheres(M& manager, double y0) {
  add(manager, "sphere_link", std::make_shared<geometry::Sphere>(0.25), at(0, 0, 0.25));
  add(manager, "sphere1_link", std::make_shared<geometry::Sphere>(0.25), at(0, 0, 0.25));
  manager.setActiveCollisionObjects({"sphere_link", "sphere1_link"});
  common::LinkIdTransformMap begin, end;
  begin["sphere_link"] = at(-0.2, y0, 0);
  end["sphere_link"] = at(-0.2, 1, 0);
  begin["sphere1_link"] = at(0.2, 0, -1);
  end["sphere1_link"] = at(0.2, 0, 1);
  manager.setCollisionObjectsTransform(begin, end);
}

TEST(TesseractContactManager, SphereMeetsSphere) {
  // 0.4^2 + y^2 + z^2 = (0.5 + m)^2 with y = z = 2 t - 1, m = 0.1: t = (1 - sqrt(0.1)) / 2.
  TesseractContactManager manager;
  placeSpheres(manager, -1);
  manager.setCollisionMarginData(collision::CollisionMarginData(0.1));
  auto found = contacts(manager, ContactTestType::CLOSEST);
  ASSERT_EQ(found.size(), 1u);
  for (const double t : found[0].cc_time) EXPECT_NEAR(t, (1 - std::sqrt(0.1)) / 2, 2e-6);
  EXPECT_NEAR(found[0].distance, 0.1, 2e-5);
  // From y = -0.5: y = 1.5 t - 0.5, z = 2 t - 1, so 6.25 t^2 - 5.5 t + 1.05 = 0: t = 0.28. (tesseract's own says 1/3
  // for the one ball and 1/2 for the other: where the hulls of their paths are deepest in each other.)
  TesseractContactManager later;
  placeSpheres(later, -0.5);
  later.setCollisionMarginData(collision::CollisionMarginData(0.1));
  found = contacts(later, ContactTestType::CLOSEST);
  ASSERT_EQ(found.size(), 1u);
  for (const double t : found[0].cc_time) EXPECT_NEAR(t, 0.28, 2e-6);
  const std::size_t a = side(found[0], "sphere_link");
  const Eigen::Vector3d towards = Eigen::Vector3d(0.4, 0.08, -0.44).normalized();
  EXPECT_NEAR((found[0].normal - (a == 0 ? 1 : -1) * towards).norm(), 0, 1e-4);
  EXPECT_NEAR((found[0].nearest_points_local[a] - (Eigen::Vector3d(0, 0, 0.25) + 0.25 * towards)).norm(), 0, 1e-4);
}

TEST(TesseractContactManager, HullsAreAnotherBodyThanTheMotion) {
  // Two balls that pass the crossing one after the other: their hulls meet, they don't.
  const auto pass = [](auto& manager) {
    add(manager, "a", std::make_shared<geometry::Sphere>(0.1));
    add(manager, "b", std::make_shared<geometry::Sphere>(0.1));
    manager.setActiveCollisionObjects({"a", "b"});
    manager.setCollisionObjectsTransform("a", at(-1, 0, 0), at(3, 0, 0));
    manager.setCollisionObjectsTransform("b", at(0, -3, 0), at(0, 1, 0));
    return contacts(manager).size();
  };
  TesseractContactManager ours;
  collision::BulletCastSimpleManager theirs;
  EXPECT_EQ(pass(ours), 0u);
  EXPECT_EQ(ours.result().status, Status::free);
  EXPECT_GE(pass(theirs), 1u);
  // A rod that turns by 170 degrees about its middle sweeps over a ball; the hull of its two poses does not reach it.
  const auto turn = [](auto& manager) {
    add(manager, "rod", std::make_shared<geometry::Box>(2, 0.05, 0.05));
    add(manager, "ball", std::make_shared<geometry::Sphere>(0.1), at(0, 0.8, 0));
    manager.setActiveCollisionObjects({"rod"});
    manager.setCollisionObjectsTransform("ball", Eigen::Isometry3d::Identity());
    manager.setCollisionObjectsTransform("rod", turned(0.1), turned(0.1 + 170 * M_PI / 180));
    return contacts(manager).size();
  };
  TesseractContactManager proves;
  collision::BulletCastSimpleManager casts;
  EXPECT_EQ(turn(proves), 1u);
  EXPECT_TRUE(proves.result().certain);
  EXPECT_EQ(turn(casts), 0u);
}

TEST(TesseractContactManager, ObjectsComeAndGo) {
  TesseractContactManager manager("named");
  EXPECT_EQ(manager.getName(), "named");
  EXPECT_TRUE(contacts(manager).empty());
  placeBoxes(manager);
  placeBoxes(manager);  // each in place of the one before
  EXPECT_EQ(manager.getCollisionObjects().size(), 3u);
  EXPECT_TRUE(manager.hasCollisionObject("thin_box_link"));
  EXPECT_FALSE(manager.isCollisionObjectEnabled("thin_box_link"));
  EXPECT_FALSE(manager.addCollisionObject("empty", 0, {}, {}));
  EXPECT_FALSE(manager.hasCollisionObject("no_such"));
  EXPECT_FALSE(manager.removeCollisionObject("no_such"));
  EXPECT_FALSE(manager.enableCollisionObject("no_such"));
  EXPECT_FALSE(manager.disableCollisionObject("no_such"));
  EXPECT_FALSE(manager.isCollisionObjectEnabled("no_such"));
  EXPECT_TRUE(manager.getCollisionObjectGeometries("no_such").empty());
  EXPECT_TRUE(manager.getCollisionObjectGeometriesTransforms("no_such").empty());
  EXPECT_THROW(manager.getCollisionObjectsTransform("no_such"), std::out_of_range);
  manager.setCollisionObjectsTransform("no_such", Eigen::Isometry3d::Identity());
  EXPECT_EQ(manager.getCollisionObjectGeometries("moving_box_link").size(), 1u);
  EXPECT_TRUE(manager.getCollisionObjectGeometriesTransforms("moving_box_link")[0].isApprox(at(0.5, -0.5, 0)));
  EXPECT_TRUE(manager.getCollisionObjectsTransform("moving_box_link").isApprox(at(-1.9, 0, 0)));
  EXPECT_EQ(manager.getActiveCollisionObjects(), std::unordered_set<LinkId>{"moving_box_link"});
  EXPECT_EQ(contacts(manager).size(), 1u);
  EXPECT_TRUE(manager.disableCollisionObject("static_box_link"));
  EXPECT_TRUE(contacts(manager).empty());
  EXPECT_TRUE(manager.enableCollisionObject("thin_box_link"));
  EXPECT_EQ(contacts(manager).size(), 1u);
  EXPECT_TRUE(manager.removeCollisionObject("thin_box_link"));
  EXPECT_TRUE(contacts(manager).empty());
  EXPECT_EQ(manager.getCollisionObjects(), (std::vector<LinkId>{"static_box_link", "moving_box_link"}));
}

/// An object that gets another shape goes on moving: it meets the post half way, where neither of its poses is.
TEST(TesseractContactManager, WhatTakesTheirPlaceIsActiveAsTheyWere) {
  TesseractContactManager manager;
  add(manager, "post", std::make_shared<geometry::Box>(0.1, 0.1, 0.1));
  add(manager, "other", std::make_shared<geometry::Box>(0.1, 0.1, 0.1));
  add(manager, "mover", std::make_shared<geometry::Box>(0.1, 0.1, 0.1));
  manager.setActiveCollisionObjects({"mover"});
  const auto go = [&] {
    manager.setCollisionObjectsTransform("other", at(0, 0, 3));
    manager.setCollisionObjectsTransform("mover", at(-1, 0, 0), at(1, 0, 0));
    return contacts(manager);
  };
  ASSERT_EQ(go().size(), 1u);
  add(manager, "mover", std::make_shared<geometry::Sphere>(0.05));
  EXPECT_EQ(manager.getActiveCollisionObjects(), std::unordered_set<LinkId>{"mover"});
  const auto found = go();
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].cc_time[side(found[0], "mover")], 0.45, 1e-5);
  add(manager, "other", std::make_shared<geometry::Sphere>(0.05));  // still as ever
  EXPECT_EQ(manager.getActiveCollisionObjects(), std::unordered_set<LinkId>{"mover"});
  manager.removeCollisionObject("mover");
  EXPECT_TRUE(manager.getActiveCollisionObjects().empty());
}

TEST(TesseractContactManager, StillObjectsAreMoved) {
  TesseractContactManager manager;
  placeBoxes(manager);
  EXPECT_EQ(contacts(manager).size(), 1u);
  manager.setCollisionObjectsTransform("static_box_link", at(0, 0, 5));
  EXPECT_TRUE(contacts(manager).empty());
  common::LinkIdTransformMap back;
  back["static_box_link"] = Eigen::Isometry3d::Identity();
  manager.setCollisionObjectsTransform(back);
  EXPECT_EQ(contacts(manager).size(), 1u);
  // One pose for a moving object: it stands there.
  manager.setCollisionObjectsTransform("moving_box_link", at(-1.9, 0, 0));
  EXPECT_TRUE(contacts(manager).empty());
  manager.setCollisionObjectsTransform(std::vector<LinkId>{"moving_box_link"},
                                       common::VectorIsometry3d{at(-0.5, 0.5, 0)});
  const auto found = contacts(manager);
  ASSERT_EQ(found.size(), 1u);
  const std::size_t moving = side(found[0], "moving_box_link");
  EXPECT_EQ(found[0].cc_type[moving], ContinuousCollisionType::CCType_Time0);
  // Who is active and who is not may change.
  manager.setCollisionObjectsTransform("moving_box_link", at(-1.9, 0, 0), at(1.9, 3.8, 0));
  EXPECT_EQ(contacts(manager).size(), 1u);
  manager.setActiveCollisionObjects({"static_box_link"});
  EXPECT_TRUE(contacts(manager).empty());  // the other box stands at its first pose
  manager.setActiveCollisionObjects(std::vector<LinkId>{});
  EXPECT_EQ(contacts(manager).size(), 1u);  // none is all
}

TEST(TesseractContactManager, MarginsOfPairs) {
  TesseractContactManager manager;
  add(manager, "a", std::make_shared<geometry::Sphere>(0.1));
  add(manager, "b", std::make_shared<geometry::Sphere>(0.1));
  add(manager, "c", std::make_shared<geometry::Sphere>(0.1));
  manager.setActiveCollisionObjects({"a"});
  manager.setCollisionObjectsTransform("b", at(0, 0.5, 0));
  manager.setCollisionObjectsTransform("c", at(0, -0.5, 0));
  manager.setCollisionObjectsTransform("a", at(-1, 0, 0), at(1, 0, 0));  // 0.3 m from both
  EXPECT_TRUE(contacts(manager).empty());
  manager.setDefaultCollisionMargin(0.29);
  EXPECT_TRUE(contacts(manager).empty());
  manager.setDefaultCollisionMargin(0.31);
  EXPECT_EQ(contacts(manager).size(), 2u);
  EXPECT_EQ(contacts(manager, ContactTestType::FIRST).size(), 1u);
  manager.setCollisionMarginPair("a", "c", 0.1);
  EXPECT_EQ(contacts(manager).size(), 1u);
  manager.incrementCollisionMargin(0.25);
  EXPECT_EQ(contacts(manager).size(), 2u);
  manager.incrementCollisionMargin(-1);
  EXPECT_TRUE(contacts(manager).empty());
  collision::CollisionMarginPairData pairs;
  pairs.setCollisionMargin("a", "b", 0.31);
  manager.setCollisionMarginPairData(pairs);
  ASSERT_EQ(contacts(manager).size(), 1u);
  EXPECT_EQ(manager.getCollisionMarginData().getCollisionMargin("a", "b"), 0.31);
}

struct Allows : common::ContactAllowedValidator {
  std::shared_ptr<bool> yes = std::make_shared<bool>(true);
  bool operator()(const common::LinkIdPair&) const override { return *yes; }
};
struct Rejects : collision::ContactResultValidator {
  std::string name;
  bool operator()(const ContactResult& contact) const override {
    return contact.link_ids[0] != name && contact.link_ids[1] != name;
  }
};

TEST(TesseractContactManager, ValidatorsAreAsked) {
  TesseractContactManager manager;
  placeBoxes(manager);
  EXPECT_EQ(manager.getContactAllowedValidator(), nullptr);
  auto allows = std::make_shared<Allows>();
  manager.setContactAllowedValidator(allows);
  EXPECT_TRUE(contacts(manager).empty());
  *allows->yes = false;  // it may change its mind without telling
  EXPECT_EQ(contacts(manager).size(), 1u);
  EXPECT_EQ(manager.getContactAllowedValidator(), allows);
  manager.setContactAllowedValidator(nullptr);

  manager.enableCollisionObject("thin_box_link");
  EXPECT_EQ(contacts(manager).size(), 2u);
  auto rejects = std::make_shared<Rejects>();
  rejects->name = "static_box_link";  // the earlier one
  ContactRequest request(ContactTestType::FIRST);
  request.is_valid = rejects;
  const auto found = contacts(manager, request);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].link_ids[1 - side(found[0], "moving_box_link")], "thin_box_link");
  request = ContactRequest(ContactTestType::LIMITED);
  request.contact_limit = 1;
  EXPECT_EQ(contacts(manager, request).size(), 1u);
}

TEST(TesseractContactManager, ClonesAreTheirOwn) {
  TesseractContactManager manager;
  placeBoxes(manager);
  manager.setDefaultCollisionMargin(0.1);
  const auto clone = manager.clone();
  EXPECT_EQ(clone->getName(), manager.getName());
  EXPECT_EQ(clone->getCollisionObjects(), manager.getCollisionObjects());
  const auto a = contacts(manager), b = contacts(*clone);
  ASSERT_EQ(a.size(), 1u);
  ASSERT_EQ(b.size(), 1u);
  EXPECT_TRUE(a[0] == b[0]);
  clone->setCollisionObjectsTransform("moving_box_link", at(5, 5, 5));
  EXPECT_TRUE(contacts(*clone).empty());
  EXPECT_EQ(contacts(manager).size(), 1u);
}

TEST(TesseractContactManager, ShapesOfALinkAndPieces) {
  TesseractContactManager manager;
  auto vertices = std::make_shared<common::VectorVector3d>();
  for (const double x : {-0.1, 0.1}) {
    for (const double y : {-0.1, 0.1}) vertices->push_back({x, y, 0});
  }
  auto faces = std::make_shared<Eigen::VectorXi>(8);
  *faces << 3, 0, 2, 1, 3, 1, 2, 3;
  const auto mesh = std::make_shared<geometry::Mesh>(vertices, faces);
  ASSERT_TRUE(manager.addCollisionObject("floor", 7, {std::make_shared<geometry::Sphere>(0.01), mesh},
                                         {at(5, 5, 5), at(0, 0, 0)}));
  add(manager, "ball", std::make_shared<geometry::Sphere>(0.02));
  manager.setActiveCollisionObjects({"ball"});
  manager.setCollisionObjectsTransform("floor", Eigen::Isometry3d::Identity());
  manager.setCollisionObjectsTransform("ball", at(-0.05, -0.05, 1), at(-0.05, -0.05, -1));
  const auto found = contacts(manager);
  ASSERT_EQ(found.size(), 1u);
  const std::size_t floor = side(found[0], "floor");
  EXPECT_EQ(found[0].shape_id[floor], 1);
  EXPECT_EQ(found[0].subshape_id[floor], 0);
  EXPECT_EQ(found[0].type_id[floor], 7);
  EXPECT_NEAR(found[0].cc_time[1 - floor], (1 - 0.02) / 2, 2e-6);
}

TEST(TesseractContactManager, EveryShape) {
  auto corners = std::make_shared<common::VectorVector3d>();
  auto faces = std::make_shared<Eigen::VectorXi>(16);
  *corners = {{0.1, 0, 0}, {-0.1, 0.1, 0}, {-0.1, -0.1, 0}, {0, 0, 0.1}};
  *faces << 3, 0, 2, 1, 3, 0, 1, 3, 3, 1, 2, 3, 3, 2, 0, 3;
  const auto mesh = std::make_shared<geometry::Mesh>(corners, faces);
  auto cells = std::make_shared<octomap::OcTree>(0.1);
  cells->updateNode(octomap::point3d(0.05F, 0.05F, 0.05F), true);
  const std::vector<std::shared_ptr<const geometry::Geometry>> shapes{
      std::make_shared<geometry::Box>(0.2, 0.2, 0.2),
      std::make_shared<geometry::Sphere>(0.1),
      std::make_shared<geometry::Cylinder>(0.1, 0.2),
      std::make_shared<geometry::Cone>(0.1, 0.2),
      std::make_shared<geometry::Capsule>(0.1, 0.2),
      std::make_shared<geometry::Plane>(1, 0, 0, 0),
      mesh,
      std::make_shared<geometry::ConvexMesh>(corners, faces),
      std::make_shared<geometry::CompoundMesh>(std::vector<std::shared_ptr<geometry::Mesh>>{mesh, mesh}),
      std::make_shared<geometry::Octree>(cells, geometry::OctreeSubType::BOX)};
  for (const auto& shape : shapes) {
    TesseractContactManager manager;
    add(manager, "shape", shape);
    add(manager, "ball", std::make_shared<geometry::Sphere>(0.02));
    manager.setActiveCollisionObjects({"ball"});
    manager.setCollisionObjectsTransform("shape", Eigen::Isometry3d::Identity());
    manager.setCollisionObjectsTransform("ball", at(-1, 0.01, 0.01), at(1, 0.01, 0.01));
    EXPECT_EQ(contacts(manager).size(), 1u)
        << geometry::GeometryTypeStrings[static_cast<std::size_t>(shape->getType())];
    manager.setCollisionObjectsTransform("ball", at(-1, 0.01, 0.01), at(-0.2, 0.01, 0.01));
    EXPECT_TRUE(contacts(manager).empty()) << geometry::GeometryTypeStrings[static_cast<std::size_t>(shape->getType())];
  }
  TesseractContactManager manager;
  const auto refusal = [&](std::shared_ptr<const geometry::Geometry> shape) -> std::string {
    try {
      manager.addCollisionObject("odd", 0, {std::move(shape)}, {Eigen::Isometry3d::Identity()});
    } catch (const std::invalid_argument& e) {
      return e.what();
    }
    return "nothing was thrown";
  };
  EXPECT_NE(refusal(std::make_shared<geometry::PolygonMesh>(corners, faces))
                .find("object 'odd', shape 0: a geometry of type POLYGON_MESH"),
            std::string::npos);
  EXPECT_NE(refusal(std::make_shared<geometry::Octree>(cells, geometry::OctreeSubType::SPHERE_INSIDE)).find("spheres"),
            std::string::npos);
  EXPECT_FALSE(manager.hasCollisionObject("odd"));
}

// A mirrored, stretched or sheared pose has a quaternion too, of another place.
TEST(TesseractContactManager, PosesThatAreNotRigidAreRefused) {
  TesseractContactManager manager;
  add(manager, "ball", std::make_shared<geometry::Sphere>(0.02));
  add(manager, "wall", std::make_shared<geometry::Box>(0.1, 1, 1));
  manager.setActiveCollisionObjects({"ball"});
  (void)contacts(manager);
  Eigen::Isometry3d mirrored = Eigen::Isometry3d::Identity(), stretched = mirrored, sheared = mirrored;
  mirrored.linear() = Eigen::Vector3d(1, 1, -1).asDiagonal();
  stretched.linear() *= 2;
  sheared.linear()(0, 1) = 1e-5;
  for (const Eigen::Isometry3d& pose : {mirrored, stretched, sheared}) {
    for (const char* object : {"ball", "wall"}) {
      EXPECT_THROW(manager.setCollisionObjectsTransform(object, at(1, 0, 0), pose), std::invalid_argument);
      EXPECT_THROW(manager.setCollisionObjectsTransform(object, pose), std::invalid_argument);
    }
    EXPECT_THROW(manager.addCollisionObject("odd", 0, {std::make_shared<geometry::Sphere>(1)}, {pose}),
                 std::invalid_argument);
  }
}

TEST(TesseractContactManager, PlugIn) {
  const std::string config = std::string("contact_manager_plugins:\n  search_paths:\n    - ") +
                             FCL_ARTIC_PLUGIN_FOLDER +
                             "\n  search_libraries:\n    - fcl_artic_tesseract\n  continuous_plugins:\n"
                             "    default: FclArtic\n    plugins:\n      FclArtic:\n"
                             "        class: FclArticContactManagerFactory\n        config:\n"
                             "          tolerance_time: 1e-4\n          any_contact: true\n";
  const common::GeneralResourceLocator locator;
  collision::ContactManagersPluginFactory factory(YAML::Load(config), locator);
  auto manager = factory.createContinuousContactManager("FclArtic");
  ASSERT_NE(manager, nullptr);
  EXPECT_EQ(manager->getName(), "FclArtic");
  placeBoxes(*manager);
  EXPECT_EQ(contacts(*manager, ContactTestType::FIRST).size(), 1u);
  EXPECT_THROW(FclArticContactManagerFactory().create("x", YAML::Load("{tolerance: 1}")), std::invalid_argument);
  EXPECT_THROW(FclArticContactManagerFactory().create("x", YAML::Load("{tolerance_time: 0}")), std::invalid_argument);
  EXPECT_NE(FclArticContactManagerFactory().create("x", YAML::Node()), nullptr);
}

}  // namespace
}  // namespace contact_manager_test
}  // namespace fcl_artic
