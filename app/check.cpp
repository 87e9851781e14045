// SPDX-License-Identifier: BSD-3-Clause
#include "check.h"

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "certificate_file.h"
#include "configuration.h"
#include "exit_status.h"
#include "fcl_artic/fcl_artic.h"
#include "files/files.h"
#include "lines.h"
#include "motions.h"
#include "outputs.h"
#include "plan_variables.h"
#include "progress.h"
#include "query_options.h"
#include "render/picture.h"
#include "replay/query_file.h"
#include "usage.h"
#include "views.h"
#include "visibility_options.h"
#include "world.h"

namespace fcl_artic::app {
namespace {

constexpr std::size_t kAllContacts = 1000000;

struct CheckVerb {
  WorldOptions world;
  ViewOptions views;
  std::string certificate, trajectory, lines, dump, replay;
  InterpolationOptions interpolation;
  std::vector<std::string> from, to, state;
  CertifiedRequest request;
  VisibilityChoice visibility;
  std::optional<std::size_t> max_contacts;
  bool every_pair = false;
  bool shortest = false, json = false, clearance = false;
  ClearanceRequest clearance_request;
};

/// The motion as fcl_artic_verify takes it, each word after a space; empty where it does not.
/// @param motion  of two ends; none: the trajectory.
/// @param foreign  the trajectory's file is of another layout.
std::string motionArguments(const CheckVerb& options, const std::optional<JointMotion>& motion, bool foreign) {
  if (options.shortest || foreign) return "";
  if (motion) {
    if (options.interpolation.kind() == plans::Interpolation::tangentHalfAngle) return "";
    const auto words = [](const Eigen::VectorXd& q) {  // they find the very numbers again
      return shellWord(fmt::format("{}", fmt::join(q.data(), q.data() + q.size(), " ")));
    };
    return " --from " + words(motion->configuration(0)) + " --to " + words(motion->configuration(1));
  }
  std::string text = " --plan " + shellWord(options.trajectory);
  for (const std::string& value : options.state) text += " --state " + shellWord(value);
  return verifierInterpolation(options.interpolation.kind(), text);
}

/// Sets what a report says of the motion: one of the two, which must live as long as the report.
void setMotion(const std::optional<JointMotion>& motion, const std::optional<JointTrajectory>& trajectory,
               Report& report) {
  report.configuration = [&](double t) { return trajectory ? trajectory->configuration(t) : motion->configuration(t); };
  if (!trajectory) return;
  report.begin = trajectory->beginTime();
  report.end = trajectory->endTime();
  report.pieces = trajectory->numPieces();
}

void print(const Report& report, bool json) {
  if (json) {
    fmt::print("{}\n", jsonReport(report).dump(2));
  } else {
    fmt::print("{}", textReport(report));
  }
}

/// Objects that move by themselves move for as long as the motion takes.
void requireTimeForSpeeds(const CheckVerb& options, const ToleranceSettings& tolerances) {
  if (tolerances.speeds.empty()) return;
  const std::string& object = tolerances.speeds.front().object;
  if (!options.lines.empty()) {
    throw std::invalid_argument(fmt::format(
        "--speed: each line of --lines is asked by itself, as if '{}' had just been seen at its place: ask about whole "
        "plans with their times (--trajectory, or certify)",
        object));
  }
  if (options.trajectory.empty()) {
    throw std::invalid_argument(fmt::format(
        "--speed: nothing says how long the motion from --from to --to takes, and so how far '{}' gets: give waypoints "
        "with times (--trajectory)",
        object));
  }
}

int runCheck(CheckVerb& options) {
  if (!options.views.image.empty()) render::requirePictures();
  (void)makeCuller(options.visibility.executor);  // refused before files are read
  std::vector<std::string> inputs = inputsOf(options.world);
  for (const std::string& file : {options.trajectory, options.lines}) {
    if (!file.empty()) inputs.push_back(file);
  }
  std::string certificate_world = options.certificate.empty() ? "" : CertificateFile(options.certificate).worldPath();
  removeEarlierOutputs({{"--image", &options.views.image},
                        {"--html", &options.views.html},
                        {"--certificate", &options.certificate},
                        {"--certificate's world", &certificate_world},
                        {"--dump", &options.dump},
                        {"--auto-srdf", &options.world.auto_srdf}},
                       inputs);
  World world(options.world);
  requireTimeForSpeeds(options, world.tolerances());
  world.open(options.request);
  const KinematicTree& tree = *world.robot.tree;
  // One of the two.
  std::optional<JointMotion> motion;
  std::optional<JointTrajectory> trajectory;
  bool foreign = false;  // its file
  plans::MotionOptions of_motion;
  of_motion.interpolation = options.interpolation.kind();
  of_motion.blend = options.interpolation.blend;
  of_motion.turns = options.shortest ? plans::Turns::shortest : plans::Turns::given;
  of_motion.ignore_limits = true;
  of_motion.state = parseValues(tree, options.state, "--state");
  std::vector<std::string> motion_notes;
  const auto noteLimits = [&](const Eigen::VectorXd& q, const std::string& where) {
    for (const std::string& note : tree.limitNotes(q)) motion_notes.push_back(where + ": " + note);
  };
  if (!options.lines.empty()) {
    // Each line is a motion of its own.
  } else if (options.trajectory.empty()) {
    const Eigen::VectorXd q0 = parseConfiguration(tree, options.from, "--from", of_motion.state);
    const Eigen::VectorXd q1 = parseConfiguration(tree, options.to, "--to", of_motion.state);
    motion = motionBetween(tree, q0, q1, of_motion);
    noteLimits(motion->configuration(0), "--from");
    noteLimits(motion->configuration(1), "--to");
  } else {
    plans::PlanMotion plan = readTrajectory(tree, options.trajectory, of_motion);
    if (!world.tolerances().speeds.empty()) plans::requireClock(plan);
    trajectory = std::move(plan.trajectory);
    foreign = plan.foreign;
    motion_notes.push_back(
        fmt::format("the waypoints of '{}' are joined by: {}", options.trajectory, toString(plan.interpolation)));
    motion_notes.insert(motion_notes.end(), plan.notes.begin(), plan.notes.end());
  }
  ArticulatedCollisionManager manager = world.makeManager();
  useVisibility(options.visibility, manager);

  CertifiedRequest request = options.request;
  request.visibility = options.visibility.mode;
  request.mode = options.every_pair ? ContactMode::firstOfEveryPair : ContactMode::first;
  request.max_contacts = options.max_contacts.value_or(options.every_pair ? kAllContacts : 1);
  request.measure_times = true;
  CertificateFile certificates(options.certificate);
  request.certificate = certificates.wanted();
  if (!options.lines.empty()) {
    printNotes(world.notes(manager));
    const int status = checkLines(manager, request, {options.lines, of_motion}, certificates);
    if (certificates.wanted()) world.unwritten.attempt([&] { certificates.write(); });
    return world.unwritten.exitStatus(status);
  }
  if (!options.dump.empty()) {  // before it is answered: it may be asked again whatever happens then
    world.unwritten.attempt([&] {
      files::write(options.dump,
                   trajectory ? manager.writeQuery(*trajectory, request) : manager.writeQuery(*motion, request));
    });
  }
  CertifiedResult result;
  {
    ProgressBar bar;
    request.progress = [&bar](double t_lower) {
      bar.showFree(t_lower, t_lower);
      return true;
    };
    if (trajectory) {
      const double begin = trajectory->beginTime(), length = trajectory->endTime() - begin;
      request.progress = [&bar, begin, length](double t_lower) {
        bar.showFree((t_lower - begin) / length, t_lower);
        return true;
      };
      manager.continuousCollide(*trajectory, request, result);
    } else {
      manager.continuousCollide(*motion, request, result);
    }
  }

  const std::string tolerances = manager.describeTolerances();
  std::optional<Clearance> clearance;
  std::optional<ToleranceLeft> tolerance_left;
  if (options.clearance) {
    const ClearanceRequest asked = clearanceOf(options.clearance_request, request);
    clearance = trajectory ? manager.clearance(*trajectory, asked) : manager.clearance(*motion, asked);
    if (!tolerances.empty()) {
      const ToleranceLeftRequest left = toleranceLeftOf(request);
      tolerance_left = trajectory ? manager.toleranceLeft(*trajectory, left) : manager.toleranceLeft(*motion, left);
    }
  }

  std::vector<std::string> notes = world.notes(manager);
  notes.insert(notes.end(), motion_notes.begin(), motion_notes.end());
  if (result.first() && result.t_lower <= (trajectory ? trajectory->beginTime() : 0))
    notes.insert(notes.begin(), startHint(*result.first()));
  if (result.certificate) {
    const std::string missing = certificates.add(*result.certificate);
    if (!missing.empty()) notes.push_back(missing);
    world.unwritten.attempt([&] {
      const std::string written =
          certificates.write(verifierArguments(options.world) + motionArguments(options, motion, foreign));
      if (!written.empty()) notes.push_back(written);
    });
  }
  Report report{tree, request, result, notes, {}};
  report.tolerances = tolerances;
  setMotion(motion, trajectory, report);
  if (clearance) report.clearance = &*clearance;
  if (tolerance_left) report.tolerance_left = &*tolerance_left;

  world.unwritten.attempt([&] {
    writeViews(options.views, world, manager, trajectory ? RobotMotion(*trajectory) : RobotMotion(*motion), report);
  });
  notes.insert(notes.end(), world.unwritten.reasons().begin(), world.unwritten.reasons().end());
  print(report, options.json);
  return world.unwritten.exitStatus(exitStatus(result));
}

/// Asks a query of --dump again.
int runReplay(const CheckVerb& options) {
  const RecordedQuery query = replay::readQueryFile(options.replay);
  const CertifiedResult result = query.ask();
  std::vector<std::string> notes = query.manager.notes();
  if (query.library != FCL_ARTIC_VERSION || query.instruction_set != instructionSet()) {
    notes.push_back(
        fmt::format("the query was written by fcl_artic {} with the instruction set {}; this is {} with {}: bits may "
                    "differ",
                    query.library, query.instruction_set, FCL_ARTIC_VERSION, instructionSet()));
  }
  Report report{query.manager.tree(), query.request, result, notes, {}};
  report.tolerances = query.manager.describeTolerances();
  setMotion(query.motion, query.trajectory, report);
  print(report, options.json);
  return exitStatus(result);
}

/// Adds --dump and --replay. All that a replay is about stands in its file: other options would be without effect.
void addReplay(CLI::App& check, CheckVerb& options) {
  CLI::Option* lines = check.get_option("--lines");
  check
      .add_option("--dump", options.dump,
                  "Write the query to FILE, with all that it depends on, before it is answered: --replay asks it again")
      ->excludes(lines)
      ->group("Output")
      ->type_name("FILE");
  check.get_option("--robot")->required(false);
  check
      .add_option("--replay", options.replay,
                  "Ask the query of a --dump again, with the same bits; no other option than --json goes with it")
      ->check(requireInput)
      ->group("Motion")
      ->type_name("FILE");
}

/// @throws CLI::ParseError for what is there beside --replay, and for what is not there without.
void requireReplayAlone(const CLI::App& check) {
  const CLI::Option* replay = check.get_option("--replay");
  if (replay->count() == 0) {
    const CLI::Option* robot = check.get_option("--robot");
    if (robot->count() == 0) throw CLI::RequiredError(robot->get_name());
    return;
  }
  for (const CLI::Option* other : check.get_options()) {
    if (other->count() == 0 || other == replay || other->check_lname("json")) continue;
    throw CLI::ExcludesError("--replay", other->get_name());
  }
}

}  // namespace

void addCheck(CLI::App& program, int& exit_status) {
  auto options = std::make_shared<CheckVerb>();
  CheckVerb& o = *options;
  CertifiedRequest& request = o.request;
  CLI::App* check = program.add_subcommand(
      "check",
      "Does anything touch while every joint goes straight from one configuration to another, or along a trajectory?");
  check->footer(
      "A configuration is a list of all joint values (\"0, 1.57, -90deg\") or name=value pairs; rad or m, angles also\n"
      "as 90deg. A joint that nobody names is an error: --state NAME=VALUE says where it stands.\n"
      "A trajectory is a CSV file as certify takes it: its first line names the columns, time and joints; times in "
      "the\n"
      "answer are the file's.\n"
      "A line of --lines has from and to (or start and goal), each a list of all joint values or an object by name,\n"
      "or waypoints (a list of these) and, where they are not 0, 1, 2 ..., times; and an id, which its answer "
      "repeats.\n"
      "Exit status: 0 free (proven), 1 contact, 2 error, 3 undecided (budget) or nothing checked; with --lines the "
      "worst\n"
      "of all answers: 2 before 1 before 3.\n"
      "If an answer surprises you: --dump writes the query as one file, which a report of it should have.");

  o.world.timed = true;  // requireTimeForSpeeds() looks closer
  addWorldOptions(*check, o.world);

  CLI::Option* from = check->add_option("--from", o.from, "Configuration at t = 0")->group("Motion")->type_name("Q");
  CLI::Option* to = check->add_option("--to", o.to, "Configuration at t = 1")->group("Motion")->type_name("Q");
  CLI::Option* trajectory =
      check->add_option("--trajectory", o.trajectory, "Waypoints (CSV) instead of --from and --to")
          ->check(requireInput)
          ->excludes(from)
          ->excludes(to)
          ->group("Motion")
          ->type_name("FILE");
  CLI::Option* lines =
      check
          ->add_option("--lines", o.lines,
                       "Many motions, one a line in JSON, as {\"from\": [..], \"to\": [..]}, and an answer in JSON a "
                       "line; - reads standard input")
          ->excludes(from)
          ->excludes(to)
          ->excludes(trajectory)
          ->group("Motion")
          ->type_name("FILE");
  addInterpolation(*check, o.interpolation, "Motion");
  addState(*check, o.state, "Motion");
  check->add_flag("--shortest", o.shortest, "Continuous joints take the shorter way round")->group("Motion");

  addQueryOptions(*check, request);
  CLI::Option* clearance = addClearanceOptions(*check, o.clearance, o.clearance_request);
  check->add_option("--max-contacts", o.max_contacts, "Contacts to report at most (1; with --every-pair: all)")
      ->check(CLI::PositiveNumber)
      ->group("Query");
  check->add_flag("--every-pair", o.every_pair, "The first contact of every pair of bodies that touches")
      ->group("Query");

  check
      ->add_option_function<std::string>(
          "--method",
          [&request](const std::string& name) {
            request.method = name == "redon2004" ? Method::redon2004 : Method::standard;
          },
          "standard, or redon2004: the paper's own")
      ->check(CLI::IsMember({"standard", "redon2004"}))
      ->group("Query");
  addVisibilityOptions(*check, o.visibility);

  check->add_flag("--json", o.json, "Answer in JSON, all digits")->group("Output");
  check
      ->add_option("--certificate", o.certificate,
                   "Write the answer's proof, and what it is about to FILE.world: fcl_artic_verify proves it again")
      ->group("Output")
      ->type_name("FILE");
  for (CLI::Option* view : addViewOptions(*check, o.views)) view->excludes(lines);
  clearance->excludes(lines);
  addReplay(*check, o);
  check->callback([check, options, from, to, trajectory, lines, &exit_status] {
    requireReplayAlone(*check);
    options->interpolation.require();
    const bool replay = !options->replay.empty();
    const bool waypoints = trajectory->count() > 0 || lines->count() > 0 || replay;
    for (const CLI::Option* end : {from, to}) {
      if (end->count() == 0 && !waypoints) throw CLI::RequiredError(end->get_name());
    }
    if (!waypoints && !isOfTwoEnds(options->interpolation.kind())) {
      throw CLI::RequiresError("--interpolation " + options->interpolation.name, "--trajectory or --lines");
    }
    const plans::Interpolation kind = options->interpolation.kind();
    // Both say which way round a joint goes. (For other interpolations with waypoints, the readers of plans check
    // this.)
    if (options->shortest && (kind == plans::Interpolation::tangentHalfAngle || kind == plans::Interpolation::jtc)) {
      throw CLI::ExcludesError("--shortest", "--interpolation " + options->interpolation.name);
    }
    try {
      exit_status = replay ? runReplay(*options) : runCheck(*options);
    } catch (const std::exception& error) {
      if (options->json)
        fmt::print("{}\n", nlohmann::ordered_json{{"status", "error"}, {"error", error.what()}}.dump(2));
      throw;
    }
  });
}

}  // namespace fcl_artic::app
