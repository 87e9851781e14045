// SPDX-License-Identifier: BSD-3-Clause
#include "certify_bench.h"

#include <algorithm>

#include <fmt/format.h>

#include "certification.h"
#include "exit_status.h"
#include "files/files.h"
#include "planning/fcl_state_check.h"
#include "planning/plans.h"
#include "progress.h"

namespace fcl_artic::app {
namespace {

using namespace planning_data;

constexpr double kResolution = 0.01;  // OMPL's default, of the space's extent
constexpr int kPasses = 3;            // of which the fastest counts

struct Row {
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

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

class Bench {
 public:
  explicit Bench(const CertifyBenchOptions& options)
      : options_(options), robot_(readRobot(options.data, options.robot)) {}

  void run() {
    std::vector<std::string> names = options_.environments;
    if (names.empty()) names = environmentsOf(options_.data, options_.robot);
    ProgressBar bar;
    for (std::size_t e = 0; e < names.size(); ++e) {
      const Environment environment =
          readEnvironment(problemsPath(options_.data, options_.robot, names[e]), *robot_.tree);
      const std::size_t problems = std::min(environment.problems.size(), static_cast<std::size_t>(options_.problems));
      for (std::size_t i = 0; i < problems; ++i) {
        runProblem(environment, environment.problems[i]);
        bar.show((static_cast<double>(e) + static_cast<double>(i + 1) / static_cast<double>(problems)) /
                 static_cast<double>(names.size()));
      }
    }
  }

  /// No plan certified free is seen to collide.
  bool sound() const {
    return std::none_of(rows_.begin(), rows_.end(),
                        [](const Row& r) { return (r.sampled && r.verdict == Status::free) || r.mended_sampled; });
  }

  std::string table() const {
    std::string out = fmt::format(
        "{}: plans of RRTConnect over FCL at OMPL's default of 1 %, simplified, certified and "
        "mended\n\n{:<18}{:>7}{:>10}"
        "{:>11}{:>9}{:>12}{:>12}{:>10}{:>10}{:>11}{:>10}{:>8}\n",
        options_.robot, "environment", "plans", "sampling", "certify", "missed", "median us", "slowest us", "mended",
        "median ms", "deviation", "longer", "hidden");
    std::vector<std::string> names;
    for (const Row& row : rows_) {
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
    for (const Row& r : rows_) {
      out += fmt::format("{},{},{},{},{},{:d},{},{:.3f},{:d},{:d},{:.3f},{:.6g},{:.6g},\"{}\"\n", options_.robot,
                         r.environment, r.problem, r.seed, r.waypoints, r.sampled, toString(r.verdict), r.us, r.mended,
                         r.mended_sampled, r.mend_ms, r.deviation, r.length_ratio, r.not_mended);
    }
    return out;
  }

 private:
  void runProblem(const Environment& environment, const Problem& problem) {
    const planning::PlanningSetup ours = setUp(robot_, environment, problem);
    FclStateCheck check(robot_, problem.scene);
    const auto theirs = discreteOverFcl(robot_, environment, problem, kResolution);
    const auto collides = [&](const Way& way) {
      return firstSample(ours, way, [&](const std::vector<double>& q) {
               return check.collides(environment.configuration(*robot_.tree, q));
             }) >= 0;
    };
    CertifyOptions options;
    options.motion.ignore_limits = true;  // the data's own starts are beyond some
    for (int seed = 1; seed <= options_.seeds; ++seed) {
      const Plans made = plan(theirs, ours, problem.start, problem.goal, static_cast<unsigned>(seed), options_.seconds);
      if (!made.solved) continue;
      Row row;
      row.environment = environment.name;
      row.problem = problem.index;
      row.seed = seed;
      row.waypoints = made.simplified.size();
      row.sampled = collides(made.simplified);
      CertifiedPlan one;
      one.plan.joints = environment.joints;
      one.plan.positions = made.simplified;
      one.plan.state = environment.locked;
      for (int pass = 0; pass < kPasses; ++pass) {
        certify(*ours.manager, options, one);
        row.us = pass == 0 ? one.us : std::min(row.us, one.us);
      }
      if (!one.error.empty()) throw std::runtime_error(fmt::format("{}: {}", environment.name, one.error));
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
  }

  std::string tableRow(const std::string& environment) const {
    std::size_t plans = 0, sampled = 0, touching = 0, missed = 0, mended = 0, hidden = 0;
    std::vector<double> us, ms, deviation, longer;
    for (const Row& r : rows_) {
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
    return fmt::format("{:<18}{:>7}{:>10}{:>11}{:>9}{:>12.1f}{:>12.1f}{:>10}{:>10.1f}{:>11.3f}{:>10.3f}{:>8}\n",
                       environment, plans, sampled, touching, missed, median(us),
                       us.empty() ? 0 : *std::max_element(us.begin(), us.end()), mended, median(ms), median(deviation),
                       median(longer), hidden);
  }

  const CertifyBenchOptions& options_;
  Robot robot_;
  std::vector<Row> rows_;
};

}  // namespace

int benchCertify(const CertifyBenchOptions& options) {
  Bench bench(options);
  bench.run();
  fmt::print("{}", bench.table());
  if (!options.csv.empty()) files::write(options.csv, bench.csv());
  return bench.sound() ? kExitFree : kExitContact;
}

}  // namespace fcl_artic::app
