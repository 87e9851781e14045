// SPDX-License-Identifier: BSD-3-Clause
// Clouds of points: what as many balls say one by one, in every place where geometry goes.
#include "fcl_artic/point_cloud.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <iostream>
#include <limits>
#include <map>
#include <string>

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/math/motion/translation_motion.h>
#include <fcl/narrowphase/continuous_collision_object.h>
#include <gtest/gtest.h>

#include "../support/random_placing.h"
#include "fcl_artic/fcl_artic.h"

namespace point_cloud_test {

namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using namespace fcl_artic;
using test::Random;

Isometry3d at(const Vector3d& x) {
  return Isometry3d(Eigen::Translation3d(x));
}
std::shared_ptr<fcl::CollisionObjectd> object(const std::shared_ptr<fcl::CollisionGeometryd>& geometry,
                                              const Isometry3d& pose = Isometry3d::Identity()) {
  return std::make_shared<fcl::CollisionObjectd>(geometry, pose);
}

/// Two hinges and a slide, each with a box.
std::shared_ptr<KinematicTree> armTree() {
  auto tree = std::make_shared<KinematicTree>("arm");
  for (const char* link : {"base", "upper", "lower", "tool"}) tree->addLink(link);
  tree->addJoint(Joint::revolute("j1", "base", "upper", Vector3d::UnitZ()));
  tree->addJoint(Joint::revolute("j2", "upper", "lower", Vector3d::UnitY(), at({0.5, 0, 0})));
  Joint slide;
  slide.name = "j3", slide.type = JointType::prismatic, slide.parent = "lower", slide.child = "tool";
  slide.axis = Vector3d::UnitX();
  slide.origin = at({0.5, 0, 0});
  tree->addJoint(slide);
  return tree;
}
void bindBoxes(ArticulatedCollisionManager& manager) {
  const auto box = std::make_shared<fcl::Boxd>(0.3, 0.08, 0.06);
  for (const char* link : {"upper", "lower", "tool"}) manager.bind(link, object(box), at({0.25, 0, 0}));
}

struct Cloud {
  std::vector<Vector3d> points;
  std::vector<double> radii;
};
Cloud randomCloud(Random& random, int n, double spread, bool one_radius) {
  Cloud cloud;
  while (static_cast<int>(cloud.points.size()) < n) {
    cloud.points.push_back(random.box(spread));
    cloud.radii.push_back(one_radius ? 0.01 : random.logUniform(1e-3, 0.05));
  }
  if (one_radius) cloud.radii.assign(1, 0.01);
  return cloud;
}

/// Many motions amid a cloud and amid the same balls one by one; and the distance of each point at samples.
TEST(PointCloud, SaysWhatItsBallsSayOneByOne) {
  Random random(1);
  int contacts = 0, free = 0, sampled = 0;
  for (int scene = 0; scene < 24; ++scene) {
    const auto tree = armTree();
    const Cloud cloud = randomCloud(random, scene % 6 == 0 ? 1 : 200, 1.3, scene % 2 == 0);
    const Isometry3d pose = at({0.1, -0.2, 0.05}) * Eigen::AngleAxisd(0.3 * scene, Vector3d(1, 2, 3).normalized());
    const PointCloud geometry(cloud.points, cloud.radii);
    ArticulatedCollisionManager whole(tree), single(tree);
    bindBoxes(whole);
    bindBoxes(single);
    whole.registerObject(object(std::make_shared<PointCloud>(geometry), pose), "cloud");
    std::vector<std::shared_ptr<fcl::CollisionObjectd>> balls;
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
      balls.push_back(object(std::make_shared<fcl::Sphered>(geometry.radius(i)), pose * at(cloud.points[i])));
      single.registerObject(balls.back(), std::to_string(i));
    }
    whole.setup();
    single.setup();
    for (int i = 0; i < 40; ++i) {
      Vector3d q0 = Vector3d(0, 0, 0.1) + Vector3d(3, 1.5, 0.1).cwiseProduct(random.box(1)),
               dq = Vector3d(1, 1, 0.2).cwiseProduct(random.box(1));
      const JointMotion motion = JointMotion::linear(*tree, q0, q0 + dq);
      for (const Method method : {Method::standard, Method::redon2004}) {
        CertifiedRequest request;
        request.method = method;
        CertifiedResult a, b;
        whole.continuousCollide(motion, request, a);
        single.continuousCollide(motion, request, b);
        ASSERT_EQ(a.status, b.status) << scene << " " << i;
        ++(a.isFree() ? free : contacts);
        if (a.isFree()) continue;
        EXPECT_NEAR(a.t_lower, b.t_lower, 3e-6) << scene << " " << i;
        ASSERT_FALSE(a.contacts.empty());
        const CertifiedContact& contact = a.contacts[0];
        EXPECT_EQ(contact.body2.name, "cloud");
        ASSERT_GE(contact.b2, 0);
        ASSERT_LT(static_cast<std::size_t>(contact.b2), cloud.points.size());
        const auto ball = static_cast<std::size_t>(contact.b2);
        if (a.t_lower == 0) continue;  // in each other already
        EXPECT_NEAR((contact.point - pose * cloud.points[ball]).norm(), geometry.radius(ball), 1e-3);
        CertifiedRequest any = request;
        any.mode = ContactMode::any;
        whole.continuousCollide(motion, any, b);
        EXPECT_EQ(b.status, Status::contact);
      }
      CertifiedResult answer;
      whole.continuousCollide(motion, CertifiedRequest(), answer);
      std::vector<Isometry3d> M_0;
      for (double t = 0; t <= 1; t += 0.02) {
        tree->forwardKinematics(motion.configuration(t), M_0);
        bool touches = false;
        for (const char* link : {"upper", "lower", "tool"}) {
          const Isometry3d box = M_0[static_cast<std::size_t>(tree->linkId(link))] * at({0.25, 0, 0});
          for (std::size_t k = 0; k < cloud.points.size(); ++k) {
            const Vector3d x = box.inverse() * (pose * cloud.points[k]);
            const Vector3d outside = (x.cwiseAbs() - 0.5 * Vector3d(0.3, 0.08, 0.06)).cwiseMax(0);
            touches = touches || outside.norm() < geometry.radius(k) - 1e-12;
          }
        }
        if (!touches) continue;
        ++sampled;
        ASSERT_EQ(answer.status, Status::contact) << scene << " " << i << " at " << t;
        EXPECT_LE(answer.t_lower, t);
        break;
      }
    }
  }
  std::cout << contacts << " contacts, " << free << " free, " << sampled << " sampled contacts\n";
  EXPECT_GE(contacts, 200);
  EXPECT_GE(free, 200);
  EXPECT_GE(sampled, 80);
}

/// A ball of 0.1 m that comes down 1 m onto a point of 0.05 m at the origin: its centre is 0.15 m above at t = 0.35.
TEST(PointCloud, GoesWhereGeometryGoes) {
  const auto cloud =
      std::make_shared<PointCloud>(std::vector<Vector3d>{{0, 0, 0}, {3, 0, 0}}, std::vector<double>{0.05, 1});
  const auto ball = std::make_shared<fcl::Sphered>(0.1);
  auto tree = std::make_shared<KinematicTree>("slide");
  tree->addLink("base");
  tree->addLink("link");
  Joint joint;
  joint.name = "j", joint.type = JointType::prismatic, joint.parent = "base", joint.child = "link";
  joint.axis = -Vector3d::UnitZ();
  tree->addJoint(joint);
  const auto ask = [&](ArticulatedCollisionManager& manager, double margin = 0) {
    manager.setup();
    CertifiedRequest request;
    request.margin = margin;
    CertifiedResult result;
    manager.continuousCollide(JointMotion::linear(*tree, Eigen::VectorXd::Zero(1), Eigen::VectorXd::Ones(1)), request,
                              result);
    EXPECT_EQ(result.status, Status::contact);
    EXPECT_TRUE(result.certain);
    return result.t_lower;
  };
  {
    ArticulatedCollisionManager manager(tree);  // an obstacle
    manager.bind("link", object(ball), at({0, 0, 0.5}));
    manager.registerObject(object(cloud));
    EXPECT_NEAR(ask(manager), 0.35, 2e-6);
    EXPECT_NEAR(ask(manager, 0.05), 0.3, 2e-6);
  }
  {
    ArticulatedCollisionManager manager(tree);  // on a link
    manager.bind("link", object(cloud), at({0, 0, 0.5}));
    manager.registerObject(object(ball));
    EXPECT_NEAR(ask(manager), 0.35, 2e-6);
  }
  {
    ArticulatedCollisionManager manager(tree);  // that moves up as the link comes down
    manager.bind("link", object(ball), at({0, 0, 0.5}));
    const auto up = std::make_shared<fcl::TranslationMotiond>(at({0, 0, -0.5}), at({0, 0, 0}));
    const fcl::ContinuousCollisionObjectd carried(cloud, up);
    manager.registerObject(&carried);
    EXPECT_NEAR(ask(manager), 0.85 / 1.5, 4e-6);
  }
  const fcl::TranslationMotiond down(at({0, 0, 0.5}), at({0, 0, -0.5})), still(at({0, 0, 0}), at({0, 0, 0}));
  CertifiedPairResult pair;
  continuousCollide(ball.get(), &down, static_cast<const fcl::CollisionGeometryd*>(cloud.get()), &still,
                    CertifiedPairRequest(), pair);
  EXPECT_EQ(pair.status, Status::contact);
  EXPECT_NEAR(pair.t_lower, 0.35, 2e-6);
}

TEST(PointCloud, CertificatesSayThatTheyCannotStateIt) {
  const auto tree = armTree();
  ArticulatedCollisionManager manager(tree);
  bindBoxes(manager);
  manager.registerObject(object(std::make_shared<PointCloud>(std::vector<Vector3d>{{5, 0, 0}}, 0.1)));
  manager.setup();
  CertifiedRequest request;
  request.certificate = true;
  CertifiedResult result;
  manager.continuousCollide(JointMotion::linear(*tree, Vector3d(0, 0, 0), Vector3d(1, 0, 0)), request, result);
  EXPECT_TRUE(result.isFree());
  ASSERT_NE(result.certificate, nullptr);
  EXPECT_FALSE(*result.certificate);
  EXPECT_NE(result.certificate->missing.find("point cloud"), std::string::npos) << result.certificate->missing;
}

/// Stage 2 proves of a cloud what it proves of the balls.
TEST(PointCloud, IsCulledByVisibility) {
  Random random(2);
  const auto tree = armTree();
  ArticulatedCollisionManager manager(tree);
  bindBoxes(manager);
  std::vector<Vector3d> points;
  for (int i = 0; i < 4000; ++i) {
    const double turn = random.uniform(-3, 3);
    points.emplace_back(0.75 * std::cos(turn), 0.75 * std::sin(turn), random.uniform(0.1, 0.4));
  }
  manager.registerObject(object(std::make_shared<PointCloud>(points, 0.005)));
  manager.setup();
  std::uint64_t pairs = 0, free = 0, contacts = 0;
  for (int i = 0; i < 60; ++i) {
    const Vector3d q0 = Vector3d(0, -0.1, 0) + Vector3d(3, 0.2, 0).cwiseProduct(random.box(1)),
                   q1 = q0 + Vector3d(0, -0.15, 0.1) + Vector3d(1, 0.45, 0).cwiseProduct(random.box(1));
    CertifiedRequest request;
    CertifiedResult off, on;
    const JointMotion motion = JointMotion::linear(*tree, q0, q1);
    manager.continuousCollide(motion, request, off);
    request.visibility = VisibilityMode::on;
    manager.continuousCollide(motion, request, on);
    ASSERT_EQ(on.status, off.status);
    ASSERT_EQ(on.t_lower, off.t_lower);
    pairs += on.statistics.visibility.culled + on.statistics.visibility.nodes;
    ++(off.isFree() ? free : contacts);
  }
  EXPECT_GE(pairs, 10u);
  EXPECT_GE(free, 5u);
  EXPECT_GE(contacts, 5u);
}

std::string messageOf(const std::function<void()>& call) {
  try {
    call();
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "nothing thrown";
}

namespace {

/// The sign of a sum of doubles, exactly: each partial sum keeps what rounding takes (J. R. Shewchuk 1997).
int signOfSum(const std::vector<double>& terms) {
  std::vector<double> parts;  // none overlaps another, the largest last
  for (double x : terms) {
    std::vector<double> next;
    for (const double y : parts) {
      const double sum = x + y, bb = sum - x, error = (x - (sum - bb)) + (y - bb);
      if (error != 0) next.push_back(error);
      x = sum;
    }
    if (x != 0) next.push_back(x);
    parts = next;
  }
  return parts.empty() ? 0 : parts.back() > 0 ? 1 : -1;
}

/// The terms of a product, exactly.
void addProduct(double a, double b, double sign, std::vector<double>& terms) {
  const double product = a * b;
  terms.push_back(sign * product);
  terms.push_back(sign * std::fma(a, b, -product));
}

/// Whether the ball around p lies in the ball around c, exactly: |p - c| <= R - r, by squares of exact differences.
bool liesIn(const Vector3d& p, double r, const Vector3d& c, double R) {
  // Differences as two doubles each: high + low.
  const auto difference = [](double a, double b, double* parts) {
    parts[0] = a - b;
    const double bb = parts[0] - a;
    parts[1] = (a - (parts[0] - bb)) + (-b - bb);
  };
  double most[2];
  difference(R, r, most);
  if (most[0] < 0) return false;
  std::vector<double> terms;
  const auto addSquare = [&](const double* d, double sign) {
    addProduct(d[0], d[0], sign, terms);
    addProduct(d[0], 2 * d[1], sign, terms);
    addProduct(d[1], d[1], sign, terms);
  };
  addSquare(most, 1);
  for (int k = 0; k < 3; ++k) {
    double d[2];
    difference(p[k], c[k], d);
    addSquare(d, -1);
  }
  return signOfSum(terms) >= 0;
}

}  // namespace

/// Each ball of a cloud lies in a ball of the thinned one, by exact arithmetic, and none of these is larger than said.
/// Faults to put in: the radius not rounded up; the middle of the cube in place of the points'; one axis of two left
/// out.
TEST(PointCloud, ThinnedHoldsEveryBall) {
  Random random(3);
  std::size_t balls = 0, thinned_balls = 0, tight = 0;
  for (int round = 0; round < 40; ++round) {
    const bool many = round % 20 == 0;  // over threads; in voxels that hold several
    const double scale = random.logUniform(1e-3, 1e3);
    const double voxel = std::max(1e-6, scale * random.logUniform(many ? 0.2 : 0.01, 3));
    const Vector3d place = round % 3 == 0 ? random.box(1e5) : Vector3d(0, 0, 0);
    std::vector<Vector3d> points;
    std::vector<double> radii;
    const int n = many ? 20000 : 300;
    for (int i = 0; i < n; ++i) {
      points.push_back(place + Vector3d(scale, scale, round % 2 ? 0 : scale).cwiseProduct(random.box(1)));
      if (i % 20 == 19) points.back() = points[static_cast<std::size_t>(i - 7)];
      radii.push_back(round % 4 == 1 ? 1e-12 : scale * random.logUniform(1e-4, 0.1));
    }
    if (round % 2) radii.resize(1);
    const PointCloud cloud(points, radii);
    const auto thinned = cloud.thinned(voxel);
    ASSERT_LE(thinned->points().size(), points.size());
    const auto cellOf = [&](const Vector3d& x) {
      std::array<double, 3> cell;
      for (int k = 0; k < 3; ++k) cell[static_cast<std::size_t>(k)] = std::floor(x[k] * (1 / voxel));
      return cell;
    };
    std::map<std::array<double, 3>, std::size_t> voxels;  // by their first points
    std::vector<std::size_t> count, of;
    for (const Vector3d& x : points) {
      const auto [at, is_new] = voxels.emplace(cellOf(x), voxels.size());
      if (is_new) count.push_back(0);
      ++count[at->second];
      of.push_back(at->second);
    }
    ASSERT_EQ(thinned->points().size(), voxels.size()) << round;
    std::vector<double> reach(voxels.size(), 0);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const std::size_t v = of[i];
      ASSERT_TRUE(liesIn(points[i], cloud.radius(i), thinned->points()[v], thinned->radius(v)))
          << "round " << round << ", point " << i;
      ASSERT_LE(thinned->radius(v), *std::max_element(radii.begin(), radii.end()) + 0.8661 * voxel + 1e-9);
      if (count[v] == 1) {
        ASSERT_EQ(thinned->points()[v], points[i]);
        ASSERT_EQ(thinned->radius(v), cloud.radius(i));
      }
      reach[v] = std::max(reach[v], (points[i] - thinned->points()[v]).norm() + cloud.radius(i));
    }
    for (std::size_t v = 0; v < reach.size(); ++v) tight += thinned->radius(v) <= reach[v] * (1 + 1e-13) + 1e-140;
    balls += points.size();
    thinned_balls += voxels.size();
  }
  EXPECT_EQ(tight, thinned_balls);      // no larger than its points need
  EXPECT_LT(2 * thinned_balls, balls);  // the test is telling: most cubes have several
  EXPECT_GT(20 * thinned_balls, balls);
}

/// A motion that is free amid a thinned cloud is free amid the cloud: the queries' own view.
TEST(PointCloud, FreeOfTheThinnedIsFree) {
  Random random(4);
  const auto tree = armTree();
  int free = 0, contacts = 0;
  for (int scene = 0; scene < 12; ++scene) {
    const Cloud cloud = randomCloud(random, 400, 1.3, scene % 2 == 0);
    const auto all = std::make_shared<PointCloud>(cloud.points, cloud.radii);
    ArticulatedCollisionManager whole(tree), fewer(tree);
    for (ArticulatedCollisionManager* manager : {&whole, &fewer}) {
      bindBoxes(*manager);
      manager->registerObject(object(manager == &whole ? all : all->thinned(0.15)), "cloud");
      manager->setup();
    }
    for (int i = 0; i < 100; ++i) {
      const Vector3d q0 = Vector3d(0, 0, 0.1) + Vector3d(3, 1.5, 0.1).cwiseProduct(random.box(1));
      const Vector3d q1 = q0 + random.box(0.1);
      const bool free_of_fewer = fewer.isFree(q0, q1), free_of_all = whole.isFree(q0, q1);
      if (free_of_fewer) EXPECT_TRUE(free_of_all);
      free += free_of_fewer;
      contacts += !free_of_all;
    }
  }
  EXPECT_GT(free, 10);
  EXPECT_GT(contacts, 10);
}

/// Rows of any size and alignment; what is not finite is left out and counted.
TEST(ReadFrame, TakesRowsAsTheyLie) {
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  const std::vector<std::array<double, 3>> values = {{1, 2, 3},    {nan, 0, 0},  {0.5, -0.25, 7}, {0, inf, 0},
                                                     {0, 0, -inf}, {-1, -2, -3}, {nan, -inf, 1}};
  const FrameLayout layouts[] = {{12, 0, 4, 8, false}, {32, 16, 20, 24, false}, {13, 9, 1, 5, false},
                                 {24, 0, 8, 16, true}, {29, 21, 1, 10, true},   {24, 16, 8, 0, true}};
  for (const FrameLayout& layout : layouts) {
    std::vector<char> bytes(1 + values.size() * layout.stride, '\x55');
    for (std::size_t i = 0; i < values.size(); ++i) {
      const std::size_t places[] = {layout.x, layout.y, layout.z};
      for (std::size_t k = 0; k < 3; ++k) {
        char* to = &bytes[1 + i * layout.stride + places[k]];
        const float single = static_cast<float>(values[i][k]);
        layout.is_double ? std::memcpy(to, &values[i][k], 8) : std::memcpy(to, &single, 4);
      }
    }
    const FramePoints frame = readFrame(bytes.data() + 1, values.size(), layout);
    ASSERT_EQ(frame.points.size(), 3u);
    EXPECT_EQ(frame.points[0], Vector3d(1, 2, 3));
    EXPECT_EQ(frame.points[1], Vector3d(0.5, -0.25, 7));
    EXPECT_EQ(frame.points[2], Vector3d(-1, -2, -3));
    EXPECT_EQ(frame.rows, (std::vector<std::uint32_t>{0, 2, 5}));
    EXPECT_EQ(frame.missing, 4u);
    EXPECT_EQ(frame.too_near, 2u);
    EXPECT_TRUE(readFrame(bytes.data() + 1, 1, layout).rows.empty());
  }
  EXPECT_TRUE(readFrame(nullptr, 0).points.empty());
  for (const FrameLayout& wrong : {FrameLayout{11, 0, 4, 8, false}, FrameLayout{12, 0, 4, 8, true},
                                   FrameLayout{12, 0, 4, std::size_t(-2), false}}) {
    EXPECT_THROW((void)readFrame(nullptr, 0, wrong), std::invalid_argument);
  }
}

TEST(PointCloud, WhatIsNoCloudIsRefused) {
  const auto contains = [](const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos ? testing::AssertionSuccess() : testing::AssertionFailure() << text;
  };
  const std::vector<Vector3d> two{{0, 0, 0}, {1, 0, 0}};
  EXPECT_TRUE(contains(messageOf([&] { PointCloud(std::vector<Vector3d>(), 0.1); }), "no point"));
  EXPECT_TRUE(contains(messageOf([&] { PointCloud(two, 0); }), "radius is 0"));
  EXPECT_TRUE(contains(messageOf([&] { PointCloud(two, std::nan("")); }), "radius is nan"));
  EXPECT_TRUE(contains(messageOf([&] { PointCloud(two, {0.1, -1}); }), "radius of point 1"));
  EXPECT_TRUE(contains(messageOf([&] { PointCloud(two, {0.1, 0.1, 0.1}); }), "2 points and 3 radii"));
  EXPECT_TRUE(contains(messageOf([&] { PointCloud({{0, 0, 0}, {0, std::nan(""), 0}}, 0.1); }), "point 1"));
  EXPECT_TRUE(contains(messageOf([&] { PointCloud({{0, 0, 2e9}}, 0.1); }), "point 0"));
  for (const double side : {0.0, -1.0, 1e-7, 2e9, std::nan("")}) {
    EXPECT_TRUE(contains(messageOf([&] { (void)PointCloud(two, 0.1).thinned(side); }), "voxel")) << side;
  }
}

}  // namespace

}  // namespace point_cloud_test
