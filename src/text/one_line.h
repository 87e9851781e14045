// SPDX-License-Identifier: BSD-3-Clause
// Texts that hold names of others' in reports of lines.
#pragma once

#include <string>
#include <string_view>

namespace fcl_artic::text {

/// The text with line ends and other control characters as \xHH: a name can't begin a line of its own.
inline std::string oneLine(std::string_view text) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string out;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 32 && byte != 127) {
      out += c;
    } else {
      out += "\\x";
      out += kDigits[byte >> 4];
      out += kDigits[byte & 15];
    }
  }
  return out;
}

}  // namespace fcl_artic::text
