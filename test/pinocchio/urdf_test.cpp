// SPDX-License-Identifier: BSD-3-Clause
//
// The bundled robot among pipes, read by pinocchio (meshes by coal) and by this library: the same answers.
#include <iostream>
#include <random>

#include <gtest/gtest.h>

#include <pinocchio/fwd.hpp>  // before boost's variant

#include <coal/BVH/BVH_model.h>
#include <fcl/geometry/bvh/BVH_model.h>
#include <pinocchio/collision/collision.hpp>
#include <pinocchio/collision/distance.hpp>
#include <pinocchio/parsers/urdf.hpp>

#include "fcl_artic/pinocchio/pinocchio.h"
#include "fcl_artic/urdf/urdf.h"

namespace fcl_artic {
namespace urdf_test {
namespace {

/// FCL's mesh as coal's, triangle by triangle.
std::shared_ptr<coal::CollisionGeometry> coalMesh(const fcl::CollisionGeometryd& geometry) {
  const auto& mesh = dynamic_cast<const fcl::BVHModel<fcl::OBBRSSd>&>(geometry);
  auto copy = std::make_shared<coal::BVHModel<coal::OBBRSS>>();
  copy->beginModel();
  for (int i = 0; i < mesh.num_tris; ++i) {
    const fcl::Triangle& t = mesh.tri_indices[i];
    copy->addTriangle(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]);
  }
  copy->endModel();
  return copy;
}

TEST(PinocchioUrdf, ThousandMotionsOfThePuma) {
  const Robot own = loadUrdf("data/puma560/puma560.urdf");
  const Scene scene = loadScene("data/pipes.obj");
  ArticulatedCollisionManager direct(own.tree);
  own.addTo(direct);
  scene.addTo(direct);
  direct.setup();

  pinocchio::Model model;
  pinocchio::urdf::buildModel("data/puma560/puma560.urdf", model);
  pinocchio::GeometryModel geometries;
  pinocchio::urdf::buildGeom(model, "data/puma560/puma560.urdf", pinocchio::COLLISION, geometries,
                             std::vector<std::string>{"data/puma560"});
  const std::size_t bodies = geometries.ngeoms;
  ASSERT_EQ(bodies, own.geometry.size());
  for (const auto& [a, b] : direct.checkedLinkPairs()) {
    geometries.addCollisionPair({geometries.getGeometryId(a + "_0"), geometries.getGeometryId(b + "_0")});
  }
  ASSERT_EQ(scene.obstacles.size(), 1u);
  const fcl::CollisionObjectd& pipes = *scene.obstacles[0].object;
  const auto obstacle = geometries.addGeometryObject(pinocchio::GeometryObject(
      "pipes", 0, pinocchio::SE3(pipes.getRotation(), pipes.getTranslation()), coalMesh(*pipes.collisionGeometry())));
  for (std::size_t g = 0; g < bodies; ++g) {
    if (geometries.geometryObjects[g].parentJoint > 0) geometries.addCollisionPair({g, obstacle});
  }
  // The base stands still: this library checks it against the pipes as well, where it is a link.
  direct.allow("base", "pipes");
  direct.setup();
  const PinocchioRobot robot = fromPinocchio(model, geometries);
  ASSERT_EQ(robot.tree->dof(), own.tree->dof());

  pinocchio::Data data(model);
  pinocchio::GeometryData geometry_data(geometries);
  std::mt19937_64 random(3);
  int free = 0, touching = 0, initial = 0, other_verdict = 0, other_time = 0, missed = 0, not_there = 0;
  for (int i = 0; i < 1000; ++i) {
    Eigen::VectorXd q0(6), q1(6);
    for (int v = 0; v < 6; ++v) {
      const Joint& joint = own.tree->joint(own.tree->variableJoint(v));
      ASSERT_EQ(joint.name, robot.tree->joint(robot.tree->variableJoint(v)).name);
      q0[v] = std::uniform_real_distribution<double>(joint.lower, joint.upper)(random);
      q1[v] = q0[v] + std::uniform_real_distribution<double>(-0.6, 0.6)(random);
    }
    const CertifiedResult result = robot.manager->continuousCollide(robot.motion(q0, q1));
    const CertifiedResult by_hand = direct.continuousCollide(q0, q1);
    other_verdict += result.status != by_hand.status;
    free += result.status == Status::free;
    if (result.status != Status::free) {
      ++touching;
      initial += result.t_lower <= 0;
      // coal's reader has coordinates as float.
      other_time += result.t_lower > by_hand.t_upper + 1e-5 || by_hand.t_lower > result.t_upper + 1e-5;
      const Eigen::VectorXd q = q0 + result.t_upper * (q1 - q0);
      if (result.certain && !pinocchio::computeCollisions(model, data, geometries, geometry_data, q, true)) {
        double least = INFINITY;
        pinocchio::computeDistances(model, data, geometries, geometry_data, q);
        for (const auto& each : geometry_data.distanceResults) least = std::min(least, each.min_distance);
        not_there += least > 2e-6;
      }
    }
    const double until = result.status == Status::free ? 1 : result.t_lower;
    for (int k = 0; k < 25; ++k) {  // coal looks from the start on; at t_lower the gap is rounding's
      if (until <= 0) break;
      if (pinocchio::computeCollisions(model, data, geometries, geometry_data, q0 + until * k / 25 * (q1 - q0), true)) {
        ++missed;
        break;
      }
    }
  }
  std::cout << free << " free, " << touching << " in contact (" << initial
            << " from the start); other verdicts than by this library's own reader: " << other_verdict
            << ", other times: " << other_time << ", missed: " << missed
            << ", contacts that coal does not see: " << not_there << "\n";
  EXPECT_GT(free, 100);
  EXPECT_GT(touching - initial, 100);
  EXPECT_EQ(other_verdict, 0);
  EXPECT_EQ(other_time, 0);
  EXPECT_EQ(missed, 0);
  EXPECT_EQ(not_there, 0);
}

}  // namespace
}  // namespace urdf_test
}  // namespace fcl_artic
