// SPDX-License-Identifier: BSD-3-Clause
//
// Files that a run writes. A file of an earlier run must not be taken for this run's answer.
#pragma once

#include <exception>
#include <string>
#include <vector>

namespace fcl_artic::app {

struct WorldOptions;

/// An option that names a file to write.
struct Output {
  const char* option;       ///< as it is typed, for messages
  const std::string* path;  ///< empty: not asked for
};

/// Removes what lies under the names of a run's outputs: if the run does not write them, nobody does. If it is a
/// symbolic link, the file that it points to goes and the link stays. Other things than regular files stay. To be
/// called before the run reads anything.
/// @param inputs  the run's own files; of a folder the files in it.
/// @throws std::invalid_argument naming option and file, before anything is removed: the output is an input or a
///   folder, or two outputs are one file.
/// @throws std::runtime_error naming the file: the system doesn't remove it.
void removeEarlierOutputs(const std::vector<Output>& outputs, const std::vector<std::string>& inputs);

/// The outputs that a run could not write. It prints its answers all the same, with the reasons among their notes, and
/// ends as an error.
class UnwrittenOutputs {
 public:
  /// Does what writes an output.
  template <class Write>
  void attempt(const Write& write) {
    try {
      write();
    } catch (const std::exception& error) {
      reasons_.emplace_back(error.what());
    }
  }
  const std::vector<std::string>& reasons() const { return reasons_; }
  /// The run's exit status, which would be `status` if all had been written. Prints the reasons as errors.
  int exitStatus(int status) const;

 private:
  std::vector<std::string> reasons_;
};

/// Prints notes to standard error, a line each.
/// @param of  what all of them are of, as "'plan.csv'"; empty: they say so themselves.
void printNotes(const std::vector<std::string>& notes, const std::string& of = {});

/// The files that the options name: robot, SRDF, scenes, carried objects.
std::vector<std::string> inputsOf(const WorldOptions& options);

}  // namespace fcl_artic::app
