// SPDX-License-Identifier: BSD-3-Clause
//
// What stage 2 hands to an executor, for the motion of an arm of four joints.
#pragma once

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "fcl_artic/manager.h"
#include "visibility/cpu_executor.h"

namespace fcl_artic {
namespace test {

/// The executor cpu, with what it was asked last.
struct Recorder : visibility::Executor {
  explicit Recorder(visibility::Batch& kept) : last(kept) {}
  void run(const visibility::Batch& batch, std::vector<std::uint8_t>& may) override {
    last = batch;
    cpu.run(batch, may);
  }
  visibility::Batch& last;
  visibility::CpuExecutor cpu;
};
inline std::shared_ptr<const VisibilityCuller> recordTo(visibility::Batch& batch,
                                                        const VisibilityOptions& options = {}) {
  return std::make_shared<VisibilityCuller>(options, "recorder",
                                            [&batch] { return std::make_unique<Recorder>(batch); });
}

/// How far a volume reaches along n.
inline double support(const visibility::Batch& batch, const visibility::Volume& volume, const Eigen::Vector3d& n) {
  double most = -HUGE_VAL;
  for (int i = 0; i < volume.count; ++i) {
    most = std::max(most, n.dot(Eigen::Vector3d::Map(batch.points.data() + 3 * (volume.first + i))));
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
