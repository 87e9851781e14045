// SPDX-License-Identifier: BSD-3-Clause
// The program fcl_artic-bench, which measures: bench robot; and generate, for data to measure with.
#include <CLI/CLI.hpp>

#include "bench/generate.h"
#include "bench/robot_bench.h"
#include "program.h"

int main(int argc, char** argv) {
  using namespace fcl_artic::app;
  return runProgram(argc, argv, [](CLI::App& program, int& exit_status) {
    CLI::App* bench = program.add_subcommand("bench", "Benchmarks on one's own machine");
    bench->require_subcommand(1);
    addRobotBench(*bench, exit_status);
    addGenerate(program, exit_status);
  });
}
