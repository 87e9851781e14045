// SPDX-License-Identifier: BSD-3-Clause
//
// Edges that a planner asked for: a Panda amid boxes and cylinders, world and self collision together, first contact
// bracketed to 2^-12 of the edge. FCL_ARTIC_DATA names the folder with robots/, problems/ and edges/. The edges come
// labelled by dense sampling with FCL: every one that was seen to collide must be reported, not later than sampling saw it.
//
// Exit status 1 when a collision is missed or reported late.

#include <cstdlib>
#include <deque>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <memory>
#include <stdexcept>

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "fcl_artic/urdf/urdf.h"
#include "options.h"

using namespace fcl_artic;
using namespace fcl_artic::bench;
using nlohmann::json;

namespace {

constexpr Answer kFree = 2;

json readJson(const std::filesystem::path& path) {
  std::ifstream in(path);
  if (!in) throw std::runtime_error("cannot read " + path.string());
  return json::parse(in);
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

/// One problem's scene, ready for queries.
struct World {
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> obstacles;
  std::unique_ptr<ArticulatedCollisionManager> manager;
};

struct Edge {
  const World* world;
  JointMotion motion;
  double seen_at;  ///< first sample in collision, an upper bound of the first contact; kFree when none was seen
  std::string name;
};

/// The problems of one environment: start and goal joints by name, the rest locked.
class Environment {
 public:
  Environment(const Robot& robot, const json& problems) : tree_(*robot.tree), locked_(Eigen::VectorXd::Zero(tree_.dof())) {
    for (const std::string name : problems.at("joints")) variables_.push_back(variable(name));
    for (const auto& [name, value] : problems.at("locked_joints").items()) {
      const JointId joint = tree_.jointId(name);
      if (!tree_.joint(joint).mimics) locked_[tree_.jointVariable(joint)] = value;
    }
    for (const json& problem : problems.at("problems")) {
      World& world = worlds_[problem.at("index")];
      world.manager = std::make_unique<ArticulatedCollisionManager>(robot.tree);
      robot.addTo(*world.manager);
      for (const json& obstacle : problem.at("obstacles")) {
        world.obstacles.push_back(std::make_unique<fcl::CollisionObjectd>(toGeometry(obstacle), toPose(obstacle)));
        world.manager->registerObject(world.obstacles.back().get(), obstacle.at("name"));
      }
      world.manager->setup();
    }
  }

  Edge edge(const json& given, double seen_at, const std::string& name) const {
    return {&worlds_.at(given.at("problem")),
            JointMotion::linear(tree_, configuration(given.at("from")), configuration(given.at("to"))), seen_at, name};
  }

 private:
  int variable(const std::string& joint) const { return tree_.jointVariable(tree_.jointId(joint)); }
  Eigen::VectorXd configuration(const std::vector<double>& values) const {
    if (values.size() != variables_.size()) throw std::runtime_error("an edge with a wrong number of joint values");
    Eigen::VectorXd q = locked_;
    for (std::size_t i = 0; i < values.size(); ++i) q[variables_[i]] = values[i];
    return q;
  }

  const KinematicTree& tree_;
  Eigen::VectorXd locked_;
  std::vector<int> variables_;
  std::map<int, World> worlds_;
};

/// Verdicts beside the labels.
struct Agreement {
  std::size_t hit = 0, missed = 0, late = 0, free = 0, rejected = 0, uncertain = 0;
};

}  // namespace

int main(int argc, char** argv) try {
  Report report("bench_panda");
  CLI::App app("Certified queries on a planner's edges (FCL_ARTIC_DATA names the data)");
  int passes = 3;
  app.add_option("--passes", passes, "passes over the edges; the least time of each counts")
      ->check(CLI::PositiveNumber)->capture_default_str();
  if (const auto status = readOptions(app, report, argc, argv)) return *status;
  const char* data_variable = std::getenv("FCL_ARTIC_DATA");
  if (!data_variable || !std::filesystem::exists(std::filesystem::path(data_variable) / "edges")) {
    std::cout << "bench_panda skipped: FCL_ARTIC_DATA does not name a folder with robots/, problems/ and edges/\n";
    return 0;
  }
  const std::filesystem::path data = data_variable;

  Robot robot = loadUrdf((data / "robots/panda/panda.urdf").string());
  robot.allowed = loadSrdf((data / "robots/panda/panda.srdf").string(), *robot.tree);

  CertifiedRequest request;
  request.tolerance_time = 0x1p-12;
  request.tolerance_distance = 1e-5;
  CertifiedResult result;
  // First contact: its lower bound. Any contact: where one is proven.
  const auto ask = [&](const Edge& edge, ContactMode mode) -> Answer {
    request.mode = mode;
    edge.world->manager->continuousCollide(edge.motion, request, result);
    if (result.status == Status::undecided) throw std::runtime_error("a query without a budget ended undecided");
    return result.status == Status::contact ? (mode == ContactMode::any ? result.t_upper : result.t_lower) : kFree;
  };

  std::map<std::string, Agreement> agreements;                       // by method
  std::map<std::pair<std::string, std::string>, Measured> all;       // by method and set
  const auto addMode = [&](const std::string& environment, const std::string& set, const std::vector<Edge>& edges,
                           ContactMode mode, const char* method) {
    report.add("panda " + environment, set, method, [&, set, mode, method] {
      Measured measured = measure(edges.size(), passes, [&](std::size_t i) { return ask(edges[i], mode); });
      for (std::size_t i = 0; i < edges.size(); ++i) {
        ask(edges[i], mode);
        addCounters(measured.row, result.statistics);
        const bool seen = edges[i].seen_at <= 1, reported = measured.answers[i] <= 1;
        const bool late = seen && reported && mode == ContactMode::first && measured.answers[i] > edges[i].seen_at;
        Agreement& agreement = agreements[method];
        agreement.hit += seen;
        agreement.free += !seen;
        agreement.missed += seen && !reported;
        agreement.late += late;
        agreement.rejected += !seen && reported;
        agreement.uncertain += reported && !result.certain;
        if (seen && !reported) report.note(edges[i].name + ": MISSED, seen at " + std::to_string(edges[i].seen_at));
        if (late) report.note(fmt::format("{}: LATE, {} after {}", edges[i].name, measured.answers[i], edges[i].seen_at));
        if (!seen && reported) {
          report.note(fmt::format("{}: labelled free, contact{} at {:.6f} between {} and {}", edges[i].name,
                                  result.certain ? " proven" : " not excluded", result.t_lower,
                                  result.contacts.at(0).body1.name, result.contacts.at(0).body2.name));
        }
      }
      Measured& sum = all[{method, set}];
      sum.answers.insert(sum.answers.end(), measured.answers.begin(), measured.answers.end());
      sum.us.insert(sum.us.end(), measured.us.begin(), measured.us.end());
      return measured;
    });
  };
  const auto add = [&](const std::string& environment, const std::string& set, const std::vector<Edge>& edges) {
    addMode(environment, set, edges, ContactMode::first, "fcl_artic, first contact");
    addMode(environment, set, edges, ContactMode::any, "fcl_artic, any contact");
  };

  std::deque<Environment> environments;
  std::deque<std::vector<Edge>> kept;
  std::map<std::string, const Environment*> by_name;
  for (const char* name : {"bookshelf_small", "bookshelf_tall", "bookshelf_thin", "box", "cage", "table_pick",
                           "table_under_pick", "thin"}) {
    const Environment& environment =
        environments.emplace_back(robot, readJson(data / "problems/panda" / (std::string(name) + ".json")));
    by_name[name] = &environment;
    auto& free = kept.emplace_back();
    auto& hit = kept.emplace_back();
    int number = 0;
    const json trace = readJson(data / "edges" / fmt::format("panda_trace.{}.json", name));
    for (const json& given : trace.at("edges")) {
      const bool seen = given.at("dense") == "hit";
      (seen ? hit : free).push_back(environment.edge(given, seen ? given.at("first_hit").get<double>() : kFree,
                                                    fmt::format("{} edge {}", name, number++)));
    }
    add(name, "free", free);
    add(name, "hit", hit);
  }
  auto& missed_by_sampling = kept.emplace_back();
  int number = 0;
  const json trace = readJson(data / "edges/panda_missed.json");
  for (const json& given : trace.at("edges")) {
    missed_by_sampling.push_back(by_name.at(given.at("environment"))->edge(
        given, given.at("hit_at"), fmt::format("missed edge {}", number++)));
  }
  add("missed by 1 %", "hit", missed_by_sampling);

  report.run();
  for (auto& [of, measured] : all) {
    measured.row.scene = "panda ALL";
    measured.row.method = of.first;
    measured.row.set = of.second;
    measured.row.passes = passes;
    summarise(measured);
    report.addRow(measured.row);
  }
  std::size_t faults = 0;
  for (const auto& [method, agreement] : agreements) {
    report.note(fmt::format("{}: labelled hit {}: missed {}, late {}; labelled free {}: rejected {}; uncertain contacts {}",
                            method, agreement.hit, agreement.missed, agreement.late, agreement.free, agreement.rejected,
                            agreement.uncertain));
    faults += agreement.missed + agreement.late;
  }
  const int status = report.finish();
  return faults > 0 ? 1 : status;
} catch (const std::exception& error) {
  std::cerr << "bench_panda: " << error.what() << '\n';
  return 1;
}
