// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>
#include <ompl/base/ScopedState.h>
#include <CLI/CLI.hpp>

#include "averages.h"
#include "exit_status.h"
#include "files/files.h"
#include "outputs.h"
#include "plan_options.h"
#include "planning/fcl_state_check.h"
#include "planning/plans.h"
#include "progress.h"
#include "render/picture.h"
#include "tables.h"
#include "usage.h"

namespace fcl_artic::app {
namespace {

namespace ob = ompl::base;
using namespace planning_data;
using planning::PlanningSetup;

/// OMPL's default, and ten times finer: parts of the space's extent. Then ours, which has no resolution.
constexpr double kResolutions[] = {0.01, 0.001};
constexpr int kPlanningValidators = 3, kPlanningOurs = 2;
constexpr const char* kPlanningNames[kPlanningValidators] = {"FCL, OMPL's 1 %", "FCL, 0.1 %", "fcl_artic"};

struct PlanningOptions : PlanOptions {
  std::string image;  ///< file; empty: none
};

struct PlanningOutcome {
  std::string environment;
  int problem = 0, seed = 0, validator = 0;
  bool solved = false;
  double plan_ms = 0, simplify_ms = 0;
  std::vector<double> valid_us, invalid_us;              ///< of the motions that the planner asked about
  bool raw_sampled = false, simplified_sampled = false;  ///< FCL sees it collide in steps 100 times finer
  bool raw_proven = false, simplified_proven = false;    ///< contact is proven on it
};

/// A plan that sampling accepted and that collides: the one with the longest way in collision.
struct Example {
  double hidden = 0;  ///< of the space's distance
  std::string environment;
  const Problem* problem = nullptr;
  Eigen::VectorXd from, to;
  CertifiedResult contact;
};

/// The motions of a way, each asked for its first contact. Null: none touches.
std::optional<std::pair<std::size_t, CertifiedResult>> firstContact(const PlanningSetup& setup,
                                                                    const Environment& environment, const Way& way) {
  const KinematicTree& tree = setup.manager->tree();
  CertifiedResult result;
  for (std::size_t i = 0; i + 1 < way.size(); ++i) {
    const auto motion =
        JointMotion::linear(tree, environment.configuration(tree, way[i]), environment.configuration(tree, way[i + 1]));
    setup.manager->continuousCollide(motion, planning::planningRequest(), result);
    if (!result.isFree() && result.certain) return std::pair(i, result);
  }
  return std::nullopt;
}

class PlanningBench {
 public:
  explicit PlanningBench(const PlanningOptions& options)
      : options_(options), robot_(planning_data::readRobot(options.data, options.robot)) {
    std::vector<std::string> names = options.environments;
    if (names.empty()) names = environmentsOf(options.data, options.robot);
    for (const std::string& name : names) {
      environments_.push_back(readEnvironment(problemsPath(options.data, options.robot, name), *robot_.tree));
    }
  }

  void run() {
    double asked = 0, done = 0;
    for (const Environment& environment : environments_) asked += static_cast<double>(numProblems(environment));
    ProgressBar bar;
    for (const Environment& environment : environments_) {
      for (std::size_t i = 0; i < numProblems(environment); ++i) {
        runProblem(environment, environment.problems[i]);
        bar.show(++done / asked);
      }
    }
  }

  bool sound() const {
    return std::none_of(outcomes_.begin(), outcomes_.end(), [](const PlanningOutcome& o) {
      return o.validator == kPlanningOurs &&
             (o.raw_sampled || o.simplified_sampled || o.raw_proven || o.simplified_proven);
    });
  }

  std::string table() const {
    std::string out = fmt::format(
        "{}, {} problems of each environment, {} seed{}; RRTConnect and simplification, means; motions, medians\n\n",
        options_.robot, options_.problems, options_.seeds, options_.seeds == 1 ? "" : "s");
    out += fmt::format("{:<{}}{:<17}{:>8}{:>10}{:>12}{:>19}{:>19}{:>22}{:>22}\n", "environment", nameWidth(),
                       "validator", "solved", "plan ms", "simplify ms", "valid us (n)", "invalid us (n)",
                       "raw plans collide", "simplified collide");
    for (const std::string& name : groups()) {
      for (int v = 0; v < kPlanningValidators; ++v) out += tableRow(name, v);
    }
    if (left_out_) out += fmt::format("\n{} problems left out: their start or goal touches something\n", left_out_);
    return out + "\ncollide: seen by FCL in steps 100 times finer than OMPL's default / contact proven by fcl_artic\n";
  }

  std::string csv() const {
    std::string out =
        "robot,environment,problem,seed,validator,solved,plan_ms,simplify_ms,valid_motions,valid_median_us,valid_mean_"
        "us,"
        "invalid_motions,invalid_median_us,invalid_mean_us,raw_collides_sampled,raw_collides_proven,"
        "simplified_collides_sampled,simplified_collides_proven\n";
    for (const PlanningOutcome& o : outcomes_) {
      out +=
          fmt::format("{},{},{},{},\"{}\",{:d},{:.4f},{:.4f},{},{:.3f},{:.3f},{},{:.3f},{:.3f},{:d},{:d},{:d},{:d}\n",
                      options_.robot, o.environment, o.problem, o.seed, kPlanningNames[o.validator], o.solved,
                      o.plan_ms, o.simplify_ms, o.valid_us.size(), median(o.valid_us), mean(o.valid_us),
                      o.invalid_us.size(), median(o.invalid_us), mean(o.invalid_us), o.raw_sampled, o.raw_proven,
                      o.simplified_sampled, o.simplified_proven);
    }
    return out;
  }

  /// @return false: there is nothing to show.
  bool picture(const std::string& path) const {
    if (!example_.problem) return false;
    const CertifiedContact& contact = example_.contact.contacts.at(0);
    render::PictureOptions picture;
    picture.width = 1200;
    picture.height = 750;
    picture.title = fmt::format("accepted by sampling: {} - {} at t = {:.3f}", contact.body1.name, contact.body2.name,
                                example_.contact.t_lower);
    const auto way = [&](double t) -> Eigen::VectorXd { return example_.from + t * (example_.to - example_.from); };
    render::writePicture(path, robot_, example_.problem->scene.obstacles, way, example_.contact, picture);
    return true;
  }

 private:
  struct Sum {
    int runs = 0, solved = 0, raw_sampled = 0, raw_proven = 0, simplified_sampled = 0, simplified_proven = 0;
    double plan_ms = 0, simplify_ms = 0;  ///< means
    std::vector<double> valid_us, invalid_us;
  };

  std::size_t numProblems(const Environment& environment) const {
    return std::min(environment.problems.size(), static_cast<std::size_t>(options_.problems));
  }

  void runProblem(const Environment& environment, const Problem& problem) {
    const PlanningSetup ours = setUp(robot_, environment, problem);
    if (!mayBeSolved(ours, problem)) {
      ++left_out_;
      return;
    }
    FclStateCheck check(robot_, problem.scene);
    const ob::SpaceInformationPtr spaces[kPlanningValidators] = {
        discreteOverFcl(robot_, environment, problem, kResolutions[0]),
        discreteOverFcl(robot_, environment, problem, kResolutions[1]), ours.si};
    std::shared_ptr<TimedMotionValidator> timed[kPlanningValidators];
    for (int v = 0; v < kPlanningValidators; ++v) timed[v] = TimedMotionValidator::wrap(spaces[v]);
    for (int seed = 1; seed <= options_.seeds; ++seed) {
      for (int v = 0; v < kPlanningValidators; ++v) {
        timed[v]->valid_us.clear();
        timed[v]->invalid_us.clear();
        const Plans plans = plan(spaces[v], ours, problem.start, problem.goal, static_cast<unsigned>(seed),
                                 options_.seconds, options_.range);
        PlanningOutcome o;
        o.environment = environment.name;
        o.problem = problem.index;
        o.seed = seed;
        o.validator = v;
        o.solved = plans.solved;
        o.plan_ms = plans.plan_ms;
        o.simplify_ms = plans.simplify_ms;
        o.valid_us = timed[v]->valid_us;
        o.invalid_us = timed[v]->invalid_us;
        o.raw_sampled = collidingSamples(ours, environment, check, plans.raw) > 0;
        const long hidden = collidingSamples(ours, environment, check, plans.simplified);
        o.simplified_sampled = hidden > 0;
        o.raw_proven = firstContact(ours, environment, plans.raw).has_value();
        const auto contact = firstContact(ours, environment, plans.simplified);
        o.simplified_proven = contact.has_value();
        if (v == 0 && contact && static_cast<double>(hidden) >= example_.hidden) {
          const Way& way = plans.simplified;
          example_ = {static_cast<double>(hidden),
                      environment.name,
                      &problem,
                      environment.configuration(*robot_.tree, way[contact->first]),
                      environment.configuration(*robot_.tree, way[contact->first + 1]),
                      contact->second};
        }
        outcomes_.push_back(std::move(o));
      }
    }
  }

  /// Whether neither start nor goal touches anything.
  static bool mayBeSolved(const PlanningSetup& setup, const Problem& problem) {
    ob::ScopedState<> state(setup.space);
    for (const std::vector<double>* end : {&problem.start, &problem.goal}) {
      setup.setState(state.get(), *end);
      if (!setup.si->isValid(state.get())) return false;
    }
    return true;
  }

  long collidingSamples(const PlanningSetup& setup, const Environment& environment, FclStateCheck& check,
                        const Way& way) const {
    long colliding = 0;
    firstSample(setup, way, [&](const std::vector<double>& q) {
      colliding += check.collides(environment.configuration(*robot_.tree, q));
      return false;  // all of them
    });
    return colliding;
  }

  std::vector<std::string> groups() const {
    std::vector<std::string> names;
    for (const Environment& environment : environments_) names.push_back(environment.name);
    if (names.size() > 1) names.push_back("ALL");
    return names;
  }

  std::size_t nameWidth() const {
    std::size_t width = 18;
    for (const std::string& name : groups()) width = std::max(width, name.size() + 2);
    return width;
  }

  Sum sumOf(const std::string& environment, int validator) const {
    Sum sum;
    for (const PlanningOutcome& o : outcomes_) {
      if (o.validator != validator || (environment != "ALL" && o.environment != environment)) continue;
      ++sum.runs;
      sum.solved += o.solved;
      sum.raw_sampled += o.raw_sampled;
      sum.raw_proven += o.raw_proven;
      sum.simplified_sampled += o.simplified_sampled;
      sum.simplified_proven += o.simplified_proven;
      sum.plan_ms += o.plan_ms;
      sum.simplify_ms += o.simplify_ms;
      sum.valid_us.insert(sum.valid_us.end(), o.valid_us.begin(), o.valid_us.end());
      sum.invalid_us.insert(sum.invalid_us.end(), o.invalid_us.begin(), o.invalid_us.end());
    }
    sum.plan_ms /= std::max(1, sum.runs);
    sum.simplify_ms /= std::max(1, sum.runs);
    return sum;
  }

  std::string tableRow(const std::string& environment, int validator) const {
    const Sum s = sumOf(environment, validator);
    const auto cost = [](const std::vector<double>& us) { return fmt::format("{:.2f} ({})", median(us), us.size()); };
    return fmt::format("{:<{}}{:<17}{:>8}{:>10.2f}{:>12.2f}{:>19}{:>19}{:>22}{:>22}\n", environment, nameWidth(),
                       kPlanningNames[validator], fmt::format("{}/{}", s.solved, s.runs), s.plan_ms, s.simplify_ms,
                       cost(s.valid_us), cost(s.invalid_us), fmt::format("{} / {}", s.raw_sampled, s.raw_proven),
                       fmt::format("{} / {}", s.simplified_sampled, s.simplified_proven));
  }

  const PlanningOptions& options_;
  Robot robot_;
  std::vector<Environment> environments_;
  std::vector<PlanningOutcome> outcomes_;
  int left_out_ = 0;  ///< problems whose start or goal touches something
  Example example_;
};

int runPlanning(PlanningOptions& o) {
  if (!o.image.empty()) render::requirePictures();
  removeEarlierOutputs({{"--csv", &o.csv}, {"--image", &o.image}}, {});
  PlanningBench bench(o);
  bench.run();
  fmt::print("{}", bench.table());
  if (!o.csv.empty()) files::write(o.csv, bench.csv());
  if (!o.image.empty() && !bench.picture(o.image)) {
    fmt::print("no picture: no plan that sampling accepted collides\n");
  }
  return bench.sound() ? kExitFree : kExitContact;
}

}  // namespace

void addPlanning(CLI::App& program, int& exit_status) {
  auto options = std::make_shared<PlanningOptions>();
  PlanningOptions& o = *options;
  CLI::App* verb = program.add_subcommand(
      "planning",
      "RRTConnect with OMPL's discrete validator over FCL, at its default and ten times finer, and with ours");
  verb->footer(
      "Every plan is looked at by FCL in steps 100 times finer than OMPL's default, and its motions are checked with\n"
      "proof.\n"
      "Exit status: 0 no plan made with fcl_artic collides, 1 one does, 2 error.");
  addPlanOptions(*verb, o);
  verb->add_option("--image", o.image, "Draw a plan that sampling accepted, at the moment of contact, as PNG")
      ->check(requirePng)
      ->type_name("FILE");
  verb->callback([options, &exit_status] { exit_status = runPlanning(*options); });
}

}  // namespace fcl_artic::app
