// SPDX-License-Identifier: BSD-3-Clause
// Compares a world with the files that it was written from: read here again, with none of the library's readers.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "statement.h"

namespace verify {

struct Comparison {
  std::vector<std::string> differences;  // none: the world is what the file says
  std::vector<std::string> notes;        // for people
};

/// Frames, joints and collision geometry of a URDF. @param packages  folders of "package://NAME/".
/// @throws BadInput: unreadable.
Comparison compareWithUrdf(const World& world, const std::string& path,
                           const std::map<std::string, std::string>& packages);
/// Every pair that the world calls `allowed` is one that the SRDF disables.
Comparison compareWithSrdf(const World& world, const std::string& path);

std::string readFile(const std::string& path);
/// Corners of a mesh file's triangles, nine numbers each: STL (binary or text) or OBJ. @throws BadInput
std::vector<double> readMesh(const std::string& path);

}  // namespace verify
