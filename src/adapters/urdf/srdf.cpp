// SPDX-License-Identifier: BSD-3-Clause
#include <tinyxml2.h>

#include "detail.h"
#include "fcl_artic/urdf/urdf.h"
#include "files/files.h"

namespace fcl_artic {
namespace {

using detail::fail;

/// A link's name from an attribute. @throws std::runtime_error when it is missing or unknown.
std::string linkName(const std::string& where, const tinyxml2::XMLElement& element, const char* attribute,
                     const KinematicTree& tree) {
  const std::string line = where + ", line " + std::to_string(element.GetLineNum());
  const char* name = element.Attribute(attribute);
  if (!name) fail(line, std::string("<") + element.Name() + "> has no attribute '" + attribute + "'");
  if (!tree.hasLink(name)) {
    fail(line, std::string("<") + element.Name() + "> names link '" + name + "', which robot '" + tree.name() +
                   "' does not have");
  }
  return name;
}

}  // namespace

AllowedCollisionMatrix loadSrdf(const std::string& path, const KinematicTree& tree) {
  const std::string where = "'" + path + "'";
  const std::string xml = files::read(path);
  tinyxml2::XMLDocument document;
  if (document.Parse(xml.c_str(), xml.size()) != tinyxml2::XML_SUCCESS) fail(where, document.ErrorStr());
  const tinyxml2::XMLElement* robot = document.RootElement();
  if (!robot || std::string(robot->Name()) != "robot") {
    fail(where, "is not an SRDF: the root element is not <robot>");
  }
  const auto forEach = [&](const char* name, auto&& visit) {
    for (auto* e = robot->FirstChildElement(name); e; e = e->NextSiblingElement(name)) visit(*e);
  };

  // In MoveIt's order of precedence: a pair that is named wins over a link's default, and disabled wins over enabled.
  AllowedCollisionMatrix matrix;
  forEach("disable_default_collisions", [&](const tinyxml2::XMLElement& e) {
    const std::string link = linkName(where, e, "link", tree);
    for (LinkId other = 0; other < tree.numLinks(); ++other) {
      if (tree.linkName(other) != link) matrix.allow(link, tree.linkName(other));
    }
  });
  forEach("enable_collisions", [&](const tinyxml2::XMLElement& e) {
    matrix.disallow(linkName(where, e, "link1", tree), linkName(where, e, "link2", tree));
  });
  forEach("disable_collisions", [&](const tinyxml2::XMLElement& e) {
    matrix.allow(linkName(where, e, "link1", tree), linkName(where, e, "link2", tree));
  });
  return matrix;
}

}  // namespace fcl_artic
