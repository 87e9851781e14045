// SPDX-License-Identifier: BSD-3-Clause
#include "changes.h"

#include <algorithm>
#include <vector>

#ifdef FCL_ARTIC_GLTF
#include <nlohmann/json.hpp>
#endif

namespace fcl_artic::test {
namespace {

/// A part of a text: from, to.
using Span = std::pair<std::size_t, std::size_t>;

/// Parts of a text that can be removed, doubled or moved: lines, words, elements of XML with what they hold, values of
/// JSON.
std::vector<Span> partsOf(const std::string& text, Random& random) {
  std::vector<Span> parts;
  const auto between = [&](const char* ends) {
    for (std::size_t at = 0; at < text.size();) {
      const std::size_t end = std::min(text.find_first_of(ends, at), text.size());
      if (end > at) parts.emplace_back(at, std::min(end + 1, text.size()));
      at = end + 1;
    }
  };
  const int kind = static_cast<int>(random() % 3);
  if (kind == 0) between("\n\r");
  if (kind == 1) between(" \t\n\r\",<>=/");
  if (kind == 2) {
    // The text between brackets; between the beginning and the end of an element.
    for (std::size_t at = 0; at < text.size(); ++at) {
      const char open = text[at], close = open == '{' ? '}' : open == '[' ? ']' : '\0';
      if (close) {
        int depth = 0;
        for (std::size_t end = at; end < text.size(); ++end) {
          depth += text[end] == open ? 1 : text[end] == close ? -1 : 0;
          if (depth > 0) continue;
          parts.emplace_back(at, end + 1);
          break;
        }
      }
      if (open == '<' && at + 1 < text.size() && std::isalpha(static_cast<unsigned char>(text[at + 1]))) {
        const std::size_t tag_end = text.find('>', at), name_end = text.find_first_of(" />", at);
        if (tag_end == text.npos || name_end == text.npos) continue;
        if (text[tag_end - 1] == '/') {
          parts.emplace_back(at, tag_end + 1);
        } else {
          const std::string close_tag = "</" + text.substr(at + 1, name_end - at - 1) + ">";
          const std::size_t end = text.find(close_tag, tag_end);
          if (end != text.npos) parts.emplace_back(at, end + close_tag.size());
        }
      }
    }
  }
  return parts;
}

std::string changed(std::string text, Random& random) {
  static const std::vector<std::string> kWords{"0",    "-1",    "1",   "3",      "4294967295", "99999999999999999999",
                                               "1.5",  "1e999", "nan", "-inf",   "x",          "",
                                               "\"\"", "null",  "[]",  "{}",     "true",       "#g0",
                                               "#n0",  "65535", "2",   "vertex", "face"};
  for (int changes = 1 + static_cast<int>(random() % 3); changes > 0; --changes) {
    const std::vector<Span> parts = partsOf(text, random);
    if (parts.empty()) continue;
    const Span one = parts[random() % parts.size()], other = parts[random() % parts.size()];
    const std::string part = text.substr(one.first, one.second - one.first);
    switch (random() % 4) {
      case 0:
        text.erase(one.first, part.size());
        break;
      case 1:
        text.insert(one.first, part);
        break;
      case 2:
        text.insert(other.first, part);
        break;
      default:
        text.replace(one.first, part.size() > 1 ? part.size() - 1 : 1, kWords[random() % kWords.size()]);
    }
  }
  return text;
}

#ifdef FCL_ARTIC_GLTF
/// All values of a document.
void collectValues(nlohmann::json& value, std::vector<nlohmann::json*>& all) {
  all.push_back(&value);
  if (!value.is_structured()) return;
  for (nlohmann::json& part : value) collectValues(part, all);
}

std::string changedJson(const std::string& text, Random& random) {
  using Json = nlohmann::json;
  Json root = Json::parse(text, nullptr, false);
  if (root.is_discarded()) return changed(text, random);
  for (int changes = 1 + static_cast<int>(random() % 3); changes > 0; --changes) {
    std::vector<Json*> all;
    collectValues(root, all);
    Json& one = *all[random() % all.size()];
    const Json other = *all[random() % all.size()];
    static const Json kValues[] = {
        0, -1, 1, 2, 3, 7, 1.5, 1e300, 4294967295u, "x", nullptr, true, Json::array(), Json::object()};
    const std::size_t at = one.is_structured() && !one.empty() ? random() % one.size() : 0;
    switch (random() % 4) {
      case 0:
        if (one.is_array() && !one.empty()) one.erase(at);
        if (one.is_object() && !one.empty()) one.erase(std::next(one.begin(), static_cast<std::ptrdiff_t>(at)));
        break;
      case 1:
        if (one.is_array() && !one.empty()) one.insert(one.begin(), Json(one[at]));
        break;
      case 2:
        one = other;
        break;
      default:
        one = kValues[random() % std::size(kValues)];
    }
  }
  return root.dump();
}
#endif

bool isJson(const std::string& name) {
  const std::string ending = name.substr(name.rfind('.'));
  return ending == ".gltf" || ending == ".json";
}

}  // namespace

std::string changedFile(const std::string& name, const std::string& content, Random& random) {
#ifdef FCL_ARTIC_GLTF
  if (isJson(name) && random() % 4 != 0) return changedJson(content, random);
#endif
  (void)name;
  return changed(content, random);
}

}  // namespace fcl_artic::test
