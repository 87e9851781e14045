// SPDX-License-Identifier: BSD-3-Clause
//
// What stage 2 hands to an executor, for the motion of an arm of four joints.
#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "fcl_artic/manager.h"
#include "visibility/executor.h"

namespace fcl_artic {
namespace test {

/// The executor cpu, but that `before` and `after` may change the task and the answer.
struct Changed : visibility::Executor {
  void findThatMayOverlap(const visibility::Drawing& drawing, std::vector<std::uint8_t>& may) override {
    visibility::Drawing changed = drawing;
    if (before) before(changed);
    cpu->draw(changed, may);
    if (after) after(may);
  }
  std::function<void(visibility::Drawing& drawing)> before;
  std::function<void(std::vector<std::uint8_t>& may)> after;
  std::unique_ptr<visibility::Executor> cpu = visibility::makeCpuExecutor();
};
/// A culler with that executor, whose self-test is done: nothing of it reaches the functions.
inline std::shared_ptr<const VisibilityCuller> changedBy(
    const std::function<void(visibility::Drawing& drawing)>& before,
    const std::function<void(std::vector<std::uint8_t>& may)>& after = nullptr) {
  auto tested = std::make_shared<bool>(false);
  const auto culler = std::make_shared<VisibilityCuller>(VisibilityOptions(), "changed", [before, after, tested] {
    auto executor = std::make_unique<Changed>();
    if (before)
      executor->before = [before, tested](visibility::Drawing& drawing) {
        if (*tested) before(drawing);
      };
    if (after)
      executor->after = [after, tested](std::vector<std::uint8_t>& may) {
        if (*tested) after(may);
      };
    return executor;
  });
  (void)culler->executor();
  *tested = true;
  return culler;
}
inline std::shared_ptr<const VisibilityCuller> recordTo(visibility::Drawing& last) {
  return changedBy([&last](visibility::Drawing& drawing) { last = drawing; });
}

/// How far a volume reaches along n.
inline double support(const visibility::Drawing& drawing, const visibility::Volume& volume, const Eigen::Vector3d& n) {
  double most = -HUGE_VAL;
  for (int i = 0; i < volume.count; ++i) {
    most = std::max(most, n.dot(Eigen::Vector3d::Map(drawing.points.data() + 3 * (volume.first + i))));
  }
  return most + volume.radius * n.norm();
}

/// Links "base" and "link0" to "link3"; the third joint slides, the others turn.
inline std::shared_ptr<const KinematicTree> fourJoints() {
  auto tree = std::make_shared<KinematicTree>("chain");
  tree->addLink("base");
  for (int i = 0; i < 4; ++i) {
    Joint joint;
    joint.name = "joint" + std::to_string(i);
    joint.type = i == 2 ? JointType::prismatic : JointType::revolute;
    joint.parent = i ? "link" + std::to_string(i - 1) : "base";
    joint.child = "link" + std::to_string(i);
    joint.axis = Eigen::Vector3d::Unit(i % 3);
    joint.origin.translation() << 0.1, 0.2 * i, 0.3;
    tree->addLink(joint.child);
    tree->addJoint(joint);
  }
  return tree;
}

}  // namespace test
}  // namespace fcl_artic
