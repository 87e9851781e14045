// SPDX-License-Identifier: BSD-3-Clause
//
// Edges that a planner asked for: a Panda amid boxes and cylinders, world and self collision together, first contact
// bracketed to 2^-12 of the edge. FCL_ARTIC_DATA names the folder with robots/, problems/ and edges/. The edges come
// labelled by dense sampling with FCL: every one that was seen to collide must be reported, not later than sampling saw
// it.
//
// Exit status 1 when a collision is missed or reported late.

#include <algorithm>
#include <chrono>
#include <ctime>
#include <deque>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>

#include "options.h"
#include "planning/problems.h"

using namespace fcl_artic;
using namespace fcl_artic::bench;
using namespace fcl_artic::planning_data;

namespace {

constexpr Answer kFree = 2;

/// A motion in the scene of its problem.
struct Asked {
  std::shared_ptr<const ArticulatedCollisionManager> manager;
  JointMotion motion;
  double seen_at;  ///< first sample in collision, an upper bound of the first contact; kFree when none was seen
  std::string name;
};

/// The problems of one environment, set up.
class Worlds {
 public:
  Worlds(const Robot& robot, const std::filesystem::path& problems)
      : tree_(*robot.tree), environment_(readEnvironment(problems, *robot.tree)) {
    for (const Problem& problem : environment_.problems) managers_[problem.index] = makeManager(robot, problem.scene);
  }

  Asked ask(const Edge& edge, const std::string& name) const {
    return {managers_.at(edge.problem),
            JointMotion::linear(tree_, environment_.configuration(tree_, edge.from),
                                environment_.configuration(tree_, edge.to)),
            edge.seen_at, name};
  }

 private:
  const KinematicTree& tree_;
  Environment environment_;
  std::map<int, std::shared_ptr<const ArticulatedCollisionManager>> managers_;
};

/// Motions of one scene as batches over 1, 2, 4 ... threads, in turn; the least times of the passes count. On a machine
/// that others use too, the processors' time for a motion tells what threads cost each other.
void noteThreads(Report& report, const std::vector<Asked>& edges, const CertifiedRequest& request, int passes) {
  constexpr std::size_t kMotions = 8000;
  std::vector<JointMotion> motions;
  for (std::size_t i = 0; motions.size() < kMotions; ++i) {
    const Asked& edge = edges[i % edges.size()];
    if (edge.manager == edges[0].manager) motions.push_back(edge.motion);
  }
  using Clock = std::chrono::steady_clock;
  const int most = static_cast<int>(std::thread::hardware_concurrency());
  std::map<int, double> seconds, busy;
  const auto least = [](std::map<int, double>& times, int threads, double s) {
    times[threads] = times.count(threads) ? std::min(times[threads], s) : s;
  };
  std::vector<CertifiedResult> results;
  for (int pass = 0; pass < passes; ++pass) {
    for (int threads = 1; threads <= std::max(1, most); threads *= 2) {
      const auto begin = Clock::now();
      const std::clock_t used = std::clock();
      edges[0].manager->continuousCollide(motions, request, results, threads);
      least(busy, threads, static_cast<double>(std::clock() - used) / CLOCKS_PER_SEC);
      least(seconds, threads, std::chrono::duration<double>(Clock::now() - begin).count());
    }
  }
  for (const auto& [threads, s] : seconds) {
    report.note(fmt::format(
        "batch of {} motions over {} thread{}: {:.0f} motions per second, {:.2f} times those of one; {:.2f} us of "
        "processors' time each",
        kMotions, threads, threads == 1 ? "" : "s", kMotions / s, seconds[1] / s, 1e6 * busy[threads] / kMotions));
  }
}

/// Verdicts beside the labels.
struct Agreement {
  std::size_t hit = 0, missed = 0, late = 0, free = 0, rejected = 0, uncertain = 0;
};

}  // namespace

int main(int argc, char** argv) try {
  Report report("bench_panda");
  CLI::App app("Certified queries on a planner's edges (FCL_ARTIC_DATA names the data)");
  int passes = 3;
  app.add_option("--passes", passes, "passes over the edges at least; the least time of each counts")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  if (const auto status = readOptions(app, report, argc, argv)) return *status;
  const std::filesystem::path data = sharedData();
  if (data.empty()) {
    std::cout << "bench_panda skipped: FCL_ARTIC_DATA does not name a folder with robots/, problems/ and edges/\n";
    return 0;
  }
  const Robot robot = readRobot(data, "panda");

  CertifiedRequest request;
  request.tolerance_time = 0x1p-12;
  request.tolerance_distance = 1e-5;
  CertifiedResult result;
  // First contact: its lower bound. Any contact: where one is proven.
  const auto ask = [&](const Asked& edge, ContactMode mode) -> Answer {
    request.mode = mode;
    request.max_contacts = mode == ContactMode::any ? 0 : 1;  // a planner's question: the verdict
    edge.manager->continuousCollide(edge.motion, request, result);
    if (result.status == Status::undecided) throw std::runtime_error("a query without a budget ended undecided");
    return result.status == Status::contact ? (mode == ContactMode::any ? result.t_upper : result.t_lower) : kFree;
  };

  std::map<std::string, Agreement> agreements;                  // by method
  std::map<std::pair<std::string, std::string>, Measured> all;  // by method and set
  const auto addMode = [&](const std::string& environment, const std::string& set, const std::vector<Asked>& edges,
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
        if (late)
          report.note(fmt::format("{}: LATE, {} after {}", edges[i].name, measured.answers[i], edges[i].seen_at));
        if (!seen && reported) {
          const CertifiedContact* const c = result.first();
          const std::string pair = c ? fmt::format(" between {} and {}", c->body1.name, c->body2.name) : "";
          report.note(fmt::format("{}: labelled free, contact{} at {:.6f}{}", edges[i].name,
                                  result.certain ? " proven" : " not excluded", result.t_lower, pair));
        }
      }
      Measured& sum = all[{method, set}];
      sum.answers.insert(sum.answers.end(), measured.answers.begin(), measured.answers.end());
      sum.us.insert(sum.us.end(), measured.us.begin(), measured.us.end());
      return measured;
    });
  };
  const auto add = [&](const std::string& environment, const std::string& set, const std::vector<Asked>& edges) {
    addMode(environment, set, edges, ContactMode::first, "fcl_artic, first contact");
    addMode(environment, set, edges, ContactMode::any, "fcl_artic, any contact");
    if (set != "free") return;
    report.add("panda " + environment, set, "fcl_artic, clearance", [&] {
      return measure(edges.size(), passes, [&](std::size_t i) -> Answer {
        const Clearance clearance = edges[i].manager->clearance(edges[i].motion);
        if (!clearance.within_tolerance) throw std::runtime_error(edges[i].name + ": the clearance stays open");
        return kFree + clearance.lower;
      });
    });
  };

  std::map<std::string, Worlds> worlds;
  std::deque<std::vector<Asked>> kept;
  for (const std::string name : {"bookshelf_small", "bookshelf_tall", "bookshelf_thin", "box", "cage", "table_pick",
                                 "table_under_pick", "thin"}) {
    const Worlds& here = worlds.try_emplace(name, robot, data / "problems/panda" / (name + ".json")).first->second;
    auto& free = kept.emplace_back();
    auto& hit = kept.emplace_back();
    int number = 0;
    for (const Edge& edge : readTrace(data / "edges" / fmt::format("panda_trace.{}.json", name))) {
      (edge.hit ? hit : free).push_back(here.ask(edge, fmt::format("{} edge {}", name, number++)));
    }
    add(name, "free", free);
    add(name, "hit", hit);
  }
  auto& missed_by_sampling = kept.emplace_back();
  int number = 0;
  for (const Edge& edge : readMissed(data / "edges/panda_missed.json")) {
    missed_by_sampling.push_back(worlds.at(edge.environment).ask(edge, fmt::format("missed edge {}", number++)));
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
  if (!kept.front().empty()) {
    request.mode = ContactMode::any;
    noteThreads(report, kept.front(), request, passes);
  }
  std::size_t faults = 0;
  for (const auto& [method, agreement] : agreements) {
    report.note(fmt::format(
        "{}: labelled hit {}: missed {}, late {}; labelled free {}: rejected {}; uncertain contacts {}", method,
        agreement.hit, agreement.missed, agreement.late, agreement.free, agreement.rejected, agreement.uncertain));
    faults += agreement.missed + agreement.late;
  }
  const int status = report.finish();
  return faults > 0 ? 1 : status;
} catch (const std::exception& error) {
  std::cerr << "bench_panda: " << error.what() << '\n';
  return 1;
}
