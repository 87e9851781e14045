// SPDX-License-Identifier: BSD-3-Clause
#include "roadmap/roadmap_verb.h"

#include <chrono>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "edges/inputs.h"
#include "elapsed.h"
#include "exit_status.h"
#include "files/files.h"
#include "outputs.h"
#include "plans/motion.h"
#include "plans/plan.h"
#include "plans/variables.h"
#include "query_options.h"
#include "roadmap/roadmap.h"
#include "text/counted.h"
#include "usage.h"
#include "world.h"

namespace fcl_artic::app {
namespace {

struct RoadmapVerb {
  WorldOptions world;
  CertifiedRequest request;
  RoadmapOptions make;
  std::string given, roadmap, out;
  bool valid_only = false, any = false;
};

/// The waypoints of a file's plans, which name all joints.
std::vector<Eigen::VectorXd> readConfigurations(const KinematicTree& tree, const std::string& path) {
  std::vector<Eigen::VectorXd> configurations;
  const auto fail = [&](const std::string& why) { throw std::invalid_argument(fmt::format("'{}': {}", path, why)); };
  for (const plans::Plan& plan : plans::parsePlans(tree, files::read(path), plans::formatOf(path))) {
    if (!plan.error.empty()) fail(plan.error);
    printNotes(plans::notesOf(plan, false), "'" + path + "'");
    std::vector<int> variables;  // of the columns
    std::vector<bool> given(static_cast<std::size_t>(tree.dof()), plan.joints.empty());
    for (int v = 0; plan.joints.empty() && v < tree.dof(); ++v) variables.push_back(v);
    for (const std::string& joint : plan.joints) {
      variables.push_back(plans::variableOf(tree, joint, fmt::format("'{}'", path)));
      if (given[static_cast<std::size_t>(variables.back())]) fail(fmt::format("joint '{}' is there twice", joint));
      given[static_cast<std::size_t>(variables.back())] = true;
    }
    for (int v = 0; v < tree.dof(); ++v) {
      if (given[static_cast<std::size_t>(v)]) continue;
      fail(fmt::format("it has no joint '{}': a roadmap's configurations are of all joints", tree.variableName(v)));
    }
    for (const std::vector<double>& row : plan.positions) {
      if (row.size() != variables.size())
        fail(fmt::format("a row has {} for {}", text::counted(row.size(), "value"),
                         text::counted(variables.size(), "joint")));
      Eigen::VectorXd q(tree.dof());
      for (std::size_t j = 0; j < row.size(); ++j) q[variables[j]] = row[j];
      configurations.push_back(std::move(q));
    }
  }
  return configurations;
}

/// Refuses configurations beyond the joints' limits, and notes those that are beyond by no more than the tolerance.
/// @param configurationOf  of a number below `count`.
template <class F>
void judgeLimits(const KinematicTree& tree, const char* what, std::size_t count, const F& configurationOf) {
  plans::LimitJudge limits(tree);
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::VectorXd q = configurationOf(i);
    for (int v = 0; v < tree.dof(); ++v) {
      const std::string why = limits.refusal(v, q[v]);
      if (!why.empty()) throw std::invalid_argument(fmt::format("roadmap: {} {}: {}", what, i, why));
    }
  }
  printNotes(limits.notes(), fmt::format("of {}", what));
}

/// Removes files of an earlier run, which must not be taken for this run's.
void removeEarlier(RoadmapVerb& o) {
  requireRoadmapEnding(o.out);
  std::vector<std::string> inputs = inputsOf(o.world);
  for (const std::string& file : {o.given, o.roadmap}) {
    if (!file.empty()) inputs.push_back(file);
  }
  std::string vertices = verticesFileOf(o.out);
  removeEarlierOutputs({{"--out", &o.out}, {"--out's vertices", &vertices}, {"--auto-srdf", &o.world.auto_srdf}},
                       inputs);
}

int make(RoadmapVerb& o) {
  removeEarlier(o);
  World world(o.world);
  world.open(o.request);
  const KinematicTree& tree = *world.robot.tree;
  if (!o.given.empty()) o.make.given = readConfigurations(tree, o.given);
  judgeLimits(tree, "given configuration", o.make.given.size(), [&](std::size_t i) { return o.make.given[i]; });
  const ArticulatedCollisionManager manager = world.makeManager();
  printNotes(world.notes(manager));
  const auto begin = Clock::now();
  std::size_t tried = 0;
  Roadmap roadmap = makeRoadmap(manager, o.request, o.make, tried);
  roadmap.robot = robotHash(world);
  const double seconds = secondsSince(begin);
  world.unwritten.attempt([&] { writeRoadmap(roadmap, o.out, false); });
  fmt::print("{}, {} of {} proven free, in {:.1f} s: {}\n", text::counted(roadmap.numVertices(), "vertex", "vertices"),
             roadmap.numEdges(), text::counted(tried, "edge"), seconds, o.out);
  return world.unwritten.exitStatus(kExitFree);
}

int certify(RoadmapVerb& o) {
  removeEarlier(o);
  World world(o.world);
  world.open(o.request);
  Roadmap roadmap = readRoadmap(o.roadmap, *world.robot.tree);
  judgeLimits(*world.robot.tree, "vertex", roadmap.numVertices(),
              [&](std::size_t i) { return roadmap.configuration(i); });
  const ArticulatedCollisionManager manager = world.makeManager();
  printNotes(world.notes(manager));
  bool proven = false;  // something of all edges, before
  if (o.request.check_self) {
    // The proof from when the roadmap was made holds for every scene, if the robot is the same and the margin no
    // larger.
    const bool same = roadmap.robot == robotHash(world);
    const bool holds = roadmap.self_proven && same && o.request.margin <= roadmap.self_margin;
    if (!holds) {
      fmt::print(stderr, "fcl_artic: note: links are checked against links again: {}\n",
                 roadmap.changed        ? "the roadmap was changed since it was made"
                 : !roadmap.self_proven ? "the roadmap was made without that"
                 : !same                ? "the roadmap is of another robot, other allowed pairs or another load"
                         : fmt::format("the roadmap was made for a margin of {} m", roadmap.self_margin));
    }
    o.request.check_self = !holds;
    proven = holds;
  }
  if (o.any) o.request.mode = ContactMode::any;
  const auto begin = Clock::now();
  const bool checked = certifyRoadmap(manager, o.request, o.make.threads, roadmap);
  const double seconds = secondsSince(begin);
  world.unwritten.attempt([&] { writeRoadmap(roadmap, o.out, o.valid_only); });
  Counts counts;
  counts.add(roadmap.answers);
  fmt::print("{} in {:.3f} s: {} free, {} contact, {} undecided: {}\n", text::counted(roadmap.numEdges(), "edge"),
             seconds, counts[RowStatus::free], counts[RowStatus::contact], counts[RowStatus::undecided], o.out);
  int status = kExitFree;
  if (roadmap.numEdges() == 0 || !(checked || proven)) {
    fmt::print("NOTHING CHECKED: {}\n",
               roadmap.numEdges() == 0 ? "the roadmap has no edge" : "no two bodies are asked about");
    status = kExitUndecided;
  }
  if (counts[RowStatus::undecided] > 0) status = worseExit(status, kExitUndecided);
  if (counts[RowStatus::contact] > 0) status = worseExit(status, kExitContact);
  return world.unwritten.exitStatus(status);
}

constexpr const char* kStatuses =
    "Exit status: of make 0 it is made; of certify that of the worst edge, whether it is written or not: 0 all free\n"
    "(proven), 1 contact, 3 undecided (budget) or nothing checked, 1 before 3; of both 2 error.";

void addCommon(CLI::App& verb, RoadmapVerb& o) {
  addWorldOptions(verb, o.world, "--robot,--urdf");
  addQueryOptions(verb, o.request);
  verb.remove_option(verb.get_option("--ignore-initial-contact"));  // edges are gone along both ways
  verb.add_option("--threads", o.make.threads, "Threads at most; 0: as many as the machine runs at once")
      ->check(CLI::NonNegativeNumber)
      ->group("Query")
      ->capture_default_str();
}

}  // namespace

void addRoadmap(CLI::App& program, int& exit_status) {
  CLI::App* roadmap = program.add_subcommand(
      "roadmap", "A probabilistic roadmap of a robot: made once, proven free again in each new scene");
  roadmap->require_subcommand(1);
  roadmap->footer("fcl_artic roadmap make --help and fcl_artic roadmap certify --help say more.\n" +
                  std::string(kStatuses));

  auto making = std::make_shared<RoadmapVerb>();
  CLI::App* make_verb = roadmap->add_subcommand(
      "make",
      "Draw configurations, join the nearest ones; what is not proven free, of links against links, is left out");
  make_verb->footer(kStatuses);
  addCommon(*make_verb, *making);
  make_verb->add_option("--vertices", making->make.vertices, "Configurations")
      ->check(CLI::PositiveNumber)
      ->group("Roadmap")
      ->capture_default_str();
  make_verb->add_option("--neighbours", making->make.neighbours, "Nearest configurations that each is joined with")
      ->check(CLI::PositiveNumber)
      ->group("Roadmap")
      ->capture_default_str();
  make_verb->add_option("--seed", making->make.seed, "The same seed draws the same configurations")
      ->group("Roadmap")
      ->capture_default_str();
  make_verb
      ->add_option("--with", making->given,
                   "Configurations that become the first vertices: the waypoints of plans, as `certify` takes them")
      ->check(requireInput)
      ->group("Roadmap")
      ->type_name("FILE");
  make_verb->add_option("--out", making->out, "File to write: .h5, .graphml or .csv")->required()->group("Output");
  make_verb->callback([making, &exit_status] { exit_status = make(*making); });

  auto asking = std::make_shared<RoadmapVerb>();
  CLI::App* certify_verb = roadmap->add_subcommand(
      "certify", "Which edges of a roadmap are free in a scene, and when the others touch first");
  certify_verb->footer(kStatuses);
  certify_verb->add_option("ROADMAP", asking->roadmap, "File of `roadmap make`, .h5")->required()->check(requireInput);
  addCommon(*certify_verb, *asking);
  certify_verb->add_flag("--any", asking->any, "Any contact, not the first: cheaper where only the verdict matters")
      ->group("Query");
  certify_verb->add_flag("--valid-only", asking->valid_only, "Write only edges that are proven free")->group("Output");
  certify_verb->add_option("--out", asking->out, "File to write: .h5, .graphml or .csv")->required()->group("Output");
  certify_verb->callback([asking, &exit_status] { exit_status = certify(*asking); });
}

}  // namespace fcl_artic::app
