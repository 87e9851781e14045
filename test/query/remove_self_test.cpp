// SPDX-License-Identifier: BSD-3-Clause
// Points on the robot, held to distances by formulas that the library has none of.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cone.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/ellipsoid.h>
#include <fcl/geometry/shape/sphere.h>
#include <gtest/gtest.h>

#include "../support/random_placing.h"
#include "fcl_artic/fcl_artic.h"

namespace remove_self_test {

namespace {

using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using namespace fcl_artic;
using test::Random;

std::shared_ptr<fcl::CollisionObjectd> object(const std::shared_ptr<fcl::CollisionGeometryd>& geometry) {
  return std::make_shared<fcl::CollisionObjectd>(geometry);
}

using Distance = std::function<double(const Vector3d&)>;
/// A geometry and the distance from it, 0 within a solid.
struct Kind {
  std::string name;
  std::shared_ptr<fcl::CollisionGeometryd> geometry;
  Distance distance;
};

double toSegment(const Vector2d& x, const Vector2d& a, const Vector2d& b) {
  const double t = std::clamp((x - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (x - a - t * (b - a)).norm();
}
double toSegment(const Vector3d& x, const Vector3d& a, const Vector3d& b) {
  const double t = std::clamp((x - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (x - a - t * (b - a)).norm();
}
/// The foot on its plane, where that is within; else the nearest edge.
double toTriangle(const Vector3d& x, const std::array<Vector3d, 3>& v) {
  const Vector3d n = (v[1] - v[0]).cross(v[2] - v[0]).normalized();
  double nearest = std::numeric_limits<double>::infinity();
  bool inside = true;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector3d &a = v[k], &b = v[(k + 1) % 3];
    nearest = std::min(nearest, toSegment(x, a, b));
    inside = inside && n.dot((b - a).cross(x - a)) >= 0;
  }
  return inside ? std::abs(n.dot(x - v[0])) : nearest;
}
/// In the plane of its axis: the tip and the rim are joined by a segment.
double toCone(const Vector3d& x, double radius, double half) {
  const Vector2d p(x.head<2>().norm(), x[2]), tip(0, half), rim(radius, -half), foot(0, -half);
  const bool below_side = (rim - tip).x() * (p - tip).y() - (rim - tip).y() * (p - tip).x() <= 0;
  if (below_side && p.y() >= -half) return 0;
  return std::min(toSegment(p, tip, rim), toSegment(p, foot, rim));
}
/// The nearest point is e^2 x / (e^2 + t) where it lies on the surface: t by bisection.
double toEllipsoid(const Vector3d& x, const Vector3d& e) {
  const auto level = [&](double t) { return (e.array() * x.array() / (e.array().square() + t)).square().sum(); };
  if (level(0) <= 1) return 0;
  double lower = 0, upper = x.norm() * e.maxCoeff();
  for (int i = 0; i < 200; ++i) {
    const double t = 0.5 * (lower + upper);
    (level(t) > 1 ? lower : upper) = t;
  }
  return (x.array() * lower / (e.array().square() + lower)).matrix().norm();
}

std::vector<std::array<Vector3d, 3>> octahedron(const Vector3d& size) {
  std::vector<std::array<Vector3d, 3>> triangles;
  for (int i = 0; i < 8; ++i) {
    const Vector3d x((i & 1 ? -1 : 1) * size[0], 0, 0), y(0, (i & 2 ? -1 : 1) * size[1], 0),
        z(0, 0, (i & 4 ? -1 : 1) * size[2]);
    const bool even = ((i & 1) + (i >> 1 & 1) + (i >> 2 & 1)) % 2 == 0;
    triangles.push_back(even ? std::array<Vector3d, 3>{x, y, z} : std::array<Vector3d, 3>{y, x, z});
  }
  return triangles;
}

std::vector<Kind> kinds(Random& random) {
  std::vector<Kind> all;
  const double a = 0.2, b = 0.07, c = 0.11;
  all.push_back({"box", std::make_shared<fcl::Boxd>(2 * a, 2 * b, 2 * c),
                 [=](const Vector3d& x) { return (x.cwiseAbs() - Vector3d(a, b, c)).cwiseMax(0).norm(); }});
  all.push_back(
      {"sphere", std::make_shared<fcl::Sphered>(a), [=](const Vector3d& x) { return std::max(0.0, x.norm() - a); }});
  all.push_back({"capsule", std::make_shared<fcl::Capsuled>(b, 2 * a), [=](const Vector3d& x) {
                   return std::max(0.0, toSegment(x, Vector3d(0, 0, -a), Vector3d(0, 0, a)) - b);
                 }});
  all.push_back({"cylinder", std::make_shared<fcl::Cylinderd>(b, 2 * a), [=](const Vector3d& x) {
                   return Vector2d(std::max(0.0, x.head<2>().norm() - b), std::max(0.0, std::abs(x[2]) - a)).norm();
                 }});
  all.push_back({"cone", std::make_shared<fcl::Coned>(b, 2 * a), [=](const Vector3d& x) { return toCone(x, b, a); }});
  all.push_back({"ellipsoid", std::make_shared<fcl::Ellipsoidd>(a, b, c), [=](const Vector3d& x) {
                   return toEllipsoid(x, {a, b, c});
                 }});
  const auto triangles = octahedron({a, b, c});
  const auto toSurface = [=](const Vector3d& x) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const auto& t : triangles) nearest = std::min(nearest, toTriangle(x, t));
    return nearest;
  };
  const auto isInside = [=](const Vector3d& x) {
    return std::abs(x[0]) / a + std::abs(x[1]) / b + std::abs(x[2]) / c <= 1;
  };
  const auto mesh = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
  mesh->beginModel();
  for (const auto& t : triangles) mesh->addTriangle(t[0], t[1], t[2]);
  mesh->endModel();
  all.push_back({"mesh", mesh, toSurface});
  const auto vertices = std::make_shared<std::vector<Vector3d>>();
  for (int k = 0; k < 3; ++k) {
    for (const double sign : {-1.0, 1.0}) vertices->push_back(sign * Vector3d(a, b, c)[k] * Vector3d::Unit(k));
  }
  all.push_back({"convex", std::make_shared<fcl::Convexd>(vertices, 0, std::make_shared<std::vector<int>>()),
                 [=](const Vector3d& x) { return isInside(x) ? 0 : toSurface(x); }});
  std::vector<Vector3d> points;
  for (int i = 0; i < 300; ++i) points.push_back(random.box(a));
  all.push_back({"cloud", std::make_shared<PointCloud>(points, 0.02), [=](const Vector3d& x) {
                   double nearest = std::numeric_limits<double>::infinity();
                   for (const Vector3d& p : points) nearest = std::min(nearest, (x - p).norm());
                   return std::max(0.0, nearest - 0.02);
                 }});
  return all;
}

std::shared_ptr<KinematicTree> armTree() {
  auto tree = std::make_shared<KinematicTree>("arm");
  for (const char* link : {"base", "upper", "lower", "tool"}) tree->addLink(link);
  tree->addJoint(Joint::revolute("j1", "base", "upper", Vector3d::UnitZ()));
  tree->addJoint(
      Joint::revolute("j2", "upper", "lower", Vector3d::UnitY(), Isometry3d(Eigen::Translation3d(0.5, 0, 0))));
  tree->addJoint(
      Joint::prismatic("j3", "lower", "tool", Vector3d::UnitX(), Isometry3d(Eigen::Translation3d(0.5, 0, 0))));
  return tree;
}
Isometry3d toolAt(const Vector3d& q) {
  return Eigen::AngleAxisd(q[0], Vector3d::UnitZ()) * Eigen::Translation3d(0.5, 0, 0) *
         Eigen::AngleAxisd(q[1], Vector3d::UnitY()) * Eigen::Translation3d(0.5 + q[2], 0, 0) * Isometry3d::Identity();
}

}  // namespace

// No point farther than the padding is dropped, and all that are nearer by more than rounding are, for each kind of
// geometry, bound or attached. Many points lie within 1e-6 to 1e-13 m of the padding. Faults to put in: the pose's
// error added to the padding, attached objects left out, triangles asked for corners only, the frame not inverted.
TEST(RemoveSelf, DropsWhatIsWithinThePadding) {
  Random random(11);
  int dropped = 0, kept = 0, close = 0;
  for (const Kind& kind : kinds(random)) {
    for (int round = 0; round < 12; ++round) {
      const Vector3d q = Vector3d(3, 1.5, 0.3).cwiseProduct(random.box(1));
      const Isometry3d offset = random.pose(0.2), frame = round % 3 ? random.pose(2) : Isometry3d::Identity();
      const double padding = round % 4 == 0 ? 0 : random.uniform(0.001, 0.1);
      ArticulatedCollisionManager manager(armTree());
      const auto part = object(kind.geometry);
      if (round % 2) {
        manager.registerObject(part, "part");
        manager.attach("tool", part, offset);
      } else {
        manager.bind("tool", part, offset);
      }
      const auto wall = object(std::make_shared<fcl::Boxd>(20, 20, 20));  // obstacles do not count
      manager.registerObject(wall, "room");
      manager.setup();
      const Isometry3d pose = toolAt(q) * offset, to_points = frame.inverse() * pose;
      std::vector<Vector3d> points;
      std::vector<double> distances;
      for (int i = 0; i < 2000; ++i) {
        Vector3d x = random.box(0.35);
        if (i % 2) {  // moved next to the border: along the way to a point within, by bisection
          Vector3d in = kind.name == "mesh" ? Vector3d(0.2, 0, 0) : kind.name == "cloud" ? x : Vector3d(0, 0, 0);
          const double goal = padding + (i % 4 == 1 ? 1 : -1) * random.logUniform(1e-13, 1e-6);
          if (kind.distance(in) < goal && kind.distance(x) > goal) {
            for (int k = 0; k < 60; ++k) {
              const Vector3d middle = 0.5 * (in + x);
              (kind.distance(middle) < goal ? in : x) = middle;
            }
          }
        }
        points.push_back(to_points * x);
        if (i % 100 == 99) points.back()[i % 3] = std::nan("");
      }
      // (Distances of the rounded points themselves, but for 1e-15 or so.)
      for (const Vector3d& x : points) distances.push_back(kind.distance(to_points.inverse() * x));
      std::vector<Vector3d> left = points;
      const std::vector<std::uint8_t> marks = manager.pointsOnSelf(points, q, padding, frame);
      const std::size_t removed = manager.removeSelf(left, q, padding, frame);
      std::size_t next = 0, marked = 0;
      for (std::size_t i = 0; i < points.size(); ++i) {
        marked += marks[i];
        if (!marks[i]) {
          ASSERT_LT(next, left.size());
          const bool same = std::equal(points[i].data(), points[i].data() + 3, left[next].data(),
                                       [](double x, double y) { return x == y || (x != x && y != y); });
          ASSERT_TRUE(same) << "the order of the others";
          ++next;
        }
        if (!points[i].allFinite()) {
          EXPECT_FALSE(marks[i]);
          continue;
        }
        if (marks[i]) EXPECT_LE(distances[i], padding + 2e-15) << kind.name << ' ' << padding;
        if (distances[i] <= padding - 1e-10) EXPECT_TRUE(marks[i]) << kind.name << ' ' << distances[i] - padding;
        close += std::abs(distances[i] - padding) < 1e-9;
        ++(marks[i] ? dropped : kept);
      }
      EXPECT_EQ(next, left.size());
      EXPECT_EQ(marked, removed);
    }
  }
  EXPECT_GT(dropped, 20000);
  EXPECT_GT(kept, 20000);
  EXPECT_GT(close, 10000);
}

// Points one by one, and all of them over threads.
TEST(RemoveSelf, IsTheSameOverThreads) {
  Random random(12);
  ArticulatedCollisionManager manager(armTree());
  for (const Kind& kind : kinds(random)) manager.bind("lower", object(kind.geometry), random.pose(0.5));
  manager.setup();
  const Vector3d q(0.3, -0.4, 0.1);
  std::vector<Vector3d> points;
  for (int i = 0; i < 100000; ++i) points.push_back(random.box(1.5));
  const std::vector<std::uint8_t> all = manager.pointsOnSelf(points, q, 0.02);
  std::size_t differ = 0;
  for (std::size_t i = 0; i < points.size(); i += 50) {
    differ += manager.pointsOnSelf({points[i]}, q, 0.02)[0] != all[i];
  }
  EXPECT_EQ(differ, 0u);
  EXPECT_GT(std::count(all.begin(), all.end(), 1), 500);
}

TEST(RemoveSelf, BadInputChangesNothing) {
  ArticulatedCollisionManager manager(armTree());
  manager.bind("tool", object(std::make_shared<fcl::Sphered>(1)));
  std::vector<Vector3d> points(5, Vector3d(0, 0, 0));
  const Vector3d q(0, 0, 0);
  EXPECT_THROW(manager.removeSelf(points, q), std::logic_error);
  manager.setup();
  for (const double wrong : std::vector<double>{-0.1, NAN, INFINITY}) {
    EXPECT_THROW(manager.removeSelf(points, q, wrong), std::invalid_argument) << wrong;
  }
  EXPECT_THROW(manager.removeSelf(points, Eigen::VectorXd::Zero(2)), std::invalid_argument);
  EXPECT_THROW(manager.removeSelf(points, Vector3d(0, NAN, 0)), std::invalid_argument);
  Isometry3d wide = Isometry3d::Identity();
  wide.linear() *= 2;
  EXPECT_THROW(manager.removeSelf(points, q, 0.1, wide), std::invalid_argument);
  EXPECT_EQ(points.size(), 5u);
  std::vector<Vector3d> none;
  EXPECT_EQ(manager.removeSelf(none, q), 0u);
}

}  // namespace remove_self_test
