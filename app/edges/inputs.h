// SPDX-License-Identifier: BSD-3-Clause
//
// A hash of all that answers depend on, as it was read: joints, shapes, places. A kept answer is used again only if the
// hash is the same. (Files may have come through a pipe that nobody can read again, or name other files.)
#pragma once

#include <string>

#include "world.h"

namespace fcl_artic::app {

/// Number of the entries of doc/ERRATA.md: what an earlier library has proven may be wrong, so it is in the hashes. (A
/// test counts them.)
constexpr int kErrata = 90;

/// SHA-256 of the obstacles of a scene's file. If the file itself holds all of them, it is the file's.
/// @param options  as loadScene() takes them.
std::string sceneFileHash(const std::string& path, const SceneOptions& options);

/// SHA-256 of the first obstacles of a scene.
std::string obstaclesHash(const Scene& scene, std::size_t number);

/// SHA-256 of all that a robot's answers depend on but for scenes and requests: joints, geometry, where it stands, what
/// it carries, the pairs that are allowed; and of kErrata.
/// @param read  after World::open().
std::string robotHash(const World& read);

}  // namespace fcl_artic::app
