// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <exception>

#include <CLI/CLI.hpp>

#include "pair_campaign.h"

int main(int argc, char** argv) {
  CLI::App app{
      "Seeded queries of two moving bodies to fcl_artic, against a judge of its own. Exit status 0: no fault; 1: a "
      "fault; "
      "2: wrong use."};
  pair_campaign::Options options;
  std::uint64_t replay = 0;
  std::vector<std::string> names;
  for (const auto& family : pair_campaign::families()) names.push_back(family.name);
  app.add_option("--queries", options.queries, "number of queries; 2,000 of 8,000 are mesh pairs, 4,000 shape pairs")
      ->capture_default_str();
  app.add_option("--seed", options.seed, "seed of the campaign")->capture_default_str();
  app.add_option("--threads", options.threads, "threads")->capture_default_str()->check(CLI::Range(1, 1024));
  app.add_option("--class", options.family, "only this class")->check(CLI::IsMember(names));
  const auto* again = app.add_option("--replay", replay, "run the query of this seed (with --class) and dump it");
  app.add_flag("--try-spoiling", options.try_corruptions,
               "spoil a copy of each answer in each way, and count what is noticed");
  CLI11_PARSE(app, argc, argv);
  try {
    if (*again) {
      std::string words;
      const bool good = pair_campaign::replay(options.family, replay, words);
      std::fputs(words.c_str(), stdout);
      return good ? 0 : 1;
    }
    const pair_campaign::Report report = pair_campaign::run(options);
    std::fputs(pair_campaign::toText(report).c_str(), stdout);
    return report.total.faulty() == 0 ? 0 : 1;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "pair_campaign: %s\n", e.what());
    return 2;
  }
}
