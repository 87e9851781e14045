// SPDX-License-Identifier: BSD-3-Clause
#include "plans/carried.h"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "text/nearest_name.h"

namespace fcl_artic::plans {
namespace {

/// For each file: which of its objects stand for a carried one already.
using Taken = std::vector<std::vector<bool>>;

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

bool isUntouched(const std::vector<bool>& taken) {
  return !taken.empty() && std::none_of(taken.begin(), taken.end(), [](bool t) { return t; });
}

/// An object of that name; @return its file, or kNone.
std::size_t takeObject(const std::vector<Attached>& attached, const std::string& name, Taken& taken) {
  for (std::size_t f = 0; f < attached.size(); ++f) {
    for (std::size_t i = 0; i < attached[f].objects.size(); ++i) {
      if (taken[f][i] || attached[f].objects[i] != name) continue;
      taken[f][i] = true;
      return f;
    }
  }
  return kNone;
}

/// Takes all objects in a file of that name.
std::size_t takeFile(const std::vector<Attached>& attached, const std::string& name, Taken& taken) {
  for (std::size_t f = 0; f < attached.size(); ++f) {
    if (!isUntouched(taken[f]) || (!name.empty() && attached[f].file != name)) continue;
    taken[f].assign(taken[f].size(), true);
    return f;
  }
  return kNone;
}

/// The link that moves this one: the nearest at or above it that no fixed joint carries.
LinkId mover(const KinematicTree& tree, LinkId link) {
  while (tree.parentJoint(link) >= 0 && tree.joint(tree.parentJoint(link)).type == JointType::fixed) {
    link = tree.parentLink(link);
  }
  return link;
}

void requireLink(const KinematicTree& tree, const Carried& carried, LinkId attached_to) {
  if (carried.link.empty()) return;
  LinkId link = -1;
  std::vector<std::string> names;
  for (LinkId l = 0; l < tree.numLinks(); ++l) {
    names.push_back(tree.linkName(l));
    if (names.back() == carried.link) link = l;
  }
  if (link < 0) {
    throw std::invalid_argument(
        fmt::format("the message says that link '{}' carries '{}', and robot '{}' has no such link{}", carried.link,
                    carried.name, tree.name(), text::didYouMean(carried.link, names)));
  }
  if (mover(tree, link) == mover(tree, attached_to)) return;
  throw std::invalid_argument(
      fmt::format("the message says that link '{}' carries '{}', and it is attached to '{}', which moves against it",
                  carried.link, carried.name, tree.linkName(attached_to)));
}

std::string quoted(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) {
    text += (text.empty() ? "" : ", ") + (name.empty() ? "an object without a name" : "'" + name + "'");
  }
  return text;
}

}  // namespace

void requireCarried(const KinematicTree& tree, const Plan& plan, const std::vector<Attached>& attached,
                    const std::string& how) {
  Taken taken;
  for (const Attached& file : attached) taken.emplace_back(file.objects.size(), false);
  std::vector<std::size_t> found(plan.carried.size(), kNone);
  // Objects first: a file's name stands for all of its objects only if no object of it is named itself.
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (!plan.carried[i].name.empty()) found[i] = takeObject(attached, plan.carried[i].name, taken);
  }
  for (const bool named : {true, false}) {
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (found[i] != kNone || plan.carried[i].name.empty() == named) continue;
      found[i] = takeFile(attached, plan.carried[i].name, taken);
    }
  }
  std::vector<std::string> missing, there;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found[i] == kNone) missing.push_back(plan.carried[i].name);
  }
  for (const Attached& file : attached) there.insert(there.end(), file.objects.begin(), file.objects.end());
  if (!missing.empty()) {
    throw std::invalid_argument(fmt::format("the message says that the robot carries {}: {}{}", quoted(missing), how,
                                            there.empty() ? "" : "; what is attached is " + quoted(there)));
  }
  for (std::size_t i = 0; i < found.size(); ++i) requireLink(tree, plan.carried[i], attached[found[i]].link);
}

}  // namespace fcl_artic::plans
