// SPDX-License-Identifier: BSD-3-Clause
//
// The verbs of bench_tables: each prints a table of the documents.
#pragma once

#include "cli_app.h"

namespace fcl_artic::app {

/// Adds `table1`: Table 1 of Redon et al. 2004, measured anew.
/// @param[out] exit_status  set when the verb has run, as for the others.
void addTable1(CLI::App& program, int& exit_status);
/// Adds `ideas`: what each option of the paper's method is worth.
void addIdeas(CLI::App& program, int& exit_status);
/// Adds `compare`: random pairs of moving bodies through FCL's ways and through this library; kExitFree when this
/// library was right throughout.
void addCompare(CLI::App& program, int& exit_status);

// These three need OMPL.
/// Adds `planning`: plans of RRTConnect with OMPL's discrete validator over FCL, and with ours.
void addPlanning(CLI::App& program, int& exit_status);
/// Adds `certify`: how many of a planner's plans collide, and what `fcl_artic certify` finds and mends.
void addCertifyPlans(CLI::App& program, int& exit_status);
/// Adds `rigid`: plans of a mesh among meshes.
void addRigid(CLI::App& program, int& exit_status);

}  // namespace fcl_artic::app
