// SPDX-License-Identifier: BSD-3-Clause
//
// The smallest robot that turns.
#pragma once

#include <memory>

#include "../query/arms.h"

namespace fcl_artic {
namespace tube_test {

using namespace fcl_artic::test;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// A ball of radius `kRadius` at the end of an arm of length 1 that turns about z.
constexpr double kRadius = 0.01;

struct OneTurn {
  std::shared_ptr<KinematicTree> tree = std::make_shared<KinematicTree>("arm");
  std::shared_ptr<fcl::CollisionObjectd> tip = ball(kRadius);
  std::unique_ptr<ArticulatedCollisionManager> manager;

  explicit OneTurn(JointType type = JointType::revolute) {
    tree->addLink("base");
    tree->addLink("arm");
    tree->addJoint(makeJoint("joint", type, "base", "arm", Vector3d::UnitZ()));
    manager = std::make_unique<ArticulatedCollisionManager>(tree);
    manager->bind("arm", tip, pose(Vector3d::UnitX()));
  }
  CertifiedResult turn(double from, double to) {
    manager->setup();
    return ask(*manager, VectorXd::Constant(1, from), VectorXd::Constant(1, to));
  }
};

inline double angleOf(const VectorXd& q) {
  return q[0];
}

}  // namespace tube_test
}  // namespace fcl_artic
