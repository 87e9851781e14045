// SPDX-License-Identifier: BSD-3-Clause
//
// Stage 2, culling by visibility: what it takes out and what it costs, on an arm of six capsules amid 500 pipes, 1,500
// thin pipes, 125 chains of four pipes, and the 500 pipes as one mesh; the joint that turns most turns by 5 to 30
// degrees. Robot against itself off.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <iostream>
#include <set>

#include <fmt/format.h>

#include "certified_arm.h"
#include "options.h"
#include "pipe_scene.h"
#ifdef FCL_ARTIC_HAS_OFFSCREEN
#include "fcl_artic/visibility/offscreen.h"
#endif

using namespace fcl_artic;
using namespace fcl_artic::bench;

namespace {

struct Way {
  std::string name;
  VisibilityMode mode;
  std::shared_ptr<const VisibilityCuller> culler;
};

std::vector<Way> ways() {
  const auto options = [](int resolution, VisibilityRule rule) {
    VisibilityOptions o;
    o.resolution = resolution;
    o.rule = rule;
    return o;
  };
  const auto cpu = [&](int resolution, VisibilityRule rule) {
    return std::make_shared<VisibilityCuller>(options(resolution, rule));
  };
  std::vector<Way> all = {
      {"off", VisibilityMode::off, nullptr},
      {"automatic", VisibilityMode::automatic, cpu(32, VisibilityRule::intervals)},
      {"cpu 16", VisibilityMode::on, cpu(16, VisibilityRule::intervals)},
      {"cpu 32", VisibilityMode::on, cpu(32, VisibilityRule::intervals)},
      {"cpu 64", VisibilityMode::on, cpu(64, VisibilityRule::intervals)},
      {"cpu 32 occlusion", VisibilityMode::on, cpu(32, VisibilityRule::occlusion)},
  };
#ifdef FCL_ARTIC_HAS_OFFSCREEN
  for (const auto& [name, backend] : {std::pair("osmesa", OffscreenBackend::osmesa), {"egl", OffscreenBackend::egl}}) {
    for (const auto& [suffix, rule] :
         {std::pair("", VisibilityRule::intervals), {" occlusion", VisibilityRule::occlusion}}) {
      all.push_back(
          {fmt::format("{} 32{}", name, suffix), VisibilityMode::on, makeOffscreenCuller(backend, options(32, rule))});
    }
  }
#endif
  return all;
}

CertifiedRequest baseRequest() {
  CertifiedRequest request;
  request.check_self = false;
  request.tolerance_time = 0x1p-13;
  return request;
}

/// Means per motion.
struct Truth {
  double boxes_meet = 0;  ///< pairs whose boxes over the whole motion meet, by 65 poses
  double touching = 0;    ///< of these, in contact at some time
};

Truth findTruth(PipeScene& scene, const std::vector<JointMotion>& motions) {
  CertifiedRequest request = baseRequest();
  request.mode = ContactMode::firstOfEveryPair;
  request.max_contacts = 100000;
  CertifiedResult result;
  Truth truth;
  for (const JointMotion& motion : motions) {
    scene.manager().continuousCollide(motion, request, result);
    std::set<std::pair<const void*, const void*>> pairs;
    for (const CertifiedContact& c : result.contacts) pairs.insert({c.body1.object, c.body2.object});
    truth.touching += static_cast<double>(pairs.size());
    truth.boxes_meet += static_cast<double>(scene.pairsWhoseBoxesMeet(motion));
  }
  truth.touching /= static_cast<double>(motions.size());
  truth.boxes_meet /= static_cast<double>(motions.size());
  return truth;
}

/// Those of the motions that are free, or not.
std::vector<JointMotion> withVerdict(PipeScene& scene, const std::vector<JointMotion>& motions, bool free) {
  CertifiedResult result;
  std::vector<JointMotion> kept;
  for (const JointMotion& motion : motions) {
    scene.manager().continuousCollide(motion, baseRequest(), result);
    if ((result.status == Status::free) == free) kept.push_back(motion);
  }
  return kept;
}

/// `automatic` and `off` in turn, block by block, trials included: the median ratio of their times.
std::string automaticBesideOff(ArticulatedCollisionManager& manager, const std::vector<JointMotion>& motions) {
  using Clock = std::chrono::steady_clock;
  CertifiedRequest request = baseRequest();
  CertifiedResult result;
  std::vector<double> ratios;
  std::uint64_t trials = 0;
  double sums[2] = {0, 0};
  for (int block = 0; block < 41; ++block) {
    double us[2];
    for (int i = 0; i < 2; ++i) {
      const bool automatic = (i + block) % 2;
      request.visibility = automatic ? VisibilityMode::automatic : VisibilityMode::off;
      const Clock::time_point begin = Clock::now();
      for (int k = 0; k < 8; ++k) {
        for (const JointMotion& m : motions) {
          manager.continuousCollide(m, request, result);
          trials += result.statistics.visibility.trials;
        }
      }
      us[automatic] = std::chrono::duration<double, std::micro>(Clock::now() - begin).count();
      sums[automatic] += us[automatic];
    }
    ratios.push_back(us[1] / us[0]);
  }
  std::nth_element(ratios.begin(), ratios.begin() + 20, ratios.end());
  return fmt::format("beside off: {:.3f} times its time (median of 41 blocks; {:.3f} in all), {} trials", ratios[20],
                     sums[1] / sums[0], trials);
}

}  // namespace

int main(int argc, char** argv) {
  Report report("bench_visibility");
  CLI::App app("Culling by visibility: power and cost");
  std::size_t count = 40;
  int passes = 3;
  double scale = 1;
  std::vector<double> steps = {5, 10, 20, 30};
  std::string only = "all";
  app.add_option("--queries", count, "motions per scene and step")->capture_default_str();
  app.add_option("--passes", passes, "passes over the queries; the least time of each counts")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--steps", steps, "degrees, the joint that turns most")->capture_default_str();
  app.add_option("--only", only, "motions that are free, or in contact")
      ->check(CLI::IsMember({"all", "free", "contact"}))
      ->capture_default_str();
  app.add_option("--scale", scale, "times the scenes' numbers of objects")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  if (const auto status = readOptions(app, report, argc, argv)) return *status;

  const struct {
    std::string name;
    PipeSceneOptions options;
  } scenes[] = {{"500 pipes", {500, 1, 1.0}},
                {"1500 thin pipes", {1500, 1, 0.5}},
                {"125 chains", {125, 4, 1.0}},
                {"500 in one mesh", {500, 1, 1.0, true}}};
  const std::vector<Way> all = ways();
  std::deque<PipeScene> kept_scenes;
  std::deque<std::vector<JointMotion>> kept_motions;
  report.note(fmt::format("\n{:<16} {:>3} {:>6} {:>8} {:>7} {:>6}  {:<20} {:>7} {:>8} {:>10} {:>9} {:>10} {:>9}",
                          "scene", "deg", "boxes", "touching", "stage 1", "pieces", "method", "culled", "with 1",
                          "us/pair in", "stage us", "break-even", "saves us"));
  for (const auto& entry : scenes) {
    PipeSceneOptions options = entry.options;
    options.objects = std::max(1, static_cast<int>(options.objects * scale));
    PipeScene& scene = kept_scenes.emplace_back(options);
    std::cout << entry.name << ": " << scene.triangles() << " triangles\n";
    for (const double step : steps) {
      auto& motions = kept_motions.emplace_back(scene.motions(step * kPi / 180, count));
      if (only != "all") motions = withVerdict(scene, motions, only == "free");
      if (motions.empty()) continue;
      const Truth truth = findTruth(scene, motions);
      const auto off_us = std::make_shared<double>(0);
      for (const Way& method : all) {
        report.add(
            entry.name, fmt::format("{:g}", step), method.name,
            [&scene, &motions, &method, &report, passes, truth, off_us, name = entry.name, step] {
              scene.manager().setVisibility(method.culler);
              CertifiedRequest request = baseRequest();
              request.visibility = method.mode;
              CertifiedResult result;
              const auto ask = [&](const JointMotion& m) {
                scene.manager().continuousCollide(m, request, result);
                return toAnswer(result);
              };
              if (method.mode == VisibilityMode::automatic) {  // until it knows
                for (int i = 0; i < 100; ++i) {
                  for (const JointMotion& m : motions) ask(m);
                }
              }
              std::vector<double> stage_least(motions.size(), HUGE_VAL), narrow_least(motions.size(), HUGE_VAL);
              request.measure_times = true;
              Measured measured = measure(motions.size(), passes, [&](std::size_t i) {
                const Answer answer = ask(motions[i]);
                stage_least[i] = std::min(stage_least[i], result.statistics.visibility.us);
                narrow_least[i] = std::min(narrow_least[i], result.statistics.narrowphase_us);
                return answer;
              });
              Row& row = measured.row;
              double pairs = 0, culled = 0, pieces = 0, after = 0, stage_us = 0, narrow_us = 0;
              for (std::size_t i = 0; i < motions.size(); ++i) {
                ask(motions[i]);
                const QueryStatistics& s = result.statistics;
                if (!s.visibility_fallback.empty()) throw std::runtime_error(s.visibility_fallback);
                addCounters(row, s);
                after += static_cast<double>(s.pairs_after_culling);
                pairs += static_cast<double>(s.visibility.pairs);
                culled += static_cast<double>(s.visibility.culled);
                pieces += static_cast<double>(s.visibility.pieces);
                stage_us += stage_least[i];
                narrow_us += narrow_least[i];
              }
              const auto n = static_cast<double>(motions.size());
              const Truth& t = truth;
              row.per_query.insert(row.per_query.end(), {{"boxes_meet", t.boxes_meet},
                                                         {"touching", t.touching},
                                                         {"visibility_pairs", pairs / n},
                                                         {"visibility_culled", culled / n},
                                                         {"visibility_pieces", pieces / n},
                                                         {"visibility_us", stage_us / n},
                                                         {"narrowphase_us", narrow_us / n}});
              const std::string head = fmt::format("{:<16} {:>3} {:>6.1f} {:>8.1f} {:>7.1f} {:>6.1f}  {:<20}", name,
                                                   step, t.boxes_meet, t.touching, after / n, pieces / n, method.name);
              if (method.mode == VisibilityMode::off) {
                *off_us = row.mean_us;
                report.note(fmt::format("{} {:>7} {:>7.1f}%   the rest costs {:.2f} us a pair", head, "",
                                        100 * (t.boxes_meet - after / n) / (t.boxes_meet - t.touching),
                                        narrow_us / after));
              } else if (method.mode == VisibilityMode::on) {
                report.note(fmt::format("{} {:>6.1f}% {:>7.1f}% {:>10.2f} {:>9.1f} {:>10.1f} {:>9.1f}", head,
                                        100 * culled / (after - n * t.touching),
                                        100 * (t.boxes_meet - (after - culled) / n) / (t.boxes_meet - t.touching),
                                        stage_us / pairs, stage_us / n, stage_us / culled, *off_us - row.mean_us));
              } else {
                report.note(fmt::format("{}   {}", head, automaticBesideOff(scene.manager(), motions)));
              }
              return measured;
            });
      }
    }
  }
  report.run();
  return report.finish();
}
