// SPDX-License-Identifier: BSD-3-Clause
#include "link_pairs.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "configuration.h"
#include "exit_status.h"
#include "outputs.h"
#include "progress.h"
#include "render/picture.h"
#include "robot_options.h"
#include "setup/neighbours.h"
#include "text/counted.h"

namespace fcl_artic::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr LinkPairKind kKinds[] = {LinkPairKind::never, LinkPairKind::always, LinkPairKind::sometimes,
                                   LinkPairKind::unproven};

struct SrdfVerb {
  RobotOptions robot;
  std::string check, write, images;
  std::vector<std::string> allow_at;
  LinkPairOptions search;
  bool json = false;
};

std::string pairsText(std::size_t n) {
  return text::counted(n, "pair");
}

const char* meaningOf(LinkPairKind kind) {
  switch (kind) {
    case LinkPairKind::never:
      return "never touch within the joints' limits: proven";
    case LinkPairKind::always:
      return "touch in every configuration that was tried";
    case LinkPairKind::sometimes:
      return "touch in some configurations";
    case LinkPairKind::unproven:
      return "touch in no configuration that was tried, but are not proven apart";
  }
  return "";
}

/// All joints at 0, or as near as the limits let them.
Eigen::VectorXd restOf(const KinematicTree& tree) {
  Eigen::VectorXd rest = tree.neutralConfiguration();
  for (int v = 0; v < tree.dof(); ++v) {
    const Joint& joint = tree.joint(tree.variableJoint(v));
    if (hasLimits(joint)) rest[v] = std::clamp(rest[v], joint.lower, joint.upper);
  }
  return rest;
}

/// Values of the joints that are not at rest.
std::string configurationText(const KinematicTree& tree, const Eigen::VectorXd& q) {
  const Eigen::VectorXd rest = restOf(tree);
  std::string text;
  for (int v = 0; v < tree.dof(); ++v) {
    if (q[v] == rest[v]) continue;
    text += fmt::format("{}{}={:.6g}", text.empty() ? "" : ",", tree.variableName(v), q[v]);
  }
  return text.empty() ? "rest" : text;
}

std::string lineOf(const KinematicTree& tree, const LinkPairFinding& pair) {
  std::string text = fmt::format("{} and {}{}", pair.link1, pair.link2, pair.neighbours ? " (neighbours)" : "");
  switch (pair.kind) {
    case LinkPairKind::never:
      break;
    case LinkPairKind::always:
      text += pair.proven ? ": proven, no joint moves them apart" : fmt::format(": in all {} tried", pair.tried);
      break;
    case LinkPairKind::sometimes:
      text += fmt::format(": in {} of {} tried, as at {}", pair.touching, pair.tried,
                          configurationText(tree, pair.configuration));
      break;
    case LinkPairKind::unproven:
      if (pair.tried == 0) text += ": a joint between them has no bounds";
      if (std::isfinite(pair.nearest)) {
        text += fmt::format(": within {:.3g} m at {}", pair.nearest, configurationText(tree, pair.configuration));
      }
      break;
  }
  return text;
}

Json jsonOf(const KinematicTree& tree, const LinkPairFinding& pair) {
  Json out = {{"link1", pair.link1},
              {"link2", pair.link2},
              {"kind", toString(pair.kind)},
              {"neighbours", pair.neighbours},
              {"proven", pair.proven},
              {"tried", pair.tried},
              {"touching", pair.touching},
              {"apart", pair.apart},
              {"nearest", std::isfinite(pair.nearest) ? Json(pair.nearest) : Json()},
              {"configuration", Json()}};
  if (pair.configuration.size() == 0) return out;
  Json& q = out["configuration"] = Json::object();
  for (int v = 0; v < tree.dof(); ++v) q[tree.variableName(v)] = pair.configuration[v];
  return out;
}

/// The picture of a pair.
std::string pictureOf(const std::string& folder, const std::string& link1, const std::string& link2) {
  std::string name = link1 + "-" + link2 + ".png";
  std::replace(name.begin(), name.end(), '/', '_');  // a link's name is no path
  return folder + "/" + name;
}

/// Removes the pictures of an earlier run, of any pair of the robot's links.
void removePictures(const KinematicTree& tree, const std::string& folder) {
  for (LinkId a = 0; a < tree.numLinks(); ++a) {
    for (LinkId b = 0; b < tree.numLinks(); ++b) {
      std::string path = pictureOf(folder, tree.linkName(a), tree.linkName(b));
      removeEarlierOutputs({{"--images", &path}}, {});
    }
  }
}

/// Draws each pair that touches sometimes, where it does.
void drawTouching(const Robot& robot, const LinkPairReport& report, const std::string& folder) {
  std::filesystem::create_directories(folder);
  for (const LinkPairFinding& pair : report.pairs) {
    if (pair.kind != LinkPairKind::sometimes) continue;
    ArticulatedCollisionManager manager(robot.tree);
    for (const LinkGeometry& geometry : robot.geometry) {
      const std::string& name = robot.tree->linkName(geometry.link);
      if (name == pair.link1 || name == pair.link2) manager.bind(geometry.link, geometry.object, geometry.offset);
    }
    manager.setup();
    render::PictureOptions options;
    options.title = fmt::format("{} and {}", pair.link1, pair.link2);
    const std::string path = pictureOf(folder, pair.link1, pair.link2);
    render::writePicture(
        path, robot, {}, [&](double) { return pair.configuration; }, manager.collide(pair.configuration), options);
    fmt::print("picture {}\n", path);
  }
}

/// Values of all joints; where some are named, the others are at rest, and "rest" names none.
Eigen::VectorXd allowedAt(const KinematicTree& tree, const std::vector<std::string>& words) {
  const char* const option = "--allow-at";
  if (words == std::vector<std::string>{"rest"}) return restOf(tree);
  const bool named = words.front().find('=') != std::string::npos;
  if (!named) return parseConfiguration(tree, words, option);
  const Eigen::VectorXd rest = restOf(tree);
  std::map<std::string, double> others;
  for (int v = 0; v < tree.dof(); ++v) others[tree.variableName(v)] = rest[v];
  for (const auto& [name, value] : parseValues(tree, words, option)) others.erase(name);
  return parseConfiguration(tree, words, option, others);
}

/// Pairs that touch in a configuration, or are too near to tell, of those that need a check.
std::vector<SrdfPair> touchingAt(Robot robot, const LinkPairReport& report, const Eigen::VectorXd& q, double margin) {
  robot.allowed = report.needNoCheck();
  robot.allowed.setComplete();
  ArticulatedCollisionManager manager(robot.tree);
  robot.addTo(manager);
  manager.setup();
  CertifiedRequest request;
  request.mode = ContactMode::firstOfEveryPair;
  request.max_contacts = report.pairs.size();
  request.margin = margin;
  std::vector<SrdfPair> pairs;
  for (const CertifiedContact& c : manager.collide(q, request).contacts) {
    pairs.push_back({c.body1.name, c.body2.name, "Unproven"});
  }
  return pairs;
}

/// " and, unproven, 2 pairs that touch at elbow=1: a and b; b and c".
std::string allowedText(const std::vector<SrdfPair>& pairs, const std::string& at) {
  std::string text =
      fmt::format(" and, unproven, {} that touch{} at {}", pairsText(pairs.size()), pairs.size() == 1 ? "es" : "", at);
  for (const SrdfPair& pair : pairs)
    text += fmt::format("{} {} and {}", &pair == &pairs.front() ? ":" : ";", pair.link1, pair.link2);
  return text;
}

/// Exit status for the pairs reported: those that an SRDF disables, or all.
int exitStatusOf(const LinkPairReport& disabled) {
  if (disabled.count(LinkPairKind::sometimes) > 0) return kExitContact;
  return disabled.count(LinkPairKind::unproven) > 0 ? kExitUndecided : kExitFree;
}

void printPairs(const KinematicTree& tree, const LinkPairReport& report, bool all) {
  for (const LinkPairKind kind : kKinds) {
    const std::size_t count = report.count(kind);
    if (count == 0) continue;
    fmt::print("  {:4} {}: {}\n", count, toString(kind), meaningOf(kind));
    if (!all && kind == LinkPairKind::never) continue;
    for (const LinkPairFinding& pair : report.pairs) {
      if (pair.kind == kind) fmt::print("         {}\n", lineOf(tree, pair));
    }
  }
}

int runSrdf(SrdfVerb& options) {
  if (!options.images.empty()) render::requirePictures();
  removeEarlierOutputs({{"--write", &options.write}}, {options.robot.robot, options.check});
  Robot robot = loadUrdf(options.robot.robot, urdfOptions(options.robot));
  const KinematicTree& tree = *robot.tree;
  if (!options.images.empty()) removePictures(tree, options.images);
  std::optional<Eigen::VectorXd> allow_at;  // read before the long work
  if (!options.allow_at.empty()) allow_at = allowedAt(tree, options.allow_at);
  std::optional<AllowedCollisionMatrix> disabled;
  if (!options.check.empty()) disabled = loadSrdf(options.check, tree, &robot.notes);
  const LinkPairReport report = classify(robot, options.search);
  LinkPairReport of_file;
  if (disabled) {
    for (const LinkPairFinding& pair : report.pairs) {
      if (disabled->allowed(pair.link1, pair.link2)) of_file.pairs.push_back(pair);
    }
  }
  if (options.json) {
    Json out = {
        {"robot", tree.name()}, {"margin", options.search.margin}, {"notes", robot.notes}, {"pairs", Json::array()}};
    for (const LinkPairFinding& pair : report.pairs) {
      Json one = jsonOf(tree, pair);
      if (disabled) one["disabled"] = disabled->allowed(pair.link1, pair.link2);
      out["pairs"].push_back(std::move(one));
    }
    fmt::print("{}\n", out.dump(2));
  } else if (disabled) {
    fmt::print("{} disables {} of links with geometry:\n", options.check, pairsText(of_file.pairs.size()));
    printPairs(tree, of_file, false);
    LinkPairReport missing;
    for (const LinkPairFinding& pair : report.pairs) {
      if (pair.kind == LinkPairKind::always && !disabled->allowed(pair.link1, pair.link2))
        missing.pairs.push_back(pair);
    }
    if (!missing.pairs.empty()) {
      fmt::print("It leaves {} to be checked that no motion is free of:\n", missing.pairs.size());
      printPairs(tree, missing, true);
    }
  } else {
    fmt::print("{}: {} of links with geometry:\n", tree.name(), pairsText(report.pairs.size()));
    printPairs(tree, report, true);
  }
  if (!options.json) {
    for (const std::string& note : robot.notes) fmt::print("note: {}\n", note);
  }
  if (!options.write.empty()) {
    std::vector<SrdfPair> touching;
    if (allow_at) touching = touchingAt(robot, report, *allow_at, options.search.margin);
    writeSrdf(options.write, tree.name(), report, touching);
    const std::string more = allow_at ? allowedText(touching, configurationText(tree, *allow_at)) : "";
    if (!options.json) fmt::print("{}{} written to {}\n", summaryOf(report), more, options.write);
  }
  if (!options.images.empty()) drawTouching(robot, disabled ? of_file : report, options.images);
  return disabled ? exitStatusOf(of_file) : kExitFree;
}

}  // namespace

LinkPairReport classify(const Robot& robot, LinkPairOptions options) {
  ProgressBar bar;
  options.progress = [&bar](std::size_t done, std::size_t total) {
    bar.show(static_cast<double>(done) / static_cast<double>(total));
  };
  return generateAllowedCollisions(robot, options);
}

std::string summaryOf(const LinkPairReport& report) {
  const std::size_t all = report.needNoCheck().pairs().size(), apart = report.count(LinkPairKind::never);
  const std::size_t always = report.alwaysTouching().pairs().size();
  return fmt::format(
      "{} of links that need no check ({} proven apart, {} neighbours that touch, {} others always in contact)",
      pairsText(all), apart, all - apart - always, always);
}

std::vector<std::string> doubtsOf(const KinematicTree& tree, const LinkPairReport& disabled, double margin) {
  const auto carrier = [&](const std::string& name) { return carrierOf(tree, tree.linkId(name)); };
  std::vector<std::string> lines;
  const std::string touch = margin > 0 ? fmt::format("come within the margin of {:g} m", margin) : "touch";
  const std::string apart = margin > 0 ? fmt::format(" by the margin of {:g} m", margin) : "";
  const auto names = [&](LinkPairKind kind) {
    constexpr std::size_t kMax = 3;
    std::string text;
    std::size_t count = 0;
    for (const LinkPairFinding& pair : disabled.pairs) {
      if (pair.kind != kind || carrier(pair.link1) == carrier(pair.link2)) continue;  // no motion changes the latter
      if (count++ < kMax) text += fmt::format("{}{} and {}", text.empty() ? "" : "; ", pair.link1, pair.link2);
    }
    if (count > kMax) text += fmt::format("; and {} more", count - kMax);
    return std::make_pair(count, text);
  };
  if (const auto [count, text] = names(LinkPairKind::sometimes); count > 0) {
    lines.push_back(fmt::format("{} can {}, and {} not checked: {}", text::counted(count, "allowed pair"), touch,
                                count == 1 ? "is" : "are", text));
  }
  if (const auto [count, text] = names(LinkPairKind::unproven); count > 0) {
    lines.push_back(
        fmt::format("{} allowed pair{} not proven apart{}: {}", count, count == 1 ? " is" : "s are", apart, text));
  }
  if (!lines.empty()) lines.back() += " (fcl_artic srdf --check tells more)";
  return lines;
}

void addSrdf(CLI::App& program, int& exit_status) {
  auto options = std::make_shared<SrdfVerb>();
  SrdfVerb& o = *options;
  CLI::App* srdf = program.add_subcommand(
      "srdf", "Which pairs of a robot's links need no check, proven; and whether an SRDF's are right");
  srdf->footer(
      "Pairs that never touch are proven apart for all joint values within their limits; pairs that touch are shown\n"
      "with a configuration. The answer depends on no random numbers.\n"
      "Exit status: 0, or with --check: 0 every disabled pair never touches, proven, or always does; 1 one touches\n"
      "sometimes; 3 neither is known of one; 2 error.");
  addRobotFile(*srdf, o.robot);
  srdf->add_option("--check", o.check, "Look at the pairs that this SRDF disables")->type_name("FILE");
  CLI::Option* write =
      srdf->add_option("--write", o.write, "Write the pairs that need no check, as SRDF")->type_name("FILE");
  srdf->add_option("--allow-at", o.allow_at,
                   "Have --write allow the pairs too that touch in this configuration, marked as unproven: all values, "
                   "NAME=VALUE of those that are not at rest, or 'rest'")
      ->needs(write)
      ->type_name("Q");
  srdf->add_flag("--solid-meshes", o.robot.solid_meshes, "Meshes are solids: what lies within one touches it");
  srdf->add_option("--margin", o.search.margin, "Links must keep this distance to count as apart, in m")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  srdf->add_option("--work", o.search.work, "Tests at most for one pair; what needs more is checked")
      ->capture_default_str();
  srdf->add_option("--samples", o.search.samples, "Configurations to try for one pair")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  srdf->add_option("--threads", o.search.threads, "Threads at most; 0: as many as the machine runs at once")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  srdf->add_option("--images", o.images, "Draw each pair that touches sometimes to a PNG in this folder")
      ->type_name("DIR");
  srdf->add_flag("--json", o.json, "JSON instead of text");
  srdf->callback([options, &exit_status] { exit_status = runSrdf(*options); });
}

}  // namespace fcl_artic::app
