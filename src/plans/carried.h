// SPDX-License-Identifier: BSD-3-Clause
//
// Compares what a plan's message says the robot carries with what the caller has attached.
#pragma once

#include <string>
#include <vector>

#include "fcl_artic/kinematic_tree.h"
#include "plans/plan.h"

namespace fcl_artic::plans {

/// Objects that a caller has attached to a link together, from one file.
struct Attached {
  std::string file;                  ///< without folder and ending; empty: of none
  std::vector<std::string> objects;  ///< their names
  LinkId link = 0;
};

/// Every object that the plan's message says is carried must be attached, to its link or one that stands still against
/// it. An object stands for one carried object of its name. Objects that came from one file together stand for one of
/// the file's name. For a carried object without a name stands a file's. Nothing stands for two. More may be attached
/// than the message names.
/// @param how  ends the message: how one attaches.
/// @throws std::invalid_argument naming what is missing, or the two links.
void requireCarried(const KinematicTree& tree, const Plan& plan, const std::vector<Attached>& attached,
                    const std::string& how);

}  // namespace fcl_artic::plans
