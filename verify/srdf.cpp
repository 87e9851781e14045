// SPDX-License-Identifier: BSD-3-Clause
#include <utility>

#include "readers.h"
#include "report.h"
#include "xml.h"

namespace verify {

// MoveIt's rules: a pair is disabled by name, or where a link is disabled by default and the pair is not enabled. All
// other pairs of links are to be checked, neighbours too.
Comparison compareWithSrdf(const World& world, const std::string& path) {
  const Xml xml(path);
  std::set<std::pair<std::string, std::string>> disabled, enabled;
  std::set<std::string> defaults;
  // The lists of src/adapters/urdf/urdf_elements.cpp, written a second time: another element could say which pairs are
  // checked. Text is passed over, as some robots' files have it.
  xml.only(xml.robot(), {"name", "version", "xmlns"},
           {"disable_collisions", "enable_collisions", "disable_default_collisions"},
           {"group", "group_state", "end_effector", "virtual_joint", "passive_joint", "link_sphere_approximation",
            "joint_property", "gripper", "rotor_params", "specificities"},
           Xml::Text::passed_over);
  for (const Xml::Element* e = xml.robot().FirstChildElement(); e != nullptr; e = e->NextSiblingElement()) {
    const std::string kind = e->Name();
    if (kind == "disable_default_collisions") {
      xml.only(*e, {"link", "reason"}, {}, {}, Xml::Text::passed_over);
      defaults.insert(xml.attribute(*e, "link"));
    } else if (kind == "disable_collisions" || kind == "enable_collisions") {
      xml.only(*e, {"link1", "link2", "reason"}, {}, {}, Xml::Text::passed_over);
      const std::string a = xml.attribute(*e, "link1"), b = xml.attribute(*e, "link2");
      (kind[0] == 'd' ? disabled : enabled).insert({std::min(a, b), std::max(a, b)});
    }
  }
  Comparison result;
  std::set<std::string> links, others;
  for (const Body& body : world.bodies) (body.role == Role::link ? links : others).insert(body.name);
  for (const std::string& name : others) links.erase(name);  // the SRDF's word is about links
  // A slip in the name of one that is to be checked would leave the pair that is meant disabled by default.
  for (const auto& [a, b] : enabled) {
    for (const auto& [name, other] : {std::make_pair(a, b), std::make_pair(b, a)}) {
      if (defaults.count(other) > 0 && links.count(name) == 0)
        result.differences.push_back("the SRDF enables the pair of " + inQuotes(other) +
                                     ", which it disables by default, with " + inQuotes(name) +
                                     ", and the world has no such link with geometry");
    }
  }
  std::size_t found = 0;
  for (const auto& [pair, listed] : world.unchecked) {
    const Reason reason = listed.reason;
    if (reason == Reason::touch_link || reason == Reason::still) continue;
    const std::string &x = world.names[static_cast<std::size_t>(pair.first)],
                      &y = world.names[static_cast<std::size_t>(pair.second)];
    const std::pair<std::string, std::string> key(std::min(x, y), std::max(x, y));
    const bool by_default = (defaults.count(x) > 0 || defaults.count(y) > 0) && enabled.count(key) == 0;
    if (links.count(x) > 0 && links.count(y) > 0 && (disabled.count(key) > 0 || by_default)) {
      ++found;
    } else {
      result.differences.push_back(
          std::string("the world ") + (reason == Reason::allowed ? "allows " : "does not check the neighbours ") +
          inQuotes(x) + " and " + inQuotes(y) +
          (reason == Reason::allowed ? " to touch, the SRDF does not" : ", which the SRDF does not disable"));
    }
  }
  result.notes.push_back("in the SRDF, and not checked by the world: " + counted(found, "pair") + " of names");
  return result;
}

}  // namespace verify
