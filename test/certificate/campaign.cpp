// SPDX-License-Identifier: BSD-3-Clause
//
// Certificates of many answers, proven again by the verifier: how many hold, how large they are, how long they take;
// and forged ones, of which none must.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "arm_scene.h"
#include "fcl_artic/fcl_artic.h"
#include "modes/world.h"
#include "pairs/random_pairs.h"
#include "planning/problems.h"
#include "proof.h"
#include "sha256.h"
#include "tables/random_links.h"
#include "urdf/tree_campaign.h"

namespace fcl_artic {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using campaign::Tally;

double microseconds(Clock::time_point begin) {
  return std::chrono::duration<double, std::micro>(Clock::now() - begin).count();
}

void print(const std::string& name, const Tally& tally) {
  std::printf("%s", toText(name, tally).c_str());
  std::fflush(stdout);
}

/// The text with the value of one of its lines replaced.
std::string withLine(std::string text, const std::string& key, const std::string& value) {
  const std::size_t begin = text.find("\n" + key + " ") + 1, end = text.find('\n', begin);
  return text.replace(begin, end - begin, key + " " + value);
}

/// A record that names its motion by the right hash, whatever the motion is.
std::string recordOf(const std::string& motion, const std::string& nodes) {
  Certificate forged;
  forged.motion = motion;
  forged.proof = verify::sha256(motion) + nodes;
  return forged.record();
}

/// Has certificates proven again, written to files, forged.
class Judge {
 public:
  Judge(fs::path folder, bool forge, std::size_t flips) : folder_(std::move(folder)), forge_(forge), flips_(flips) {
    if (!folder_.empty()) fs::create_directories(folder_);
  }

  /// @param free  the motion is; else it certainly touches, if `meets`.
  void look(const std::string& name, const Certificate& certificate, bool free, bool meets, Tally& tally) {
    if (certificate.world != world_text_) {
      world_text_ = certificate.world;
      world_ = std::make_unique<verify::World>(verify::readWorld(*world_text_));
      kept_.clear();
    }
    const std::string record = certificate.record();
    const auto begin = Clock::now();
    const verify::Verdict verdict = verdictOn(record);
    tally.note("verifier, us", microseconds(begin));
    tally.count("VERIFIED", verdict.verified);
    tally.count("with a meeting", verdict.verified && verdict.contact);
    if (!verdict.verified) tally.fault("NOT VERIFIED: " + name + ": " + verdict.reason);
    write(name, record);
    if (forge_) forge(certificate, free, meets, tally);
  }

 private:
  verify::Verdict verdictOn(const std::string& record) const {
    return verify::verifyRecord(*world_, verify::splitRecords(record).at(0));
  }
  bool isVerified(const std::string& record) const {
    try {
      return verdictOn(record).verified;
    } catch (const verify::BadInput&) {
      return false;
    }
  }
  void write(const std::string& name, const std::string& record) const {
    if (folder_.empty()) return;
    const fs::path world = folder_ / (name + ".world");
    if (!fs::exists(world)) std::ofstream(world, std::ios::binary) << *world_text_;
    std::ofstream(folder_ / (name + ".fac"), std::ios::binary | std::ios::app) << record;
  }

  void forge(const Certificate& certificate, bool free, bool meets, Tally& tally) {
    const std::string nodes = certificate.proof.substr(32);
    // A bit more or less. The claim stays what it is, as the motion's hash shows: what is accepted is a proof all the
    // same. A flipped bit of the motion or of the hash is never accepted.
    const std::string record = certificate.record();
    const std::size_t hints = record.size() - nodes.size(), bits = 8 * record.size();
    const std::size_t count = flips_ == 0 ? bits : flips_;
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t bit = flips_ == 0 ? i : random_() % bits;
      std::string flipped = record;
      flipped[bit / 8] = static_cast<char>(flipped[bit / 8] ^ (1 << bit % 8));
      const bool accepted = isVerified(flipped), of_motion = bit / 8 < hints;
      tally.mutant("a bit of the motion flipped", 1, of_motion, of_motion && !accepted);
      tally.mutant("a bit of the proof flipped", 0, !of_motion, !of_motion && !accepted);
      if (of_motion && accepted) tally.fault("A RECORD OF ANOTHER MOTION WAS ACCEPTED");
    }
    if (free) {
      if (kept_.size() < 20) kept_.push_back(nodes);
      return;
    }
    if (!meets) return;
    // It touches, and is claimed not to: with its own proof, stretched, and with those of free motions of this world.
    const std::string lie = withLine(certificate.motion, "until", "0x1p+0");
    std::vector<std::string> proofs = kept_;
    proofs.push_back(nodes);
    if (const std::size_t at = nodes.rfind(std::string("\x20\0", 2)); at != std::string::npos)
      proofs.push_back(nodes.substr(0, at));
    for (const std::string& proof : proofs) {
      const bool accepted = verdictOn(recordOf(lie, proof)).verified;
      tally.mutant("a false claim with a forged proof", 1, true, !accepted);
      if (accepted) tally.fault("A FALSE CLAIM WAS ACCEPTED");
    }
  }

  fs::path folder_;
  bool forge_;
  std::size_t flips_;
  std::shared_ptr<const std::string> world_text_;
  std::unique_ptr<verify::World> world_;
  std::vector<std::string> kept_;  ///< nodes of free motions of this world
  std::mt19937_64 random_{7};
};

/// Takes an answer's certificate, if it has a proof.
template <class Result>
void take(const std::string& name, const Result& result, Judge& judge, Tally& tally) {
  const Certificate& certificate = *result.certificate;
  if (!certificate) {
    const bool nothing = certificate.missing.rfind("nothing is claimed", 0) == 0;
    tally.count("nothing claimed", nothing);
    tally.count("without a proof", !nothing);
    if (!nothing) std::printf("%s: %s\n", name.c_str(), certificate.missing.c_str());
    return;
  }
  tally.note("proof, bytes", static_cast<double>(certificate.proof.size()));
  tally.note("motion's text, bytes", static_cast<double>(certificate.motion.size()));
  judge.look(name, certificate, result.isFree(), result.certain, tally);
}

/// Asks for an answer, and again for its certificate. A certificate that fails leaves its query as a file.
/// @param query  query(request, result)
/// @param text  text(request), as campaign::QueryFiles::add() has it
template <class Result, class Request, class Query, class Text>
void ask(const Query& query, const Text& text, Request request, bool others, const std::string& name, Judge& judge,
         Tally& tally) {
  Result result;
  query(request, result);
  const auto begin = Clock::now();
  query(request, result);
  const double query_us = microseconds(begin);
  tally.count("free", result.isFree());
  tally.count("others", !result.isFree());
  if (!result.isFree() && !others) return;
  request.certificate = true;
  const auto again = Clock::now();
  query(request, result);
  tally.note("query with certificate, us", microseconds(again));
  tally.note("query, us", query_us);
  const std::uint64_t faults = tally.faults();
  take(name, result, judge, tally);
  if (tally.faults() == faults) return;
  campaign::QueryFiles files(campaign::QueryFiles::usualFolder(), "certificate-" + name + "-" + std::to_string(faults));
  files.add([&] { return text(request); });
  std::printf("%s:\n%s", name.c_str(), files.lines().c_str());
}
template <class Motion>
void ask(const ArticulatedCollisionManager& manager, const Motion& motion, bool others, const std::string& name,
         Judge& judge, Tally& tally, const CertifiedRequest& request = {}) {
  ask<CertifiedResult>(
      [&](const CertifiedRequest& own, CertifiedResult& result) { manager.continuousCollide(motion, own, result); },
      [&](const CertifiedRequest& own) { return manager.writeQuery(motion, own); }, request, others, name, judge,
      tally);
}

void panda(const fs::path& data, std::size_t most, bool others, Judge& judge, Tally& all) {
  using namespace planning_data;
  const Robot robot = readRobot(data, "panda");
  for (const std::string name : {"bookshelf_small", "bookshelf_tall", "bookshelf_thin", "box", "cage", "table_pick",
                                 "table_under_pick", "thin"}) {
    const Environment environment = readEnvironment(data / "problems/panda" / (name + ".json"), *robot.tree);
    std::map<int, std::shared_ptr<const ArticulatedCollisionManager>> managers;
    Tally tally;
    std::size_t asked[2] = {0, 0};
    for (const Edge& edge : readTrace(data / "edges" / ("panda_trace." + name + ".json"))) {
      if (edge.hit && !others) continue;
      if (asked[edge.hit]++ >= most) continue;
      auto& manager = managers[edge.problem];
      const std::string file = name + "_" + std::to_string(edge.problem);
      if (!manager) manager = makeManager(robot, environment.problem(edge.problem).scene);
      const auto motion = JointMotion::linear(*robot.tree, environment.configuration(*robot.tree, edge.from),
                                              environment.configuration(*robot.tree, edge.to));
      ask(*manager, motion, others, file, judge, tally);
    }
    print(name, tally);
    all.add(tally);
  }
}

/// Two bodies of any kinds, by FCL's motions (data/pairs).
void pairsOf(pairs::Bodies bodies, const char* set, std::size_t most, std::uint64_t seed, bool others, Judge& judge,
             Tally& all) {
  using namespace pairs;
  Tally tally;
  for (const Moves moves : {Moves::interp, Moves::translation, Moves::screw, Moves::spline}) {
    for (std::size_t i = 0; i < most / 4; ++i) {
      PairOptions options;
      options.bodies = bodies;
      options.moves = moves;
      options.graze = i % 4 == 3;
      options.unbounded = true;
      const PairQuery query = makePair(options, seed + i);
      const auto motion1 = query.path1->motion(), motion2 = query.path2->motion();
      ask<CertifiedPairResult>(
          [&](const CertifiedPairRequest& request, CertifiedPairResult& result) {
            fcl_artic::continuousCollide(query.body1->geometry.get(), motion1.get(), query.body2->geometry.get(),
                                         motion2.get(), request, result);
          },
          [](const CertifiedPairRequest&) -> std::string { throw std::invalid_argument(campaign::kTwoBodies); },
          CertifiedPairRequest(), others, set + std::to_string(static_cast<int>(moves)) + "_" + std::to_string(i),
          judge, tally);
    }
  }
  print(set, tally);
  all.add(tally);
}

/// The arm of bench_arm amid spheres, 100,000 triangles, without self-collision.
void arm(std::size_t most, std::uint64_t seed, bool others, Judge& judge, Tally& all) {
  bench::ArmSceneOptions options;
  options.seed = seed;
  const bench::ArmScene scene = bench::makeArmScene(options);
  ArticulatedCollisionManager manager(scene.tree);
  for (const bench::ArmLink& link : scene.links) {
    manager.bind(link.link, std::make_shared<fcl::CollisionObjectd>(bench::toBvh<fcl::OBBRSSd>(link.mesh)),
                 link.offset);
  }
  for (const bench::TriangleMesh& mesh : scene.obstacles) {
    manager.registerObject(std::make_shared<fcl::CollisionObjectd>(bench::toBvh<fcl::OBBRSSd>(mesh)));
  }
  manager.setup();
  CertifiedRequest request;
  request.check_self = false;
  for (const double step : {1.0, 5.0, 30.0}) {
    const auto ends = bench::makeArmQueries(scene, step * bench::kPi / 180, most, options.seed, [&](const auto& q) {
      return !manager.continuousCollide(q.q0, q.q1, request).isFree();
    });
    Tally tally;
    for (const auto& set : ends) {
      for (const bench::ArmQuery& q : set) {
        ask(manager, JointMotion::linear(*scene.tree, q.q0, q.q1), others, "arm", judge, tally, request);
      }
    }
    print("arm, " + std::to_string(static_cast<int>(step)) + " degrees", tally);
    all.add(tally);
  }
}

/// Two links with up to three joint variables between them, which have tables (test/tables), on small and large
/// motions.
void links(std::size_t most, std::uint64_t seed, bool others, Judge& judge, Tally& all) {
  Tally tally;
  for (std::size_t i = 0; i < most; ++i) {
    pairs::Random random(pairs::Random::mix(seed, i));
    const tables::RandomLinks links(random);
    ArticulatedCollisionManager manager(links.tree);
    manager.bind("a", links.a, links.on_a);
    manager.bind("b", links.b, links.on_b);
    if (links.margin > 0) manager.setMargin("a", "b", links.margin);
    manager.setup();
    for (int k = 0; k < 40; ++k) {
      const Eigen::VectorXd q0 = links.draw(random), q1 = q0 + random.logUniform(1e-5, 1) * (links.draw(random) - q0);
      const auto motion = JointMotion::linear(*links.tree, q0, q1);
      ask(manager, motion, others, "links_" + std::to_string(i), judge, tally);
    }
  }
  print("links", tally);
  all.add(tally);
}

/// Random robots from URDF text (test/urdf).
void trees(std::size_t most, std::uint64_t seed, bool others, Judge& judge, Tally& all) {
  Tally tally;
  const auto trees = urdf_trees::campaignOfTrees([&](campaign::Case& c, const CertifiedResult& result) {
    if (c.files) return;  // counted already
    tally.count("free", result.isFree());
    tally.count("others", !result.isFree());
    const std::uint64_t faults = tally.faults();
    if (result.isFree() || others) take("tree_" + std::to_string(c.index), result, judge, tally);
    if (tally.faults() > faults) c.fault("certificate", "which one, stands below");
  });
  campaign::Options options;
  options.cases = most;
  options.seed = seed;
  options.threads = 1;
  const campaign::Report report = run(trees, options);
  std::printf("%s", toText(report).c_str());
  print("trees", tally);
  all.add(tally);
  for (const auto& [kind, cases] : report.total.faultKinds()) all.fault(kind);
}

/// Trajectories of the Panda: from one end of an edge to the other and on to a third configuration, as cubic pieces, at
/// rest at the ends only, and with straight pieces and parabolic blends.
void trajectories(const fs::path& data, std::size_t most, bool others, Judge& judge, Tally& all) {
  using namespace planning_data;
  const Robot robot = readRobot(data, "panda");
  const KinematicTree& tree = *robot.tree;
  Tally tally;
  for (const std::string name : {"bookshelf_small", "box", "cage", "table_pick", "thin"}) {
    const Environment environment = readEnvironment(data / "problems/panda" / (name + ".json"), tree);
    std::map<int, std::shared_ptr<const ArticulatedCollisionManager>> managers;
    std::map<int, Eigen::VectorXd> last;
    std::size_t asked = 0;
    for (const Edge& edge : readTrace(data / "edges" / ("panda_trace." + name + ".json"))) {
      if (edge.hit) continue;
      if (asked >= most) break;
      auto& manager = managers[edge.problem];
      if (!manager) manager = makeManager(robot, environment.problem(edge.problem).scene);
      const Eigen::VectorXd q0 = environment.configuration(tree, edge.from),
                            q1 = environment.configuration(tree, edge.to);
      const auto before = last.find(edge.problem);
      const Eigen::VectorXd q2 = before == last.end() ? q0 : Eigen::VectorXd(q1 + 0.2 * (before->second - q1));
      last[edge.problem] = q0;
      const std::vector<double> times = {0, 1, 1.7};
      const Eigen::VectorXd rest = Eigen::VectorXd::Zero(q0.size());
      const std::string file = "trajectory_" + name + "_" + std::to_string(edge.problem);
      ask(*manager, JointTrajectory::cubic(tree, times, {q0, q1, q2}, {rest, 0.2 * (q2 - q0), rest}), others, file,
          judge, tally);
      ask(*manager, JointTrajectory::parabolicBlends(tree, times, {q0, q1, q2}, 0.2), others, file, judge, tally);
      ++asked;
    }
  }
  print("trajectories", tally);
  all.add(tally);
}

/// Small worlds with all that there is: attached objects, moving obstacles, margins, trajectories, solids, ignored
/// contacts (test/modes).
void modesOf(std::size_t most, std::uint64_t seed, bool others, Judge& judge, Tally& all) {
  std::map<std::string, Tally> tallies;
  for (std::size_t i = 0; i < most; ++i) {
    modes::Random random(seed + i);
    const modes::World world(random);
    CertifiedRequest request;
    request.margin = random.chance(0.3) ? random.in(0, 0.05) : 0;
    request.ignore_initial_contact = random.chance(0.3);
    const std::string kind = world.isPair()         ? "modes, pair"
                             : world.isTrajectory() ? "modes, trajectory"
                                                    : "modes, motion";
    ask<CertifiedResult>([&](const CertifiedRequest& own, CertifiedResult& result) { world.ask(own, result); },
                         [&](const CertifiedRequest& own) { return world.writeQuery(own); }, request, others,
                         "modes_" + std::to_string(i), judge, tallies[kind]);
  }
  for (const auto& [kind, tally] : tallies) {
    print(kind, tally);
    all.add(tally);
  }
}

}  // namespace
}  // namespace fcl_artic

int main(int argc, char** argv) try {
  using namespace fcl_artic;
  CLI::App app("Certificates of many answers (FCL_ARTIC_DATA names the data of the set panda)");
  std::string out, set = "panda";
  std::size_t most = 1000000;
  std::size_t flips = 20;
  std::uint64_t seed = 1;
  bool others = false, forge = false;
  app.add_option("--out", out, "folder for worlds and certificates");
  app.add_option("--set", set, "motions")
      ->check(CLI::IsMember({"panda", "trajectories", "arm", "trees", "links", "meshes", "shapes", "mixed", "modes"}))
      ->capture_default_str();
  app.add_option("--most", most, "motions of each part of the set")->capture_default_str();
  app.add_option("--seed", seed, "of what is random")->capture_default_str();
  app.add_flag("--forge", forge, "also flip bits of proofs, and try to pass colliding motions off as free");
  app.add_option("--flips", flips, "bits of each record, one at a time; 0: every one")->capture_default_str();
  app.add_flag("--contacts", others, "motions that are not free, too: until their t_lower");
  CLI11_PARSE(app, argc, argv);
  Judge judge(out, forge, flips);
  Tally all;
  if (set == "arm") {
    arm(most, seed, others, judge, all);
  } else if (set == "links") {
    links(most, seed, others, judge, all);
  } else if (set == "trees") {
    trees(most, seed, others, judge, all);
  } else if (set == "modes") {
    modesOf(most, seed, others, judge, all);
  } else if (set != "panda" && set != "trajectories") {
    const std::map<std::string, pairs::Bodies> bodies = {
        {"meshes", pairs::Bodies::meshes}, {"shapes", pairs::Bodies::shapes}, {"mixed", pairs::Bodies::mixed}};
    pairsOf(bodies.at(set), set.c_str(), most, seed, others, judge, all);
  } else {
    const std::filesystem::path data = planning_data::sharedData();
    if (data.empty()) {
      std::cout << "FCL_ARTIC_DATA does not name a folder with robots/, problems/ and edges/\n";
      return 0;
    }
    (set == "panda" ? panda : trajectories)(data, most, others, judge, all);
  }
  print("all", all);
  return all.faults() == 0 && all["VERIFIED"] > 0 ? 0 : 1;
} catch (const std::exception& error) {
  std::cerr << "certificate_campaign: " << error.what() << '\n';
  return 1;
}
