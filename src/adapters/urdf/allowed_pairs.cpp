// SPDX-License-Identifier: BSD-3-Clause
//
// Pairs of a robot's links that need no check, found by the manager, and written for programs that read SRDF.
#include <tinyxml2.h>

#include <stdexcept>

#include "fcl_artic/urdf/urdf.h"
#include "files/files.h"

namespace fcl_artic {
namespace {

/// The word that MoveIt's assistant has for a pair that needs no check.
const char* reasonOf(const LinkPairFinding& pair) {
  if (pair.kind == LinkPairKind::never) return "Never";
  return pair.neighbours ? "Adjacent" : "Always";
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
      " Never: proven apart for all joint values within their limits. Always: in contact in all configurations that "
      "were tried. Adjacent: the same, or too near to decide, of links with at most one moving joint between them. "));
  tinyxml2::XMLElement* robot = document.NewElement("robot");
  robot->SetAttribute("name", robot_name.c_str());
  document.InsertEndChild(robot);
  const AllowedCollisionMatrix need_no_check = report.needNoCheck();
  for (const LinkPairFinding& pair : report.pairs) {
    if (!need_no_check.allowed(pair.link1, pair.link2)) continue;
    tinyxml2::XMLElement* element = robot->InsertNewChildElement("disable_collisions");
    element->SetAttribute("link1", pair.link1.c_str());
    element->SetAttribute("link2", pair.link2.c_str());
    element->SetAttribute("reason", reasonOf(pair));
  }
  tinyxml2::XMLPrinter printer;
  document.Print(&printer);
  files::write(path, printer.CStr());
}

}  // namespace fcl_artic
