// SPDX-License-Identifier: BSD-3-Clause
//
// Robots in Python.
#pragma once

#include "fcl_artic/urdf/urdf.h"
#include "geometry.h"
#include "guard_files.h"
#include "kinematics.h"

namespace fcl_artic::python {

/// Pairs of names as Python has them, a frozenset of pairs, and back.
py::frozenset pairsOf(const AllowedCollisionMatrix& matrix);
/// @param value  pairs of names in any collection. @throws py::type_error naming `what`.
AllowedCollisionMatrix matrixOfPairs(py::handle value, const char* what);
/// The same, with another matrix's data beside its pairs: whether they are all, and which pairs were disallowed.
AllowedCollisionMatrix matrixOfPairs(py::handle value, const char* what, const AllowedCollisionMatrix& before);

/// Folders of ROS packages, from None or a dict. @throws py::type_error.
std::map<std::string, std::string> packagesOf(py::handle value);

/// A file that the caller names by its path or hands over as text. A value that begins with `<` is text.
class Input {
 public:
  /// @throws py::type_error naming `what`: neither str nor os.PathLike.
  Input(py::handle value, const char* what);
  ~Input();
  Input(const Input&) = delete;
  Input& operator=(const Input&) = delete;
  /// The path that the loaders read.
  const std::string& path() const { return path_; }
  /// Reads, with the errors of guardFiles(); messages call a text "text".
  template <class Read>
  auto read(Read&& read) const {
    return guardFiles(path_, read);
  }

 private:
  std::string path_;
  int file_ = -1;  ///< in memory, of a text
};

void bindRobot(py::module_& module);
void bindLinkPairs(py::module_& module);

using ClassifyWith = std::function<LinkPairReport(const LinkPairOptions&)>;
/// Answers classify_link_pairs(), for a robot or a world.
/// @param ask  calls its argument with a function that classifies: in the library, without the GIL.
LinkPairReport classifyWatched(py::handle only, double margin, std::uint64_t work, std::size_t samples, int threads,
                               py::object progress,
                               const std::function<void(const std::function<void(const ClassifyWith&)>&)>& ask);

}  // namespace fcl_artic::python
