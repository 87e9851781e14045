// SPDX-License-Identifier: BSD-3-Clause
#include "urdf_elements.h"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <map>
#include <set>
#include <vector>

#include "detail.h"
#include "text/nearest_name.h"
#include "text/utf8.h"
#include "text/xml_root.h"

namespace fcl_artic::detail {
namespace {

constexpr int kAny = 1 << 30;

/// How often an element may stand in another one.
struct Count {
  int least, most;
};

/// The children and attributes that an element may have.
struct Grammar {
  std::map<std::string, Count> children;  ///< that are understood
  std::set<std::string> attributes;       ///< that are understood
  /// Children and attributes that are passed over: they are about looks, masses, forces, sensors, controllers and
  /// names.
  std::set<std::string> passed_over, passed_over_attributes;
};

/// By name of the element. (No name is that of two kinds.)
using Elements = std::map<std::string, Grammar>;

const Elements& urdfElements() {
  static const Elements elements = {
      {"robot",
       {{{"link", {0, kAny}}, {"joint", {0, kAny}}},
        {"name"},
        {"material", "gazebo", "transmission", "ros2_control", "sensor", "force_element", "frame", "bullet",
         "drake:collision_filter_group"},
        {"version", "xsi:schemaLocation"}}},
      {"link",
       {{{"collision", {0, kAny}}},
        {"name"},
        {"visual", "inertial", "contact", "surface", "gravity", "kinematic", "sensor", "audio_source", "bullet",
         "self_filter"},
        {"type", "concave"}}},
      {"collision",
       {{{"origin", {0, 1}}, {"geometry", {1, 1}}},
        {},
        {"material", "verbose", "contact_coefficients", "drake:proximity_properties"},
        {"name", "concave", "group", "mask"}}},
      {"geometry", {{{"box", {0, 1}}, {"sphere", {0, 1}}, {"cylinder", {0, 1}}, {"mesh", {0, 1}}}, {}, {}, {}}},
      {"box", {{}, {"size"}, {}, {}}},
      {"sphere", {{}, {"radius"}, {}, {}}},
      {"cylinder", {{}, {"radius", "length"}, {}, {}}},
      {"mesh", {{}, {"filename", "scale"}, {}, {}}},
      {"origin", {{}, {"xyz", "rpy"}, {}, {}}},
      {"joint",
       {{{"parent", {1, 1}},
         {"child", {1, 1}},
         {"origin", {0, 1}},
         {"axis", {0, 1}},
         {"limit", {0, 1}},
         {"mimic", {0, 1}}},
        {"name", "type"},
        {"dynamics", "safety_controller", "calibration", "controller_gains", "joint_properties", "traits",
         "hardwareInterface"},
        {"dont_collapse"}}},
      {"parent", {{}, {"link"}, {}, {}}},
      {"child", {{}, {"link"}, {}, {}}},
      {"axis", {{}, {"xyz"}, {}, {}}},
      {"limit",
       {{},
        {"lower", "upper"},
        {},
        {"effort", "velocity", "acceleration", "deceleration", "jerk", "current", "command_effort", "gear_velocity"}}},
      {"mimic", {{}, {"joint", "multiplier", "offset"}, {}, {}}}};
  return elements;
}

/// The elements that are passed over are about planning groups, the joint to the world, spheres that stand for links in
/// planners, grasps and drives. Text is passed over, too: Baxter's file has some.
const Elements& srdfElements() {
  static const Elements elements = {
      {"robot",
       {{{"disable_collisions", {0, kAny}},
         {"enable_collisions", {0, kAny}},
         {"disable_default_collisions", {0, kAny}}},
        {},
        {"group", "group_state", "end_effector", "virtual_joint", "passive_joint", "link_sphere_approximation",
         "joint_property", "gripper", "rotor_params", "specificities"},
        {"name", "version"}}},
      {"disable_collisions", {{}, {"link1", "link2", "reason"}, {}, {}}},
      {"enable_collisions", {{}, {"link1", "link2"}, {}, {"reason"}}},
      {"disable_default_collisions", {{}, {"link"}, {}, {"reason"}}}};
  return elements;
}

class Strict {
 public:
  Strict(const std::string& where, Vocabulary vocabulary)
      : where_(where),
        vocabulary_(vocabulary),
        grammar_(vocabulary == Vocabulary::urdf ? urdfElements() : srdfElements()),
        matters_(vocabulary == Vocabulary::urdf ? "may be a geometry, a place or a motion"
                                                : "may say which pairs are checked") {}

  void check(const tinyxml2::XMLElement& e) const {
    const Grammar& of = grammar_.at(e.Name());
    attributes(e, of);
    std::map<std::string, int> counts;
    for (const tinyxml2::XMLNode* node = e.FirstChild(); node; node = node->NextSibling()) {
      const tinyxml2::XMLText* text = node->ToText();
      if (text && vocabulary_ == Vocabulary::urdf) {
        refuse(e, std::string("the text '") + text->Value() + "' stands in it, which is not understood; remove it");
      }
      const tinyxml2::XMLElement* const child = node->ToElement();
      if (!child || of.passed_over.count(child->Name())) continue;  // a comment
      const auto known = of.children.find(child->Name());
      if (known == of.children.end()) unknown(*child, e, of);
      if (++counts[child->Name()] > known->second.most) {
        refuse(*child, std::string("<") + e.Name() + "> may have only one of these; remove the others");
      }
      check(*child);
    }
    for (const auto& [name, count] : of.children) {
      if (count.least > 0 && !counts.count(name)) refuse(e, "it has no <" + name + ">");
    }
    if (std::strcmp(e.Name(), "geometry") == 0 && counts.size() != 1) {
      refuse(e, "it has " + std::string(counts.empty() ? "no shape" : "several shapes") +
                    "; a collision element needs one geometry element with one shape");
    }
  }

  [[noreturn]] void refuse(const tinyxml2::XMLElement& e, const std::string& why) const {
    fail(where_, "line " + std::to_string(e.GetLineNum()) + ", <" + e.Name() + ">" + partOf(e) + ": " + why);
  }

 private:
  /// " of link 'arm'": the link or joint that an element is or stands in, if it has a name.
  static std::string partOf(const tinyxml2::XMLElement& e) {
    for (const tinyxml2::XMLNode* up = &e; up; up = up->Parent()) {
      const tinyxml2::XMLElement* const part = up->ToElement();
      const bool named = part && (std::strcmp(part->Name(), "link") == 0 || std::strcmp(part->Name(), "joint") == 0);
      if (named && part->Attribute("name"))
        return std::string(part == &e ? " '" : std::string(" of ") + part->Name() + " '") + part->Attribute("name") +
               "'";
    }
    return "";
  }

  void attributes(const tinyxml2::XMLElement& e, const Grammar& of) const {
    for (const tinyxml2::XMLAttribute* a = e.FirstAttribute(); a; a = a->Next()) {
      const std::string name = a->Name();  // there once: tinyxml2 sees to that
      if (of.attributes.count(name)) {
        if (text::isUtf8(a->Value())) continue;
        refuse(e, "the attribute '" + name + "' has bytes that are no UTF-8; save the file as UTF-8");
      }
      if (name == "xmlns" || name.rfind("xmlns:", 0) == 0) continue;
      // A word of another vocabulary, such as drake:acceleration, is passed over like the word itself.
      if (of.passed_over_attributes.count(name.substr(name.find(':') + 1))) continue;
      // Some writers give an axis angles, all of them 0: these mean nothing.
      if (std::strcmp(e.Name(), "axis") == 0 && name == "rpy" && isZero(a->Value())) continue;
      const std::string cure = name == "quat_xyzw" || name == "quat_wxyz"
                                   ? "; write the rotation as rpy=\"ROLL PITCH YAW\" (rad)"
                                   : text::didYouMean(name, {of.attributes.begin(), of.attributes.end()});
      refuse(e, "the attribute '" + name + "' is not understood, and " + matters_ +
                    (cure.empty() ? "; if it is not, remove it" : cure));
    }
  }

  static bool isZero(const std::string& text) { return text.find_first_not_of(" \t\r\n0.-+") == std::string::npos; }

  [[noreturn]] void unknown(const tinyxml2::XMLElement& e, const tinyxml2::XMLElement& in, const Grammar& of) const {
    const std::string name = e.Name();
    if (name.rfind("xacro:", 0) == 0 || name == "insert_block") {
      refuse(e, "is left of xacro; expand the file first (xacro FILE > robot.urdf)");
    }
    if (name.rfind("xi:", 0) == 0) refuse(e, "is an inclusion, which is not read; put in what it names");
    std::vector<std::string> known(of.passed_over.begin(), of.passed_over.end());
    for (const auto& [child, count] : of.children) known.push_back(child);
    const std::string hint = text::didYouMean(name, known);
    refuse(e, std::string("in <") + in.Name() + "> it is not understood, and " + matters_ +
                  (hint.empty() ? "; if it is not, remove it" : hint));
  }

  const std::string& where_;
  const Vocabulary vocabulary_;
  const Elements& grammar_;
  const std::string matters_;
};

}  // namespace

tinyxml2::XMLElement& parseUnderstood(const std::string& where, const std::string& content, Vocabulary vocabulary,
                                      tinyxml2::XMLDocument& document) {
  const char* const kind = vocabulary == Vocabulary::urdf ? "a URDF" : "an SRDF";
  const std::string wrong = text::parseXml(content, "robot", kind, document);
  if (!wrong.empty()) fail(where, wrong);
  Strict(where, vocabulary).check(*document.RootElement());
  return *document.RootElement();
}

}  // namespace fcl_artic::detail
