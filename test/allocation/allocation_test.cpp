// SPDX-License-Identifier: BSD-3-Clause
//
// A warm query that is free allocates nothing, one that ends in contact a vector of joint values: all memory that this
// program asks for is counted.
#include <atomic>
#include <cstdlib>
#include <utility>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/geometric_shape_to_BVH_model.h>
#include <gtest/gtest.h>

#include "fcl_artic/guard.h"
#include "fcl_artic/manager.h"
#include "fcl_artic/point_cloud.h"

namespace allocation_test {

namespace {
std::atomic<long> allocations{0};
}

}  // namespace allocation_test

// glibc's own, under its other names. Outside of the namespace they are the ones that its header declares, which are
// seen by all libraries.
extern "C" {
void* __libc_malloc(std::size_t size);                           // NOLINT: glibc's name
void* __libc_calloc(std::size_t count, std::size_t size);        // NOLINT
void* __libc_realloc(void* memory, std::size_t size);            // NOLINT
void* __libc_memalign(std::size_t alignment, std::size_t size);  // NOLINT

void* malloc(std::size_t size) {
  ++allocation_test::allocations;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  ++allocation_test::allocations;
  return __libc_calloc(count, size);
}
void* realloc(void* memory, std::size_t size) {
  ++allocation_test::allocations;
  return __libc_realloc(memory, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  ++allocation_test::allocations;
  return __libc_memalign(alignment, size);
}
}

namespace allocation_test {

using namespace fcl_artic;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

std::shared_ptr<fcl::CollisionObjectd> object(const std::shared_ptr<fcl::CollisionGeometryd>& geometry,
                                              const Vector3d& at) {
  return std::make_shared<fcl::CollisionObjectd>(geometry, Isometry3d(Eigen::Translation3d(at)));
}

/// An arm of three boxes, a mesh among them, amid a few bodies.
struct Arm {
  std::shared_ptr<KinematicTree> tree = std::make_shared<KinematicTree>("arm");
  std::unique_ptr<ArticulatedCollisionManager> manager;
  Arm() {
    tree->addLink("base");
    tree->addLink("upper");
    tree->addLink("lower");
    tree->addLink("hand");
    const Isometry3d out(Eigen::Translation3d(0.5, 0, 0));
    tree->addJoint(Joint::revolute("j1", "base", "upper", Vector3d::UnitZ()));
    tree->addJoint(Joint::revolute("j2", "upper", "lower", Vector3d::UnitZ(), out));
    tree->addJoint(Joint::revolute("j3", "lower", "hand", Vector3d::UnitX(), out));
    manager = std::make_unique<ArticulatedCollisionManager>(tree);
    const auto mesh = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
    fcl::generateBVHModel(*mesh, fcl::Boxd(0.45, 0.1, 0.1), Isometry3d(Eigen::Translation3d(0.25, 0, 0)));
    manager->bind("upper", object(mesh, Vector3d::Zero()));
    manager->bind("lower", object(mesh, Vector3d::Zero()));
    manager->bind("hand", object(std::make_shared<fcl::Boxd>(0.1, 0.1, 0.1), Vector3d::Zero()));
    manager->registerObject(object(mesh, {0.7, 0, 0}), "bar");
    manager->registerObject(object(std::make_shared<fcl::Sphered>(0.1), {0.2, 0.9, 0}), "ball");
    manager->registerObject(object(std::make_shared<fcl::Cylinderd>(0.05, 2), {-0.6, 0.3, 0}), "post");
    manager->setup();
  }
};

/// Allocations of the third of three equal queries.
long allocationsOf(const Arm& arm, const VectorXd& q0, const VectorXd& q1, const CertifiedRequest& request,
                   Status expected) {
  const JointMotion motion = JointMotion::linear(*arm.tree, q0, q1);
  CertifiedResult result;
  long counted = 0;
  for (int i = 0; i < 3; ++i) {
    const long before = allocations;
    arm.manager->continuousCollide(motion, request, result);
    counted = allocations - before;
    EXPECT_EQ(result.status, expected);
  }
  return counted;
}

TEST(Allocation, CounterCounts) {
  const long before = allocations;
  const std::unique_ptr<std::string> text(new std::string(100, 'x'));
  EXPECT_EQ(text->size(), 100u);
  EXPECT_GT(allocations - before, 0) << "nothing is counted: the tests below say nothing";
}

TEST(Allocation, WarmQueriesHaveTheirMemory) {
  const Arm arm;
  const VectorXd q0 = Vector3d(0.6, 0.2, 0), free = Vector3d(0.7, 0.5, 1), hit = Vector3d(-0.5, 0.2, 0);
  for (const ContactMode mode : {ContactMode::first, ContactMode::any}) {
    CertifiedRequest request;
    request.mode = mode;
    EXPECT_EQ(allocationsOf(arm, q0, free, request, Status::free), 0) << "mode " << static_cast<int>(mode);
    // The joint values at t_lower, for the poses there.
    EXPECT_LE(allocationsOf(arm, q0, hit, request, Status::contact), 1) << "mode " << static_cast<int>(mode);
  }
}

/// Allocations of a manager's first and second query by the paper's method.
std::pair<long, long> firstAndSecond(bool prepared) {
  const Arm arm;
  if (prepared) {
    arm.manager->prepareFor(Method::redon2004);
    arm.manager->setup();
  }
  const JointMotion motion = JointMotion::linear(*arm.tree, Vector3d(0.6, 0.2, 0), Vector3d(0.7, 0.5, 1));
  CertifiedRequest request;
  request.method = Method::redon2004;
  CertifiedResult result;
  long counts[2];
  for (long& counted : counts) {
    const long before = allocations;
    arm.manager->continuousCollide(motion, request, result);
    counted = allocations - before;
  }
  return {counts[0], counts[1]};
}

TEST(Allocation, PreparedTreesAreNotMadeByTheFirstQuery) {
  firstAndSecond(false);  // the thread's own memory
  const auto [late, warm] = firstAndSecond(false);
  EXPECT_GT(late, warm) << "nothing is made: this says nothing";
  const auto [prepared, after] = firstAndSecond(true);
  EXPECT_EQ(prepared, after);
}

/// As many answers as FCL_ARTIC_GUARD_ANSWERS says.
long answersWanted() {
  const char* text = std::getenv("FCL_ARTIC_GUARD_ANSWERS");
  return text ? std::atol(text) : 20000;
}

TEST(Allocation, AGuardsAnswersHaveTheirMemory) {
  Arm arm;
  std::vector<Vector3d> points;
  for (int row = 0; row < 20; ++row) {
    for (int k = 0; k < 100; ++k) points.emplace_back(0.2 + 0.001 * k, -0.8, 0.01 * row);
  }
  arm.manager->registerObject(object(std::make_shared<PointCloud>(points, 0.01), Vector3d::Zero()), "cloud");
  const std::string person = "a person whose name is longer than a short string";
  arm.manager->registerObject(object(std::make_shared<fcl::Sphered>(0.2), {1.6, 1.2, 0}), person);
  arm.manager->setObjectSpeed(person, {0.6, 0});
  arm.manager->setJointTolerances({0.005, 0});
  arm.manager->setup();
  const std::vector<double> times{0, 1, 1.5, 3, 4};
  const std::vector<VectorXd> waypoints{Vector3d(0.6, 0.2, 0), Vector3d(0.7, 0.5, 1), Vector3d(1.2, 0.1, 0),
                                        Vector3d(-0.8, 0.3, 1), Vector3d(0.4, 0.2, 0)};
  const std::vector<VectorXd> still(5, Vector3d::Zero());
  GuardOptions options;
  options.deceleration = Vector3d(10, 10, 10);
  options.most_age = 1e9;
  for (const bool smooth : {false, true}) {
    Guard guard(arm.tree, options);
    guard.follow(smooth ? JointTrajectory::quintic(*arm.tree, times, waypoints, still, still)
                        : JointTrajectory::linear(*arm.tree, times, waypoints));
    const LiveScene live(arm.manager->copy());
    GuardAnswer answer;
    AheadAnswer ahead;
    long before = 0, full = 0, slow = 0, stop = 0;
    const long wanted = answersWanted();
    for (long n = -1000; n < wanted; ++n) {
      if (n == 0) before = allocations;
      const double at = 4 * static_cast<double>((n + 1000) * 7919 % 1000) / 1000;
      const double speed = static_cast<double>(n & 3) / 3;
      guard.ask(*live.latest(), 1e-4 * static_cast<double>(n & 63), at, speed, answer);
      if (n < 0 || n % 16 == 0) guard.lookAhead(*live.latest(), 0, at, ahead);
      full += answer.speed == 1;
      slow += answer.speed > 0 && answer.speed < 1;
      stop += answer.speed == 0;
    }
    EXPECT_EQ(allocations - before, 0);
    EXPECT_GT(full, wanted / 100);
    EXPECT_GT(slow, wanted / 100);
    EXPECT_GT(stop, wanted / 100);
  }
}

}  // namespace

}  // namespace allocation_test
