// SPDX-License-Identifier: BSD-3-Clause
#include "world.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <memory>
#include <stdexcept>

#include <fmt/format.h>

#include "fcl_artic/solid_mesh.h"
#include "link_pairs.h"
#include "text/nearest_name.h"
#include "usage.h"

namespace fcl_artic::app {
namespace {

/// The object with its mesh as a solid.
/// @param name  of its link or obstacle.
std::shared_ptr<fcl::CollisionObjectd> solidOf(const fcl::CollisionObjectd& object, const std::string& name) {
  try {
    return std::make_shared<fcl::CollisionObjectd>(makeSolid(*object.collisionGeometry()), object.getTransform());
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(fmt::format("--solid {}: {}", name, error.what()));
  }
}

/// Makes the meshes of links or obstacles with these names solids.
/// @param namesOf  all names of an item of `bodies`, each of which has an `object`.
/// @param[in,out] names  those that are found are taken out.
template <class Bodies, class NamesOf>
void makeSolids(Bodies& bodies, const NamesOf& namesOf, std::set<std::string>& names) {
  std::set<std::string> found;
  for (auto& body : bodies) {
    bool asked = false;
    for (const std::string& name : namesOf(body)) {
      if (!names.count(name) || body.object->getObjectType() != fcl::OT_BVH) continue;
      if (!asked) body.object = solidOf(*body.object, name);
      asked = true;
      found.insert(name);
    }
  }
  for (const std::string& name : found) names.erase(name);
}

}  // namespace

std::string shellWord(const std::string& word) {
  const auto plain = [](unsigned char c) { return std::isalnum(c) || std::strchr("_-+=.,:/@%", c); };
  if (!word.empty() && std::all_of(word.begin(), word.end(), plain)) return word;
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

void addWorldOptions(CLI::App& verb, WorldOptions& o, const std::string& robot_names) {
  CLI::Option* srdf = addRobotOptions(verb, o.robot, robot_names);
  verb.add_option("--auto-srdf", o.auto_srdf,
                  "Find the pairs of links that need no check, proven apart or always in "
                  "contact, write them to FILE and use them")
      ->group("Robot and scene")
      ->type_name("FILE")
      ->excludes(srdf);
  verb.add_option("--scene", o.scenes,
                  "Obstacles: mesh, .urdf, MoveIt .scene, OctoMap .bt .ot, points .pcd "
                  ".ply .xyz; may be repeated")
      ->check(requireInput)
      ->allow_extra_args(false)
      ->group("Robot and scene")
      ->type_name("FILE");
  verb.add_option("--scale", o.scale, "Factor for all lengths of the scenes: 0.001 if they are in millimetres")
      ->check(requirePositive)
      ->group("Robot and scene")
      ->type_name("FACTOR")
      ->capture_default_str();
  verb.add_flag("--collada-up-axis", o.robot.collada_up_axis,
                "COLLADA and glTF meshes: turn what is up by the file to z; else, as in RViz, it stays as it stands")
      ->group("Robot and scene");
  verb.add_flag("--unknown-cells", o.unknown_cells, "OctoMap: unknown cells are obstacles too")
      ->group("Robot and scene");
  verb.add_option("--point-radius", o.point_radius, "Radius of the points of point clouds, m, whatever the scale")
      ->check(requirePositive)
      ->group("Robot and scene")
      ->type_name("RADIUS");
  verb.add_flag("--solid-meshes", o.robot.solid_meshes,
                "Meshes are solids: what lies within one touches it. They must be closed")
      ->group("Robot and scene");
  verb.add_option("--solid", o.solids, "Link or obstacle whose meshes are solids, and no others; may be repeated")
      ->allow_extra_args(false)
      ->group("Robot and scene")
      ->type_name("NAME");
  addAttachOption(verb, o.robot);
  addPairOptions(verb, o.pairs);
  addToleranceOptions(verb, o.tolerances, o.timed);
  verb.add_option("--proof-work", o.proof_work,
                  "Tests at most for the proof that one allowed pair of links never touches, as --work of srdf")
      ->group("Robot and scene")
      ->capture_default_str();
}

std::string shellArguments(const WorldOptions& o) {
  std::string text = shellWord(o.robot.robot);
  const auto add = [&](const char* option, const std::string& value) {
    if (!value.empty()) text += fmt::format(" {} {}", option, shellWord(value));
  };
  const auto addAll = [&](const char* option, const std::vector<std::string>& values) {
    for (const std::string& value : values) add(option, value);
  };
  const auto addFlag = [&](const char* option, bool set) {
    if (set) text += fmt::format(" {}", option);
  };
  addAll("--package", o.robot.packages);
  if (o.robot.srdf.empty()) {
    add("--auto-srdf", "/dev/null");
  } else {
    add("--srdf", o.robot.srdf);
  }
  if (!o.robot.base.empty()) text += " --base=" + shellWord(o.robot.base);  // may begin with a minus
  addFlag("--floating-base", o.robot.floating_base);
  addFlag("--virtual-joint", o.robot.virtual_joint);
  addAll("--scene", o.scenes);
  if (o.scale != 1) add("--scale", fmt::format("{}", o.scale));
  addFlag("--collada-up-axis", o.robot.collada_up_axis);
  addFlag("--import", o.robot.import_meshes);
  addFlag("--unknown-cells", o.unknown_cells);
  if (o.point_radius > 0) add("--point-radius", fmt::format("{}", o.point_radius));
  addFlag("--solid-meshes", o.robot.solid_meshes);
  addAll("--solid", o.solids);
  addAll("--attach", o.robot.attached);
  addAll("--margin-of", o.pairs.margins_of);
  addAll("--margin-pair", o.pairs.pair_margins);
  add("--margins", o.pairs.margins);
  addAll("--allow", o.pairs.allowed);
  addAll("--disallow", o.pairs.disallowed);
  addAll("--joint-tolerance", o.tolerances.joints);
  add("--base-tolerance", o.tolerances.base);
  addAll("--tolerance", o.tolerances.objects);
  addAll("--speed", o.tolerances.speeds);
  if (o.proof_work != WorldOptions().proof_work) add("--proof-work", fmt::format("{}", o.proof_work));
  return text;
}

static bool isVerifiersScene(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return ending == ".urdf" || ending == ".stl" || ending == ".obj";
}

std::string verifierArguments(const WorldOptions& o) {
  std::string text = " --urdf " + shellWord(o.robot.robot);
  const auto addAll = [&](const char* option, const std::vector<std::string>& values) {
    for (const std::string& value : values) text += fmt::format(" {} {}", option, shellWord(value));
  };
  const std::string& srdf = o.robot.srdf.empty() ? o.auto_srdf : o.robot.srdf;
  if (!srdf.empty() && o.pairs.allowed.empty()) addAll("--srdf", {srdf});
  if (std::all_of(o.scenes.begin(), o.scenes.end(), isVerifiersScene)) {
    addAll("--scene", o.scenes);
    if (o.scale != 1 && !o.scenes.empty()) text += fmt::format(" --scale {}", o.scale);
  }
  if (!o.robot.base.empty()) addAll("--base", {o.robot.base});
  addAll("--package", o.robot.packages);
  if (o.robot.solid_meshes) text += " --solid-meshes";
  addAll("--solid", o.solids);
  return text;
}

SceneOptions sceneOptions(const WorldOptions& options) {
  SceneOptions out = sceneOptions(options.robot);
  out.unknown_cells = options.unknown_cells;
  out.point_radius = options.point_radius;
  out.scale = options.scale;
  return out;
}

World::World(const WorldOptions& options)
    : options_(options),
      pairs_(readPairSettings(options.pairs)),
      tolerances_(readToleranceSettings(options.tolerances)),
      solids_(options.solids.begin(), options.solids.end()) {
  if (tolerances_.speeds.empty() || options.timed) return;
  throw std::invalid_argument(
      fmt::format("--speed: here each motion is asked by itself, as if '{}' had just been seen at its place, so free "
                  "would not hold for what comes after it: ask about whole plans with their times, by certify or check "
                  "--trajectory",
                  tolerances_.speeds.front().object));
}

void World::readRobot() {
  robot = app::readRobot(options_.robot);
  allowLinks();
  makeSolids(
      robot.geometry, [&](const LinkGeometry& g) { return std::vector{robot.tree->linkName(g.link)}; }, solids_);
}

/// Allowed pairs of two links are part of the robot: their proofs are made with the others.
void World::allowLinks() {
  for (const PairSettings::Said& said : pairs_.allowed) {
    if (robot.tree->hasLink(said.a) && robot.tree->hasLink(said.b)) robot.allowed.allow(said.a, said.b);
  }
}

LinkPairReport World::provePairs(double margin) {
  LinkPairOptions search;
  search.work = options_.proof_work;
  if (!options_.robot.srdf.empty()) {
    search.only = &robot.allowed;
    search.margin = margin;
    const LinkPairReport report = classify(robot, search);
    robot.proofs = report.proofs;
    for (const std::string& doubt : doubtsOf(*robot.tree, report, margin)) robot.notes.push_back(doubt);
    return report;
  }
  // Pairs that always touch are found without the margin: pairs that only come near stay checked.
  LinkPairReport report = classify(robot, search);
  robot.proofs = report.proofs;
  robot.allowed = report.alwaysTouching();
  allowLinks();
  if (!options_.auto_srdf.empty()) {
    unwritten.attempt([&] {
      writeSrdf(options_.auto_srdf, robot.tree->name(), report);
      robot.notes.push_back(fmt::format("{} written to {}", summaryOf(report), options_.auto_srdf));
    });
  }
  if (margin > 0) {
    AllowedCollisionMatrix apart;
    for (const LinkPairFinding& pair : report.pairs) {
      if (pair.kind == LinkPairKind::never) apart.allow(pair.link1, pair.link2);
    }
    search.only = &apart;
    search.margin = margin;
    robot.proofs = classify(robot, search).proofs;
  }
  return report;
}

void World::open(const CertifiedRequest& request) {
  readRobot();
  const bool allowed = !options_.robot.srdf.empty() && request.check_self;
  if (allowed || !options_.auto_srdf.empty()) provePairs(request.margin);
  readScene();
}

void World::readScene() {
  const KinematicTree& tree = *robot.tree;
  std::vector<Scene> scenes;
  const SceneOptions scene_options = sceneOptions(options_);
  SceneOptions carried_options = scene_options;
  carried_options.scale = 1;
  for (const std::string& path : options_.scenes) scenes.push_back(loadScene(path, scene_options));
  attachments = readAttachments(options_.robot, tree, carried_options, scenes);
  scene = combineScenes(scenes, tree);
  makeSolids(
      scene.obstacles,
      [](const Scene::Obstacle& o) {
        return std::vector{o.name, o.shape_of};
      },
      solids_);
  if (solids_.empty()) return;
  std::vector<std::string> names;
  for (const LinkGeometry& g : robot.geometry) names.push_back(tree.linkName(g.link));
  for (const Scene::Obstacle& o : scene.obstacles) names.push_back(o.name);
  throw std::invalid_argument(fmt::format("--solid {}: no link or obstacle of that name has a mesh{}", *solids_.begin(),
                                          text::didYouMean(*solids_.begin(), names)));
}

ArticulatedCollisionManager World::makeManager(const std::function<void(ArticulatedCollisionManager&)>& change) const {
  ArticulatedCollisionManager manager(robot.tree);
  robot.addTo(manager);
  scene.addTo(manager);
  attachLast(attachments, scene, manager);
  pairs_.apply(scene, manager);
  tolerances_.apply(scene, manager);
  if (change) change(manager);
  manager.setup();
  return manager;
}

std::vector<std::string> World::notes(const ArticulatedCollisionManager& manager) const {
  std::vector<std::string> notes = robot.notes;
  for (const std::string& note : manager.notes()) notes.push_back(note);
  notes.insert(notes.end(), scene.notes.begin(), scene.notes.end());
  for (const std::string& note : unitNotes(robot, scene)) notes.push_back(note);
  return notes;
}

}  // namespace fcl_artic::app
