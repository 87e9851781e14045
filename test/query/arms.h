// SPDX-License-Identifier: BSD-3-Clause
//
// Small robots and objects for tests with times worked out by hand.
#pragma once

#include <memory>
#include <random>
#include <string>
#include <vector>

#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision_object.h>

#include "fcl_artic/manager.h"

namespace fcl_artic {
namespace test {

// Times are exact here but for rounding of a few ulp and the prefix root's 1e-12 of the last lane.
constexpr double kRounding = 1e-11;

inline Eigen::Isometry3d pose(const Eigen::Vector3d& x, double angle = 0,
                              const Eigen::Vector3d& axis = Eigen::Vector3d::UnitZ()) {
  return Eigen::Translation3d(x) * Eigen::AngleAxisd(angle, axis.normalized());
}

inline Joint makeJoint(const std::string& name, JointType type, const std::string& parent, const std::string& child,
                       const Eigen::Vector3d& axis, const Eigen::Isometry3d& origin = Eigen::Isometry3d::Identity()) {
  Joint joint;
  joint.name = name;
  joint.type = type;
  joint.parent = parent;
  joint.child = child;
  joint.axis = axis;
  joint.origin = origin;
  return joint;
}

inline std::shared_ptr<fcl::CollisionObjectd> object(const std::shared_ptr<fcl::CollisionGeometryd>& geometry,
                                                     const Eigen::Isometry3d& M = Eigen::Isometry3d::Identity()) {
  return std::make_shared<fcl::CollisionObjectd>(geometry, M);
}
inline std::shared_ptr<fcl::CollisionObjectd> ball(double radius, const Eigen::Vector3d& x = Eigen::Vector3d::Zero()) {
  return object(std::make_shared<fcl::Sphered>(radius), pose(x));
}

inline CertifiedResult ask(const ArticulatedCollisionManager& manager, const Eigen::VectorXd& q0,
                           const Eigen::VectorXd& q1, const CertifiedRequest& request = {}) {
  CertifiedResult result;
  manager.continuousCollide(JointMotion::linear(manager.tree(), q0, q1), request, result);
  return result;
}

/// Links in a row, each on a slider along x on the one before.
inline std::shared_ptr<KinematicTree> sliderTree(const std::vector<std::string>& links) {
  auto tree = std::make_shared<KinematicTree>("slider");
  for (const std::string& link : links) tree->addLink(link);
  for (std::size_t i = 1; i < links.size(); ++i) {
    tree->addJoint(
        makeJoint("slide" + std::to_string(i), JointType::prismatic, links[i - 1], links[i], Eigen::Vector3d::UnitX()));
  }
  return tree;
}

/// A slider along x, whose link "cart" carries one geometry; variable: x.
struct Cart {
  std::shared_ptr<KinematicTree> tree = sliderTree({"rail", "cart"});
  std::shared_ptr<fcl::CollisionObjectd> body;
  std::unique_ptr<ArticulatedCollisionManager> manager = std::make_unique<ArticulatedCollisionManager>(tree);
  explicit Cart(const std::shared_ptr<fcl::CollisionGeometryd>& geometry = std::make_shared<fcl::Sphered>(0.1))
      : body(object(geometry)) {
    manager->bind("cart", body.get());
  }
  CertifiedResult run(double from, double to, const CertifiedRequest& request = {}) const {
    return ask(*manager, Eigen::VectorXd::Constant(1, from), Eigen::VectorXd::Constant(1, to), request);
  }
};

}  // namespace test
}  // namespace fcl_artic
