// SPDX-License-Identifier: BSD-3-Clause
// Characters of URLs that are written as % and two hexadecimal digits.
#pragma once

#include <cctype>
#include <optional>
#include <string>

namespace fcl_artic::text {

/// The text with each %XX as the byte that it stands for; nothing where a % has not two such digits after it, or stands
/// for a byte 0.
inline std::optional<std::string> percentDecoded(const std::string& text) {
  const auto digit = [](char c) { return c <= '9' ? c - '0' : std::tolower(static_cast<unsigned char>(c)) - 'a' + 10; };
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      out += text[i];
      continue;
    }
    if (i + 2 >= text.size() || !std::isxdigit(static_cast<unsigned char>(text[i + 1])) ||
        !std::isxdigit(static_cast<unsigned char>(text[i + 2])))
      return std::nullopt;
    const int byte = 16 * digit(text[i + 1]) + digit(text[i + 2]);
    if (byte == 0) return std::nullopt;
    out += static_cast<char>(byte);
    i += 2;
  }
  return out;
}

}  // namespace fcl_artic::text
