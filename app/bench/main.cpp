// SPDX-License-Identifier: BSD-3-Clause
// The program fcl_artic-bench, which measures: bench, compare; and generate, for data to measure with.
#include "bench/bench.h"
#include "bench/compare.h"
#include "bench/generate.h"
#include "program.h"

int main(int argc, char** argv) {
  using namespace fcl_artic::app;
  return runProgram(argc, argv, [](CLI::App& program, int& exit_status) {
    addBench(program, exit_status);
    addCompare(program, exit_status);
    addGenerate(program, exit_status);
  });
}
