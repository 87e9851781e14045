// SPDX-License-Identifier: BSD-3-Clause
// Numbers of things in messages.
#pragma once

#include <cstddef>
#include <string>

namespace fcl_artic::text {

/// "1 joint", "2 joints", "0 joints".
/// @param many  of a noun that does not end in s when there are several of it.
inline std::string counted(std::size_t n, const std::string& one, const std::string& many = {}) {
  return std::to_string(n) + " " + (n == 1 ? one : many.empty() ? one + "s" : many);
}

}  // namespace fcl_artic::text
