// SPDX-License-Identifier: BSD-3-Clause
#include "harness.h"

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <type_traits>

#include <benchmark/benchmark.h>
#include <fcl/config.h>
#include <fmt/format.h>

#include "files/files.h"

namespace fcl_artic::bench {
namespace {

std::string cpuField(const std::string& key) {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    const auto colon = line.find(':');
    if (colon == std::string::npos || line.compare(0, key.size(), key) != 0) continue;
    if (line.find_first_not_of(" \t", key.size()) != colon) continue;  // "model" is not "model name"
    return colon + 2 <= line.size() ? line.substr(colon + 2) : std::string();
  }
  return {};
}

std::uint64_t fnv1a(const std::vector<Answer>& answers) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const Answer answer : answers) {
    unsigned char bytes[sizeof answer];
    std::memcpy(bytes, &answer, sizeof answer);
    for (const unsigned char byte : bytes) hash = (hash ^ byte) * 0x100000001b3u;
  }
  return hash;
}

double quantile(const std::vector<double>& sorted, double q) {
  return sorted[std::min(sorted.size() - 1, static_cast<std::size_t>(q * static_cast<double>(sorted.size())))];
}

/// One minute's load average: what else ran on the machine.
std::string load() {
  std::ifstream in("/proc/loadavg");
  std::string one_minute;
  in >> one_minute;
  return one_minute;
}

}  // namespace

std::string circumstances() {
  return fmt::format("{}; g++ {}; {}; FCL {}; load average {}", cpuField("model name"), __VERSION__, BENCH_FLAGS,
                     FCL_VERSION, load());
}

void addCounters(Row& row, const QueryStatistics& s) {
  std::vector<std::pair<const char*, std::uint64_t>> all = {{"pairs", s.pairs},
                                                            {"pairs_after_culling", s.pairs_after_culling}};
  StandardStatistics::forEachField([&](const char* name, auto field) {
    if constexpr (std::is_same_v<decltype(field), std::uint64_t StandardStatistics::*>)
      all.emplace_back(name, s.*field);
  });
  row.per_query.resize(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    row.per_query[i].first = all[i].first;
    row.per_query[i].second += static_cast<double>(all[i].second) / static_cast<double>(row.queries);
  }
}

/// Passes go on so long: few short queries would be over before the processor is at its full clock.
constexpr std::chrono::milliseconds kLeastTime(20);

Measured measure(std::size_t queries, int passes, const std::function<Answer(std::size_t)>& query) {
  return measureInTurns(queries, passes, {query}).front();
}

std::vector<Measured> measureInTurns(std::size_t queries, int passes,
                                     const std::vector<std::function<Answer(std::size_t)>>& ways) {
  using Clock = std::chrono::steady_clock;
  std::vector<Measured> all(ways.size());
  for (Measured& measured : all) {
    measured.answers.resize(queries);
    measured.us.assign(queries, std::numeric_limits<double>::infinity());
  }
  const auto pass = [&](std::size_t way, bool first) {
    Measured& measured = all[way];
    for (std::size_t i = 0; i < queries; ++i) {
      const auto begin = Clock::now();
      const Answer answer = ways[way](i);
      const auto end = Clock::now();
      measured.us[i] = std::min(measured.us[i], std::chrono::duration<double, std::micro>(end - begin).count());
      if (!first && answer != measured.answers[i]) {
        throw std::runtime_error(fmt::format("query {} answers {} and, repeated, {}", i, measured.answers[i], answer));
      }
      measured.answers[i] = answer;
    }
  };
  const auto enough = Clock::now() + ways.size() * kLeastTime;
  int done = 0;
  while (done < passes || (queries > 0 && Clock::now() < enough)) {
    const int more = done < passes ? std::min(2, passes - done) : 2;
    for (std::size_t way = 0; way < ways.size(); ++way) {
      for (int k = done; k < done + more; ++k) pass(way, k == 0);
    }
    done += more;
  }
  for (Measured& measured : all) {
    measured.row.passes = done;
    summarise(measured);
  }
  return all;
}

void summarise(Measured& measured) {
  Row& row = measured.row;
  row.queries = measured.answers.size();
  row.hash = fnv1a(measured.answers);
  row.hits = 0;
  row.mean_toc = 0;
  for (const Answer answer : measured.answers) {
    if (answer > 1) continue;
    ++row.hits;
    row.mean_toc += answer;
  }
  if (row.hits > 0) row.mean_toc /= static_cast<double>(row.hits);
  if (row.queries == 0) return;
  std::vector<double> us = measured.us;
  std::sort(us.begin(), us.end());
  row.median_us = quantile(us, 0.5);
  row.p95_us = quantile(us, 0.95);
  row.max_us = us.back();
  row.mean_us = std::accumulate(us.begin(), us.end(), 0.0) / static_cast<double>(row.queries);
}

void Report::add(const std::string& scene, const std::string& set, const std::string& method,
                 std::function<Measured()> run) {
  benchmark::RegisterBenchmark(
      fmt::format("{}/{}/{}", scene, set, method).c_str(),
      [this, scene, set, method, run = std::move(run)](benchmark::State& state) {
        for (auto _ : state) {
          Row row;
          try {
            row = run().row;
          } catch (const std::exception& error) {
            state.SkipWithError(error.what());
            failed_ = true;
            break;
          }
          row.scene = scene;
          row.set = set;
          row.method = method;
          state.SetIterationTime(row.median_us * 1e-6);
          state.counters["mean_us"] = row.mean_us;
          state.counters["p95_us"] = row.p95_us;
          state.counters["hits"] = static_cast<double>(row.hits);
          state.SetLabel(fmt::format("median of {} queries, answers {:016x}", row.queries, row.hash));
          rows_.push_back(std::move(row));
        }
      })
      ->UseManualTime()
      ->Iterations(1)
      ->Unit(benchmark::kMicrosecond);
}

std::string Report::table() const {
  std::string out = fmt::format("{}\n{}\n\n", program_, circumstances());
  out += fmt::format("{:<18} {:<6} {:<30} {:>7} {:>5} {:>11} {:>11} {:>11} {:>9} {:>16}\n", "scene", "set", "method",
                     "queries", "hits", "median us", "mean us", "p95 us", "mean toc", "answers");
  for (const Row& r : rows_) {
    out += fmt::format("{:<18} {:<6} {:<30} {:>7} {:>5} {:>11.2f} {:>11.2f} {:>11.2f} {:>9.5f} {:016x}\n", r.scene,
                       r.set, r.method, r.queries, r.hits, r.median_us, r.mean_us, r.p95_us, r.mean_toc, r.hash);
    if (r.per_query.empty()) continue;
    out += "   per query:";
    for (const auto& [name, value] : r.per_query) out += fmt::format(" {} {:.4g}", name, value);
    out += '\n';
  }
  for (const std::string& line : notes_) out += line + '\n';
  return out;
}

void Report::run() {
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}

int Report::finish() const {
  std::cout << '\n' << table();
  if (!rows_.empty()) write(program_ + ".txt", table());
  files::flushStandardOutput();
  return failed_ ? 1 : 0;
}

void Report::write(const std::string& file, const std::string& content) const {
  if (results_folder.empty()) return;
  const auto folder = std::filesystem::path(results_folder) / machineName();
  std::filesystem::create_directories(folder);
  files::write(folder / file, content);
}

std::string machineName() {
  const std::string model = cpuField("model name");
  const std::string family = cpuField("cpu family"), number = cpuField("model");
  const bool amd = cpuField("vendor_id") == "AuthenticAMD";
  if (amd && model.find("EPYC") != std::string::npos && !family.empty() && !number.empty()) {
    // Family 17h: Zen 1 and 2 by model; 19h: Zen 3 below 10h, Zen 4 in 10h-1Fh and A0h-AFh; 1Ah: Zen 5.
    const int f = std::stoi(family), m = std::stoi(number);
    if (f == 0x17) return m < 0x30 ? "amd-epyc-zen1" : "amd-epyc-zen2";
    if (f == 0x19) return m < 0x10 ? "amd-epyc-zen3" : "amd-epyc-zen4";
    if (f == 0x1a) return "amd-epyc-zen5";
  }
  std::string name;
  for (const char c : model) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) {
      name += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    } else if (!name.empty() && name.back() != '-') {
      name += '-';
    }
  }
  while (!name.empty() && name.back() == '-') name.pop_back();
  return name.empty() ? "unknown" : name;
}

}  // namespace fcl_artic::bench
