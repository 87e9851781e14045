// SPDX-License-Identifier: BSD-3-Clause
//
// A mesh among meshes, planned for in OMPL's SE3 and SE2 spaces. The way that is proven is the one that interpolate()
// takes: FCL's static test at many poses of OMPL's own is the judge.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/narrowphase/collision.h>
#include <ompl/base/ScopedState.h>
#include <ompl/base/spaces/SE2StateSpace.h>
#include <ompl/base/spaces/SE3StateSpace.h>

#include "fcl_artic/continuous_collision.h"
#include "fcl_artic/ompl/planning_setup.h"

namespace fcl_artic::planning {
namespace rigid_body_test {
namespace {

namespace ob = ::ompl::base;
using Eigen::Vector3d;
using Mesh = fcl::BVHModel<fcl::OBBRSSd>;

/// A long flat box whose frame is off its middle, so that turns about another point would show.
std::shared_ptr<Mesh> boxMesh(const Vector3d& size, const Vector3d& center) {
  std::vector<Vector3d> v;
  for (int i = 0; i < 8; ++i) {
    v.push_back(center + 0.5 * size.cwiseProduct(Vector3d(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1)));
  }
  const int quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  std::vector<fcl::Triangle> t;
  for (const auto& q : quads) {
    t.emplace_back(q[0], q[1], q[2]);
    t.emplace_back(q[0], q[2], q[3]);
  }
  auto mesh = std::make_shared<Mesh>();
  mesh->beginModel();
  mesh->addSubModel(v, t);
  mesh->endModel();
  mesh->computeLocalAABB();
  return mesh;
}

std::shared_ptr<Mesh> body() {
  return boxMesh({0.6, 0.1, 0.05}, {0.25, 0, 0.02});
}

Scene posts(std::mt19937& random, int count) {
  std::uniform_real_distribution<double> at(-1, 1);
  Scene scene;
  for (int i = 0; i < count; ++i) {
    const fcl::Transform3d pose(Eigen::Translation3d(at(random), at(random), at(random)));
    scene.obstacles.push_back({"post" + std::to_string(i),
                               std::make_shared<fcl::CollisionObjectd>(boxMesh({0.1, 0.1, 0.5}, {0, 0, 0}), pose)});
  }
  return scene;
}

SetupOptions withinOne() {
  SetupOptions options;
  options.position_lower.setConstant(-1);
  options.position_upper.setConstant(1);
  return options;
}

Eigen::Isometry3d poseOf(const ob::SE3StateSpace::StateType& state) {
  const auto& r = state.rotation();
  return Eigen::Translation3d(state.getX(), state.getY(), state.getZ()) * Eigen::Quaterniond(r.w, r.x, r.y, r.z);
}

bool touches(const fcl::CollisionGeometryd& geometry, const Eigen::Isometry3d& M_0, const Scene& scene) {
  for (const Scene::Obstacle& obstacle : scene.obstacles) {
    fcl::CollisionResultd result;
    if (fcl::collide(&geometry, M_0, obstacle.object->collisionGeometry().get(), obstacle.object->getTransform(),
                     fcl::CollisionRequestd(), result) > 0) {
      return true;
    }
  }
  return false;
}

TEST(RigidBody, ProvenFreeIsFreeAlongOmplsOwnWay) {
  std::mt19937 random(5);
  int free = 0, contact = 0, touched = 0;
  const auto geometry = body();
  for (int i = 0; i < 300; ++i) {
    const Scene scene = posts(random, 4);
    const PlanningSetup setup = setUpRigidBody(geometry, scene, withinOne());
    setup.space->as<ob::SE3StateSpace>();
    ompl::RNG::setSeed(1);
    const auto sampler = setup.space->allocStateSampler();
    ob::ScopedState<ob::SE3StateSpace> s1(setup.space), s2(setup.space), between(setup.space);
    std::uniform_real_distribution<double> at(-1, 1);
    const auto draw = [&](ob::ScopedState<ob::SE3StateSpace>& s) {
      s->setXYZ(at(random), at(random), at(random));
      Eigen::Vector4d q(at(random), at(random), at(random), at(random));
      q.normalize();  // of either sign: the shorter way is taken all the same
      s->rotation().x = q[0];
      s->rotation().y = q[1];
      s->rotation().z = q[2];
      s->rotation().w = q[3];
    };
    draw(s1);
    draw(s2);
    const bool proven = setup.si->checkMotion(s1.get(), s2.get());
    (proven ? free : contact)++;
    bool hit = false;
    for (int k = 0; k <= 300 && !hit; ++k) {
      setup.space->interpolate(s1.get(), s2.get(), k / 300.0, between.get());
      hit = touches(*geometry, poseOf(*between), scene);
    }
    EXPECT_FALSE(proven && hit) << i;
    touched += hit;
  }
  EXPECT_GT(free, 60);
  EXPECT_GT(contact, 60);
  EXPECT_GT(touched, contact * 9 / 10) << "nearly all that is not free does touch";
}

TEST(RigidBody, LinearIsTheWayAndScrewIsAnother) {
  // Two of FCL's motion types: a proof along CCDM_LINEAR and one along CCDM_SCREW, against OMPL's own poses.
  std::mt19937 random(6);
  std::uniform_real_distribution<double> at(-1, 1);
  const auto geometry = body();
  const auto space = std::make_shared<ob::SE3StateSpace>();
  space->setBounds([] {
    ob::RealVectorBounds bounds(3);
    bounds.setLow(-1);
    bounds.setHigh(1);
    return bounds;
  }());
  int screw_free = 0, linear_free = 0, screw_collides = 0;
  for (int i = 0; i < 300; ++i) {
    const Scene scene = posts(random, 1);
    ob::ScopedState<ob::SE3StateSpace> s1(space), s2(space), between(space);
    for (auto* s : {&s1, &s2}) {
      (*s)->setXYZ(at(random), at(random), at(random));
      const Vector3d axis = Vector3d(at(random), at(random), at(random)).normalized();
      (*s)->rotation().setAxisAngle(axis.x(), axis.y(), axis.z(), 1.5 * at(random));
    }
    const fcl::CollisionObjectd& post = *scene.obstacles[0].object;
    const auto isFree = [&](fcl::CCDMotionType type) {
      CertifiedPairResult result;
      continuousCollide(geometry.get(), poseOf(*s1), poseOf(*s2), post.collisionGeometry().get(), post.getTransform(),
                        post.getTransform(), type, CertifiedPairRequest(), result);
      return result.isFree();
    };
    bool hit = false;
    for (int k = 0; k <= 300 && !hit; ++k) {
      space->interpolate(s1.get(), s2.get(), k / 300.0, between.get());
      hit = touches(*geometry, poseOf(*between), scene);
    }
    const bool linear = isFree(fcl::CCDM_LINEAR), screw = isFree(fcl::CCDM_SCREW);
    linear_free += linear;
    screw_free += screw;
    EXPECT_FALSE(linear && hit) << i;
    screw_collides += screw && hit;
  }
  EXPECT_GT(linear_free, 50);
  EXPECT_GT(screw_free, 50);
  EXPECT_GT(screw_collides, 0) << "this is what doc/MIGRATION.md warns of";
}

TEST(RigidBody, InThePlaneItIsAnSE2Space) {
  Scene scene;
  scene.obstacles.push_back(
      {"body", std::make_shared<fcl::CollisionObjectd>(std::make_shared<fcl::Boxd>(0.1, 0.1, 0.1),
                                                       fcl::Transform3d(Eigen::Translation3d(0.5, 0, 0)))});
  const PlanningSetup setup = setUpRigidBody(body(), scene, withinOne(), JointType::planar);
  EXPECT_EQ(setup.space->getType(), ob::STATE_SPACE_SE2);
  EXPECT_EQ(setup.notes.size(), 1u) << "the obstacle has the link's name, and gets another";
  ob::ScopedState<ob::SE2StateSpace> s1(setup.space), s2(setup.space);
  s1->setXY(-0.9, 0);
  s1->setYaw(0);
  s2->setXY(0.9, 0);
  s2->setYaw(0);
  EXPECT_FALSE(setup.si->checkMotion(s1.get(), s2.get()));
  s1->setXY(-0.9, 0.5);
  s2->setXY(0.9, 0.5);
  EXPECT_TRUE(setup.si->checkMotion(s1.get(), s2.get()));
  s1->setXY(0.2, 0.5);
  s1->setYaw(0);
  s2->setXY(0.2, 0.5);
  s2->setYaw(-1.2);  // turns its far end into the obstacle
  EXPECT_FALSE(setup.si->checkMotion(s1.get(), s2.get()));
}

TEST(RigidBody, QuaternionsOfFewDigitsAreOmpls) {
  const PlanningSetup setup = setUpRigidBody(body(), Scene(), withinOne());
  ob::ScopedState<ob::SE3StateSpace> s(setup.space);
  setup.setState(s.get(), {0, 0, 0, 0, 0, 0.68164, 0.73169});  // 1.5 rad about z
  EXPECT_TRUE(setup.space->satisfiesBounds(s.get()));
  EXPECT_NEAR(s->rotation().z, std::sin(0.75), 3e-6);
  EXPECT_NEAR(s->rotation().w, std::cos(0.75), 3e-6);
  const std::vector<double> exact{0, 0, 0, 0, 0, std::sin(0.75), std::cos(0.75)};
  setup.setState(s.get(), exact);
  EXPECT_EQ(setup.values(s.get()), exact) << "what OMPL takes stays as it is";
  for (const double w : {0.7, std::nan("")}) {  // no orientation; OMPL takes one with NaN to be within its bounds
    setup.setState(s.get(), {0, 0, 0, 0, 0, 0.68164, w});
    EXPECT_THROW((void)setup.si->isValid(s.get()), std::invalid_argument);
  }
}

TEST(RigidBody, WhatIsNoneIsRefused) {
  EXPECT_THROW(setUpRigidBody(nullptr, Scene(), withinOne()), std::invalid_argument);
  EXPECT_THROW(setUpRigidBody(body(), Scene(), SetupOptions()), std::invalid_argument);
  EXPECT_THROW(setUpRigidBody(body(), Scene(), withinOne(), JointType::revolute), std::invalid_argument);
}

}  // namespace
}  // namespace rigid_body_test
}  // namespace fcl_artic::planning
