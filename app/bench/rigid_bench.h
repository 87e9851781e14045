// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace fcl_artic::app {

struct RigidBenchOptions {
  std::vector<std::string> problems;  ///< files of OMPL.app (.cfg)
  int seeds = 3;
  double seconds = 20;  ///< for a plan, and for its simplification
  std::string csv;      ///< file of a row for each plan; empty: none
};

/// Plans the way of a mesh among meshes with each motion validator in turn, and prints the table: OMPL's discrete one
/// over FCL, FCL's continuous collision as OMPL.app asks for it, and ours.
/// @return exit status: 1 when a plan made with our validator is seen to collide.
/// @throws std::runtime_error naming a file that is missing or can't be read or written, or what it lacks; that this
/// program was built without OMPL.
int benchRigid(RigidBenchOptions& options);

}  // namespace fcl_artic::app
