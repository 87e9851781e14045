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

#include "fcl_artic/fcl_artic.h"
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
  void world(const std::string& name, const ArticulatedCollisionManager& manager) const {
    if (!folder_.empty()) std::ofstream(folder_ / (name + ".world"), std::ios::binary) << manager.certificateWorld();
  }
  void add(const std::string& name, const Certificate& certificate) const {
    if (folder_.empty()) return;
    std::ofstream(folder_ / (name + ".fac"), std::ios::binary | std::ios::app) << certificate.record();
  }

 private:
  fs::path folder_;
};

void ask(const ArticulatedCollisionManager& manager, const JointMotion& motion, bool others, const std::string& name,
         const Writer& writer, Sum& sum) {
  CertifiedRequest request;
  CertifiedResult result;
  manager.continuousCollide(motion, request, result);
  const auto begin = Clock::now();
  manager.continuousCollide(motion, request, result);
  const double query_us = microseconds(begin);
  if (!result.isFree()) ++sum.other;
  if (!result.isFree() && !others) return;
  request.certificate = true;
  const auto again = Clock::now();
  manager.continuousCollide(motion, request, result);
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
      if (!manager) {
        manager = makeManager(robot, environment.problem(edge.problem).scene);
        writer.world(file, *manager);
      }
      const auto motion = JointMotion::linear(*robot.tree, environment.configuration(*robot.tree, edge.from),
                                              environment.configuration(*robot.tree, edge.to));
      ask(*manager, motion, others, file, writer, sum);
      ask(*manager, motion, others, file, Writer({}), all);
    }
    print(name, sum);
  }
  print("panda, all", all);
}

}  // namespace
}  // namespace fcl_artic

int main(int argc, char** argv) try {
  CLI::App app("Certificates of many answers (FCL_ARTIC_DATA names the data)");
  std::string out, set = "panda";
  std::size_t most = 1000000;
  bool others = false;
  app.add_option("--out", out, "folder for worlds and certificates");
  app.add_option("--set", set, "motions")->check(CLI::IsMember({"panda"}))->capture_default_str();
  app.add_option("--most", most, "motions of each part of the set")->capture_default_str();
  app.add_flag("--contacts", others, "motions that are not free, too: until their t_lower");
  CLI11_PARSE(app, argc, argv);
  const std::filesystem::path data = fcl_artic::planning_data::sharedData();
  if (data.empty()) {
    std::cout << "FCL_ARTIC_DATA does not name a folder with robots/, problems/ and edges/\n";
    return 0;
  }
  fcl_artic::panda(data, most, others, fcl_artic::Writer(out));
  return 0;
} catch (const std::exception& error) {
  std::cerr << "certificate_campaign: " << error.what() << '\n';
  return 1;
}
