// SPDX-License-Identifier: BSD-3-Clause
#include "planning/problems.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <limits>
#include <stdexcept>

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>
#include <nlohmann/json.hpp>

#include "files/files.h"

namespace fcl_artic::planning_data {
namespace {

using nlohmann::json;

/// @param use  called with what the file holds. @throws std::runtime_error naming the file, also for what is missing in
/// it.
template <typename F>
auto withJson(const std::filesystem::path& path, F&& use) {
  const std::string content = files::read(path);
  try {
    return use(json::parse(content));
  } catch (const std::exception& error) {
    throw std::runtime_error("'" + path.string() + "': " + error.what());
  }
}

std::shared_ptr<fcl::CollisionGeometryd> toGeometry(const json& obstacle) {
  const std::string type = obstacle.at("type");
  if (type == "box") {
    const std::array<double, 3> size = obstacle.at("size");
    return std::make_shared<fcl::Boxd>(size[0], size[1], size[2]);
  }
  if (type == "cylinder") return std::make_shared<fcl::Cylinderd>(obstacle.at("radius"), obstacle.at("length"));
  if (type == "sphere") return std::make_shared<fcl::Sphered>(obstacle.at("radius"));
  throw std::runtime_error("unknown obstacle type '" + type + "'");
}

fcl::Transform3d toPose(const json& obstacle) {
  const std::array<double, 3> p = obstacle.at("position");
  const std::array<double, 4> q = obstacle.at("quaternion_xyzw");
  fcl::Transform3d M = fcl::Transform3d::Identity();
  M.translation() << p[0], p[1], p[2];
  M.linear() = Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized().toRotationMatrix();
  return M;
}

int variable(const KinematicTree& tree, const std::string& joint) {
  for (int v = 0; v < tree.dof(); ++v) {
    if (tree.variableName(v) == joint) return v;
  }
  return -1;
}

/// A number that the file gives a problem. (The parser's own conversion cuts off what does not fit.)
int numberOf(const json& value) {
  const double number = value.is_number_integer() ? value.get<double>() : -1;
  if (!(number >= 0 && number <= std::numeric_limits<int>::max()))
    throw std::runtime_error("the number " + value.dump() + " of a problem is none of 0, 1, 2 ...");
  return static_cast<int>(number);
}

Edge readEdge(const json& given) {
  Edge edge;
  edge.problem = numberOf(given.at("problem"));
  given.at("from").get_to(edge.from);
  given.at("to").get_to(edge.to);
  return edge;
}

}  // namespace

const Problem& Environment::problem(int index) const {
  for (const Problem& p : problems) {
    if (p.index == index) return p;
  }
  throw std::runtime_error("environment " + name + " has no problem " + std::to_string(index));
}

Eigen::VectorXd Environment::configuration(const KinematicTree& tree, const std::vector<double>& values) const {
  if (values.size() != joints.size()) throw std::runtime_error("a wrong number of joint values");
  Eigen::VectorXd q = Eigen::VectorXd::Zero(tree.dof());
  for (const auto& [joint, value] : locked) q[variable(tree, joint)] = value;
  for (std::size_t i = 0; i < joints.size(); ++i) q[variable(tree, joints[i])] = values[i];
  return q;
}

Environment readEnvironment(const std::filesystem::path& path, const KinematicTree& tree) {
  return withJson(path, [&](const json& file) {
    Environment environment;
    environment.name = path.stem().string();
    file.at("joints").get_to(environment.joints);
    for (const std::string& joint : environment.joints) {
      if (variable(tree, joint) < 0) throw std::runtime_error("unknown joint '" + joint + "'");
    }
    for (const auto& [joint, value] : file.at("locked_joints").items()) {
      if (variable(tree, joint) >= 0) environment.locked[joint] = value;
    }
    for (const json& given : file.at("problems")) {
      Problem& problem = environment.problems.emplace_back();
      problem.index = numberOf(given.at("index"));
      given.at("start").get_to(problem.start);
      given.at("goal").get_to(problem.goal);
      for (const json& obstacle : given.at("obstacles")) {
        problem.scene.obstacles.push_back(
            {obstacle.at("name"), std::make_shared<fcl::CollisionObjectd>(toGeometry(obstacle), toPose(obstacle))});
      }
    }
    return environment;
  });
}

std::vector<Edge> readTrace(const std::filesystem::path& path) {
  return withJson(path, [](const json& file) {
    std::vector<Edge> edges;
    for (const json& given : file.at("edges")) {
      Edge& edge = edges.emplace_back(readEdge(given));
      file.at("environment").get_to(edge.environment);
      edge.hit = given.at("dense") == "hit";
      if (edge.hit) given.at("first_hit").get_to(edge.seen_at);
    }
    return edges;
  });
}

std::vector<Edge> readMissed(const std::filesystem::path& path) {
  return withJson(path, [](const json& file) {
    std::vector<Edge> edges;
    for (const json& given : file.at("edges")) {
      Edge& edge = edges.emplace_back(readEdge(given));
      given.at("environment").get_to(edge.environment);
      edge.hit = true;
      given.at("hit_at").get_to(edge.seen_at);
    }
    return edges;
  });
}

std::filesystem::path problemsPath(const std::filesystem::path& data, const std::string& robot,
                                   const std::string& environment) {
  return data / "problems" / (robot == "ur5_coarse" ? "ur5" : robot) / (environment + ".json");
}

std::vector<std::string> environmentsOf(const std::filesystem::path& data, const std::string& robot) {
  const std::filesystem::path folder = problemsPath(data, robot, "").parent_path();
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& file : std::filesystem::directory_iterator(folder, error)) {
    if (file.path().extension() == ".json") names.push_back(file.path().stem().string());
  }
  if (names.empty()) throw std::runtime_error("'" + folder.string() + "' has no problems");
  std::sort(names.begin(), names.end());
  return names;
}

Robot readRobot(const std::filesystem::path& data, const std::string& name) {
  const std::string base = (data / "robots" / name / name).string();
  Robot robot = loadUrdf(base + ".urdf");
  robot.allowed = loadSrdf(base + ".srdf", *robot.tree, &robot.notes);
  return robot;
}

std::shared_ptr<const ArticulatedCollisionManager> makeManager(const Robot& robot, const Scene& scene) {
  struct World {
    Robot robot;
    Scene scene;
    ArticulatedCollisionManager manager;
  };
  const auto world = std::make_shared<World>(World{robot, scene, ArticulatedCollisionManager(robot.tree)});
  world->robot.addTo(world->manager);
  world->scene.addTo(world->manager);
  world->manager.setup();
  return {world, &world->manager};
}

std::filesystem::path sharedData() {
  const char* folder = std::getenv("FCL_ARTIC_DATA");
  if (!folder) return {};
  const std::filesystem::path data = folder;
  for (const char* part : {"robots", "problems", "edges"}) {
    if (!std::filesystem::exists(data / part)) return {};
  }
  return data;
}

}  // namespace fcl_artic::planning_data
