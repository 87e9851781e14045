// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/continuous_collision.h>
#include <fcl/narrowphase/detail/conservative_advancement_func_matrix.h>
#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "children.h"
#include "exit_status.h"
#include "fcl_artic/continuous_collision.h"
#include "pairs/random_pairs.h"
#include "progress.h"
#include "tables.h"

namespace fcl_artic::app {
namespace {

using Json = nlohmann::ordered_json;
using pairs::Bodies;
using pairs::Judge;
using pairs::PairQuery;

// Limits within which an answer is right; printed in the help text. FCL's own tolerances are 1e-5 and 1e-4 m.
constexpr double kLate = 1e-4;       ///< in t
constexpr double kEarly = 1e-3;      ///< in t
constexpr double kNear = 1e-4;       ///< m
constexpr double kRounding = 1e-12;  ///< m

constexpr const char* kOursPrefix = "fcl_artic";  ///< how the names of this library's ways begin

struct CompareOptions {
  std::size_t queries = 200;
  std::uint64_t seed = 20040401;
  std::string set = "all";
  double limit_s = 10;
  bool json = false;
};

/// One way to answer a query. Called with fresh motions, at t = 0.
struct FclWay {
  std::string name;
  pairs::Volume volume;  ///< of the meshes: the one that suits it best
  std::function<TaskResult(const PairQuery&, const fcl::MotionBased&, const fcl::MotionBased&)> ask;
};

TaskResult answered(bool contact, double time) {
  TaskResult r;
  r.end = TaskResult::End::answered;
  r.contact = contact;
  r.time = contact ? time : 1;
  return r;
}

FclWay publicEntry(const std::string& name, pairs::Volume volume, const fcl::ContinuousCollisionRequestd& request) {
  return {name, volume, [request](const PairQuery& q, const fcl::MotionBased& m1, const fcl::MotionBased& m2) {
            fcl::ContinuousCollisionResultd result;
            const double toc =
                fcl::continuousCollide(q.body1->geometry.get(), &m1, q.body2->geometry.get(), &m2, request, result);
            TaskResult r = answered(result.is_collide, result.time_of_contact);
            if (toc < 0) r.end = TaskResult::End::refused;  // -1: nothing was done
            return r;
          }};
}

/// FCL's mesh routine that works, which the public entry never reaches.
TaskResult orientedAdvancement(const PairQuery& q, const fcl::MotionBased& m1, const fcl::MotionBased& m2) {
  using Model = fcl::BVHModel<fcl::RSSd>;
  fcl::CollisionResultd result;
  double toc = 1;
  const bool contact = fcl::detail::conservativeAdvancementMeshOriented<
      fcl::RSSd, fcl::detail::MeshConservativeAdvancementTraversalNodeRSS<double>>(
      static_cast<const Model&>(*q.body1->geometry), &m1, static_cast<const Model&>(*q.body2->geometry), &m2,
      fcl::CollisionRequestd(), result, toc);
  return answered(contact, toc);
}

TaskResult dropIn(const PairQuery& q, const fcl::MotionBased& m1, const fcl::MotionBased& m2) {
  fcl::ContinuousCollisionResultd result;
  fcl_artic::continuousCollide<double>(q.body1->geometry.get(), &m1, q.body2->geometry.get(), &m2,
                                       fcl::ContinuousCollisionRequestd(), result);
  return answered(result.is_collide, result.time_of_contact);
}

TaskResult certified(const PairQuery& q, const fcl::MotionBased& m1, const fcl::MotionBased& m2,
                     const CertifiedPairRequest& request) {
  CertifiedPairResult result;
  fcl_artic::continuousCollide(q.body1->geometry.get(), &m1, q.body2->geometry.get(), &m2, request, result);
  TaskResult r = answered(result.status != Status::free, result.t_lower);
  r.upper = result.t_upper;
  r.certain = result.certain;
  return r;
}

TaskResult standard(const PairQuery& q, const fcl::MotionBased& m1, const fcl::MotionBased& m2) {
  return certified(q, m1, m2, {});
}

TaskResult redon2004(const PairQuery& q, const fcl::MotionBased& m1, const fcl::MotionBased& m2) {
  CertifiedPairRequest request;
  request.method = Method::redon2004;
  return certified(q, m1, m2, request);
}

/// FCL's ways, then this library's.
std::vector<FclWay> waysFor(Bodies bodies) {
  fcl::ContinuousCollisionRequestd naive(1000), advance;
  advance.ccd_solver_type = fcl::CCDC_CONSERVATIVE_ADVANCEMENT;
  // Static checks of RSS trees copy both meshes each time, so naive stepping gets the volumes that are fastest for it.
  constexpr auto kRss = pairs::Volume::rss, kObbRss = pairs::Volume::obbrss;
  std::vector<FclWay> ways{publicEntry("FCL, defaults (naive, 10 steps)", kObbRss, {}),
                           publicEntry("FCL naive, 1000 steps", kObbRss, naive)};
  if (bodies == Bodies::meshes) {
    ways.push_back(publicEntry("FCL conservative advancement", kRss, advance));
    ways.push_back({"FCL oriented advancement, internal", kRss, orientedAdvancement});
  } else {
    ways.push_back(publicEntry("FCL conservative adv., libccd", kRss, advance));
    advance.gjk_solver_type = fcl::GST_INDEP;
    ways.push_back(publicEntry("FCL conservative adv., indep", kRss, advance));
  }
  ways.push_back({kOursPrefix, kRss, dropIn});
  // Curved shapes the paper's method leaves to the library's own.
  if (bodies == Bodies::meshes) ways.push_back({kOursPrefix + std::string(", method redon2004"), kRss, redon2004});
  return ways;
}

/// Runs a way on all queries, in children. The time is the lesser one of two runs.
std::vector<TaskResult> runWay(const FclWay& way, const std::vector<PairQuery>& queries, double limit_s,
                               const std::function<void(std::size_t)>& done) {
  return runInChildren(
      queries.size(), limit_s,
      [&](std::size_t i) {
        TaskResult result;
        double least = 1e300;
        for (int pass = 0; pass < 2; ++pass) {
          const auto motion1 = queries[i].path1->motion(), motion2 = queries[i].path2->motion();
          const auto begin = std::chrono::steady_clock::now();
          result = way.ask(queries[i], *motion1, *motion2);
          least = std::min(least,
                           std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin).count());
        }
        result.elapsed_us = least;
        return result;
      },
      done);
}

/// Facts about one query.
struct QueryTruth {
  bool hit = false;
  double time = 1;
  double gap = 0;  ///< least sampled one
};

/// Sampled truth. A contact that the library shows and the samples have passed over counts too, if the judge finds the
/// bodies in contact at the time it names. The library's word alone counts nothing.
QueryTruth know(const PairQuery& query, const TaskResult& certified, std::size_t& added) {
  const Judge judge(query);
  const pairs::Truth truth = judge.firstContact();
  const bool sooner = !truth.hit || certified.upper < truth.time - kLate / 100;
  if (certified.certain && sooner && judge.at(certified.upper, 1e-6).gap <= kRounding) {
    ++added;
    return {true, certified.upper, 0};
  }
  return {truth.hit, truth.time, truth.gap};
}

enum Grade { right, late, early, missed, false_contact, refused, crashed, timed_out, grades };
constexpr std::array<const char*, grades> kGrades{"right", "late",    "early",   "missed",
                                                  "false", "refused", "crashed", "timed out"};

Grade grade(const PairQuery& query, const QueryTruth& known, const TaskResult& r) {
  if (r.end == TaskResult::End::refused) return refused;
  if (r.end == TaskResult::End::crashed) return crashed;
  if (r.end == TaskResult::End::timed_out) return timed_out;
  if (!r.contact) return known.hit ? missed : right;
  // Not a number is no time.
  if (!(r.time >= 0 && r.time <= 1)) return known.hit ? late : false_contact;
  if (known.hit && r.time > known.time + kLate) return late;
  if (known.hit && r.time >= known.time - kEarly) return right;
  if (Judge(query).at(r.time, 0.01).gap <= kNear) return right;  // that near, contact is a matter of tolerance
  return known.hit ? early : false_contact;
}

struct Score {
  std::string way;
  std::array<std::size_t, grades> count{};
  double median_us = 0, p95_us = 0;
};

struct SetReport {
  std::string name;
  std::size_t queries = 0, hits = 0, starts = 0, grazes = 0, added = 0;
  std::vector<Score> scores;
};

SetReport compareSet(const std::string& name, Bodies bodies, const CompareOptions& options,
                     const std::function<void(double)>& progress) {
  SetReport report;
  report.name = name;
  report.queries = options.queries;
  const std::vector<FclWay> ways = waysFor(bodies);
  const double parts = static_cast<double>(ways.size()) + 2;
  std::vector<PairQuery> queries;
  const auto show = [&](double part, std::size_t done) {
    progress((part + static_cast<double>(done) / static_cast<double>(options.queries)) / parts);
  };
  for (std::size_t i = 0; i < options.queries; ++i, show(0, i)) {
    queries.push_back(pairs::referencePair(bodies, options.seed, i));
  }
  std::vector<PairQuery> obbrss;
  for (const PairQuery& q : queries) obbrss.push_back(pairs::withVolume(q, pairs::Volume::obbrss));
  const auto brackets = runWay({"", pairs::Volume::rss, standard}, queries, options.limit_s, {});
  std::vector<QueryTruth> known;
  for (std::size_t i = 0; i < queries.size(); ++i, show(1, i)) {
    known.push_back(know(queries[i], brackets[i], report.added));
    report.hits += known[i].hit;
    report.starts += known[i].hit && known[i].time == 0;
    report.grazes += !known[i].hit && known[i].gap <= 1e-3;
  }
  for (std::size_t w = 0; w < ways.size(); ++w) {
    Score score;
    score.way = ways[w].name;
    const auto results = runWay(ways[w], ways[w].volume == pairs::Volume::obbrss ? obbrss : queries, options.limit_s,
                                [&](std::size_t i) { show(2 + static_cast<double>(w), i); });
    std::vector<double> us;
    for (std::size_t i = 0; i < queries.size(); ++i) {
      ++score.count[grade(queries[i], known[i], results[i])];
      if (results[i].end == TaskResult::End::answered) us.push_back(results[i].elapsed_us);
    }
    std::sort(us.begin(), us.end());
    if (!us.empty()) {
      score.median_us = us[us.size() / 2];
      score.p95_us = us[std::min(us.size() - 1, us.size() * 95 / 100)];
    }
    report.scores.push_back(score);
  }
  return report;
}

std::size_t widthOf(const std::string& column) {
  return std::max<std::size_t>(6, column.size() + 1);
}

std::string textOf(const SetReport& r) {
  std::string out =
      fmt::format("{}: {} queries, {} touch ({} at the start), {} stay clear ({} of them nearer than 1 mm)\n", r.name,
                  r.queries, r.hits, r.starts, r.queries - r.hits, r.grazes);
  out += fmt::format("  {:<34}", "");
  for (const char* name : kGrades) out += fmt::format("{:>{}}", name, widthOf(name));
  out += fmt::format("{:>11}{:>10}\n", "median us", "p95 us");
  for (const Score& s : r.scores) {
    out += fmt::format("  {:<34}", s.way);
    for (std::size_t g = 0; g < s.count.size(); ++g) out += fmt::format("{:>{}}", s.count[g], widthOf(kGrades[g]));
    const bool timed = s.p95_us > 0;
    out += timed ? fmt::format("{:>11.1f}{:>10.1f}\n", s.median_us, s.p95_us) : fmt::format("{:>11}{:>10}\n", "-", "-");
  }
  if (r.added)
    out += fmt::format("  In {} queries fcl_artic showed a contact that the samples had missed or found later.\n",
                       r.added);
  return out;
}

Json jsonOf(const SetReport& r) {
  Json ways = Json::array();
  for (const Score& s : r.scores) {
    Json way{{"way", s.way}};
    for (std::size_t g = 0; g < grades; ++g)
      way[kGrades[g] == std::string("timed out") ? "timed_out" : kGrades[g]] = s.count[g];
    way["median_us"] = s.median_us;
    way["p95_us"] = s.p95_us;
    ways.push_back(way);
  }
  return {{"set", r.name},      {"queries", r.queries},          {"hits", r.hits}, {"starts", r.starts},
          {"grazes", r.grazes}, {"shown_by_fcl_artic", r.added}, {"ways", ways}};
}

int runCompare(const CompareOptions& options) {
  const std::vector<std::pair<std::string, Bodies>> sets{
      {"meshes", Bodies::meshes}, {"shapes", Bodies::shapes}, {"mixed", Bodies::mixed}};
  std::vector<SetReport> reports;
  {
    ProgressBar bar;
    const double asked = options.set == "all" ? 3 : 1;
    for (const auto& [name, bodies] : sets) {
      if (options.set != "all" && options.set != name) continue;
      const double before = static_cast<double>(reports.size());
      reports.push_back(compareSet(name, bodies, options, [&](double share) { bar.show((before + share) / asked); }));
    }
  }
  bool good = true;
  Json all{{"seed", options.seed}, {"sets", Json::array()}};
  for (const SetReport& r : reports) {
    for (const Score& s : r.scores) {
      if (s.way.rfind(kOursPrefix, 0) == 0) good = good && s.count[right] == r.queries;
    }
    all["sets"].push_back(jsonOf(r));
    if (!options.json) fmt::print("{}\n", textOf(r));
  }
  if (options.json) fmt::print("{}\n", all.dump(2));
  return good ? kExitFree : kExitContact;
}

}  // namespace

void addCompare(CLI::App& program, int& exit_status) {
  auto options = std::make_shared<CompareOptions>();
  CompareOptions& o = *options;
  CLI::App* compare =
      program.add_subcommand("compare", "How often are FCL's ways of continuous collision right, and this library?");
  compare->footer(
      "Two random bodies move by fcl::InterpMotion, turning by up to 180 degrees; half of the queries move both, a "
      "quarter\n"
      "only just touch or miss. Every answer comes from a child process. Truth is dense sampling by a judge of its "
      "own,\n"
      "closing in on every near miss; contacts that only fcl_artic shows count when the judge confirms them.\n"
      "  right      the contact's time is at most 1e-4 late and 1e-3 early, or the bodies are within 1e-4 m at that "
      "time;\n"
      "             or free, and nothing touches\n"
      "  late, early, missed, false   otherwise\n"
      "  refused    FCL returned -1, or something was thrown\n"
      "Times are of the answered queries, the lesser one of two runs each.\n"
      "Exit status: 0 fcl_artic was right throughout, by either method, 1 it was not, 2 error.");
  compare->add_option("--queries", o.queries, "Queries of each set")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  compare->add_option("--seed", o.seed, "The same seed asks the same queries")->capture_default_str();
  compare->add_option("--set", o.set, "meshes (12 to 2,000 triangles), shapes, mixed (a mesh and a shape), or all")
      ->check(CLI::IsMember({"meshes", "shapes", "mixed", "all"}))
      ->capture_default_str();
  compare->add_option("--time-limit", o.limit_s, "Seconds that one query may take")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  compare->add_flag("--json", o.json, "Answer in JSON");
  compare->callback([options, &exit_status] { exit_status = runCompare(*options); });
}

}  // namespace fcl_artic::app
