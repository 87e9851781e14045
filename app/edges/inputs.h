// SPDX-License-Identifier: BSD-3-Clause
//
// What answers that are kept depend on, as a hash of what was read: joints, shapes, places. (Files may have come
// through a pipe that nobody can read again, or name other files.)
#pragma once

#include <string>

#include "world.h"

namespace fcl_artic::app {

/// Number of the entries of doc/ERRATA.md: what an earlier library has proven may be wrong, so it is in the hashes. (A
/// test counts them.)
constexpr int kErrata = 88;

/// SHA-256 of the obstacles of a scene's file; where all that there is stands in the file itself, of the file.
/// @param options  as loadScene() takes them.
std::string sceneFileHash(const std::string& path, const SceneOptions& options);

/// SHA-256 of the first obstacles of a scene.
std::string obstaclesHash(const Scene& scene, std::size_t number);

/// SHA-256 of all that a robot's answers depend on but for scenes and requests: joints, geometry, where it stands, what
/// it carries, the pairs that are allowed; and of kErrata.
/// @param read  after World::open().
std::string robotHash(const World& read);

}  // namespace fcl_artic::app
