// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include "plans/document.h"

namespace fcl_artic::plans {
namespace {

/// The text with NaN, Infinity and -Infinity in quotes, where they stand outside of strings.
std::string withQuotedWords(std::string_view content) {
  std::string out;
  out.reserve(content.size());
  bool in_string = false;
  for (std::size_t i = 0; i < content.size(); ++i) {
    const char c = content[i];
    if (in_string) {
      if (c == '\\' && i + 1 < content.size()) out += content[i++];
      in_string = content[i] != '"' || c == '\\';
      out += content[i];
      continue;
    }
    bool word = false;
    for (const std::string_view name : {"NaN", "Infinity", "-Infinity"}) {
      if (content.substr(i, name.size()) != name) continue;
      out += fmt::format("\"{}\"", name);
      i += name.size() - 1;
      word = true;
      break;
    }
    if (word) continue;
    in_string = c == '"';
    out += c;
  }
  return out;
}

}  // namespace

Json parseJson(std::string_view content) {
  return text::parseJson(withQuotedWords(content));
}

}  // namespace fcl_artic::plans
