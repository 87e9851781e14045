// SPDX-License-Identifier: BSD-3-Clause
#include "edges/inputs.h"

#include <filesystem>
#include <set>

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

std::string robotHash(const WorldOptions& world, const World& read) {
  std::string text = hashOfFile(world.robot.robot);
  std::set<std::string> sources;
  for (const LinkGeometry& geometry : read.robot.geometry) sources.insert(hashOfFile(geometry.source));
  for (const std::string& source : sources) text += source;
  for (const std::string& attached : world.robot.attached) {
    const Attachment one = parseAttachment(*read.robot.tree, attached);
    text += hashOfFile(one.file) + one.link;
    for (const std::string& link : one.touch_links) text += " " + link;
    for (Eigen::Index k = 0; k < 16; ++k) text += fmt::format(" {:a}", one.pose.matrix().data()[k]);
  }
  text += fmt::format(" {} {} {} {}", world.robot.base, world.robot.floating_base, world.robot.solid_meshes,
                      world.robot.collada_up_axis);
  for (const std::string& solid : world.solids) text += " " + solid;
  for (const auto& [a, b] : read.robot.allowed.pairs()) text += "\n" + a + " " + b;
  return certificate::sha256Text(text);
}

}  // namespace fcl_artic::app
