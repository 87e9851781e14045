// SPDX-License-Identifier: BSD-3-Clause
//
// Small robots whose contact times are known in closed form.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/sphere.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>

#include "fcl_artic/manager.h"

namespace fcl_artic::planning {

inline Joint makeJoint(const std::string& name, JointType type, const std::string& parent, const std::string& child,
                       const Eigen::Vector3d& axis, double lower = 0, double upper = 0) {
  Joint joint;
  joint.name = name;
  joint.type = type;
  joint.parent = parent;
  joint.child = child;
  joint.axis = axis;
  joint.lower = lower;
  joint.upper = upper;
  return joint;
}

inline fcl::Transform3d at(double x, double y, double z = 0) {
  return fcl::Transform3d(Eigen::Translation3d(x, y, z));
}

/// A manager with what it holds pointers to.
class World {
 public:
  explicit World(std::shared_ptr<const KinematicTree> tree)
      : manager_(std::make_shared<ArticulatedCollisionManager>(std::move(tree))) {}
  World& bind(const std::string& link, const std::shared_ptr<fcl::CollisionGeometryd>& shape,
              const fcl::Transform3d& offset = fcl::Transform3d::Identity()) {
    objects_.push_back(std::make_unique<fcl::CollisionObjectd>(shape));
    manager_->bind(link, objects_.back().get(), offset);
    return *this;
  }
  World& obstacle(const std::shared_ptr<fcl::CollisionGeometryd>& shape, const fcl::Transform3d& pose,
                  const std::string& name = {}) {
    objects_.push_back(std::make_unique<fcl::CollisionObjectd>(shape, pose));
    manager_->registerObject(objects_.back().get(), name);
    return *this;
  }
  World& margin(const std::string& a, const std::string& b, double margin) {
    manager_->setMargin(a, b, margin);
    return *this;
  }
  World& tolerance(const JointTolerance& of_all_joints) {
    manager_->setJointTolerances(of_all_joints);
    return *this;
  }
  std::shared_ptr<const ArticulatedCollisionManager> manager() const {
    manager_->setup();
    return manager_;
  }

 private:
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> objects_;
  std::shared_ptr<ArticulatedCollisionManager> manager_;
};

/// A unit cube on a slide along x, and the like fixed at x = 3: faces meet at x = 2 and part at x = 4.
inline World slideWorld() {
  auto tree = std::make_shared<KinematicTree>("slide");
  tree->addLink("rail");
  tree->addLink("bar");
  tree->addJoint(makeJoint("slide", JointType::prismatic, "rail", "bar", Eigen::Vector3d::UnitX(), -10, 10));
  World world(tree);
  const auto cube = std::make_shared<fcl::Boxd>(1, 1, 1);
  world.bind("bar", cube).obstacle(cube, at(3, 0));
  return world;
}

/// A ball of 0.1 m that an arm carries round the origin at 1 m, and the like fixed at an angle: they meet at an angle
/// of 2 asin(0.1) between them.
inline World turnWorld(JointType type, double obstacle_angle) {
  auto tree = std::make_shared<KinematicTree>("arm");
  tree->addLink("base");
  tree->addLink("arm");
  tree->addJoint(makeJoint("turn", type, "base", "arm", Eigen::Vector3d::UnitZ()));
  World world(tree);
  const auto ball = std::make_shared<fcl::Sphered>(0.1);
  world.bind("arm", ball, at(1, 0)).obstacle(ball, at(std::cos(obstacle_angle), std::sin(obstacle_angle)));
  return world;
}

inline std::shared_ptr<::ompl::base::RealVectorStateSpace> reals(unsigned n, double bound = 10) {
  auto space = std::make_shared<::ompl::base::RealVectorStateSpace>(n);
  space->setBounds(-bound, bound);
  return space;
}

/// A state of a space, freed at the end; numbers in the order of the space's parts.
class TestState {
 public:
  TestState(::ompl::base::StateSpacePtr space, const std::vector<double>& values)
      : space_(std::move(space)), state_(space_->allocState()) {
    for (unsigned i = 0; i < values.size(); ++i) *space_->getValueAddressAtIndex(state_, i) = values[i];
  }
  ~TestState() { space_->freeState(state_); }
  TestState(const TestState&) = delete;
  TestState& operator=(const TestState&) = delete;

  operator ::ompl::base::State*() const { return state_; }
  double operator[](unsigned i) const { return *space_->getValueAddressAtIndex(state_, i); }

 private:
  ::ompl::base::StateSpacePtr space_;
  ::ompl::base::State* state_;
};

}  // namespace fcl_artic::planning
