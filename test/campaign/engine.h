// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include <fcl_artic/fcl_artic.h>

#include "scene.h"

namespace campaign {

/// The library's answer to a scene, with what is needed to read it.
struct Answer {
  fcl_artic::CertifiedRequest request;
  fcl_artic::CertifiedResult result;
  std::vector<std::shared_ptr<fcl::CollisionObjectd>> objects;  ///< one for each body of the scene
  double elapsed_us = 0;                                        ///< of the query alone

  /// Body of the scene, -1 when it is none.
  int bodyOf(const fcl::CollisionObjectd* object) const;
};

/// A scene put to the library, ready to be asked.
struct Question {
  std::vector<std::shared_ptr<fcl::CollisionObjectd>> objects;  ///< one for each body of the scene
  std::shared_ptr<const fcl_artic::KinematicTree> tree;
  std::unique_ptr<fcl_artic::ArticulatedCollisionManager> manager;
  std::optional<fcl_artic::JointMotion> motion;
  fcl_artic::CertifiedRequest request;  ///< as the scene says
};
Question prepare(const Scene& scene);

/// Asks the library through its public interface. The only place of these campaigns that links to it.
Answer ask(const Question& question, const fcl_artic::CertifiedRequest& request);

/// The tree and motion of a scene, in the library's types.
std::shared_ptr<const fcl_artic::KinematicTree> treeOf(const Scene& scene);
fcl_artic::JointMotion motionOf(const Scene& scene, const fcl_artic::KinematicTree& tree);

}  // namespace campaign
