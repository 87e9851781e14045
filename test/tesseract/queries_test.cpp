// SPDX-License-Identifier: BSD-3-Clause
//
// Random motions. The contact manager's answers are compared with the library's for each pair of shapes by itself, and
// with tesseract's own discrete manager, which looks at many poses on the way.
#include <cstdlib>
#include <iostream>
#include <random>

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cone.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/math/motion/interp_motion.h>
#include <gtest/gtest.h>
#include <tesseract/collision/fcl/fcl_discrete_managers.h>
#include <tesseract/geometry/geometries.h>

#include "fcl_artic/continuous_collision.h"
#include "fcl_artic/tesseract/contact_manager.h"

namespace fcl_artic {
namespace queries_test {
namespace {

namespace collision = ::tesseract::collision;
namespace common = ::tesseract::common;
namespace geometry = ::tesseract::geometry;

/// Poses that tesseract looks at on the way of a motion; more with FCL_ARTIC_SAMPLES.
int samples() {
  const char* asked = std::getenv("FCL_ARTIC_SAMPLES");
  return asked ? std::atoi(asked) : 100;
}

struct Random {
  std::mt19937_64 engine;
  double uniform(double lower, double upper) { return std::uniform_real_distribution<double>(lower, upper)(engine); }
  Eigen::Isometry3d pose(double reach) {
    Eigen::Isometry3d M = Eigen::Isometry3d::Identity();
    M.linear() =
        Eigen::Quaterniond(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)).normalized().matrix();
    M.translation() = Eigen::Vector3d(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)) * reach;
    return M;
  }
};

/// A shape in both libraries' types.
struct Shape {
  std::shared_ptr<const geometry::Geometry> theirs;
  std::shared_ptr<fcl::CollisionGeometryd> fcl;
};

Shape randomShape(Random& random) {
  const double a = random.uniform(0.05, 0.2), b = random.uniform(0.05, 0.2), c = random.uniform(0.05, 0.2);
  switch (random.engine() % 5) {
    case 0:
      return {std::make_shared<geometry::Box>(a, b, c), std::make_shared<fcl::Boxd>(a, b, c)};
    case 1:
      return {std::make_shared<geometry::Sphere>(a), std::make_shared<fcl::Sphered>(a)};
    case 2:
      return {std::make_shared<geometry::Capsule>(a, b), std::make_shared<fcl::Capsuled>(a, b)};
    case 3:
      return {std::make_shared<geometry::Cone>(a, b), std::make_shared<fcl::Coned>(a, b)};
    default:
      return {std::make_shared<geometry::Cylinder>(a, b), std::make_shared<fcl::Cylinderd>(a, b)};
  }
}

struct Object {
  std::string name;
  bool moves;
  std::vector<Shape> shapes;
  common::VectorIsometry3d poses;
  Eigen::Isometry3d begin, end;
};

/// Where an object is: its origin on a straight line, turning the shortest way at constant speed.
Eigen::Isometry3d poseAt(const Object& object, double t) {
  Eigen::Isometry3d M = Eigen::Isometry3d::Identity();
  M.linear() = Eigen::Quaterniond(object.begin.linear()).slerp(t, Eigen::Quaterniond(object.end.linear())).matrix();
  M.translation() = (1 - t) * object.begin.translation() + t * object.end.translation();
  return M;
}

/// A shape's motion, about the origin of its object.
fcl::InterpMotion<double> motionOf(const Object& object, std::size_t shape) {
  const Eigen::Isometry3d begin = object.begin * object.poses[shape], end = object.end * object.poses[shape];
  return fcl::InterpMotion<double>(begin.linear(), begin.translation(), end.linear(), end.translation(),
                                   object.poses[shape].inverse().translation());
}

TEST(TesseractQueries, ThousandMotions) {
  Random random{std::mt19937_64(21)};
  int free = 0, touching = 0, initial = 0, other_verdict = 0, other_time = 0, missed = 0, not_there = 0;
  long looks = 0;
  for (int query = 0; query < 1000; ++query) {
    std::vector<Object> objects(3 + random.engine() % 4);
    TesseractContactManager manager;
    collision::FCLDiscreteBVHManager looker;
    std::vector<common::LinkId> moving;
    for (std::size_t i = 0; i < objects.size(); ++i) {
      Object& object = objects[i];
      object.name = "object" + std::to_string(i);
      object.moves = i < 2 || random.engine() % 2;
      collision::CollisionShapesConst shapes;
      for (std::size_t k = 0; k < 1 + random.engine() % 2; ++k) {
        object.shapes.push_back(randomShape(random));
        object.poses.push_back(random.pose(0.2));
        shapes.push_back(object.shapes.back().theirs);
      }
      object.begin = random.pose(1);
      object.end = object.moves ? random.pose(1) : object.begin;
      if (object.moves) moving.emplace_back(object.name);
      ASSERT_TRUE(manager.addCollisionObject(object.name, 0, shapes, object.poses));
      ASSERT_TRUE(looker.addCollisionObject(object.name, 0, shapes, object.poses));
    }
    manager.setActiveCollisionObjects(moving);
    looker.setActiveCollisionObjects(moving);
    for (const Object& object : objects) {
      manager.setCollisionObjectsTransform(object.name, object.begin, object.end);
      looker.setCollisionObjectsTransform(object.name, object.begin);
    }
    collision::ContactResultMap map;
    manager.contactTest(map, collision::ContactRequest(collision::ContactTestType::FIRST));
    const CertifiedResult& result = manager.result();

    // Each pair of shapes by itself.
    double first_lower = 1, first_upper = 1;
    bool any = false;
    for (std::size_t i = 0; i < objects.size(); ++i) {
      for (std::size_t k = i + 1; k < objects.size(); ++k) {
        if (!objects[i].moves && !objects[k].moves) continue;
        for (std::size_t x = 0; x < objects[i].shapes.size(); ++x) {
          for (std::size_t y = 0; y < objects[k].shapes.size(); ++y) {
            const fcl::InterpMotion<double> a = motionOf(objects[i], x), b = motionOf(objects[k], y);
            CertifiedPairResult pair;
            continuousCollide(objects[i].shapes[x].fcl.get(), &a, objects[k].shapes[y].fcl.get(), &b,
                              CertifiedPairRequest(), pair);
            if (pair.status != Status::contact) continue;
            any = true;
            first_lower = std::min(first_lower, pair.t_lower);
            first_upper = std::min(first_upper, pair.t_upper);
          }
        }
      }
    }
    other_verdict += any != !map.empty() || (result.status == Status::free) != map.empty();
    if (any && !map.empty()) other_time += result.t_lower > first_upper + 1e-9 || first_lower > result.t_upper + 1e-9;

    const auto touches = [&](double t) {
      for (const Object& object : objects) looker.setCollisionObjectsTransform(object.name, poseAt(object, t));
      collision::ContactResultMap seen;
      looker.contactTest(seen, collision::ContactRequest(collision::ContactTestType::FIRST));
      ++looks;
      for (const auto& [pair, contacts] : seen) {
        for (const auto& contact : contacts) {
          if (contact.distance < -1e-6) return true;  // FCL's own iterations end at about that
        }
      }
      return false;
    };
    double until = 1;
    if (map.empty()) {
      ++free;
    } else {
      ++touching;
      initial += result.t_lower <= 0;
      until = result.t_lower;
      // Deep enough for FCL to see, a little later.
      bool seen = touches(result.t_upper);
      for (double later = 1e-6; !seen && later < 0.1; later *= 4) seen = touches(std::min(1.0, result.t_upper + later));
      not_there += !seen;
    }
    for (int k = 0; k <= samples(); ++k) {
      const double t = until * k / samples();
      if (!map.empty() && t >= until) break;
      if (touches(t)) {
        ++missed;
        break;
      }
    }
  }
  std::cout << free << " free, " << touching << " in contact (" << initial
            << " from the start); other verdicts than by pairs: " << other_verdict << ", other times: " << other_time
            << "; looks of tesseract: " << looks << ", missed: " << missed
            << ", contacts that it does not see within 0.1 later: " << not_there << "\n";
  EXPECT_GT(free, 100);
  EXPECT_GT(touching - initial, 100);
  EXPECT_EQ(other_verdict, 0);
  EXPECT_EQ(other_time, 0);
  EXPECT_EQ(missed, 0);
  EXPECT_LE(not_there, touching / 100);  // grazes that part again
}

}  // namespace
}  // namespace queries_test
}  // namespace fcl_artic
