// SPDX-License-Identifier: BSD-3-Clause
#include "info.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "exit_status.h"
#include "fcl_artic/fcl_artic.h"
#include "kinematics/angles.h"
#include "robot_options.h"
#include "text/counted.h"

namespace fcl_artic::app {
namespace {

using Json = nlohmann::ordered_json;

const char* nameOf(JointType type) {
  switch (type) {
    case JointType::fixed:
      return "fixed";
    case JointType::revolute:
      return "revolute";
    case JointType::continuous:
      return "continuous";
    case JointType::prismatic:
      return "prismatic";
    case JointType::planar:
      return "planar";
    case JointType::spherical:
      return "spherical";
    case JointType::floating:
      return "floating";
  }
  return "";
}

/// One geometry of a link.
struct Shape {
  std::string kind, source;  ///< "mesh", "box" ...; of a mesh its file, else empty
  int triangles = 0;         ///< of a mesh
  std::string open;          ///< of a mesh that is not closed and oriented: why
  Eigen::Vector3d extents;   ///< of the box around it, in its own frame, m
};

/// A file's path from the robot's folder, where it lies in there; else as it is.
std::string shownPath(const std::string& file, const std::string& robot) {
  const std::filesystem::path below =
      std::filesystem::path(file).lexically_relative(std::filesystem::absolute(robot).lexically_normal().parent_path());
  return below.empty() || *below.begin() == ".." ? file : below.string();
}

Shape shapeOf(const LinkGeometry& g, const std::string& robot) {
  const fcl::CollisionGeometryd& geometry = *g.object->collisionGeometry();
  Shape shape;
  shape.extents = geometry.aabb_local.max_ - geometry.aabb_local.min_;
  const auto* mesh = dynamic_cast<const fcl::BVHModel<fcl::OBBRSSd>*>(&geometry);
  shape.kind = mesh ? "mesh" : g.source;
  if (!mesh) return shape;
  shape.source = shownPath(g.source, robot);
  shape.triangles = mesh->num_tris;
  try {
    makeSolid(geometry);
  } catch (const std::invalid_argument& error) {
    shape.open = error.what();
    const std::string prefix = "makeSolid: ";
    if (shape.open.rfind(prefix, 0) == 0) shape.open.erase(0, prefix.size());
  }
  return shape;
}

/// Warns of sizes that files in other units have; a line each.
/// @param shapes  with the link of each.
std::vector<std::string> unitWarnings(const Robot& robot, const std::vector<std::pair<LinkId, Shape>>& shapes) {
  const double reach = reachUpper(*robot.tree);
  if (!(reach > 0) || shapes.empty()) return {};
  // A mesh in millimetres is a thousand times too large, one in inches 39 times. A wide base or a long tool is at most
  // a few times as long as all joints' distances in a row.
  constexpr double kFarLarger = 20, kFarSmaller = 0.01;
  std::vector<std::string> warnings;
  std::size_t meshes = 0, large = 0;
  const std::pair<LinkId, Shape>*largest = nullptr, *any = &shapes.front();
  const auto size = [](const std::pair<LinkId, Shape>& s) { return s.second.extents.maxCoeff(); };
  for (const auto& shape : shapes) {
    if (size(shape) > size(*any)) any = &shape;
    if (shape.second.kind != "mesh") continue;
    ++meshes;
    if (size(shape) <= kFarLarger * reach) continue;
    ++large;
    if (!largest || size(shape) > size(*largest)) largest = &shape;
  }
  if (largest) {
    warnings.push_back(fmt::format(
        "{} of {} meshes are far larger than the robot: its joints reach {:.4g} m, mesh '{}' of link '{}' is {:.4g} m "
        "long. Are they in other units? A file in millimetres needs scale=\"0.001 0.001 0.001\" in its <mesh>",
        large, meshes, reach, largest->second.source, robot.tree->linkName(largest->first), size(*largest)));
  }
  if (size(*any) < kFarSmaller * reach) {
    warnings.push_back(fmt::format(
        "the largest geometry is {:.4g} m long, the robot's joints reach {:.4g} m: is it in other units, or "
        "scaled twice?",
        size(*any), reach));
  }
  return warnings;
}

/// A pair of links with geometry that is not checked, and why.
struct Unchecked {
  std::string link1, link2, reason;
};

struct Info {
  Robot robot;
  std::vector<std::pair<LinkId, Shape>> shapes;
  double reach = 0, joints_reach = 0;
  std::vector<std::pair<std::string, std::string>> checked;
  std::vector<Unchecked> unchecked;
  std::vector<std::string> warnings;
};

Info collect(const RobotOptions& options) {
  Info info;
  Robot& robot = info.robot;
  robot = loadUrdf(options.robot, urdfOptions(options));
  std::map<std::pair<std::string, std::string>, std::string> reasons;
  if (!options.srdf.empty()) {
    robot.allowed.setComplete();
    for (const SrdfPair& pair : readSrdf(options.srdf, *robot.tree, &robot.notes)) {
      robot.allowed.allow(pair.link1, pair.link2);
      reasons[std::minmax(pair.link1, pair.link2)] = pair.reason;
    }
  }
  const KinematicTree& tree = *robot.tree;
  std::map<const fcl::CollisionGeometryd*, Shape> known;  // links may share a mesh
  std::set<std::string> with_geometry;
  for (const LinkGeometry& g : robot.geometry) {
    const auto [entry, is_new] = known.try_emplace(g.object->collisionGeometry().get());
    if (is_new) entry->second = shapeOf(g, options.robot);
    info.shapes.emplace_back(g.link, entry->second);
    with_geometry.insert(tree.linkName(g.link));
  }
  info.warnings = unitWarnings(robot, info.shapes);
  info.joints_reach = reachUpper(tree);
  info.reach = reachUpper(tree, robot.geometry);

  ArticulatedCollisionManager manager(robot.tree);
  robot.addTo(manager);
  manager.setup();
  info.checked = manager.checkedLinkPairs();
  std::set<std::pair<std::string, std::string>> neighbours, undecided;
  for (const LinkPairFinding& pair : manager.neighbours()) {
    neighbours.insert(std::minmax(pair.link1, pair.link2));
    if (pair.undecided()) undecided.insert(std::minmax(pair.link1, pair.link2));
  }
  const std::set<std::pair<std::string, std::string>> checked(info.checked.begin(), info.checked.end());
  for (auto a = with_geometry.begin(); a != with_geometry.end(); ++a) {
    for (auto b = std::next(a); b != with_geometry.end(); ++b) {
      if (checked.count({*a, *b})) continue;
      const auto reason = reasons.find({*a, *b});
      std::string why = neighbours.count({*a, *b}) ? "neighbours that touch" : "stand still against each other";
      if (undecided.count({*a, *b})) why = "neighbours, undecided";
      if (reason != reasons.end()) why = "SRDF" + (reason->second.empty() ? "" : ": " + reason->second);
      info.unchecked.push_back({*a, *b, why});
    }
  }
  return info;
}

std::string vectorText(const Eigen::Vector3d& v) {
  return fmt::format("{:.4g} x {:.4g} x {:.4g} m", v.x(), v.y(), v.z());
}

std::string limitsText(const Joint& joint) {
  if (joint.mimics) {
    return fmt::format("= {:g} * {} + {:g}", joint.mimic.multiplier, joint.mimic.master, joint.mimic.offset);
  }
  if (joint.type == JointType::fixed) return "";
  if (!hasLimits(joint)) return "no limits";
  if (joint.type == JointType::prismatic) return fmt::format("{:g} to {:g} m", joint.lower, joint.upper);
  return fmt::format("{:.4g} to {:.4g} rad ({:.0f} to {:.0f} deg)", joint.lower, joint.upper,
                     joint.lower / kRadiansPerDegree, joint.upper / kRadiansPerDegree);
}

bool hasAxis(JointType type) {
  return type != JointType::fixed && type != JointType::spherical && type != JointType::floating;
}

std::string text(const Info& info) {
  const KinematicTree& tree = *info.robot.tree;
  const auto count = [](int number, const char* what) { return text::counted(static_cast<std::size_t>(number), what); };
  std::string out =
      fmt::format("robot '{}': {}, {}, {} in a configuration\n", tree.name(), count(tree.numLinks(), "link"),
                  count(tree.numJoints(), "joint"), count(tree.dof(), "value"));
  out += fmt::format("reach: {:.4g} m at most from its root, joints alone {:.4g} m\n", info.reach, info.joints_reach);

  out += "\nvalues, in the order of a configuration\n";
  std::size_t widest = 0;
  for (int v = 0; v < tree.dof(); ++v) widest = std::max(widest, tree.variableName(v).size());
  for (int v = 0; v < tree.dof(); ++v) {
    const Joint& joint = tree.joint(tree.variableJoint(v));
    const int quaternion = tree.quaternionVariable(tree.variableJoint(v));
    const char* unit = tree.isAngle(v) ? "rad" : quaternion >= 0 && v >= quaternion ? "" : "m";
    out += fmt::format("  {:>2} {:<{}} {:<10} {:<3} {}\n", v + 1, tree.variableName(v), widest, nameOf(joint.type),
                       unit, limitsText(joint));
  }

  out += "\njoints\n";
  for (JointId j = 0; j < tree.numJoints(); ++j) {
    const Joint& joint = tree.joint(j);
    std::string line = fmt::format("  {}: {}, '{}' to '{}'", joint.name, nameOf(joint.type), joint.parent, joint.child);
    if (hasAxis(joint.type))
      line += fmt::format(", axis ({:.4g}, {:.4g}, {:.4g})", joint.axis.x() + 0.0, joint.axis.y() + 0.0,
                          joint.axis.z() + 0.0);
    if (joint.mimics) line += ", " + limitsText(joint);
    out += line + "\n";
  }

  out += "\nlinks\n";
  for (LinkId link = 0; link < tree.numLinks(); ++link) {
    std::size_t shown = 0;
    for (const auto& [of, shape] : info.shapes) {
      if (of != link) continue;
      out +=
          shown++ == 0 ? fmt::format("  {}: ", tree.linkName(link)) : std::string(tree.linkName(link).size() + 4, ' ');
      if (shape.kind == "mesh") {
        out += fmt::format("mesh {}, {}, {}, {}\n", shape.source, text::counted(shape.triangles, "triangle"),
                           vectorText(shape.extents), shape.open.empty() ? "closed and oriented" : shape.open);
      } else {
        out += fmt::format("{}, {}\n", shape.kind, vectorText(shape.extents));
      }
    }
    if (shown == 0) out += fmt::format("  {}: no collision geometry\n", tree.linkName(link));
  }

  out +=
      fmt::format("\npairs of links with geometry: {} checked, {} not\n", info.checked.size(), info.unchecked.size());
  std::map<std::string, std::vector<std::string>> by_reason;
  for (const Unchecked& u : info.unchecked) by_reason[u.reason].push_back(u.link1 + " - " + u.link2);
  for (const auto& [reason, pairs] : by_reason) {
    out += fmt::format("  not, {} ({})\n", reason, pairs.size());
    for (const std::string& pair : pairs) out += "    " + pair + "\n";
  }
  if (!info.checked.empty()) out += fmt::format("  checked ({})\n", info.checked.size());
  for (const auto& [a, b] : info.checked) out += fmt::format("    {} - {}\n", a, b);

  for (const std::string& warning : info.warnings) out += "warning: " + warning + "\n";
  for (const std::string& note : info.robot.notes) out += "note: " + note + "\n";
  return out;
}

Json vectorJson(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

Json json(const Info& info) {
  const KinematicTree& tree = *info.robot.tree;
  Json values = Json::array(), joints = Json::array(), links = Json::array(), checked = Json::array(),
       unchecked = Json::array();
  for (int v = 0; v < tree.dof(); ++v) values.push_back(tree.variableName(v));
  for (JointId j = 0; j < tree.numJoints(); ++j) {
    const Joint& joint = tree.joint(j);
    Json mimic;
    if (joint.mimics) {
      mimic = {{"joint", joint.mimic.master}, {"multiplier", joint.mimic.multiplier}, {"offset", joint.mimic.offset}};
    }
    joints.push_back({{"name", joint.name},
                      {"type", nameOf(joint.type)},
                      {"parent", joint.parent},
                      {"child", joint.child},
                      {"axis", hasAxis(joint.type) ? vectorJson(joint.axis) : Json()},
                      {"lower", hasLimits(joint) ? Json(joint.lower) : Json()},
                      {"upper", hasLimits(joint) ? Json(joint.upper) : Json()},
                      {"mimic", mimic}});
  }
  for (LinkId link = 0; link < tree.numLinks(); ++link) {
    Json geometry = Json::array();
    for (const auto& [of, shape] : info.shapes) {
      if (of != link) continue;
      Json one = {{"kind", shape.kind}, {"extents", vectorJson(shape.extents)}};
      if (shape.kind == "mesh") {
        one["file"] = shape.source;
        one["triangles"] = shape.triangles;
        one["closed"] = shape.open.empty();
        one["why_not_closed"] = shape.open.empty() ? Json() : Json(shape.open);
      }
      geometry.push_back(one);
    }
    links.push_back({{"name", tree.linkName(link)}, {"geometry", geometry}});
  }
  for (const auto& [a, b] : info.checked) checked.push_back({a, b});
  for (const Unchecked& u : info.unchecked) {
    unchecked.push_back({{"link1", u.link1}, {"link2", u.link2}, {"reason", u.reason}});
  }
  return {{"robot", tree.name()},      {"values", values},
          {"reach", info.reach},       {"joints_reach", info.joints_reach},
          {"joints", joints},          {"links", links},
          {"checked_pairs", checked},  {"unchecked_pairs", unchecked},
          {"warnings", info.warnings}, {"notes", info.robot.notes}};
}

}  // namespace

void addInfo(CLI::App& program, int& exit_status) {
  struct Options {
    RobotOptions robot;
    bool json = false;
  };
  auto options = std::make_shared<Options>();
  CLI::App* info = program.add_subcommand(
      "info", "What do a robot's files hold? Joints and limits, geometry and sizes, pairs of links that are checked");
  info->footer("Exit status: 0, also with warnings; 2 error.");
  addRobotOptions(*info, options->robot);
  info->add_flag("--json", options->json, "Answer in JSON, all digits")->group("Output");
  info->callback([options, &exit_status] {
    const Info found = collect(options->robot);
    if (options->json) {
      fmt::print("{}\n", json(found).dump(2));
    } else {
      fmt::print("{}", text(found));
    }
    exit_status = kExitFree;
  });
}

}  // namespace fcl_artic::app
