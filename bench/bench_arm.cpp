// SPDX-License-Identifier: BSD-3-Clause
//
// Links 2 to 6 of a PUMA 560 chain, about 1k triangles each, amid 10 bumpy spheres of 100k triangles in all (or of
// others, --triangles), or a chain of other joints and the same reach; steps of 1, 5 and 30 degrees of every joint from
// random free starts; robot against itself off. Beside the certified query run FCL's own ways, on the same queries and
// in the same process.

#include <algorithm>
#include <deque>
#include <functional>
#include <iostream>
#include <optional>

#include <fmt/format.h>

#include "certified_arm.h"
#include "options.h"

using namespace fcl_artic;
using namespace fcl_artic::bench;

int main(int argc, char** argv) {
  Report report("bench_arm");
  CLI::App app("Certified queries of an arm amid spheres, beside FCL's own ways");
  std::size_t count = 100, rival_count = 100;
  int passes = 3, joints = 0;
  ArmSceneOptions options;
  std::vector<double> steps = {1, 5, 30};
  bool merged = false, no_rivals = false;
  app.add_option("--queries", count, "free queries, and as many colliding ones, per step")->capture_default_str();
  app.add_option("--rival-queries", rival_count, "the first so many of them for FCL")->capture_default_str();
  app.add_option("--passes", passes, "passes over the queries at least; the least time of each counts")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--steps", steps, "degrees, every joint")->capture_default_str();
  app.add_option("--triangles", options.scene_triangles, "of the scene")->capture_default_str();
  app.add_option("--joints", joints, "a random chain of so many, of the same reach, in place of the PUMA")
      ->check(CLI::Range(1, 100));
  app.add_option("--seed", options.seed, "of scene and queries")->capture_default_str();
  app.add_flag("--merged", merged, "certified query: the scene as one mesh instead of one per sphere");
  app.add_flag("--no-rivals", no_rivals, "certified queries only");
  if (const auto status = readOptions(app, report, argc, argv)) return *status;

  if (joints > 0) {
    constexpr double kReach = 0.95;
    Random random(options.seed + static_cast<std::uint64_t>(joints));
    options.rows = randomRows(joints, kReach, random);
    options.first_link = 1;
    options.thickness = std::clamp(0.25 * kReach / joints, 0.015, 0.055);
  }
  const ArmScene scene = makeArmScene(options);
  CertifiedArm certified(scene, merged);
  std::optional<FclRivals> rivals;
  if (!no_rivals) rivals.emplace(scene);
  std::cout << scene.links.size() << " links of " << scene.links[0].mesh.triangles.size() << " triangles, "
            << scene.obstacles.size() << " spheres, " << scene.sceneTriangles() << " triangles\n";

  std::deque<std::vector<JointMotion>> kept;  // its elements stay where they are
  for (const double step : steps) {
    const auto sets = makeArmQueries(scene, step * kPi / 180, count, options.seed, [&](const ArmQuery& q) {
      return certified(JointMotion::linear(*scene.tree, q.q0, q.q1)) <= 1;
    });
    const std::string name = fmt::format("arm {:g} deg", step);
    for (int hit = 0; hit < 2; ++hit) {
      const std::string set = hit ? "hit" : "free";
      const auto& motions = kept.emplace_back(toMotions(scene, sets[static_cast<std::size_t>(hit)]));
      report.add(name, set, "fcl_artic",
                 [&certified, &motions, passes] { return certified.measureAll(motions, passes); });
      if (!rivals) continue;

      const std::size_t n = std::min(rival_count, motions.size());
      const auto rival = [&](const std::string& method, std::function<Answer(const JointMotion&)> ask) {
        report.add(name, set, method, [&certified, &rivals, &motions, &report, n, passes, name, set, method, ask] {
          std::size_t pairs = 0;
          Measured measured = measure(n, passes, [&](std::size_t i) {
            const Answer answer = ask(motions[i]);
            pairs += rivals->takePairsLeft();
            return answer;
          });
          const double runs = static_cast<double>(n) * measured.row.passes;
          if (pairs > 0) measured.row.per_query = {{"pairs_after_boxes", static_cast<double>(pairs) / runs}};
          std::size_t missed = 0, false_alarms = 0;
          double late = 0;
          for (std::size_t i = 0; i < n; ++i) {
            const Answer truth = certified(motions[i]), answer = measured.answers[i];
            missed += truth <= 1 && answer > 1;
            false_alarms += truth > 1 && answer <= 1;
            if (truth <= 1 && answer <= 1) late = std::max(late, answer - truth);
          }
          report.note(fmt::format("{}, {}, {}: {} missed, {} false, at most {:.2g} of the step late", name, set, method,
                                  missed, false_alarms, late));
          return measured;
        });
      };
      rival("FCL oriented CA, RSS", [&](const JointMotion& m) { return rivals->advancement(m); });
      rival("FCL naive, 1000 steps", [&](const JointMotion& m) { return rivals->naive(m, 1000); });
      rival("FCL collide each 0.005 rad", [&](const JointMotion& m) { return rivals->sampling(m, 0.005); });
    }
  }
  report.run();
  return report.finish();
}
