// SPDX-License-Identifier: BSD-3-Clause
// A planner's check of the path between two of pinocchio's configurations, proven in place of sampled: status 0 if all
// is as the page says.
#include <cmath>
#include <iostream>

#include <fcl_artic/pinocchio/pinocchio.h>  // before other headers of pinocchio's

#include <coal/shape/geometric_shapes.h>
#include <pinocchio/algorithm/joint-configuration.hpp>
#include <pinocchio/collision/collision.hpp>

namespace {

/// The usual check: configurations on the way, `step` from one to the next.
bool sampledCollisionsAlongPath(const pinocchio::Model& model, const pinocchio::GeometryModel& geometries,
                                const Eigen::VectorXd& q0, const Eigen::VectorXd& q1, double step) {
  pinocchio::Data data(model);
  pinocchio::GeometryData geometry_data(geometries);
  const auto steps = static_cast<int>(std::ceil(pinocchio::distance(model, q0, q1) / step)) + 1;
  for (int i = 0; i <= steps; ++i) {
    const Eigen::VectorXd q = pinocchio::interpolate(model, q0, q1, static_cast<double>(i) / steps);
    if (pinocchio::computeCollisions(model, data, geometries, geometry_data, q, true)) return true;
  }
  return false;
}

// [use]
/// The same question without a step size: false is a proof that nothing touches anywhere between q0 and q1.
class CertifiedPaths {
 public:
  CertifiedPaths(const pinocchio::Model& model, const pinocchio::GeometryModel& geometries)
      : robot_(fcl_artic::fromPinocchio(model, geometries)) {}

  bool hasCollisionsAlongPath(const Eigen::VectorXd& q0, const Eigen::VectorXd& q1) const {
    return !robot_.manager->isFree(robot_.motion(q0, q1));
  }

 private:
  fcl_artic::PinocchioRobot robot_;
};
// [/use]

Eigen::VectorXd turned(double angle) {
  return Eigen::Vector2d(std::cos(angle), std::sin(angle));
}

}  // namespace

int main() {
  // A hand of 2 cm goes around at 1 m; a rod of 2 mm stands in its way at 0.5 rad.
  pinocchio::Model model;
  const auto shoulder = model.addJoint(0, pinocchio::JointModelRUBZ(), pinocchio::SE3::Identity(), "shoulder");
  pinocchio::GeometryModel geometries;
  const auto place = [](double x, double y) {
    return pinocchio::SE3(Eigen::Matrix3d::Identity(), Eigen::Vector3d(x, y, 0));
  };
  const auto hand = geometries.addGeometryObject(
      pinocchio::GeometryObject("hand", shoulder, place(1, 0), std::make_shared<coal::Sphere>(0.02)));
  const auto rod = geometries.addGeometryObject(pinocchio::GeometryObject("rod", 0, place(std::cos(0.5), std::sin(0.5)),
                                                                          std::make_shared<coal::Cylinder>(0.002, 1)));
  geometries.addCollisionPair({hand, rod});

  const CertifiedPaths paths(model, geometries);
  // From 0 to 1 rad in 21 steps: the samples next to the rod are 1/42 rad, 23.8 mm, from its axis, and 22 mm touch.
  const bool sampled = sampledCollisionsAlongPath(model, geometries, turned(0), turned(1), 0.05);
  const bool certified = paths.hasCollisionsAlongPath(turned(0), turned(1));
  const bool beside = paths.hasCollisionsAlongPath(turned(0), turned(0.4));
  std::cout << std::boolalpha << "through the rod: sampled " << sampled << ", certified " << certified
            << "; beside it: certified " << beside << '\n';
  return !sampled && certified && !beside ? 0 : 1;
}
