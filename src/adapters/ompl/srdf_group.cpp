// SPDX-License-Identifier: BSD-3-Clause
#include <tinyxml2.h>

#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>

#include "fcl_artic/ompl/planning_setup.h"
#include "files/files.h"

namespace fcl_artic::planning {
namespace {

using Element = tinyxml2::XMLElement;

/// Collects what a group names.
class GroupReader {
 public:
  GroupReader(const std::string& path, const KinematicTree& tree) : where_("'" + path + "'"), tree_(tree) {
    const std::string xml = files::read(path);
    if (document_.Parse(xml.c_str(), xml.size()) != tinyxml2::XML_SUCCESS) fail(document_.ErrorStr());
    root_ = document_.RootElement();
    if (!root_ || std::string(root_->Name()) != "robot") fail("is not an SRDF: the root element is not <robot>");
    forEach(*root_, "virtual_joint",
            [&](const Element& e) { virtual_types_[attribute(e, "name")] = attribute(e, "type"); });
    forEach(*root_, "passive_joint", [&](const Element& e) { addJoint(e, passive_); });
  }

  std::vector<std::string> read(const std::string& group) {
    const Element* element = find(group);
    if (!element) {
      std::string known;
      forEach(*root_, "group",
              [&](const Element& e) { known += (known.empty() ? "'" : ", '") + attribute(e, "name") + "'"; });
      fail("has no group '" + group + "'" + (known.empty() ? "" : "; it has " + known));
    }
    add(*element, group);
    std::vector<std::string> names;
    for (const JointId j : joints_) {
      const Joint& joint = tree_.joint(j);
      const bool stands = joint.type == JointType::fixed || (hasLimits(joint) && joint.lower == joint.upper);
      if (!stands && !joint.mimics && !passive_.count(j)) names.push_back(joint.name);
    }
    if (names.empty()) fail("group '" + group + "' moves no joint");
    return names;
  }

 private:
  [[noreturn]] void fail(const std::string& reason) const { throw std::runtime_error(where_ + ": " + reason); }
  [[noreturn]] void fail(const Element& e, const std::string& reason) const {
    fail("line " + std::to_string(e.GetLineNum()) + ", <" + e.Name() + "> " + reason);
  }

  template <typename F>
  static void forEach(const Element& parent, const char* name, F&& visit) {
    for (auto* e = parent.FirstChildElement(name); e; e = e->NextSiblingElement(name)) visit(*e);
  }
  std::string attribute(const Element& e, const char* name) const {
    const char* value = e.Attribute(name);
    if (!value) fail(e, std::string("has no attribute '") + name + "'");
    return value;
  }
  LinkId link(const Element& e, const char* name) const {
    const std::string value = attribute(e, name);
    if (!tree_.hasLink(value)) fail(e, "names link '" + value + "', which robot '" + tree_.name() + "' does not have");
    return tree_.linkId(value);
  }
  /// A virtual joint that fixes the robot to the world changes nothing: the root link is there already. A virtual joint
  /// that moves the base is refused.
  void addJoint(const Element& e, std::set<JointId>& to) const {
    const std::string name = attribute(e, "name");
    for (JointId j = 0; j < tree_.numJoints(); ++j) {
      if (tree_.joint(j).name != name) continue;
      to.insert(j);
      return;
    }
    const auto known = virtual_types_.find(name);
    if (known == virtual_types_.end()) {
      fail(e, "names joint '" + name + "', which robot '" + tree_.name() + "' does not have");
    }
    if (known->second != "fixed") fail(e, "names the virtual joint '" + name + "', which is " + known->second);
  }
  /// The first definition; a group that is only named within another is none.
  const Element* find(const std::string& group) const {
    for (auto* e = root_->FirstChildElement("group"); e; e = e->NextSiblingElement("group")) {
      if (attribute(*e, "name") == group) return e;
    }
    return nullptr;
  }

  /// Joints from the tip up to the base; through their common ancestor where the base is on another branch.
  void addChain(const Element& e) {
    const auto upwards = [&](LinkId link) {
      std::vector<LinkId> path{link};
      while (tree_.parentLink(path.back()) >= 0) path.push_back(tree_.parentLink(path.back()));
      return path;
    };
    std::vector<LinkId> base = upwards(link(e, "base_link")), tip = upwards(link(e, "tip_link"));
    if (base.back() != tip.back()) fail(e, "names two links that are not connected");
    while (!base.empty() && !tip.empty() && base.back() == tip.back()) {
      base.pop_back();
      tip.pop_back();
    }
    for (const auto* side : {&base, &tip}) {
      for (const LinkId l : *side) joints_.insert(tree_.parentJoint(l));
    }
  }

  void add(const Element& group, const std::string& name) {
    if (!open_.insert(name).second) fail(group, "'" + name + "' holds itself");
    forEach(group, "chain", [&](const Element& e) { addChain(e); });
    forEach(group, "joint", [&](const Element& e) { addJoint(e, joints_); });
    forEach(group, "link", [&](const Element& e) {
      if (const JointId j = tree_.parentJoint(link(e, "name")); j >= 0) joints_.insert(j);
    });
    forEach(group, "passive_joint", [&](const Element& e) { addJoint(e, passive_); });
    forEach(group, "group", [&](const Element& e) {
      const std::string sub = attribute(e, "name");
      const Element* definition = find(sub);
      if (!definition) fail(e, "names group '" + sub + "', which is not defined");
      add(*definition, sub);
    });
    open_.erase(name);
  }

  std::string where_;
  const KinematicTree& tree_;
  tinyxml2::XMLDocument document_;
  const Element* root_ = nullptr;
  std::map<std::string, std::string> virtual_types_;
  std::set<JointId> joints_, passive_;
  std::set<std::string> open_;  ///< groups that are being read
};

}  // namespace

std::vector<std::string> groupJoints(const std::string& srdf, const KinematicTree& tree, const std::string& group) {
  return GroupReader(srdf, tree).read(group);
}

}  // namespace fcl_artic::planning
