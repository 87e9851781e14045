// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include <fcl_artic/fcl_artic.h>

#include "scene.h"

namespace campaign {

/// The library's answer to a scene, with what is needed to read it.
struct Answer {
  fcl_artic::CertifiedResult result;
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> objects;  ///< one for each body of the scene
  double elapsed_us = 0;                                        ///< of the query alone

  /// Body of the scene, -1 when it is none.
  int bodyOf(const fcl::CollisionObjectd* object) const;
};

/// A scene put to the library, ready to be asked.
struct Question {
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> objects;  ///< one for each body of the scene
  std::shared_ptr<const fcl_artic::KinematicTree> tree;
  std::unique_ptr<fcl_artic::ArticulatedCollisionManager> manager;
  fcl_artic::CertifiedRequest request;
};
Question prepare(const Scene& scene);

/// Asks the library through its public interface. The only place of the campaign that links to it.
/// @param how  its method and that one's options, and whether stage 2 takes part.
/// @param culler  who does stage 2; null: the executor cpu.
Answer ask(const Scene& scene, const fcl_artic::CertifiedRequest& how = {},
           const std::shared_ptr<const fcl_artic::VisibilityCuller>& culler = nullptr);

/// The tree and motion of a scene, in the library's types.
std::shared_ptr<const fcl_artic::KinematicTree> treeOf(const Scene& scene);
fcl_artic::JointMotion motionOf(const Scene& scene, const fcl_artic::KinematicTree& tree);

}  // namespace campaign
