// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

namespace fcl_artic::text {

/// Whether all of a text is UTF-8 (RFC 3629): no surrogates, no longer forms than are needed, nothing above U+10FFFF.
inline bool isUtf8(std::string_view text) {
  for (std::size_t at = 0; at < text.size();) {
    const auto first = static_cast<unsigned char>(text[at++]);
    if (first < 0x80) continue;
    const int more = first >= 0xC2 && first < 0xE0   ? 1
                     : (first & 0xF0) == 0xE0        ? 2
                     : first >= 0xF0 && first < 0xF5 ? 3
                                                     : 0;
    if (more == 0) return false;
    unsigned long code = first & (0x3Fu >> more);
    for (int k = 0; k < more; ++k) {
      const unsigned next = at < text.size() ? static_cast<unsigned char>(text[at++]) : 0;
      if ((next & 0xC0) != 0x80) return false;
      code = code << 6 | (next & 0x3F);
    }
    if (more == 2 && (code < 0x800 || (code >= 0xD800 && code < 0xE000))) return false;
    if (more == 3 && (code < 0x10000 || code > 0x10FFFF)) return false;
  }
  return true;
}

}  // namespace fcl_artic::text
