// SPDX-License-Identifier: BSD-3-Clause
//
// Pairs of a robot's links that need no check, found by the manager, and written for programs that read SRDF.
#include <tinyxml2.h>

#include <stdexcept>
#include <string>
#include <vector>

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
  writeSrdf(path, robot_name, report, {});
}

void writeSrdf(const std::string& path, const std::string& robot_name, const LinkPairReport& report,
               const std::vector<SrdfPair>& others) {
  tinyxml2::XMLDocument document;
  document.InsertEndChild(document.NewDeclaration());
  document.InsertEndChild(document.NewComment(
      " Never: proven apart for all joint values within their limits. Always: in contact in all configurations that "
      "were tried. Adjacent: the same, or too near to decide, of links with at most one moving joint between them. "
      "Another reason is the writer's: nothing is proven of the pair. "));
  tinyxml2::XMLElement* robot = document.NewElement("robot");
  robot->SetAttribute("name", robot_name.c_str());
  document.InsertEndChild(robot);
  const AllowedCollisionMatrix need_no_check = report.needNoCheck();
  const auto add = [&](const std::string& link1, const std::string& link2, const char* reason) {
    tinyxml2::XMLElement* element = robot->InsertNewChildElement("disable_collisions");
    element->SetAttribute("link1", link1.c_str());
    element->SetAttribute("link2", link2.c_str());
    element->SetAttribute("reason", reason);
  };
  for (const LinkPairFinding& pair : report.pairs) {
    if (need_no_check.allowed(pair.link1, pair.link2)) add(pair.link1, pair.link2, reasonOf(pair));
  }
  for (const SrdfPair& pair : others) {
    if (!need_no_check.allowed(pair.link1, pair.link2)) add(pair.link1, pair.link2, pair.reason.c_str());
  }
  tinyxml2::XMLPrinter printer;
  document.Print(&printer);
  files::write(path, printer.CStr());
}

}  // namespace fcl_artic
