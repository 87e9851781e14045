// SPDX-License-Identifier: BSD-3-Clause
//
// Pairs of a robot's links that need no check, found by the manager, and written for programs that read SRDF.
#include <tinyxml2.h>

#include <stdexcept>

#include "fcl_artic/urdf/urdf.h"
#include "files/files.h"

namespace fcl_artic {
namespace {

/// The word that MoveIt's assistant has for it; null: the pair is to be checked.
const char* reasonOf(LinkPairKind kind) {
  switch (kind) {
    case LinkPairKind::neighbours:
      return "Adjacent";
    case LinkPairKind::never:
      return "Never";
    case LinkPairKind::always:
      return "Always";
    case LinkPairKind::sometimes:
    case LinkPairKind::unproven:
      return nullptr;
  }
  return nullptr;
}

}  // namespace

LinkPairReport generateAllowedCollisions(const Robot& robot, const LinkPairOptions& options) {
  if (!robot.tree) throw std::invalid_argument("generateAllowedCollisions: the robot has no tree");
  ArticulatedCollisionManager manager(robot.tree);
  for (const LinkGeometry& geometry : robot.geometry) manager.bind(geometry.link, geometry.object, geometry.offset);
  return manager.classifyLinkPairs(options);
}

void writeSrdf(const std::string& path, const std::string& robot_name, const LinkPairReport& report) {
  tinyxml2::XMLDocument document;
  document.InsertEndChild(document.NewDeclaration());
  document.InsertEndChild(document.NewComment(
      " Adjacent: at most one moving joint between the links. Never: proven apart for all joint values within their "
      "limits. Always: in contact in all configurations that were tried. "));
  tinyxml2::XMLElement* robot = document.NewElement("robot");
  robot->SetAttribute("name", robot_name.c_str());
  document.InsertEndChild(robot);
  for (const LinkPairFinding& pair : report.pairs) {
    const char* reason = reasonOf(pair.kind);
    if (!reason) continue;
    tinyxml2::XMLElement* element = robot->InsertNewChildElement("disable_collisions");
    element->SetAttribute("link1", pair.link1.c_str());
    element->SetAttribute("link2", pair.link2.c_str());
    element->SetAttribute("reason", reason);
  }
  tinyxml2::XMLPrinter printer;
  document.Print(&printer);
  files::write(path, printer.CStr());
}

}  // namespace fcl_artic
