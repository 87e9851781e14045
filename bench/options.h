// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <CLI/CLI.hpp>

#include "harness.h"

namespace fcl_artic::bench {

/// Reads the command line by `app` and hands what is left to Google Benchmark (--benchmark_filter and so on).
/// @return the exit status when the program should end now.
inline std::optional<int> readOptions(CLI::App& app, Report& report, int argc, char** argv) {
  app.add_option("--results", report.results_folder, "folder for rows; a folder named for the machine is made in it");
  app.allow_extras();
  app.footer("Google Benchmark's options work too, as --benchmark_filter='5 deg/free' or --benchmark_list_tests=true.");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error);
  }
  std::vector<std::string> rest = app.remaining();
  std::vector<char*> arguments = {argv[0]};  // Google Benchmark keeps the pointer
  for (std::string& argument : rest) arguments.push_back(argument.data());
  int left = static_cast<int>(arguments.size());
  arguments.push_back(nullptr);
  benchmark::Initialize(&left, arguments.data());
  if (benchmark::ReportUnrecognizedArguments(left, arguments.data())) return 1;
  return std::nullopt;
}

}  // namespace fcl_artic::bench
