// SPDX-License-Identifier: BSD-3-Clause
#include "robot_options.h"

#include <charconv>
#include <cmath>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>

#include "kinematics/angles.h"
#include "usage.h"

namespace fcl_artic::app {
namespace {

constexpr const char* kWorldGroup = "Robot and scene";

std::string requirePackage(const std::string& text) {
  const std::size_t equals = text.find('=');
  const bool good = equals != std::string::npos && equals > 0 && equals + 1 < text.size();
  return good ? "" : "'" + text + "' is not NAME=DIR";
}

std::map<std::string, std::string> packagesOf(const RobotOptions& options) {
  std::map<std::string, std::string> packages;
  for (const std::string& package : options.packages) {
    const std::size_t equals = package.find('=');
    packages[package.substr(0, equals)] = package.substr(equals + 1);
  }
  return packages;
}

/// @param angle  whether the ending deg may be there.
std::optional<double> number(std::string_view text, bool angle) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  const bool degrees = angle && text.size() > 3 && text.substr(text.size() - 3) == "deg";
  if (degrees) text.remove_suffix(3);
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);  // from_chars takes no plus
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return degrees ? value * kRadiansPerDegree : value;
}

std::optional<Eigen::Isometry3d> poseOf(const std::string& text) {
  const std::vector<std::string> words = split(text, ',');
  if (words.size() != 3 && words.size() != 6) return std::nullopt;
  std::vector<double> values;
  for (const std::string& word : words) {
    const std::optional<double> value = number(word, values.size() >= 3);
    if (!value) return std::nullopt;
    values.push_back(*value);
  }
  values.resize(6, 0);
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  return Eigen::Isometry3d(Eigen::Translation3d(values[0], values[1], values[2]) *
                           AngleAxisd(values[5], Vector3d::UnitZ()) * AngleAxisd(values[4], Vector3d::UnitY()) *
                           AngleAxisd(values[3], Vector3d::UnitX()));
}

}  // namespace

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  for (std::size_t at = 0;;) {
    const std::size_t end = text.find(separator, at);
    parts.push_back(text.substr(at, end == std::string::npos ? end : end - at));
    if (end == std::string::npos) return parts;
    at = end + 1;
  }
}

void addRobotFile(CLI::App& verb, RobotOptions& o, const std::string& names) {
  verb.add_option(names, o.robot, "Robot (URDF)")
      ->required()
      ->check(requireInput)
      ->group(kWorldGroup)
      ->type_name("FILE");
  verb.add_option("--package", o.packages, "Folder that package://NAME/ stands for; may be repeated")
      ->check(requirePackage)
      ->allow_extra_args(false)
      ->group(kWorldGroup)
      ->type_name("NAME=DIR");
  verb.add_flag("--import", o.import_meshes,
                "Read meshes of other formats than .stl .obj .ply .off .dae .gltf .glb by assimp, with a note")
      ->group(kWorldGroup);
}

CLI::Option* addRobotOptions(CLI::App& verb, RobotOptions& o, const std::string& names) {
  addRobotFile(verb, o, names);
  CLI::Option* srdf = verb.add_option("--srdf", o.srdf, "Pairs of links that may touch (SRDF)")
                          ->check(requireInput)
                          ->group(kWorldGroup)
                          ->type_name("FILE");
  verb.add_option("--base", o.base,
                  "Where the robot's root stands in the world: x,y,z or x,y,z,roll,pitch,yaw (m, rad or 90deg)")
      ->group(kWorldGroup)
      ->type_name("POSE");
  verb.add_flag("--floating-base", o.floating_base,
                "The robot's root moves freely: seven values more, floating_base/trans_x to floating_base/rot_w, first")
      ->group(kWorldGroup);
  verb.add_flag("--virtual-joint", o.virtual_joint,
                "The robot's root moves by the virtual_joint of --srdf, planar or floating: its values come first")
      ->needs(srdf)
      ->group(kWorldGroup);
  return srdf;
}

void addAttachOption(CLI::App& verb, RobotOptions& o) {
  verb.add_option(
          "--attach", o.attached,
          "Object that a link carries, a scene file at a pose in the link's frame; LINK+LINK2=FILE: it may touch "
          "LINK2 too; may be repeated")
      ->allow_extra_args(false)
      ->group(kWorldGroup)
      ->type_name("LINK=FILE[@POSE]");
}

UrdfOptions urdfOptions(const RobotOptions& options) {
  UrdfOptions out;
  out.solid_meshes = options.solid_meshes;
  out.collada_up_axis = options.collada_up_axis;
  out.import_meshes = options.import_meshes;
  out.packages = packagesOf(options);
  if (!options.base.empty()) out.base = parsePose(options.base, "--base");
  out.floating_base = options.floating_base;
  if (options.virtual_joint) {
    // The file is read a second time for its pairs.
    std::error_code none;
    if (!std::filesystem::is_regular_file(options.srdf, none)) {
      throw std::invalid_argument("--virtual-joint: '" + options.srdf + "' is no regular file, and is read twice");
    }
    out.virtual_joint = loadVirtualJoint(options.srdf);
    if (!out.virtual_joint) {
      throw std::invalid_argument("--virtual-joint: '" + options.srdf + "' has no planar or floating virtual_joint");
    }
  }
  return out;
}

SceneOptions sceneOptions(const RobotOptions& options) {
  SceneOptions out;
  out.solid_meshes = options.solid_meshes;
  out.collada_up_axis = options.collada_up_axis;
  out.import_meshes = options.import_meshes;
  out.packages = packagesOf(options);
  return out;
}

Robot readRobot(const RobotOptions& options) {
  Robot robot = loadUrdf(options.robot, urdfOptions(options));
  if (!options.srdf.empty()) robot.allowed = loadSrdf(options.srdf, *robot.tree, &robot.notes);
  return robot;
}

Eigen::Isometry3d parsePose(const std::string& text, const std::string& option) {
  if (const std::optional<Eigen::Isometry3d> pose = poseOf(text)) return *pose;
  throw std::invalid_argument(fmt::format(
      "{}: '{}' is no pose x,y,z or x,y,z,roll,pitch,yaw, in m and rad (or an angle as 90deg)", option, text));
}

Attachment parseAttachment(const KinematicTree& tree, const std::string& text) {
  const auto refuse = [&](const std::string& reason) {
    throw std::invalid_argument(fmt::format("--attach {}: {}", text, reason));
  };
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) {
    refuse("is not LINK=FILE or LINK=FILE@x,y,z or LINK=FILE@x,y,z,roll,pitch,yaw");
  }
  Attachment out;
  std::vector<std::string> links = split(text.substr(0, equals), '+');
  for (const std::string& link : links) {
    try {
      tree.linkId(link);
    } catch (const std::out_of_range& error) {
      refuse(error.what());
    }
  }
  out.link = links.front();
  out.touch_links.assign(links.begin() + 1, links.end());
  out.file = text.substr(equals + 1);
  // A file's name may hold an @ too, but hardly with numbers and commas after it.
  const std::size_t at = out.file.rfind('@');
  if (at == std::string::npos) return out;
  const std::string pose = out.file.substr(at + 1);
  if (const auto read = poseOf(pose)) {
    out.pose = *read;
    out.file.resize(at);
  } else if (pose.find('/') == std::string::npos && pose.find(',') != std::string::npos) {
    parsePose(pose, "--attach " + text);  // says what is wrong
  }
  return out;
}

std::vector<Attachment> readAttachments(const RobotOptions& options, const KinematicTree& tree,
                                        const SceneOptions& scene_options, std::vector<Scene>& scenes) {
  std::vector<Attachment> attachments;
  for (std::size_t option = 0; option < options.attached.size(); ++option) {
    Attachment attachment = parseAttachment(tree, options.attached[option]);
    attachment.option = option;
    scenes.push_back(loadScene(attachment.file, scene_options));
    for (const Scene::Obstacle& obstacle : scenes.back().obstacles) {
      attachments.push_back(attachment);
      attachments.back().name = obstacle.name;
      attachments.back().pose = attachment.pose * obstacle.object->getTransform();
    }
  }
  return attachments;
}

void attachLast(const std::vector<Attachment>& attachments, const Scene& scene, ArticulatedCollisionManager& manager) {
  const std::size_t first = scene.obstacles.size() - attachments.size();
  for (std::size_t i = 0; i < attachments.size(); ++i) {
    const Attachment& a = attachments[i];
    const Scene::Obstacle& obstacle = scene.obstacles[first + i];
    try {
      manager.attach(a.link, obstacle.object.get(), a.pose, a.touch_links);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(fmt::format("--attach {}={}: '{}': {}", a.link, a.file, obstacle.name, error.what()));
    }
  }
}

void moveToLinks(const std::vector<Attachment>& attachments, Scene& scene, Robot& robot) {
  const std::size_t first = scene.obstacles.size() - attachments.size();
  for (std::size_t i = 0; i < attachments.size(); ++i) {
    const Attachment& a = attachments[i];
    robot.geometry.push_back({robot.tree->linkId(a.link), a.pose, scene.obstacles[first + i].object, a.file});
  }
  scene.obstacles.resize(first);
}

}  // namespace fcl_artic::app
