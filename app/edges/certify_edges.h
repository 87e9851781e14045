// SPDX-License-Identifier: BSD-3-Clause
//
// `certify --edges`: many edges or trajectories times many scenes.
#pragma once

#include <string>
#include <vector>

#include "edges/edge_source.h"
#include "fcl_artic/request.h"
#include "world.h"

namespace fcl_artic::app {

struct EdgesOptions {
  std::string edges;                ///< file
  std::vector<std::string> scenes;  ///< files and folders; none: one scene, that of the world
  std::string out;                  ///< folder
  std::string shard;                ///< "I/N"
  EdgeOptions columns;
  std::vector<std::string> state;  ///< as typed
  CertifiedRequest request;
  bool certificates = false, partial = false, quiet = false;
  std::size_t block_rows = 100000;
  int threads = 0;  ///< 0: as many as the machine runs at once; in ranks of an MPI job one
};

/// Computes its share of the blocks that are missing. Once all are there, it merges them, unless it is a shard.
/// @return the exit status: kExitFree when all is done, whatever the answers; kExitError when something could not be.
/// @throws as what it calls, naming the file.
int certifyEdges(const WorldOptions& world, EdgesOptions& options);

/// Merges the blocks of a folder, and prints the summary.
int mergeEdges(const std::string& folder, bool partial, bool json);

}  // namespace fcl_artic::app
