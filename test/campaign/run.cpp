// SPDX-License-Identifier: BSD-3-Clause
#include "run.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <functional>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <thread>

#include "generator.h"
#include "scene_file.h"

namespace campaign {
namespace {

using fcl_artic::Status;
using Clock = std::chrono::steady_clock;

double microseconds(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double, std::micro>(to - from).count();
}

bool freeAtEnd(const Oracle& oracle) {
  for (const auto& [a, b] : oracle.kinematics().pairs())
    if (oracle.at(a, b, 1, 0.5).touching) return false;
  return true;
}

/// Runs one query and counts it; what is wrong goes to `findings`.
void runOne(std::uint64_t query, const Scene& scene, const Options& options, Tally& tally,
            std::vector<Finding>& findings) {
  const auto made = Clock::now();
  std::unique_ptr<const Oracle> oracle;
  Truth truth;
  if (options.judge) {
    oracle = std::make_unique<const Oracle>(scene);
    truth = oracle->judge(scene.every_pair);
  }
  const auto judged = Clock::now();
  Answer answer;
  try {
    answer = ask(scene, options.how, options.culler);
  } catch (const std::exception& e) {
    findings.push_back({Fault::fields, std::string("threw: ") + e.what()});
    ++tally.queries;
    ++tally.faults[static_cast<int>(Fault::fields)];
    return;
  }
  if (options.answered) options.answered(query, scene, answer.result);
  const fcl_artic::CertifiedResult& r = answer.result;
  tally.oracle_us += microseconds(made, judged);
  tally.query_us += answer.elapsed_us;
  if (!options.judge) {
    ++tally.queries;
    tally.answers_contact += r.status == Status::contact;
    return;
  }
  if (options.try_corruptions) {
    const fcl_artic::CertifiedResult original = answer.result;
    for (std::size_t c = 0; c < tally.spoilt.size(); ++c) {
      if (corrupt(static_cast<Corruption>(c), scene.seed, scene, answer)) {
        ++tally.spoilt[c];
        tally.spoilt_seen[c] += !examine(scene, *oracle, truth, answer).empty();
      }
      answer.result = original;
    }
  }
  corrupt(options.corruption, scene.seed, scene, answer);
  findings = examine(scene, *oracle, truth, answer);

  ++tally.queries;
  tally.hits += truth.hit;
  tally.doubtful += !truth.hit && truth.doubtful;
  tally.starts += truth.hit && truth.time == 0;
  tally.ends_free += truth.hit && truth.time > 0 && freeAtEnd(*oracle);
  tally.grazes += !truth.hit &&
                  std::any_of(truth.pairs.begin(), truth.pairs.end(), [](const PairTruth& p) { return p.gap < 1e-3; });
  tally.answers_contact += r.status == Status::contact;
  tally.certain += r.status == Status::contact && r.certain;
  tally.uncertain += r.status == Status::contact && !r.certain;
  tally.uncertain_margin += r.status == Status::contact && !r.certain && scene.margin > 0;
  tally.undecided += r.status == Status::undecided;
  tally.beyond_sampling += r.status == Status::contact && r.certain && !truth.hit;
  if (r.certain && truth.hit) tally.lead.push_back(static_cast<float>(truth.time - r.t_lower));
  bool seen[kFaults] = {};
  for (const Finding& f : findings) seen[static_cast<int>(f.fault)] = true;
  for (int f = 0; f < kFaults; ++f) tally.faults[static_cast<std::size_t>(f)] += seen[f];
}

}  // namespace

std::uint64_t Tally::faulty() const {
  std::uint64_t n = 0;
  for (const std::uint64_t f : faults) n += f;
  return n;
}

void Tally::add(const Tally& o) {
  queries += o.queries, hits += o.hits, doubtful += o.doubtful, starts += o.starts, ends_free += o.ends_free,
      grazes += o.grazes;
  answers_contact += o.answers_contact, certain += o.certain, uncertain += o.uncertain, undecided += o.undecided;
  uncertain_margin += o.uncertain_margin;
  beyond_sampling += o.beyond_sampling;
  for (std::size_t c = 0; c < spoilt.size(); ++c) spoilt[c] += o.spoilt[c], spoilt_seen[c] += o.spoilt_seen[c];
  for (std::size_t f = 0; f < faults.size(); ++f) faults[f] += o.faults[f];
  lead.insert(lead.end(), o.lead.begin(), o.lead.end());
  query_us += o.query_us, generate_us += o.generate_us, oracle_us += o.oracle_us;
}

Report run(const Options& options) {
  if (!options.family.empty()) makeScene(options.family, 0);  // throws for an unknown class
  // For each thread its own: making an fcl::CollisionObject writes to its geometry.
  std::vector<std::vector<Scene>> given(static_cast<std::size_t>(std::max(1, options.threads)));
  if (!options.scenes.empty()) std::generate(given.begin(), given.end(), [&] { return readScenes(options.scenes); });
  const std::uint64_t queries = options.scenes.empty() ? options.queries : given[0].size();
  Report report;
  std::mutex mutex;
  std::atomic<std::uint64_t> next{0};
  std::vector<std::pair<std::uint64_t, Failure>> failures;
  const auto work = [&](const std::vector<Scene>& scenes) {
    std::map<std::string, Tally> tallies;
    for (std::uint64_t i; (i = next++) < queries;) {
      const auto begin = Clock::now();
      Scene drawn;
      if (scenes.empty()) {
        drawn = makeScene(options.family.empty() ? familyOf(options.seed, i) : options.family,
                          Random::mix(options.seed, i));
      }
      const Scene& scene = scenes.empty() ? drawn : scenes[i];
      Tally& tally = tallies[scene.family];
      tally.generate_us += microseconds(begin, Clock::now());
      std::vector<Finding> findings;
      runOne(i, scene, options, tally, findings);
      if (!findings.empty()) {
        const std::lock_guard<std::mutex> lock(mutex);
        failures.push_back({i, {scene.family, scene.seed, std::move(findings)}});
      }
      if (options.progress) options.progress(i + 1);
    }
    const std::lock_guard<std::mutex> lock(mutex);
    for (const auto& [family, tally] : tallies) report.families[family].add(tally);
  };
  const auto begin = Clock::now();
  std::vector<std::thread> threads;
  for (const std::vector<Scene>& scenes : given) threads.emplace_back(work, std::cref(scenes));
  for (std::thread& t : threads) t.join();
  report.elapsed_s = microseconds(begin, Clock::now()) * 1e-6;
  for (const auto& [family, tally] : report.families) report.total.add(tally);
  std::sort(failures.begin(), failures.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (std::size_t i = 0; i < failures.size() && i < 1000; ++i)
    report.failures.push_back(std::move(failures[i].second));
  return report;
}

bool replay(const std::string& family, std::uint64_t seed, const fcl_artic::CertifiedRequest& how, std::string& words) {
  const Scene scene = makeScene(family, seed);
  const Oracle oracle(scene);
  const Truth truth = oracle.judge(true);
  words = describe(scene);
  char line[256];
  for (const PairTruth& p : truth.pairs) {
    std::snprintf(line, sizeof line, "oracle %d %d: %s t %.17g gap %.6g at %.17g\n", p.a, p.b,
                  p.hit        ? "hit"
                  : p.doubtful ? "doubtful"
                               : "free",
                  p.time, p.gap, p.gap_time);
    words += line;
  }
  const Answer answer = ask(scene, how);
  const fcl_artic::CertifiedResult& r = answer.result;
  static const char* status[] = {"free", "contact", "undecided"};
  std::snprintf(line, sizeof line, "answer %s [%.17g, %.17g]%s in %.1f us\n", status[static_cast<int>(r.status)],
                r.t_lower, r.t_upper, r.certain ? " certain" : "", answer.elapsed_us);
  words += line;
  for (const fcl_artic::CertifiedContact& c : r.contacts) {
    std::snprintf(line, sizeof line, "  %d/%ld %d/%ld [%.17g, %.17g]%s point %.9g %.9g %.9g normal %.9g %.9g %.9g\n",
                  answer.bodyOf(c.body1.object), static_cast<long>(c.b1), answer.bodyOf(c.body2.object),
                  static_cast<long>(c.b2), c.t_lower, c.t_upper, c.certain ? " certain" : "", c.point.x(), c.point.y(),
                  c.point.z(), c.normal.x(), c.normal.y(), c.normal.z());
    words += line;
  }
  const std::vector<Finding> findings = examine(scene, oracle, scene.every_pair ? truth : oracle.judge(false), answer);
  for (const Finding& f : findings) words += std::string("FAULT ") + faultName(f.fault) + ": " + f.text + "\n";
  return findings.empty();
}

std::string toText(const Report& report) {
  std::string out;
  char line[512];
  std::snprintf(line, sizeof line, "%-20s %8s %6s %6s %8s %6s %8s %9s %6s %6s | %s\n", "class", "queries", "hits%",
                "start%", "between%", "graze%", "certain%", "uncertain%", "undec", "beyond",
                "faults; us: query, oracle, making");
  out += line;
  const auto row = [&](const std::string& name, const Tally& t) {
    const double n = std::max<double>(1, static_cast<double>(t.queries));
    const auto share = [&](std::uint64_t k) { return 100 * static_cast<double>(k) / n; };
    std::snprintf(line, sizeof line, "%-20s %8llu %6.1f %6.1f %8.1f %6.1f %8.1f %9.2f %6llu %6llu | ", name.c_str(),
                  static_cast<unsigned long long>(t.queries), share(t.hits), share(t.starts), share(t.ends_free),
                  share(t.grazes), share(t.certain), share(t.uncertain), static_cast<unsigned long long>(t.undecided),
                  static_cast<unsigned long long>(t.beyond_sampling));
    out += line;
    for (int f = 0; f < kFaults; ++f) {
      if (t.faults[static_cast<std::size_t>(f)] == 0) continue;
      std::snprintf(line, sizeof line, "%s %llu, ", faultName(static_cast<Fault>(f)),
                    static_cast<unsigned long long>(t.faults[static_cast<std::size_t>(f)]));
      out += line;
    }
    std::snprintf(line, sizeof line, "%s; %.0f, %.0f, %.0f\n", t.faulty() ? "" : "none", t.query_us / n,
                  t.oracle_us / n, t.generate_us / n);
    out += line;
  };
  for (const auto& [family, tally] : report.families) row(family, tally);
  row("all", report.total);
  Tally total = report.total;
  if (!total.lead.empty()) {
    std::sort(total.lead.begin(), total.lead.end());
    const auto at = [&](double p) {
      return static_cast<double>(total.lead[static_cast<std::size_t>(p * static_cast<double>(total.lead.size() - 1))]);
    };
    std::snprintf(line, sizeof line,
                  "sampled contact - t_lower (certain hits): least %.3g, median %.3g, p95 %.3g, most %.3g\n", at(0),
                  at(0.5), at(0.95), at(1));
    out += line;
  }
  std::snprintf(
      line, sizeof line, "uncertain %llu, of these with a margin %llu; doubtful %llu; %.1f s, %.0f queries/s\n",
      static_cast<unsigned long long>(total.uncertain), static_cast<unsigned long long>(total.uncertain_margin),
      static_cast<unsigned long long>(total.doubtful), report.elapsed_s,
      static_cast<double>(total.queries) / std::max(1e-9, report.elapsed_s));
  out += line;
  for (std::size_t c = 0; c < total.spoilt.size(); ++c) {
    if (total.spoilt[c] == 0) continue;
    std::snprintf(line, sizeof line, "spoilt on purpose, %s: %llu, of these seen %llu\n",
                  corruptionName(static_cast<Corruption>(c)), static_cast<unsigned long long>(total.spoilt[c]),
                  static_cast<unsigned long long>(total.spoilt_seen[c]));
    out += line;
  }
  // The first few of each kind, as one kind can be much more frequent than a worse one.
  std::array<int, kFaults> shown{};
  for (const Failure& f : report.failures) {
    for (const Finding& finding : f.findings) {
      if (++shown[static_cast<std::size_t>(finding.fault)] > 8) continue;
      std::snprintf(line, sizeof line, "--class %s --replay %llu: %s: ", f.family.c_str(),
                    static_cast<unsigned long long>(f.seed), faultName(finding.fault));
      out += line + finding.text + "\n";
    }
  }
  return out;
}

}  // namespace campaign
