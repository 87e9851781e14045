// SPDX-License-Identifier: BSD-3-Clause
//
// How the certified query grows: the motions of bench_arm (5 degrees, chosen in the scene of 100k triangles) in the
// same scene at 1k to 1M triangles; and seeded random chains of 2 to 30 joints of the same reach amid the 100k
// triangles.

#include <optional>

#include <fmt/format.h>

#include "certified_arm.h"
#include "options.h"
#include "plot.h"

using namespace fcl_artic;
using namespace fcl_artic::bench;

namespace {

constexpr double kStep = 5 * kPi / 180;
const char* const kTriangles = "triangles";
const char* const kJoints = "joints";

std::string toCsv(const std::vector<Row>& rows) {
  std::string csv = "series,size,set,queries,hits,median_us,mean_us,p95_us,max_us\n";
  for (const Row& r : rows) {
    csv += fmt::format("{},{:g},{},{},{},{:.3f},{:.3f},{:.3f},{:.3f}\n", r.scene, r.size, r.set, r.queries, r.hits,
                       r.median_us, r.mean_us, r.p95_us, r.max_us);
  }
  return csv;
}

std::string plotOf(const std::vector<Row>& rows, const std::string& scene, const std::string& title,
                   const std::string& x_label) {
  std::vector<Series> series;
  for (const char* set : {"free", "hit"}) {
    Series median{fmt::format("{}, median", set), {}}, mean{fmt::format("{}, mean", set), {}};
    for (const Row& r : rows) {
      if (r.scene != scene || r.set != set) continue;
      median.points.emplace_back(r.size, r.median_us);
      mean.points.emplace_back(r.size, r.mean_us);
    }
    series.push_back(std::move(median));
    series.push_back(std::move(mean));
  }
  return logLogPlot(title, x_label, "us per query", series);
}

}  // namespace

int main(int argc, char** argv) {
  Report report("bench_growth");
  CLI::App app("Growth of a certified query with the scene's triangles and the arm's joints");
  std::size_t count = 100;
  int passes = 3;
  std::uint64_t seed = 11;
  std::vector<int> sizes = {1000, 10000, 100000, 1000000}, joints = {2, 4, 6, 10, 14, 20, 30};
  app.add_option("--queries", count, "free queries, and as many colliding ones, per size")->capture_default_str();
  app.add_option("--passes", passes, "passes over the queries; the least time of each counts")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--seed", seed, "of scenes and queries")->capture_default_str();
  app.add_option("--triangles", sizes, "sizes of the scene")->capture_default_str();
  app.add_option("--joints", joints, "lengths of the chain")->capture_default_str();
  if (const auto status = readOptions(app, report, argc, argv)) return *status;

  // Scenes are built when the first of their rows runs, one at a time: a million triangles take their memory.
  ArmScene scene;
  std::optional<CertifiedArm> certified;
  std::string built;
  std::array<std::vector<JointMotion>, 2> motions;
  const auto choose = [&] {
    const auto sets = makeArmQueries(scene, kStep, count, seed, [&](const ArmQuery& q) {
      return (*certified)(JointMotion::linear(*scene.tree, q.q0, q.q1)) <= 1;
    });
    for (std::size_t k = 0; k < 2; ++k) motions[k] = toMotions(scene, sets[k]);
  };
  const auto build = [&](const ArmSceneOptions& options, const std::string& name) {
    if (built == name) return;
    certified.reset();
    scene = makeArmScene(options);
    certified.emplace(scene);
    built = name;
  };
  const auto measureSet = [&](std::size_t set, double size) {
    Measured measured = certified->measureAll(motions[set], passes);
    measured.row.size = size;
    return measured;
  };

  bool chosen = false;
  for (const int triangles : sizes) {
    for (std::size_t set = 0; set < 2; ++set) {
      report.add(kTriangles, set ? "hit" : "free", fmt::format("fcl_artic, {} triangles", triangles),
                 [&, triangles, set] {
                   ArmSceneOptions options;
                   options.seed = seed;
                   if (!chosen) {
                     build(options, "choice");
                     choose();
                     chosen = true;
                   }
                   options.scene_triangles = triangles;
                   build(options, fmt::format("{} triangles", triangles));
                   return measureSet(set, static_cast<double>(scene.sceneTriangles()));
                 });
    }
  }
  for (const int length : joints) {
    for (std::size_t set = 0; set < 2; ++set) {
      report.add(kJoints, set ? "hit" : "free", fmt::format("fcl_artic, {} joints", length), [&, length, set] {
        const std::string name = fmt::format("{} joints", length);
        if (built != name) {
          constexpr double kReach = 0.95;
          Random random(seed + static_cast<std::uint64_t>(length));
          ArmSceneOptions options;
          options.seed = seed;
          options.rows = randomRows(length, kReach, random);
          options.first_link = 1;
          options.thickness = std::clamp(0.25 * kReach / length, 0.015, 0.055);
          build(options, name);
          choose();
        }
        return measureSet(set, length);
      });
    }
  }

  report.run();
  report.write("bench_growth.csv", toCsv(report.rows()));
  for (const auto& [scene_name, title, label] :
       {std::array{kTriangles, "PUMA, 5 degree steps, growing scene", "triangles of the scene"},
        std::array{kJoints, "Chains of one reach, 5 degree steps, 100k triangles", "joints"}}) {
    const std::string svg = plotOf(report.rows(), scene_name, title, label);
    if (!svg.empty()) report.write(fmt::format("bench_growth_{}.svg", scene_name), svg);
  }
  return report.finish();
}
