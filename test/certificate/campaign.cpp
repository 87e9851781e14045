// SPDX-License-Identifier: BSD-3-Clause
//
// Certificates of many answers: how many there are, how large, how long they take, and the files for fcl_artic_verify,
// which says whether they hold.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "arm_scene.h"
#include "fcl_artic/fcl_artic.h"
#include "modes/world.h"
#include "pairs/random_pairs.h"
#include "planning/problems.h"

namespace fcl_artic {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

double microseconds(Clock::time_point begin) {
  return std::chrono::duration<double, std::micro>(Clock::now() - begin).count();
}

struct Sum {
  std::size_t free = 0, other = 0, missing = 0;
  std::vector<double> query_us, emit_us, bytes, motion_bytes;
  std::map<std::string, int> reasons;
};

double at(std::vector<double> values, double part) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(part * static_cast<double>(values.size() - 1))];
}

void print(const std::string& name, const Sum& sum) {
  std::printf(
      "%-18s free %6zu (without a certificate %zu), others %zu; proof bytes %5.0f %5.0f %6.0f (motion %4.0f); query us "
      "%7.1f, with certificate %8.1f %8.1f %8.1f\n",
      name.c_str(), sum.free, sum.missing, sum.other, at(sum.bytes, 0.5), at(sum.bytes, 0.95), at(sum.bytes, 1),
      at(sum.motion_bytes, 0.5), at(sum.query_us, 0.5), at(sum.emit_us, 0.5), at(sum.emit_us, 0.95),
      at(sum.emit_us, 1));
  for (const auto& [reason, n] : sum.reasons) std::printf("    %d times: %s\n", n, reason.c_str());
  std::fflush(stdout);
}

class Writer {
 public:
  explicit Writer(fs::path folder) : folder_(std::move(folder)) {
    if (!folder_.empty()) fs::create_directories(folder_);
  }
  void add(const std::string& name, const Certificate& certificate) const {
    if (folder_.empty()) return;
    const fs::path world = folder_ / (name + ".world");
    if (!fs::exists(world)) std::ofstream(world, std::ios::binary) << *certificate.world;
    std::ofstream(folder_ / (name + ".fac"), std::ios::binary | std::ios::app) << certificate.record();
  }

 private:
  fs::path folder_;
};

/// Asks for an answer, and again for its certificate.
/// @param query  query(request, result)
template <class Request, class Result, class Query>
void ask(const Query& query, bool others, const std::string& name, const Writer& writer, Sum& sum) {
  Request request;
  Result result;
  query(request, result);
  const auto begin = Clock::now();
  query(request, result);
  const double query_us = microseconds(begin);
  if (!result.isFree()) ++sum.other;
  if (!result.isFree() && !others) return;
  request.certificate = true;
  const auto again = Clock::now();
  query(request, result);
  sum.emit_us.push_back(microseconds(again));
  sum.query_us.push_back(query_us);
  sum.free += result.isFree();
  if (!*result.certificate) {
    ++sum.missing;
    ++sum.reasons[result.certificate->missing];
    return;
  }
  sum.bytes.push_back(static_cast<double>(result.certificate->proof.size()));
  sum.motion_bytes.push_back(static_cast<double>(result.certificate->motion.size()));
  writer.add(name, *result.certificate);
}
template <class Motion>
void ask(const ArticulatedCollisionManager& manager, const Motion& motion, bool others, const std::string& name,
         const Writer& writer, Sum& sum) {
  ask<CertifiedRequest, CertifiedResult>(
      [&](const CertifiedRequest& request, CertifiedResult& result) {
        manager.continuousCollide(motion, request, result);
      },
      others, name, writer, sum);
}

void panda(const fs::path& data, std::size_t most, bool others, const Writer& writer) {
  using namespace planning_data;
  const Robot robot = readRobot(data, "panda");
  Sum all;
  for (const std::string name : {"bookshelf_small", "bookshelf_tall", "bookshelf_thin", "box", "cage", "table_pick",
                                 "table_under_pick", "thin"}) {
    const Environment environment = readEnvironment(data / "problems/panda" / (name + ".json"), *robot.tree);
    std::map<int, std::shared_ptr<const ArticulatedCollisionManager>> managers;
    Sum sum;
    std::size_t asked = 0;
    for (const Edge& edge : readTrace(data / "edges" / ("panda_trace." + name + ".json"))) {
      if (edge.hit && !others) continue;
      if (asked++ == most) break;
      auto& manager = managers[edge.problem];
      const std::string file = name + "_" + std::to_string(edge.problem);
      if (!manager) manager = makeManager(robot, environment.problem(edge.problem).scene);
      const auto motion = JointMotion::linear(*robot.tree, environment.configuration(*robot.tree, edge.from),
                                              environment.configuration(*robot.tree, edge.to));
      ask(*manager, motion, others, file, writer, sum);
      ask(*manager, motion, others, file, Writer({}), all);
    }
    print(name, sum);
  }
  print("panda, all", all);
}

/// Two bodies of any kinds, by FCL's motions (data/pairs).
void pairsOf(pairs::Bodies bodies, const char* set, std::size_t most, std::uint64_t seed, bool others,
             const Writer& writer) {
  using namespace pairs;
  Sum sum;
  for (const Moves moves : {Moves::interp, Moves::translation, Moves::screw, Moves::spline}) {
    for (std::size_t i = 0; i < most / 4; ++i) {
      PairOptions options;
      options.bodies = bodies;
      options.moves = moves;
      options.graze = i % 4 == 3;
      options.unbounded = true;
      const PairQuery query = makePair(options, seed + i);
      const auto motion1 = query.path1->motion(), motion2 = query.path2->motion();
      ask<CertifiedPairRequest, CertifiedPairResult>(
          [&](const CertifiedPairRequest& request, CertifiedPairResult& result) {
            fcl_artic::continuousCollide(query.body1->geometry.get(), motion1.get(), query.body2->geometry.get(),
                                         motion2.get(), request, result);
          },
          others, set + std::to_string(static_cast<int>(moves)) + "_" + std::to_string(i), writer, sum);
    }
  }
  print(set, sum);
}

/// The arm of bench_arm amid spheres, 100,000 triangles, without self-collision.
void arm(std::size_t most, std::uint64_t seed, bool others, const Writer& writer) {
  bench::ArmSceneOptions options;
  options.seed = seed;
  const bench::ArmScene scene = bench::makeArmScene(options);
  ArticulatedCollisionManager manager(scene.tree);
  for (const bench::ArmLink& link : scene.links) {
    manager.bind(link.link, std::make_shared<fcl::CollisionObjectd>(bench::toBvh<fcl::OBBRSSd>(link.mesh)), link.offset);
  }
  for (const bench::TriangleMesh& mesh : scene.obstacles) {
    manager.registerObject(std::make_shared<fcl::CollisionObjectd>(bench::toBvh<fcl::OBBRSSd>(mesh)));
  }
  manager.setup();
  for (const double step : {1.0, 5.0, 30.0}) {
    const auto ends = bench::makeArmQueries(scene, step * bench::kPi / 180, most, options.seed, [&](const auto& q) {
      CertifiedRequest request;
      request.check_self = false;
      return !manager.continuousCollide(q.q0, q.q1, request).isFree();
    });
    Sum sum;
    for (const auto& set : ends) {
      for (const bench::ArmQuery& q : set) {
        ask<CertifiedRequest, CertifiedResult>(
            [&](const CertifiedRequest& request, CertifiedResult& result) {
              CertifiedRequest own = request;
              own.check_self = false;
              manager.continuousCollide(JointMotion::linear(*scene.tree, q.q0, q.q1), own, result);
            },
            others, "arm", writer, sum);
      }
    }
    print("arm, " + std::to_string(static_cast<int>(step)) + " degrees", sum);
  }
}

/// Small worlds with all that there is: attached objects, moving obstacles, margins, trajectories, solids, ignored
/// contacts (test/modes).
void modesOf(std::size_t most, std::uint64_t seed, bool others, const Writer& writer) {
  std::map<std::string, Sum> sums;
  for (std::size_t i = 0; i < most; ++i) {
    modes::Random random(seed + i);
    const modes::World world(random);
    const double margin = random.chance(0.3) ? random.in(0, 0.05) : 0;
    const bool ignore = random.chance(0.3);
    const std::string kind = world.isPair() ? "modes, pair" : world.isTrajectory() ? "modes, trajectory" : "modes, motion";
    ask<CertifiedRequest, CertifiedResult>(
        [&](const CertifiedRequest& request, CertifiedResult& result) {
          CertifiedRequest own = request;
          own.margin = margin;
          own.ignore_initial_contact = ignore;
          world.ask(own, result);
        },
        others, "modes_" + std::to_string(i), writer, sums[kind]);
  }
  for (const auto& [kind, sum] : sums) print(kind, sum);
}

}  // namespace
}  // namespace fcl_artic

int main(int argc, char** argv) try {
  using namespace fcl_artic;
  CLI::App app("Certificates of many answers (FCL_ARTIC_DATA names the data of the set panda)");
  std::string out, set = "panda";
  std::size_t most = 1000000;
  std::uint64_t seed = 1;
  bool others = false;
  app.add_option("--out", out, "folder for worlds and certificates");
  app.add_option("--set", set, "motions")
      ->check(CLI::IsMember({"panda", "arm", "meshes", "shapes", "mixed", "modes"}))
      ->capture_default_str();
  app.add_option("--most", most, "motions of each part of the set")->capture_default_str();
  app.add_option("--seed", seed, "of what is random")->capture_default_str();
  app.add_flag("--contacts", others, "motions that are not free, too: until their t_lower");
  CLI11_PARSE(app, argc, argv);
  const Writer writer(out);
  if (set == "arm") {
    arm(most, seed, others, writer);
  } else if (set == "modes") {
    modesOf(most, seed, others, writer);
  } else if (set != "panda") {
    const std::map<std::string, pairs::Bodies> bodies = {
        {"meshes", pairs::Bodies::meshes}, {"shapes", pairs::Bodies::shapes}, {"mixed", pairs::Bodies::mixed}};
    pairsOf(bodies.at(set), set.c_str(), most, seed, others, writer);
  } else {
    const std::filesystem::path data = planning_data::sharedData();
    if (data.empty()) {
      std::cout << "FCL_ARTIC_DATA does not name a folder with robots/, problems/ and edges/\n";
      return 0;
    }
    panda(data, most, others, writer);
  }
  return 0;
} catch (const std::exception& error) {
  std::cerr << "certificate_campaign: " << error.what() << '\n';
  return 1;
}
