// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "scene.h"

namespace campaign {

/// Writes scenes to a text file that keeps all bits of all numbers. Making a scene takes fifty times as long as asking
/// about it, and its sines and cosines are the machine's own: several engines, or processors, are compared by one file.
/// @throw std::runtime_error if it can't be written
void writeScenes(const std::vector<Scene>& scenes, const std::string& file);

/// The scenes of such a file, in their order. Geometries that were the same are one object again.
/// @throw std::runtime_error if it can't be read, or is no such file
std::vector<Scene> readScenes(const std::string& file);

}  // namespace campaign
