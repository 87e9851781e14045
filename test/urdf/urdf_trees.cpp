// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <exception>

#include <CLI/CLI.hpp>

#include "tree_campaign.h"

int main(int argc, char** argv) {
  CLI::App app{
      "Random URDF trees, read and asked, against dense sampling. Exit status 0: no fault; 1: faults; 2: wrong use."};
  urdf_trees::Options options;
  app.add_option("--trees", options.trees, "number of trees")->capture_default_str()->check(CLI::PositiveNumber);
  app.add_option("--first", options.first, "number of the first tree")->capture_default_str();
  app.add_option("--seed", options.seed, "seed of the campaign")->capture_default_str();
  app.add_option("--threads", options.threads, "threads")->capture_default_str()->check(CLI::Range(1, 1024));
  app.add_flag("--spoil", options.spoil, "spoil answers on purpose, and count what is noticed");
  CLI11_PARSE(app, argc, argv);
  try {
    const urdf_trees::Report report = urdf_trees::run(options);
    std::fputs(urdf_trees::toText(report).c_str(), stdout);
    return report.missed + report.untrue + report.differing == 0 ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "urdf_trees: %s\n", error.what());
    return 2;
  }
}
