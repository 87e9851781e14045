// SPDX-License-Identifier: BSD-3-Clause
// Shared by the targets that read scenes.
#pragma once

#include <fcl/geometry/shape/sphere.h>

#include "fcl_artic/urdf/urdf.h"
#include "fuzz.h"

namespace fcl_artic::fuzz {

/// Loads a scene and asks a ball that turns about it.
inline void loadAndQuery(const std::string& name, const std::string& content, const SceneOptions& options = {}) {
  const std::string path = Folder::instance().write(name, content);
  Scene scene;
  if (!loads(path, [&] { scene = loadScene(path, options); })) return;
  if (scene.obstacles.size() > 200) return;  // time
  static const auto tree = [] {
    auto all = std::make_shared<KinematicTree>("r");
    all->addLink("base");
    all->addLink("arm");
    Joint joint;
    joint.name = "turn";
    joint.type = JointType::continuous;
    joint.parent = "base";
    joint.child = "arm";
    all->addJoint(joint);
    return all;
  }();
  ArticulatedCollisionManager manager(tree);
  fcl::CollisionObjectd ball(std::make_shared<fcl::Sphered>(0.2));
  Eigen::Isometry3d offset = Eigen::Isometry3d::Identity();
  offset.translation().y() = 0.5;
  manager.bind("arm", &ball, offset);
  try {
    scene.addTo(manager);
  } catch (const std::invalid_argument&) {
    return;
  }
  query(manager);
}

}  // namespace fcl_artic::fuzz
