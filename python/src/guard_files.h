// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "files/files.h"
#include "gil.h"
#include "turns.h"

namespace fcl_artic::python {

/// Runs a function that reads or writes files. A missing file becomes a FileNotFoundError, other trouble of the system
/// an OSError, a fault in a file's content a ValueError. To be called with the GIL held.
/// @param path  of the file that the caller named.
template <class Read>
auto guardFiles(const std::string& path, Read&& read) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) fileNotFound("no such file", path);
  try {
    const GilReleased released;
    const InLibrary within;
    return read();
  } catch (const std::runtime_error& problem) {
    const std::string message = problem.what();
    if (message.find("no such file") != std::string::npos || message.find("No such file") != std::string::npos ||
        message.find("there is no package") != std::string::npos) {
      fileNotFound(message, path);
    }
    valueError(message);
  }
}

/// Writes files that belong together. A file that cannot be written is an OSError. To be called with the GIL held.
inline void writeFiles(const std::vector<files::File>& all) {
  try {
    files::writeTogether(all);
  } catch (const std::runtime_error& problem) {
    PyErr_SetString(PyExc_OSError, problem.what());
    throw py::error_already_set();
  }
}

}  // namespace fcl_artic::python
