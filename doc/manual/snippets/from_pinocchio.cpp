// SPDX-License-Identifier: BSD-3-Clause
// A pinocchio model, certified: status 0 if all is as the page says.
// [use]
#include <iostream>

#include <fcl_artic/pinocchio/pinocchio.h>  // before other headers of pinocchio's

#include <coal/shape/geometric_shapes.h>

int main() {
  // A model and its geometry, as pinocchio::urdf::buildModel() and buildGeom() read them, too.
  pinocchio::Model model;
  const auto shoulder = model.addJoint(0, pinocchio::JointModelRUBZ(), pinocchio::SE3::Identity(), "shoulder");
  pinocchio::GeometryModel geometries;
  const auto place = [](double x, double y) {
    return pinocchio::SE3(Eigen::Matrix3d::Identity(), Eigen::Vector3d(x, y, 0));
  };
  const auto hand = geometries.addGeometryObject(
      pinocchio::GeometryObject("hand", shoulder, place(1, 0), std::make_shared<coal::Sphere>(0.1)));
  const auto post = geometries.addGeometryObject(
      pinocchio::GeometryObject("post", 0, place(0, 1), std::make_shared<coal::Cylinder>(0.05, 1)));
  geometries.addCollisionPair({hand, post});

  const fcl_artic::PinocchioRobot robot = fcl_artic::fromPinocchio(model, geometries);
  const Eigen::Vector2d q0(1, 0), q1(-1, 0.1);  // pinocchio's: cosine and sine, here 0 and about 174 degrees
  const auto result = robot.manager->continuousCollide(robot.motion(q0, q1.normalized()));
  std::cout << result << '\n';
  if (const auto* contact = result.first()) std::cout << *contact << '\n';
  // [/use]
  return result.certain && result.first() && result.first()->body1.name == "hand" ? 0 : 1;
}
