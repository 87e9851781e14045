// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include "averages.h"
#include "certification.h"
#include "exit_status.h"
#include "files/files.h"
#include "outputs.h"
#include "plan_options.h"
#include "planning/fcl_state_check.h"
#include "planning/plans.h"
#include "progress.h"
#include "tables.h"

namespace fcl_artic::app {
namespace {

using namespace planning_data;

constexpr double kCertifyResolution = 0.01;  // OMPL's default, of the space's extent
constexpr int kPasses = 3;                   // of which the fastest counts

struct CertifyTableOptions : PlanOptions {
  double mend_seconds = 5;  ///< for mending one
  std::string plans;  ///< file or folder of another planner's plans, each named ENVIRONMENT/PROBLEM; empty: plan here
};

struct PlanRow {
  std::string environment;
  int problem = 0, seed = 0;
  std::size_t waypoints = 0;
  Status verdict = Status::undecided;
  bool sampled = false;  ///< FCL sees it collide
  double us = 0;
  bool mended = false, mended_sampled = false;
  double mend_ms = 0, deviation = 0, length_ratio = 1;
  std::string not_mended;
};

class CertifyBench {
 public:
  explicit CertifyBench(const CertifyTableOptions& options)
      : options_(options), robot_(planning_data::readRobot(options.data, options.robot)) {}

  void run() {
    std::vector<CertifiedPlan> given;
    std::vector<std::string> notes;  // what else a folder holds is of no concern here
    if (!options_.plans.empty()) given = readPlans(*robot_.tree, {options_.plans}, std::nullopt, {}, notes);
    std::vector<std::string> names = options_.environments;
    if (names.empty()) names = environmentsOf(options_.data, options_.robot);
    std::size_t taken = 0;
    ProgressBar bar;
    for (std::size_t e = 0; e < names.size(); ++e) {
      const Environment environment =
          readEnvironment(problemsPath(options_.data, options_.robot, names[e]), *robot_.tree);
      std::size_t problems = environment.problems.size();
      if (given.empty()) problems = std::min(problems, static_cast<std::size_t>(options_.problems));
      for (std::size_t i = 0; i < problems; ++i) {
        const Problem& problem = environment.problems[i];
        if (given.empty()) {
          planAndLook(environment, problem);
        } else {
          taken += lookAtGiven(environment, problem, given);
        }
        bar.show((static_cast<double>(e) + static_cast<double>(i + 1) / static_cast<double>(problems)) /
                 static_cast<double>(names.size()));
      }
    }
    if (options_.environments.empty() && taken < given.size()) {
      throw std::runtime_error(fmt::format(
          "{}: {} of {} plans name no problem of {}'s: each needs a name ENVIRONMENT/PROBLEM, such as \"{}/1\"",
          options_.plans, given.size() - taken, given.size(), options_.robot, names.front()));
    }
  }

  /// No plan certified free is seen to collide.
  bool sound() const {
    return std::none_of(rows_.begin(), rows_.end(),
                        [](const PlanRow& r) { return (r.sampled && r.verdict == Status::free) || r.mended_sampled; });
  }

  std::string table() const {
    std::string out = fmt::format(
        "{}: {}, certified and mended\n\n"
        "{:<{}}{:>7}{:>10}{:>11}{:>9}{:>12}{:>12}{:>10}{:>10}{:>11}{:>10}{:>8}\n",
        options_.robot,
        options_.plans.empty() ? "plans of RRTConnect over FCL at OMPL's default of 1 %, simplified"
                               : "plans of " + options_.plans,
        "environment", nameWidth(), "plans", "sampling", "certify", "missed", "median us", "slowest us", "mended",
        "median ms", "deviation", "longer", "hidden");
    std::vector<std::string> names;
    for (const PlanRow& row : rows_) {
      if (std::find(names.begin(), names.end(), row.environment) == names.end()) names.push_back(row.environment);
    }
    if (names.size() > 1) names.emplace_back("ALL");
    for (const std::string& name : names) out += tableRow(name);
    return out +
           "\nsampling: plans that collide as FCL sees in steps 100 times finer than OMPL's default; certify: that "
           "touch, "
           "as\nis proven or cannot be excluded; missed: seen to collide and certified free; mended: of those that "
           "touch,\ncertified again; median ms, deviation (rad, of any joint), longer (length by that of the plan): of "
           "these,\nmedians; hidden: mended ones that are seen to collide\n";
  }

  std::string csv() const {
    std::string out =
        "robot,environment,problem,seed,waypoints,sampled,verdict,us,mended,mended_sampled,mend_ms,deviation,length_"
        "ratio,not_mended\n";
    for (const PlanRow& r : rows_) {
      out += fmt::format("{},{},{},{},{},{:d},{},{:.3f},{:d},{:d},{:.3f},{:.6g},{:.6g},\"{}\"\n", options_.robot,
                         r.environment, r.problem, r.seed, r.waypoints, r.sampled, toString(r.verdict), r.us, r.mended,
                         r.mended_sampled, r.mend_ms, r.deviation, r.length_ratio, r.not_mended);
    }
    return out;
  }

 private:
  void planAndLook(const Environment& environment, const Problem& problem) {
    const planning::PlanningSetup ours = setUp(robot_, environment, problem);
    const auto theirs = discreteOverFcl(robot_, environment, problem, kCertifyResolution);
    for (int seed = 1; seed <= options_.seeds; ++seed) {
      const Plans made = plan(theirs, ours, problem.start, problem.goal, static_cast<unsigned>(seed), options_.seconds,
                              options_.range);
      if (!made.solved) continue;
      CertifiedPlan one;
      one.plan.positions = made.simplified;
      look(environment, problem, seed, ours, one);
    }
  }

  /// @return how many of the given plans are for this problem.
  std::size_t lookAtGiven(const Environment& environment, const Problem& problem,
                          const std::vector<CertifiedPlan>& given) {
    const std::string name = fmt::format("{}/{}", environment.name, problem.index);
    std::optional<planning::PlanningSetup> ours;
    int count = 0;
    for (const CertifiedPlan& each : given) {
      if (each.plan.name.substr(each.plan.name.find_last_of(' ') + 1) != name) continue;  // after "line 3 "
      if (!ours) ours = setUp(robot_, environment, problem);
      CertifiedPlan one = each;
      look(environment, problem, ++count, *ours, one);
    }
    return static_cast<std::size_t>(count);
  }

  void look(const Environment& environment, const Problem& problem, int seed, const planning::PlanningSetup& ours,
            CertifiedPlan& one) {
    FclStateCheck check(robot_, problem.scene);
    const auto collides = [&](const Way& way) {
      return firstSample(ours, way, [&](const std::vector<double>& q) {
               return check.collides(environment.configuration(*robot_.tree, q));
             }) >= 0;
    };
    CertifyOptions options;
    options.motion.interpolation = plans::Interpolation::linear;
    options.motion.ignore_limits = true;  // the data's own starts are beyond some
    if (one.plan.joints.empty()) one.plan.joints = environment.joints;
    if (one.plan.joints != environment.joints) {
      throw std::runtime_error(
          fmt::format("{}: its joints are not {}, in this order", one.title(), fmt::join(environment.joints, ", ")));
    }
    one.plan.state = environment.locked;
    for (int pass = 0; pass < kPasses; ++pass) {
      const double least = one.us;
      certify(*ours.manager, options, one);
      if (!one.error.empty()) throw std::runtime_error(fmt::format("{}: {}", one.title(), one.error));
      if (pass > 0) one.us = std::min(one.us, least);
    }
    PlanRow row;
    row.environment = environment.name;
    row.problem = problem.index;
    row.seed = seed;
    row.waypoints = one.plan.positions.size();
    row.sampled = collides(one.plan.positions);
    row.us = one.us;
    row.verdict = one.result.status;
    std::vector<CertifiedPlan> all{one};
    MendOptions mending;
    mending.seconds = options_.mend_seconds;
    mendAll(ours.manager, options, mending, all);
    row.not_mended = all[0].not_mended;
    if (const auto& again = all[0].as_mended) {
      row.mended = again->exitStatus() == kExitFree;
      if (!row.mended) row.not_mended = "certified again: not free";
      row.mended_sampled = row.mended && collides(again->plan.positions);
      row.mend_ms = all[0].mended->ms;
      row.deviation = all[0].mended->deviation;
      row.length_ratio = all[0].mended->length_ratio;
    }
    rows_.push_back(std::move(row));
  }

  std::size_t nameWidth() const {
    std::size_t width = 17;
    for (const PlanRow& row : rows_) width = std::max(width, row.environment.size());
    return width + 1;
  }

  std::string tableRow(const std::string& environment) const {
    std::size_t plans = 0, sampled = 0, touching = 0, missed = 0, mended = 0, hidden = 0;
    std::vector<double> us, ms, deviation, longer;
    for (const PlanRow& r : rows_) {
      if (environment != "ALL" && r.environment != environment) continue;
      ++plans;
      sampled += r.sampled;
      touching += r.verdict == Status::contact;
      missed += r.sampled && r.verdict == Status::free;
      mended += r.mended;
      hidden += r.mended_sampled;
      us.push_back(r.us);
      if (!r.mended) continue;
      ms.push_back(r.mend_ms);
      deviation.push_back(r.deviation);
      longer.push_back(r.length_ratio);
    }
    return fmt::format("{:<{}}{:>7}{:>10}{:>11}{:>9}{:>12.1f}{:>12.1f}{:>10}{:>10.1f}{:>11.3f}{:>10.3f}{:>8}\n",
                       environment, nameWidth(), plans, sampled, touching, missed, median(us),
                       us.empty() ? 0 : *std::max_element(us.begin(), us.end()), mended, median(ms), median(deviation),
                       median(longer), hidden);
  }

  const CertifyTableOptions& options_;
  Robot robot_;
  std::vector<PlanRow> rows_;
};

int runCertifyPlans(CertifyTableOptions& o) {
  removeEarlierOutputs({{"--csv", &o.csv}}, {o.plans});
  CertifyBench bench(o);
  bench.run();
  fmt::print("{}", bench.table());
  if (!o.csv.empty()) files::write(o.csv, bench.csv());
  return bench.sound() ? kExitFree : kExitContact;
}

}  // namespace

void addCertifyPlans(CLI::App& program, int& exit_status) {
  auto options = std::make_shared<CertifyTableOptions>();
  CertifyTableOptions& o = *options;
  CLI::App* verb = program.add_subcommand(
      "certify",
      "Plans of RRTConnect at OMPL's default resolution, or another planner's: how many collide, what certify\n"
      "finds and mends");
  verb->footer(
      "Every plan is certified, looked at by FCL in steps 100 times finer than OMPL's default, and mended where it\n"
      "touches. --plans takes plans that any planner made for these problems: each has the name ENVIRONMENT/PROBLEM,\n"
      "with the problem's index as its file has it, as in the JSON line\n"
      "{\"name\": \"box/1\", \"waypoints\": [[...], [...]]}\n"
      "Exit status: 0, 1 a plan certified free is seen to collide, 2 error.");
  addPlanOptions(*verb, o);
  verb->add_option("--plans", o.plans,
                   "Plans of another planner in place of RRTConnect's: a file or folder in a format that certify\n"
                   "reads; straight between waypoints")
      ->check(CLI::ExistingPath)
      ->excludes("--problems")
      ->excludes("--seeds")
      ->type_name("FILE");
  verb->add_option("--mend-time", o.mend_seconds, "Seconds to mend a plan")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  verb->callback([options, &exit_status] { exit_status = runCertifyPlans(*options); });
}

}  // namespace fcl_artic::app
