// SPDX-License-Identifier: BSD-3-Clause
// Text for XML and HTML.
#pragma once

#include <string>
#include <string_view>

namespace fcl_artic::text {

/// The text as it stands between tags, or between the quotation marks of an attribute.
inline std::string xmlText(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

}  // namespace fcl_artic::text
