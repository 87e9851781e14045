// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "fcl_artic/joint_motion.h"
#include "random.h"

namespace fcl_artic::test {

inline Eigen::Vector3d randomDirection(bench::Random& random) {
  const double z = random.uniform(-1, 1), azimuth = random.uniform(0, 6.283185307179586), r = std::sqrt(1 - z * z);
  return {r * std::cos(azimuth), r * std::sin(azimuth), z};
}

inline Eigen::Isometry3d randomPose(bench::Random& random, double spread) {
  Eigen::Isometry3d M = Eigen::Isometry3d::Identity();
  M.translation() = spread * random.uniform() * randomDirection(random);
  M.rotate(Eigen::AngleAxisd(random.uniform(-3, 3), randomDirection(random)));
  return M;
}

/// A random tree, mostly a chain, with `moving` joints of every type; fixed and mimic joints come on top.
inline std::shared_ptr<const KinematicTree> randomTree(bench::Random& random, int moving, double segment) {
  auto tree = std::make_shared<KinematicTree>("random");
  tree->addLink("link0");
  std::string master;
  while (tree->dof() < moving) {
    const int i = tree->numLinks();
    Joint joint;
    joint.name = "joint" + std::to_string(i);
    const double kind = random.uniform();
    joint.type = kind < 0.1   ? JointType::fixed
                 : kind < 0.3 ? JointType::prismatic
                 : kind < 0.5 ? JointType::continuous
                              : JointType::revolute;
    joint.parent = "link" + std::to_string(random.coin(0.85) ? i - 1 : random.index(i));
    joint.child = "link" + std::to_string(i);
    joint.origin = randomPose(random, segment);
    joint.axis = randomDirection(random);
    if (joint.type != JointType::fixed) {
      if (!master.empty() && random.coin(0.15)) {
        joint.mimics = true;
        joint.mimic = {master, random.uniform(-2, 2), random.uniform(-0.2, 0.2)};
      } else {
        master = joint.name;
      }
    }
    tree->addLink(joint.child);
    tree->addJoint(joint);
  }
  return tree;
}

/// @param angle  largest Δq of a joint, rad (a prismatic joint moves a fifth of it, in m).
inline JointMotion randomMotion(const KinematicTree& tree, bench::Random& random, double angle) {
  Eigen::VectorXd q0(tree.dof()), q1(tree.dof());
  for (int v = 0; v < tree.dof(); ++v) {
    const double scale = tree.joint(tree.variableJoint(v)).type == JointType::prismatic ? 0.2 : 1;
    q0[v] = scale * random.uniform(-3, 3);
    q1[v] = q0[v] + scale * random.uniform(-angle, angle);
  }
  return JointMotion::linear(tree, q0, q1);
}

}  // namespace fcl_artic::test
