// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>

#include "world.h"

namespace fcl_artic::app {

/// SHA-256 of a scene's file and, of a URDF file, of the meshes that it names.
/// @param packages  as UrdfOptions::packages.
std::string sceneFileHash(const std::string& path, const std::map<std::string, std::string>& packages);

/// SHA-256 of all that a robot's answers depend on but for scenes and requests: its files, their meshes, where it
/// stands, what it carries, the pairs that are allowed.
/// @param read  of these options, with readRobot() and provePairs() done.
std::string robotHash(const WorldOptions& world, const World& read);

}  // namespace fcl_artic::app
