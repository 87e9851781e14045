// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "scene.h"

namespace campaign {

/// Scenes as a text that keeps all bits of all numbers. Making a scene takes fifty times as long as asking about it,
/// and its sines and cosines are the machine's own: several engines, or processors, are compared by one file. A case
/// that has found a fault is such a text, too.
std::string toText(const std::vector<Scene>& scenes);

/// @throw std::runtime_error if it can't be written
void writeFile(const std::string& text, const std::string& file);

/// The scenes of such a file, in their order. Geometries that were the same are one object again.
/// @throw std::runtime_error if it can't be read, or is no such file
std::vector<Scene> readScenes(const std::string& file);

}  // namespace campaign
