// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "world.h"

namespace fcl_artic::app {

/// SHA-256 of all that a robot's answers depend on but for scenes and requests: its files, their meshes, where it
/// stands, what it carries, the pairs that are allowed.
/// @param read  of these options, with readRobot() and provePairs() done.
std::string robotHash(const WorldOptions& world, const World& read);

}  // namespace fcl_artic::app
