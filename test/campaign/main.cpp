// SPDX-License-Identifier: BSD-3-Clause
#include <atomic>
#include <cstdio>
#include <exception>

#include <unistd.h>
#include <CLI/CLI.hpp>

#include "generator.h"
#include "run.h"

int main(int argc, char** argv) {
  CLI::App app{
      "Seeded queries to fcl_artic against an oracle of its own. Exit status 0: no fault, and hits between 30 and "
      "70 %; 1: otherwise; 2: wrong use."};
  campaign::Options options;
  std::string spoil = "none";
  std::uint64_t replay = 0;
  app.add_option("--queries", options.queries, "number of queries")->capture_default_str();
  app.add_option("--seed", options.seed, "seed of the campaign")->capture_default_str();
  app.add_option("--threads", options.threads, "threads")->capture_default_str()->check(CLI::Range(1, 1024));
  app.add_option("--class", options.family, "only this class")->check(CLI::IsMember(campaign::families()));
  const auto* again = app.add_option("--replay", replay, "run the query of this seed (with --class) and dump it");
  app.add_option("--spoil", spoil,
                 "spoil the answers on purpose, to see that it is noticed: late, drop, invent, widen, point, "
                 "normal, poses, certain, pair")
      ->capture_default_str();
  app.add_flag("--try-spoiling", options.try_corruptions,
               "spoil a copy of each answer in each way, and count what is noticed");
  bool redon = false;
  app.add_flag("--redon2004", redon, "ask for the paper's method");
  CLI11_PARSE(app, argc, argv);
  if (redon) options.how.method = fcl_artic::Method::redon2004;
  try {
    if (*again) {
      if (options.family.empty()) {
        std::fprintf(stderr, "campaign: --replay needs --class\n");
        return 2;
      }
      std::string words;
      const bool good = campaign::replay(options.family, replay, options.how, words);
      std::fputs(words.c_str(), stdout);
      return good ? 0 : 1;
    }
    options.corruption = campaign::corruptionOf(spoil);
    const bool terminal = isatty(STDERR_FILENO);
    std::atomic<std::uint64_t> shown{0};
    options.progress = [&](std::uint64_t done) {
      const std::uint64_t percent = 100 * done / options.queries;
      if (terminal && percent > shown.exchange(std::max<std::uint64_t>(shown, percent)))
        std::fprintf(stderr, "\r%3d %%", static_cast<int>(percent));
    };
    const campaign::Report report = campaign::run(options);
    if (terminal) std::fprintf(stderr, "\r");
    std::fputs(campaign::toText(report).c_str(), stdout);
    const double share = report.total.hitShare();
    return report.total.faulty() == 0 && (!options.family.empty() || (share >= 0.3 && share <= 0.7)) ? 0 : 1;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "campaign: %s\n", e.what());
    return 2;
  }
}
