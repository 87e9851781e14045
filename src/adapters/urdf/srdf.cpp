// SPDX-License-Identifier: BSD-3-Clause
#include <tinyxml2.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "detail.h"
#include "fcl_artic/urdf/urdf.h"
#include "files/files.h"
#include "text/nearest_name.h"
#include "text/utf8.h"
#include "urdf_elements.h"

namespace fcl_artic {
namespace {

using detail::fail;

/// The entries of an SRDF about pairs of links, and those for which the robot has no links.
class SrdfReader {
 public:
  SrdfReader(const std::string& path, const KinematicTree& tree) : where_("'" + path + "'"), tree_(tree) {
    const tinyxml2::XMLElement* robot =
        &detail::parseUnderstood(where_, files::read(path), detail::Vocabulary::srdf, document_);
    // In MoveIt's order of precedence: a pair that is named wins over a link's default, and disabled wins over enabled.
    forEach(*robot, "disable_default_collisions", [&](const tinyxml2::XMLElement& e) {
      const std::string link = attribute(e, "link");
      if (!count(link)) return;
      by_default_.insert(link);
      for (LinkId other = 0; other < tree_.numLinks(); ++other) {
        if (tree_.linkName(other) != link) reasons_[key(link, tree_.linkName(other))] = e.Name();
      }
    });
    forEach(*robot, "enable_collisions", [&](const tinyxml2::XMLElement& e) {
      const std::string a = attribute(e, "link1"), b = attribute(e, "link2");
      if (count(a, b)) {
        reasons_.erase(key(a, b));
      } else if (by_default_.count(a) || by_default_.count(b)) {
        refuseEnabled(e, by_default_.count(a) ? b : a, by_default_.count(a) ? a : b);
      }
    });
    forEach(*robot, "disable_collisions", [&](const tinyxml2::XMLElement& e) {
      const std::string a = attribute(e, "link1"), b = attribute(e, "link2");
      const char* reason = e.Attribute("reason");
      if (count(a, b)) reasons_[key(a, b)] = reason ? reason : "";
    });
    forEach(*robot, "virtual_joint", [&](const tinyxml2::XMLElement& e) { noteBase(e); });
    if (known_.empty() && !unknown_.empty()) {
      fail(where_, "is of another robot: of the " + std::to_string(unknown_.size()) + " links that it names, " +
                       firstOf(unknown_) + ", robot '" + tree_.name() + "' has none");
    }
  }

  /// Pairs that need no check, each with its reason.
  const std::map<std::pair<std::string, std::string>, std::string>& reasons() const { return reasons_; }

  /// Notes on elements that were passed over, and on statements of the file that do not hold for this robot.
  std::vector<std::string> notes() const {
    std::vector<std::string> notes = notes_;
    if (passed_over_ > 0) notes.push_back(passedOver());
    return notes;
  }

 private:
  template <typename F>
  static void forEach(const tinyxml2::XMLElement& robot, const char* name, F&& visit) {
    for (auto* e = robot.FirstChildElement(name); e; e = e->NextSiblingElement(name)) visit(*e);
  }
  static std::pair<std::string, std::string> key(const std::string& a, const std::string& b) {
    return a < b ? std::make_pair(a, b) : std::make_pair(b, a);
  }
  static constexpr std::size_t kShown = 3;  ///< names, in messages
  /// "'a', 'b', 'c' and 9 more".
  static std::string firstOf(const std::vector<std::string>& names) {
    std::string shown;
    for (std::size_t i = 0; i < std::min(kShown, names.size()); ++i) shown += (i ? ", '" : "'") + names[i] + "'";
    return names.size() <= kShown ? shown : shown + " and " + std::to_string(names.size() - kShown) + " more";
  }

  std::string lineOf(const tinyxml2::XMLElement& e) const {
    return where_ + ", line " + std::to_string(e.GetLineNum());
  }
  std::string attribute(const tinyxml2::XMLElement& e, const char* name) const {
    const char* value = e.Attribute(name);
    if (!value) fail(lineOf(e), std::string("<") + e.Name() + "> has no attribute '" + name + "'");
    return value;
  }

  bool hasLink(const std::string& name) {
    if (tree_.hasLink(name)) return known_.insert(name), true;
    if (not_there_.insert(name).second) unknown_.push_back(name);
    return false;
  }
  /// Whether the robot has what an entry names; every entry is counted once.
  template <typename... Names>
  bool count(const Names&... names) {
    const int missing = (0 + ... + !hasLink(names));
    ++entries_;
    passed_over_ += missing > 0;
    return missing == 0;
  }

  std::string passedOver() const {
    std::string note = where_ + ": " + std::to_string(passed_over_) + " of " + std::to_string(entries_) +
                       " entries name links that robot '" + tree_.name() + "' does not have, " + firstOf(unknown_) +
                       "; they are passed over";
    // A link that the file names elsewhere is no candidate for a name with a slip.
    std::vector<std::string> unnamed;
    for (LinkId link = 0; link < tree_.numLinks(); ++link) {
      if (!known_.count(tree_.linkName(link))) unnamed.push_back(tree_.linkName(link));
    }
    for (std::size_t i = 0; i < std::min(kShown, unknown_.size()); ++i) {
      const std::string nearest = text::nearestName(unknown_[i], unnamed);
      if (!nearest.empty()) return note + "; did you mean '" + nearest + "' by '" + unknown_[i] + "'?";
    }
    return note;
  }

  /// Notes a robot whose base moves by its SRDF, and stands still by its tree.
  void noteBase(const tinyxml2::XMLElement& e) {
    const char *type = e.Attribute("type"), *child = e.Attribute("child_link");
    if (!type || std::string(type) == "fixed") return;
    if (child && tree_.hasLink(child) && tree_.parentJoint(tree_.linkId(child)) >= 0) return;
    notes_.push_back(lineOf(e) + ": the robot's base is " + type +
                     " by its virtual_joint, and stands still here (--virtual-joint moves it)");
  }

  [[noreturn]] void refuseEnabled(const tinyxml2::XMLElement& e, const std::string& missing,
                                  const std::string& disabled) const {
    std::vector<std::string> names;
    for (LinkId link = 0; link < tree_.numLinks(); ++link) names.push_back(tree_.linkName(link));
    fail(lineOf(e), std::string("<") + e.Name() + "> names link '" + missing + "', which robot '" + tree_.name() +
                        "' does not have, and '" + disabled +
                        "', which is disabled by default: the pair that is meant would go unchecked" +
                        text::didYouMean(missing, names));
  }

  const std::string where_;
  const KinematicTree& tree_;
  tinyxml2::XMLDocument document_;
  std::map<std::pair<std::string, std::string>, std::string> reasons_;
  std::set<std::string> by_default_, known_;
  std::vector<std::string> unknown_;  ///< in the order of the file, each once
  std::set<std::string> not_there_;   ///< the same
  std::vector<std::string> notes_;
  std::size_t entries_ = 0, passed_over_ = 0;
};

}  // namespace

std::optional<VirtualJoint> loadVirtualJoint(const std::string& path) {
  const std::string where = "'" + path + "'";
  tinyxml2::XMLDocument document;
  const tinyxml2::XMLElement* robot =
      &detail::parseUnderstood(where, files::read(path), detail::Vocabulary::srdf, document);
  std::optional<VirtualJoint> found;
  for (auto* e = robot->FirstChildElement("virtual_joint"); e; e = e->NextSiblingElement("virtual_joint")) {
    const std::string line = where + ", line " + std::to_string(e->GetLineNum());
    const auto attribute = [&](const char* name) -> std::string {
      const char* value = e->Attribute(name);
      if (!value || !*value) fail(line, std::string("<virtual_joint> has no attribute '") + name + "'");
      if (!text::isUtf8(value)) {
        fail(line, std::string("the attribute '") + name +
                       "' of <virtual_joint> has bytes that are no UTF-8; save the " + "file as UTF-8");
      }
      return value;
    };
    const std::string type = attribute("type");
    if (type == "fixed") continue;
    if (type != "planar" && type != "floating") {
      fail(line, "<virtual_joint> is of type '" + type + "', not fixed, planar or floating");
    }
    if (found)
      fail(line, "a second <virtual_joint> that moves, '" + attribute("name") + "' beside '" + found->name + "'");
    found = VirtualJoint{attribute("name"), type == "planar" ? JointType::planar : JointType::floating,
                         attribute("parent_frame"), attribute("child_link")};
  }
  return found;
}

std::vector<SrdfPair> readSrdf(const std::string& path, const KinematicTree& tree, std::vector<std::string>* notes) {
  const SrdfReader reader(path, tree);
  std::vector<SrdfPair> pairs;
  for (const auto& [names, reason] : reader.reasons()) pairs.push_back({names.first, names.second, reason});
  for (const std::string& note : reader.notes()) {
    if (notes) notes->push_back(note);
  }
  return pairs;
}

AllowedCollisionMatrix loadSrdf(const std::string& path, const KinematicTree& tree, std::vector<std::string>* notes) {
  AllowedCollisionMatrix matrix;
  matrix.setComplete();
  for (const SrdfPair& pair : readSrdf(path, tree, notes)) matrix.allow(pair.link1, pair.link2);
  return matrix;
}

}  // namespace fcl_artic
