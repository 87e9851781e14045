// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>
#include <string>

#include "fcl_artic/query_text.h"
#include "files/files.h"

namespace fcl_artic::replay {

/// Reads a query from a file.
/// @throws std::runtime_error as files::read(); std::invalid_argument as readQuery(), naming the file.
inline RecordedQuery readQueryFile(const std::string& path) {
  const std::string text = files::read(path);
  try {
    return readQuery(text);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument("'" + path + "': " + error.what());
  }
}

}  // namespace fcl_artic::replay
