// SPDX-License-Identifier: BSD-3-Clause
#include "certify.h"

#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "certificate_file.h"
#include "certification.h"
#include "certify_report.h"
#include "configuration.h"
#include "elapsed.h"
#include "exit_status.h"
#include "files/files.h"
#include "kinematics/angles.h"
#include "outputs.h"
#include "plan_variables.h"
#include "plans/variables.h"
#include "plans/write.h"
#include "query_options.h"
#include "render/picture.h"
#include "usage.h"
#include "views.h"
#include "world.h"

namespace fcl_artic::app {
namespace {

struct CertifyVerb {
  WorldOptions world;
  PlanVariables variables;
  PlanColumnOptions columns;
  std::vector<std::string> plans;
  std::string format, csv, out, certificate;
  ToolLineOptions tool_line;
  ViewOptions views;
  InterpolationOptions interpolation;
  CertifyOptions certify;
  bool clearance = false, json = false, failed_only = false, mend = false;
  ClearanceRequest clearance_request;
  MendOptions mending;
};

/// By file, as a message's objects are looked for.
std::vector<plans::Attached> attachedOf(const KinematicTree& tree, const std::vector<Attachment>& attachments) {
  std::map<std::size_t, plans::Attached> of_option;
  for (const Attachment& a : attachments) {
    plans::Attached& file = of_option[a.option];
    file.file = std::filesystem::path(a.file).stem().string();
    file.objects.push_back(a.name);
    file.link = tree.linkId(a.link);
  }
  std::vector<plans::Attached> out;
  for (auto& one : of_option) out.push_back(std::move(one.second));
  return out;
}

/// Whether a plan's own values show that it has this curve between its waypoints.
bool isByValues(plans::Interpolation kind) {
  return kind == plans::Interpolation::linear || kind == plans::Interpolation::cubic ||
         kind == plans::Interpolation::quintic;
}

/// A certified plan in the words of a format. Whoever reads it goes the way that was certified: it has velocities only
/// where these counted, turns as they were taken, and the values of all other joints.
plans::Plan writtenPlan(const KinematicTree& tree, const CertifiedPlan& one, plans::Turns turns, bool degrees,
                        plans::Format format) {
  const plans::PlanMotion& motion = *one.motion;
  plans::Plan out = one.plan;
  out.joints = motion.joints;
  out.state.clear();
  const bool quintic = motion.interpolation == plans::Interpolation::quintic,
             splines = quintic || motion.interpolation == plans::Interpolation::cubic;
  if (!splines) out.velocities.clear();
  if (!quintic) out.accelerations.clear();
  if (degrees) out = plans::inRadians(tree, out);
  out.state = motion.rest;
  std::vector<int> variables;
  for (const std::string& joint : out.joints) variables.push_back(plans::variableOf(tree, joint, "the plan"));
  for (std::size_t j = 0; turns == plans::Turns::shortest && j < variables.size(); ++j) {
    const Joint& joint = tree.joint(tree.variableJoint(variables[j]));
    const bool forever =
        joint.type == JointType::continuous || (joint.type == JointType::planar && tree.isAngle(variables[j]));
    for (std::size_t k = 1; forever && k < out.positions.size(); ++k) {
      double& value = out.positions[k][j];
      value += 2 * kPi * std::nearbyint((out.positions[k - 1][j] - value) / (2 * kPi));
    }
  }
  if (format != plans::Format::ompl) return out;
  if (motion.interpolation != plans::Interpolation::linear) {
    throw std::invalid_argument(
        fmt::format("--out: OMPL's text holds no {} plan, only straight ways between waypoints: "
                    "take .csv, .json, .jsonl or .yaml",
                    toString(motion.interpolation)));
  }
  // It has no names: all variables, in the robot's order.
  plans::Plan all = out;
  all.joints.clear();
  all.state.clear();
  for (int v = 0; v < tree.dof(); ++v) all.joints.push_back(tree.variableName(v));
  for (std::size_t k = 0; k < out.positions.size(); ++k) {
    Eigen::VectorXd q = motion.waypoints[k];
    for (std::size_t j = 0; j < variables.size(); ++j) q[variables[j]] = out.positions[k][j];
    all.positions[k].assign(q.data(), q.data() + q.size());
  }
  return all;
}

/// Writes the free plans, mended ones among them, to a file. Its text is read again first: if that is not proven free,
/// it is not written.
void writeOut(const CertifyVerb& o, const ArticulatedCollisionManager& manager, const std::vector<CertifiedPlan>& all) {
  const plans::Format format = plans::formatOf(o.out);
  std::vector<plans::Plan> out;
  std::vector<const CertifiedPlan*> from;
  for (const CertifiedPlan& plan : all) {
    if (plan.exitStatus() != kExitFree) continue;
    from.push_back(plan.as_mended ? plan.as_mended.get() : &plan);
    // For a mended plan, its own steps were proven.
    const plans::Turns turns = plan.as_mended ? plans::Turns::given : o.certify.motion.turns;
    const bool degrees = !plan.as_mended && o.certify.motion.degrees;
    plans::Plan& written = out.emplace_back(writtenPlan(manager.tree(), *from.back(), turns, degrees, format));
    if (written.name.empty() && all.size() > 1) written.name = plan.file;
  }
  if (out.empty()) return;  // the report says that none is free
  const std::string text = plans::writePlans(out, format);
  const std::vector<plans::Plan> again = plans::parsePlans(manager.tree(), text, format);
  CertifyOptions read = o.certify;
  read.motion.joints.clear();  // it names all joints, and their values
  read.motion.state.clear();
  read.motion.degrees = false;  // what is written is in rad
  read.motion.turns = plans::Turns::given;
  read.clearance.reset();
  read.request.certificate = false;
  for (std::size_t i = 0; i < out.size(); ++i) {
    CertifiedPlan one;
    one.plan = again.at(i);
    const plans::Interpolation kind = from[i]->motion->interpolation;
    read.motion.interpolation = isByValues(kind) ? plans::Interpolation::automatic : kind;
    certify(manager, read, one);
    if (one.exitStatus() == kExitFree) continue;
    throw std::runtime_error(
        fmt::format("--out '{}': {} is free, but not as the file would hold it{}{}: nothing is written", o.out,
                    from[i]->title(), one.error.empty() ? "" : ": ", one.error));
  }
  files::write(o.out, text);
}

/// Writes a record for each plan, as it was mended, that has a proof.
/// @param files  of CertificateFile::write().
/// @return one line for the user.
std::string writeCertificates(CertificateFile& certificates, const std::vector<CertifiedPlan>& all,
                              const std::string& files) {
  std::string missing;
  for (const CertifiedPlan& plan : all) {
    const CertifiedPlan& one = plan.as_mended ? *plan.as_mended : plan;
    if (!one.result.certificate) continue;
    const std::string why = certificates.add(*one.result.certificate);
    if (missing.empty()) missing = why;
  }
  std::string written = certificates.write(files);
  const bool mended =
      std::any_of(all.begin(), all.end(), [](const CertifiedPlan& plan) { return plan.as_mended != nullptr; });
  if (mended && !written.empty()) written = "of plans as they were mended: " + written;
  if (written.empty()) return missing.empty() ? "no certificate: no plan has an answer" : missing;
  return all.size() == 1 ? written : fmt::format("of {} plans {}", all.size(), written);
}

/// The plans that have certificates, as arguments of fcl_artic_verify, each word after a space. They are CSV files: as
/// given, or, for mended plans and those of another layout, as written. Empty if fcl_artic_verify does not compare
/// them.
std::string planArguments(const CertifyVerb& o, const std::vector<CertifiedPlan>& all) {
  const bool as_named = o.columns.columns.columns.empty() && o.columns.columns.skip.empty() &&
                        o.columns.columns.time.empty() && !o.columns.degrees;
  const plans::Interpolation kind = o.interpolation.kind();
  std::string text;
  bool mended = false;
  for (const CertifiedPlan& plan : all) {
    const auto& certificate = plan.as_mended ? plan.as_mended->result.certificate : plan.result.certificate;
    if (!certificate || !*certificate) continue;
    const bool as_given = as_named && !plan.as_mended && !plan.plan.foreign;
    if (!as_given && plan.exitStatus() != kExitFree) return "";         // it is not written
    if (!plan.as_mended && o.variables.turns == "shortest") return "";  // turns are added by other roundings
    const std::string& file = as_given ? plan.file : o.out;
    if (!plans::hasPlanEnding(file) || plans::formatOf(file) != plans::Format::csv) return "";
    text += " --plan " + shellWord(file);
    mended = mended || plan.as_mended;
  }
  for (const std::string& value : o.variables.state) text += " --state " + shellWord(value);
  // A mended plan goes straight.
  if (mended && (kind == plans::Interpolation::cubic || kind == plans::Interpolation::quintic)) return "";
  return verifierInterpolation(kind, text);
}

/// FILE.mended.png beside FILE.png.
ViewOptions mendedViews(const ViewOptions& views) {
  ViewOptions out = views;
  for (std::string* path : {&out.image, &out.html}) {
    if (path->empty()) continue;
    const std::filesystem::path file(*path);
    *path = std::filesystem::path(file).replace_extension(".mended" + file.extension().string()).string();
  }
  return out;
}

/// Shows the first plan that is not free, or else the first, and beside it the mended plan.
/// @return one line for the user.
std::string writePlanViews(const ViewOptions& of_plan, const ViewOptions& of_mended, const World& world,
                           const ArticulatedCollisionManager& manager, const CertifyReport& all) {
  const CertifiedPlan* shown = nullptr;
  for (const CertifiedPlan& plan : all.plans) {
    if (!plan.motion) continue;
    if (!shown || (shown->result.isFree() && !plan.result.isFree())) shown = &plan;
  }
  if (!shown) return "there is no plan to show";
  const auto show = [&](const ViewOptions& views, const CertifiedPlan& plan) {
    writeViews(views, world, manager, plan.motion->trajectory, reportOf(all, plan));
  };
  show(of_plan, *shown);
  if (!shown->as_mended || !shown->as_mended->motion) return "shown: " + shown->title();
  show(of_mended, *shown->as_mended);
  return fmt::format("shown: {}, and what it is mended to in {}{}{}", shown->title(), of_mended.html,
                     of_mended.html.empty() || of_mended.image.empty() ? "" : " and ", of_mended.image);
}

int runCertify(CertifyVerb& o) {
  if (o.mend) requireMending();
  if (o.mend && o.interpolation.kind() == plans::Interpolation::jtcUpsampled) {
    throw std::invalid_argument(
        "--mend: detours go straight between waypoints, and a controller that upsamples positions goes another way: "
        "certify a mended plan with its time law, as jtc");
  }
  if (!o.tool_line.line.empty() && o.interpolation.kind() == plans::Interpolation::tangentHalfAngle) {
    throw std::invalid_argument(
        "--line: no tool is followed along tangents of half angles: leave --line out, or certify the curve that the "
        "controller runs (--interpolation linear, cubic, quintic or jtc)");
  }
  if (!o.out.empty()) (void)plans::formatOf(o.out);
  std::vector<std::string> inputs = inputsOf(o.world);
  inputs.insert(inputs.end(), o.plans.begin(), o.plans.end());
  std::string certificate_world = o.certificate.empty() ? "" : CertificateFile(o.certificate).worldPath();
  if (!o.views.image.empty()) render::requirePictures();
  ViewOptions of_mended = mendedViews(o.views);
  removeEarlierOutputs({{"--out", &o.out},
                        {"--csv", &o.csv},
                        {"--image", &o.views.image},
                        {"--html", &o.views.html},
                        {"--image of what is mended", &of_mended.image},
                        {"--html of what is mended", &of_mended.html},
                        {"--certificate", &o.certificate},
                        {"--certificate's world", &certificate_world},
                        {"--auto-srdf", &o.world.auto_srdf}},
                       inputs);
  World world(o.world);
  if (o.mend && !world.tolerances().speeds.empty()) {
    throw std::invalid_argument(
        fmt::format("--speed: a detour is made of motions that are asked one by one, as if '{}' had just been seen at "
                    "its place: mend without --speed, then certify the mended plan with its times",
                    world.tolerances().speeds.front().object));
  }
  world.open(o.certify.request);
  const KinematicTree& tree = *world.robot.tree;
  o.certify.motion.interpolation = o.interpolation.kind();
  o.certify.motion.blend = o.interpolation.blend;
  o.certify.motion.turns = turnsOf(o.variables);
  o.certify.motion.joints = o.variables.joints;
  o.certify.motion.state = parseValues(tree, o.variables.state, "--state");
  o.certify.motion.ignore_limits = o.variables.ignore_limits;
  o.certify.motion.limit_tolerance = o.variables.limit_tolerance;
  o.certify.motion.degrees = o.columns.degrees;
  o.columns.columns.joints = plans::unnamedColumns(tree, o.certify.motion);
  if (o.clearance) o.certify.clearance = o.clearance_request;
  if (!o.tool_line.line.empty()) o.certify.line = parseToolLine(tree, o.tool_line);
  std::optional<plans::Format> format;
  if (!o.format.empty()) format = plans::formatNamed(o.format);
  std::vector<std::string> plan_notes;
  std::vector<CertifiedPlan> all = readPlans(tree, o.plans, format, o.columns.columns, plan_notes);
  o.certify.attached = attachedOf(tree, world.attachments);
  const auto manager = std::make_shared<const ArticulatedCollisionManager>(world.makeManager());

  o.certify.request.measure_times = all.size() == 1;  // the one that is shown in full
  CertificateFile certificates(o.certificate);
  o.certify.request.certificate = certificates.wanted();
  const auto begin = Clock::now();
  certify(*manager, o.certify, all);
  const double seconds = secondsSince(begin);
  if (o.mend) {
    o.mending.request = o.certify.request;
    mendAll(manager, o.certify, o.mending, all, [&](const MendPairs& pairs, double margin) {
      return std::make_shared<const ArticulatedCollisionManager>(
          world.makeManager([&](ArticulatedCollisionManager& changed) {
            for (const auto& [a, b] : pairs.ignored) changed.allow(a, b);
            for (const auto& [a, b] : pairs.near) changed.setMargin(a, b, margin);
          }));
    });
  }
  std::vector<std::string> notes = world.notes(*manager);
  notes.insert(notes.end(), plan_notes.begin(), plan_notes.end());
  const std::string tolerances = manager->describeTolerances();
  if (!tolerances.empty() && all.size() != 1) notes.push_back("free is every path within " + tolerances);
  const CertifyReport report{tree, o.certify.request, all, notes, seconds, o.failed_only, tolerances};
  UnwrittenOutputs& unwritten = world.unwritten;
  if (!o.out.empty()) unwritten.attempt([&] { writeOut(o, *manager, all); });
  if (certificates.wanted()) {
    unwritten.attempt([&] {
      notes.push_back(writeCertificates(certificates, all, verifierArguments(o.world) + planArguments(o, all)));
    });
  }
  if (o.views.wanted())
    unwritten.attempt([&] { notes.push_back(writePlanViews(o.views, of_mended, world, *manager, report)); });
  if (!o.csv.empty()) unwritten.attempt([&] { files::write(o.csv, csvReport(report)); });
  notes.insert(notes.end(), unwritten.reasons().begin(), unwritten.reasons().end());
  if (o.json) {
    fmt::print("{}\n", jsonReport(report).dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
  } else {
    fmt::print("{}", textReport(report));
  }
  int status = kExitFree;
  for (const CertifiedPlan& plan : all) status = worseExit(status, plan.exitStatus());
  return unwritten.exitStatus(status);
}

}  // namespace

void addCertify(CLI::App& program, int& exit_status) {
  auto options = std::make_shared<CertifyVerb>();
  CertifyVerb& o = *options;
  CLI::App* certify = program.add_subcommand(
      "certify", "Does anybody's plan touch anything? Plans of files, one or thousands, against a robot and a scene");
  certify->footer(
      "PLAN is a file or a folder: CSV (a header of joints' names, time where there is one), JSON and YAML (plans, or\n"
      "ROS messages: JointTrajectory, RobotTrajectory, DisplayTrajectory), JSON lines (.jsonl), OMPL's text of a path\n"
      "(.path, .txt), NumPy's arrays (.npy, .npz); - is standard input, with --format.\n"
      "Waypoints are counted from 0; times are the plan's own, or the waypoints' numbers where it has none.\n"
      "Exit status: 0 all free (proven), 1 contact, 2 error, 3 undecided (budget): the worst of all plans, 2 before 1\n"
      "before 3; a plan whose tool leaves its --line counts as in contact, with --mend a plan counts as what it is "
      "mended to.\n"
      "Many edges or trajectories in many scenes: fcl_artic certify --edges FILE.h5; certify --merge --help says "
      "more.");
  certify->add_option("PLAN", o.plans, "Files and folders of plans")->required()->group("Plans")->type_name("PLAN...");
  o.world.timed = true;  // certify() refuses plans without times
  addWorldOptions(*certify, o.world, "--robot,--urdf");

  certify->add_option("--format", o.format, "What the files are, whatever their endings")
      ->check(CLI::IsMember({"csv", "json", "jsonl", "yaml", "ompl", "numpy"}))
      ->group("Plans");
  addInterpolation(*certify, o.interpolation, "Plans");
  addPlanVariables(*certify, o.variables);
  addPlanColumns(*certify, o.columns);

  addQueryOptions(*certify, o.certify.request);
  addClearanceOptions(*certify, o.clearance, o.clearance_request);
  addToolLine(*certify, o.tool_line, "Query");
  certify->add_option("--threads", o.certify.threads, "Threads at most; 0: as many as the machine runs at once")
      ->check(CLI::NonNegativeNumber)
      ->group("Query")
      ->capture_default_str();

  CLI::Option* mend =
      certify->add_flag("--mend", o.mend, "Find certified detours around what plans touch, and certify what comes out")
          ->group("Mending");
  certify->add_option("--mend-time", o.mending.seconds, "Seconds for a plan, at most")
      ->check(requirePositive)
      ->needs(mend)
      ->group("Mending")
      ->capture_default_str();
  certify
      ->add_option("--mend-clearance", o.mending.clearance,
                   "What detours keep beyond the margin, in m; less only where no way is found that does, and between "
                   "pairs that are nearer where the plan begins or ends")
      ->check(requireNotNegative)
      ->needs(mend)
      ->group("Mending")
      ->capture_default_str();
  certify
      ->add_option("--out", o.out, "Write the plans that are free, mended ones among them (.csv, .json, .jsonl, ...)")
      ->group("Mending")
      ->type_name("FILE");

  certify->add_flag("--json", o.json, "Answer in JSON, all digits")->group("Output");
  certify->add_option("--csv", o.csv, "Write a row for each plan")->group("Output")->type_name("FILE");
  certify
      ->add_option("--certificate", o.certificate,
                   "Write a proof of each answer, and what it is about to FILE.world: fcl_artic_verify proves it again")
      ->group("Output")
      ->type_name("FILE");
  addViewOptions(*certify, o.views);
  certify->add_flag("--failed-only", o.failed_only, "Show only plans that are not free")->group("Output");
  certify->callback([options, &exit_status] {
    options->interpolation.require();
    try {
      exit_status = runCertify(*options);
    } catch (const std::exception& error) {
      if (options->json) {
        fmt::print("{}\n", nlohmann::ordered_json{{"status", "error"}, {"error", error.what()}}.dump(2));
      }
      throw;
    }
  });
}

}  // namespace fcl_artic::app
