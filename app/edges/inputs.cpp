// SPDX-License-Identifier: BSD-3-Clause
#include "edges/inputs.h"

#include <algorithm>
#include <cctype>
#include <filesystem>

#include <fmt/format.h>

#include "certificate/sha256.h"
#include "files/files.h"

namespace fcl_artic::app {
namespace {

/// Of a shape's "box" and the like: nothing.
std::string hashOfFile(const std::string& path) {
  std::error_code none;
  return std::filesystem::is_regular_file(path, none) ? certificate::sha256Text(files::read(path)) : "";
}

}  // namespace

std::string sceneFileHash(const std::string& path, const std::map<std::string, std::string>& packages) {
  const std::string own = certificate::sha256Text(files::read(path));
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  if (ending != ".urdf") return own;
  UrdfOptions options;
  options.packages = packages;
  std::string all = own;
  for (const LinkGeometry& geometry : loadUrdf(path, options).geometry) all += "\n" + hashOfFile(geometry.source);
  return certificate::sha256Text(all);
}

std::string robotHash(const WorldOptions& world, const World& read) {
  std::string text = hashOfFile(world.robot.robot);
  std::map<std::string, std::string> hashes;  // of files: links share them
  for (const LinkGeometry& geometry : read.robot.geometry) {
    const auto [at, is_new] = hashes.try_emplace(geometry.source);
    if (is_new) at->second = hashOfFile(geometry.source);
    text += "\n" + at->second;
  }
  const SceneOptions carried = sceneOptions(world.robot);
  for (const std::string& attached : world.robot.attached) {
    const Attachment one = parseAttachment(*read.robot.tree, attached);
    text += "\n" + sceneFileHash(one.file, carried.packages) + " " + one.link;
    for (const std::string& link : one.touch_links) text += " " + link;
    for (Eigen::Index k = 0; k < 16; ++k) text += fmt::format(" {:a}", one.pose.matrix().data()[k]);
  }
  if (!world.robot.attached.empty()) text += fmt::format("\n{:a} {}", world.point_radius, world.unknown_cells);
  text += fmt::format("\n{} {} {} {}", world.robot.base, world.robot.floating_base, world.robot.solid_meshes,
                      world.robot.collada_up_axis);
  for (const std::string& solid : world.solids) text += " " + solid;
  for (const auto& [a, b] : read.robot.allowed.pairs()) text += "\n" + a + " " + b;
  text += "\n" + read.pairs().text();
  return certificate::sha256Text(text);
}

}  // namespace fcl_artic::app
