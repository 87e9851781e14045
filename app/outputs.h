// SPDX-License-Identifier: BSD-3-Clause
//
// Files that a run writes. A file of an earlier run must not be taken for this run's answer.
#pragma once

#include <string>
#include <vector>

#include "world.h"

namespace fcl_artic::app {

/// An option that names a file to write.
struct Output {
  const char* option;  ///< as it is typed, for messages
  std::string* path;   ///< empty: not asked for
};

/// Removes what lies under the names of a run's outputs: if the run does not write them, nobody does. Afterwards a path
/// that was a symbolic link is the file that it points to, so that the link stays. What is no regular file stays.
/// To be called before the run reads anything.
/// @param inputs  the run's own files; of a folder the files in it.
/// @throws std::invalid_argument naming option and file, before anything is removed: the output is an input, or two
///   outputs are one file.
/// @throws std::runtime_error naming the file: the system doesn't remove it.
void removeEarlierOutputs(const std::vector<Output>& outputs, const std::vector<std::string>& inputs);

/// The files that the options name: robot, SRDF, scenes, carried objects.
std::vector<std::string> inputsOf(const WorldOptions& options);

}  // namespace fcl_artic::app
