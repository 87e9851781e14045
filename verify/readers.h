// SPDX-License-Identifier: BSD-3-Clause
// Compares a world with the files that it was written from. The robot is made anew from the files, with none of the
// library's readers, and the world must be that robot: nothing in it may be left over.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "statement.h"

namespace verify {

struct Comparison {
  std::vector<std::string> differences;  // none: the world is what the file says
  std::vector<std::string> notes;        // for people
};

/// Links whose meshes are meant as solids.
struct Solids {
  bool all = false;
  std::set<std::string> links;
};

/// Frames, joints and collision geometry of a URDF. @param packages  folders of "package://NAME/".
/// @throws BadInput: unreadable, or with something in it that is not compared.
Comparison compareWithUrdf(const World& world, const std::string& path,
                           const std::map<std::string, std::string>& packages, const Solids& solids = {});
/// Every pair that the world calls `allowed` or `neighbours` is one that the SRDF disables.
Comparison compareWithSrdf(const World& world, const std::string& path);

std::string readFile(const std::string& path);

}  // namespace verify
