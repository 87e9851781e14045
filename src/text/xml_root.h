// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <tinyxml2.h>

#include <cstring>
#include <string>
#include <string_view>

namespace fcl_artic::text {

/// Parses a text of one element, beside which there is nothing but comments. (If there are several, tinyxml2 gives the
/// first; at a byte 0 it stops; entities that a document type makes it leaves as they are.)
/// @param root  the element's name. @param kind  of file, for the message, such as "a URDF".
/// @return what is wrong; empty: nothing.
inline std::string parseXml(std::string_view content, const char* root, const std::string& kind,
                            tinyxml2::XMLDocument& document) {
  if (content.find('\0') != content.npos) return "has a byte 0, where XML would end";
  if (document.Parse(content.data(), content.size()) != tinyxml2::XML_SUCCESS) return document.ErrorStr();
  const tinyxml2::XMLElement* found = nullptr;
  for (const tinyxml2::XMLNode* node = document.FirstChild(); node; node = node->NextSibling()) {
    const std::string line = "line " + std::to_string(node->GetLineNum()) + ": ";
    if (node->ToUnknown()) return line + "document types are not read";
    if (node->ToText()) return line + "text outside of <" + root + ">";
    const tinyxml2::XMLElement* const element = node->ToElement();
    if (!element) continue;
    if (found) return line + "<" + element->Name() + "> is a second root element; a file holds one <" + root + ">";
    found = element;
  }
  const bool good = found && std::strcmp(found->Name(), root) == 0;
  return good ? "" : "is not " + kind + ": the root element is not <" + root + ">";
}

}  // namespace fcl_artic::text
