// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <charconv>
#include <string>

namespace fcl_artic {

/// A number in a message: the shortest decimal that reads back as it, so that 1e-12 is not "0.000000". The same in
/// every locale.
inline std::string shown(double x) {
  char text[32];
  return std::string(text, std::to_chars(text, text + sizeof text, x).ptr);
}

}  // namespace fcl_artic
