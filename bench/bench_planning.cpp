// SPDX-License-Identifier: BSD-3-Clause
//
// What a planner pays for a motion: through the manager, through OMPL's checkMotion() with our validator, and through
// OMPL's own discrete validator (1 %, the end point first, then bisection) over FCL's check of a state, on the same
// edges in one run. (Whole plans: `bench_tables planning`.) FCL_ARTIC_DATA names the folder with robots/, problems/ and
// edges/.
//
// Exit status 1 when an edge that was seen to collide is accepted.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iostream>
#include <map>
#include <memory>
#include <random>
#include <stdexcept>

#include <fmt/format.h>
#include <ompl/base/ScopedState.h>
#include <ompl/util/Console.h>

#include "fcl_artic/ompl/planning_setup.h"
#include "options.h"
#include "planning/plans.h"
#include "random_motion.h"

using namespace fcl_artic;
using namespace fcl_artic::bench;
using namespace fcl_artic::planning_data;
using fcl_artic::planning::PlanningSetup;
namespace ob = ompl::base;

namespace {

constexpr Answer kFree = 2;
constexpr const char* kEnvironments[] = {
    "bookshelf_small", "bookshelf_tall", "bookshelf_thin", "box", "cage", "table_pick", "table_under_pick", "thin"};

/// One problem, set up for us and for FCL over the same space.
struct World {
  PlanningSetup ours;
  ob::SpaceInformationPtr fcl;  ///< OMPL's own motion validator at its default resolution

  World(const Robot& robot, const Environment& environment, const Problem& problem)
      : ours(setUp(robot, environment, problem)), fcl(discreteOverFcl(robot, environment, problem, 0.01)) {}
};

/// A motion, ready for every way of asking.
struct Query {
  const World* world;
  Eigen::VectorXd q0, q1;
  std::shared_ptr<ob::ScopedState<>> s1, s2;
  double seen_at;

  Query(const World& w, const Environment& environment, const KinematicTree& tree, const std::vector<double>& from,
        const std::vector<double>& to, double seen)
      : world(&w),
        q0(environment.configuration(tree, from)),
        q1(environment.configuration(tree, to)),
        s1(std::make_shared<ob::ScopedState<>>(w.ours.space)),
        s2(std::make_shared<ob::ScopedState<>>(w.ours.space)),
        seen_at(seen) {
    w.ours.setState(s1->get(), from);
    w.ours.setState(s2->get(), to);
  }
};

struct Method {
  const char* name;
  std::function<Answer(const Query&)> ask;
};

std::vector<Method> methods() {
  const auto through = [](ContactMode mode) {
    return [mode, result = std::make_shared<CertifiedResult>()](const Query& query) -> Answer {
      CertifiedRequest request = planning::planningRequest();
      request.mode = mode;
      const ArticulatedCollisionManager& manager = *query.world->ours.manager;
      manager.continuousCollide(JointMotion::linear(manager.tree(), query.q0, query.q1), request, *result);
      return result->isFree() ? kFree : mode == ContactMode::first ? result->t_lower : 0;
    };
  };
  return {{"manager, any contact", through(ContactMode::any)},
          {"manager, first within 1/4096", through(ContactMode::first)},
          {"checkMotion",
           [](const Query& query) -> Answer {
             return query.world->ours.si->checkMotion(query.s1->get(), query.s2->get()) ? kFree : 0;
           }},
          {"checkMotion with lastValid",
           [](const Query& query) -> Answer {
             std::pair<ob::State*, double> last{nullptr, kFree};
             query.world->ours.si->checkMotion(query.s1->get(), query.s2->get(), last);
             return last.second;
           }},
          {"state check of the end",
           [](const Query& query) -> Answer { return query.world->ours.si->isValid(query.s2->get()) ? kFree : 1; }},
          {"FCL, state check of the end",
           [](const Query& query) -> Answer { return query.world->fcl->isValid(query.s2->get()) ? kFree : 1; }},
          {"FCL, OMPL's 1 %", [](const Query& query) -> Answer {
             return query.world->fcl->checkMotion(query.s1->get(), query.s2->get()) ? kFree : 0;
           }}};
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::nth_element(values.begin(), values.begin() + static_cast<long>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

/// Edges with all ways of asking, measured in turns when the first is asked for.
struct Edges {
  std::vector<Query> queries;
  std::vector<Method> methods;
  std::vector<Measured> results;

  const std::vector<Measured>& measured(int passes) {
    if (results.empty()) {
      std::vector<std::function<Answer(std::size_t)>> ways;
      for (const Method& method : methods) {
        ways.push_back([this, &method](std::size_t i) { return method.ask(queries[i]); });
      }
      results = measureInTurns(queries.size(), passes, ways);
    }
    return results;
  }
};

/// All that one program run collects.
class Bench {
 public:
  Bench(Report& report, int passes) : report_(report), passes_(passes) {}

  void add(const std::string& scene, const std::string& set, std::vector<Query> given) {
    if (given.empty()) return;
    adapted_.insert(adapted_.end(), given.begin(), given.end());
    const auto edges = std::make_shared<Edges>(Edges{std::move(given), methods(), {}});
    for (std::size_t m = 0; m < edges->methods.size(); ++m) {
      const char* method = edges->methods[m].name;
      report_.add(scene, set, method, [this, scene, set, edges, m, method] {
        const Measured& measured = edges->measured(passes_)[m];
        judge(scene + " " + set, method, edges->queries, measured);
        us_[{scene, set}][method] = measured.us;
        for (const double us : measured.us) all_us_[set][method].push_back(us);
        return measured;
      });
    }
  }

  void notes() {
    for (const auto& [where, by_method] : us_) note(where.first + " " + where.second, by_method);
    for (const auto& [set, by_method] : all_us_) note("ALL " + set, by_method);
    report_.note(fmt::format(
        "seen to collide and accepted by us: {}; reported later than seen: {}; labelled free and rejected: {} of {}",
        missed_, late_, rejected_, free_));
    report_.note(fmt::format("two states read and their motion made, mean: {:.3f} us", mappingTime()));
    report_.note(
        fmt::format("FCL at OMPL's 1 % accepts {} edges on which contact is proven or seen", sampling_missed_));
  }
  /// What the adapter does before the manager is asked, us per motion; making a JointMotion from joint values is part
  /// of it.
  double mappingTime() const {
    std::map<const World*, planning::JointMapping> mappings;
    for (const Query& query : adapted_) {
      const PlanningSetup& setup = query.world->ours;
      mappings.try_emplace(query.world, *setup.space, setup.manager->sharedTree(), setup.joints);
    }
    double sum = 0, us = 1e9;
    for (int pass = 0; pass < passes_; ++pass) {
      const auto begin = std::chrono::steady_clock::now();
      for (const Query& query : adapted_) {
        sum += mappings.at(query.world).motion(query.s1->get(), query.s2->get()).coefficients()(0, 1);
      }
      us = std::min(us, std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin).count());
    }
    benchmark::DoNotOptimize(sum);
    return us / static_cast<double>(adapted_.size());
  }
  bool sound() const { return missed_ + late_ == 0; }

 private:
  void judge(const std::string& where, const std::string& method, const std::vector<Query>& queries,
             const Measured& measured) {
    if (method.find("state check") != std::string::npos) return;
    for (std::size_t i = 0; i < queries.size(); ++i) {
      const bool seen = queries[i].seen_at <= 1, free = measured.answers[i] == kFree;
      if (method.rfind("FCL", 0) == 0) {
        sampling_missed_ += seen && free;
        continue;
      }
      missed_ += seen && free;
      late_ += seen && !free && measured.answers[i] > queries[i].seen_at;
      if (method != "checkMotion") continue;
      free_ += !seen;
      rejected_ += !seen && !free;
      if (!seen && !free) report_.note(fmt::format("{} edge {}: labelled free, rejected", where, i));
    }
  }

  void note(const std::string& where, const std::map<std::string, std::vector<double>>& us) {
    const auto find = [&](const char* method) { return us.count(method) ? us.at(method) : std::vector<double>(); };
    const std::vector<double> any = find("manager, any contact"), check = find("checkMotion"),
                              fcl = find("FCL, OMPL's 1 %");
    if (any.empty() || check.size() != any.size() || fcl.size() != any.size()) return;
    std::vector<double> adapter;
    for (std::size_t i = 0; i < any.size(); ++i) adapter.push_back(check[i] - any[i]);
    report_.note(
        fmt::format("{}: FCL's median is {:.0f} times the manager's, {:.0f} times checkMotion's; checkMotion adds "
                    "{:.2f} us (median)",
                    where, median(fcl) / median(any), median(fcl) / median(check), median(adapter)));
  }

  Report& report_;
  int passes_;
  std::vector<Query> adapted_;
  std::map<std::pair<std::string, std::string>, std::map<std::string, std::vector<double>>> us_;
  std::map<std::string, std::map<std::string, std::vector<double>>> all_us_;
  std::size_t missed_ = 0, late_ = 0, rejected_ = 0, free_ = 0, sampling_missed_ = 0;
};

/// Motions of a length between states that we prove free, among an environment's scenes.
void addRandom(Bench& bench, const std::string& name, const Robot& robot, const Environment& environment,
               const std::map<int, World>& worlds, std::size_t count, double length) {
  std::mt19937 random(7);
  std::vector<Query> free, hit;
  const KinematicTree& tree = *robot.tree;
  for (int tries = 0; tries < 200000 && (free.size() < count || hit.size() < count); ++tries) {
    auto world = worlds.begin();
    std::advance(world, tries % static_cast<int>(worlds.size()));
    bool within = false;
    const Ends ends = randomEnds(tree, environment.joints, length, random, within);
    if (!within) continue;
    Query query(world->second, environment, tree, ends.from, ends.to, kFree);
    const ob::SpaceInformation& si = *world->second.ours.si;
    if (!si.isValid(query.s1->get()) || !si.isValid(query.s2->get())) continue;
    std::vector<Query>& set = si.checkMotion(query.s1->get(), query.s2->get()) ? free : hit;
    if (set.size() < count) set.push_back(query);
  }
  bench.add(name, "random free", std::move(free));
  // Contact is proven or can't be excluded: nothing sampled stands behind these.
  for (Query& query : hit) query.seen_at = 1;
  bench.add(name, "random hit", std::move(hit));
}

}  // namespace

int main(int argc, char** argv) try {
  Report report("bench_planning");
  CLI::App app("A planner's motions beside OMPL's discrete validator over FCL (FCL_ARTIC_DATA names the data)");
  int passes = 3;
  std::size_t random = 200;
  bool no_other_robots = false;
  app.add_option("--passes", passes, "passes over the edges at least; the least time of each counts")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--random", random, "random motions of each kind for the UR5 and the Fanuc")->capture_default_str();
  app.add_flag("--panda-only", no_other_robots, "leave out the UR5 and the Fanuc");
  if (const auto status = readOptions(app, report, argc, argv)) return *status;
  const std::filesystem::path data = sharedData();
  if (data.empty()) {
    std::cout << "bench_planning skipped: FCL_ARTIC_DATA does not name a folder with robots/, problems/ and edges/\n";
    return 0;
  }
  ompl::msg::noOutputHandler();

  Bench bench(report, passes);
  std::map<std::string, Robot> robots;
  std::map<std::string, Environment> environments;
  std::map<std::string, std::map<int, World>> worlds;
  const auto prepare = [&](const std::string& key, const std::string& robot, const std::string& problems) {
    if (!robots.count(robot)) robots[robot] = readRobot(data, robot);
    environments[key] = readEnvironment(data / "problems" / (problems + ".json"), *robots[robot].tree);
  };
  const auto open = [&](const std::string& key, const std::string& robot) {
    for (const Problem& problem : environments[key].problems) {
      worlds[key].try_emplace(problem.index, robots[robot], environments[key], problem);
    }
  };

  for (const std::string name : kEnvironments) {
    prepare(name, "panda", "panda/" + name);
    open(name, "panda");
    std::vector<Query> free, hit;
    for (const Edge& edge : readTrace(data / "edges" / ("panda_trace." + name + ".json"))) {
      (edge.hit ? hit : free)
          .emplace_back(worlds[name].at(edge.problem), environments[name], *robots["panda"].tree, edge.from, edge.to,
                        edge.seen_at);
    }
    bench.add("panda " + name, "free", std::move(free));
    bench.add("panda " + name, "hit", std::move(hit));
  }
  std::vector<Query> missed;
  for (const Edge& edge : readMissed(data / "edges/panda_missed.json")) {
    missed.emplace_back(worlds[edge.environment].at(edge.problem), environments[edge.environment],
                        *robots["panda"].tree, edge.from, edge.to, edge.seen_at);
  }
  bench.add("panda missed by 1 %", "hit", std::move(missed));

  if (!no_other_robots && random > 0) {
    prepare("ur5", "ur5", "ur5/table_pick");
    open("ur5", "ur5");
    addRandom(bench, "ur5 table_pick", robots["ur5"], environments["ur5"], worlds["ur5"], random, 2.7);
    // The Fanuc has no problems of its own: it stands where the Panda does.
    prepare("panda for fanuc", "panda", "panda/table_pick");
    robots["fanuc"] = readRobot(data, "fanuc_m10ia");
    Environment& fanuc = environments["fanuc"] = environments["panda for fanuc"];
    fanuc.locked.clear();
    fanuc.joints.clear();
    for (int v = 0; v < robots["fanuc"].tree->dof(); ++v) fanuc.joints.push_back(robots["fanuc"].tree->variableName(v));
    open("fanuc", "fanuc");
    addRandom(bench, "fanuc table_pick", robots["fanuc"], fanuc, worlds["fanuc"], random, 2.7);
  }

  report.run();
  bench.notes();
  const int status = report.finish();
  return bench.sound() ? status : 1;
} catch (const std::exception& error) {
  std::cerr << "bench_planning: " << error.what() << '\n';
  return 1;
}
